/* Multi-contact law mc-strain (Brodu, Dijksman & Behringer 2015): [G21] Eq. 7-8 with the conventions of its errata 2.
 *   F = 4/3 E* sqrt(R*) (delta + gamma sum S_k)^1.5 + damping, not less than 0 inside the brackets,
 *   S_k = -(1+nu) F_k / (2 pi E d) [a b + (3-4nu) g - (1-2nu) (g + b)/(1 + a)],   a = n_k.u, b = n_c.u, g = n_k.n_c
 * The sum goes over the other contacts k of both particles: by S_k the force F_k moves the surface of their common
 * particle (E, nu) outward at contact c. Normals point into that particle, u from k to c, d is their distance; all
 * follow from g and the arms, the distances of the contacts from the centre. Where two contacts are nearer to each
 * other than the radius of one's circle, d is that radius: a force on a circle moves nothing as far as one on a point.
 *
 * F_k is the elastic force of the step before ("first_forces": "last", which a contact remembers), or Hertz's at its
 * overlap ("hertz"). With "iterations" the forces that follow take its place, so often, or until none changes by more
 * than "tolerance" times the largest.
 *
 * The corrected overlap makes the contact's circle, and with it damping and tangential stiffness. Friction is limited
 * by the whole force.
 *
 * Stored: 2/5 F (delta + s) - F s/2, s = gamma sum S_k. That is the potential of contacts whose S_k are constant and
 * symmetric multiples of F_k and have come to rest; they nearly are.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/contact/law/law.h"
#include "dem/contact/law/theory.h"
#include "dem/contact/normal/hertz.h"
#include "dem/seam/notes.h"

/* of pair.multi */
enum { GAMMA };
/* of model.multi_setting */
enum { FROM_HERTZ, ITERATIONS, TOLERANCE };

DEM_KERNEL void kernel(dem_contact *c, vd *history) {
  vd shift = DEM_OF(c, multi[GAMMA]) * c->shift, overlap = vd_max(c->overlap + shift, vd_set(0));
  vd elastic = dem_hertz_elastic(c, overlap);
  dem_hertz_damp(c, elastic);
  c->elastic = elastic * (vd_set(0.4) * overlap - vd_set(0.5) * shift);
  if (c->dt > 0)
    history[0] = elastic;
}

DEM_KERNEL void note(const dem_contact *c, const vd *history, dem_note *n) {
  const double *setting = c->model->multi_setting;
  dem_contact copy = *c;
  n->force = setting[FROM_HERTZ] != 0 ? dem_hertz_elastic(&copy, c->overlap) : history[0];
  n->again = setting[ITERATIONS] > 1;
  if (n->again) {
    n->hertz = vd_set(4.0 / 3) * DEM_OF(c, effective_young) * vd_sqrt(c->radius);
    n->weight = DEM_OF(c, multi[GAMMA]);
  }
}

/* ---- what the contacts of a particle give each other ---- */

enum { ROW_X, ROW_Y, ROW_Z, ROW_ARM, ROW_WIDTH, ROW_FORCE, ROW_GIVEN, ROW_BACK };

/* The contacts of a particle in rows, each row twice, one behind the other, so that lane after lane may look at the
 * contact o places on; behind them lanes that are harmless. Returns how many there are; `place` is theirs. */
static int gather(const dem_data *d, int particle, double *row[], int *place) {
  const dem_notes *notes = &d->work.notes;
  const double *column = notes->column, radius = d->state.sphere[particle].radius;
  const size_t stride = notes->stride;
  int z = 0;
  for (int q = notes->first[particle]; q < notes->first[particle + 1]; q++) {
    const size_t k = (size_t)notes->place[q] / 2;
    if (!(column[DEM_NOTE_WIDTH * stride + k] > 0))
      continue;
    double sign = notes->place[q] & 1 ? -1 : 1;
    row[ROW_X][z] = sign * column[DEM_NOTE_X * stride + k];
    row[ROW_Y][z] = sign * column[DEM_NOTE_Y * stride + k];
    row[ROW_Z][z] = sign * column[DEM_NOTE_Z * stride + k];
    row[ROW_ARM][z] = radius * column[DEM_NOTE_SHARE * stride + k];
    row[ROW_WIDTH][z] = column[DEM_NOTE_WIDTH * stride + k];
    row[ROW_FORCE][z] = column[DEM_NOTE_FORCE * stride + k];
    place[z++] = notes->place[q];
  }
  for (int r = ROW_X; r <= ROW_FORCE && z > 1; r++)
    for (int c = 0; c < z + DEM_LANES_MAX; c++)
      row[r][z + c] = c < z ? row[r][c] : row[r][0];
  return z;
}

/* 1/d [a b + (3-4nu) g - (1-2nu) (g + b)/(1 + a)] and the same from c to k; A = d a, B = d b */
typedef struct {
  vd to, back;
} influence;

DEM_KERNEL influence influence_of(vd A, vd B, vd g, vd d2, double poisson) {
  vd d = vd_sqrt(d2);
  const double rest = 1 - 2 * poisson;
  if (rest == 0) {
    vd per = vd_set(1) / d, both = (A * B * (per * per) + g) * per;
    return (influence){both, both};
  }
  vd a = d + A, b = d - B, per = vd_set(1) / (d * a * b), per_d = per * a * b; /* one division for all */
  vd both = (A * B * (per_d * per_d) + vd_set(3 - 4 * poisson) * g) * per_d;
  return (influence){both - vd_set(rest) * (g * d + B) * (per * b), both - vd_set(rest) * (g * d - A) * (per * a)};
}

/* Contacts c and those o places on, k: each pair once, or, where o is half of all, only from k to c. */
DEM_KERNEL void give(double *row[], int z, int o, double poisson) {
  const bool both = 2 * o < z;
  for (int c = 0; c < z; c += DEM_W) {
    vd n[3], m[3];
    for (int q = 0; q < 3; q++)
      n[q] = vd_load(row[q] + c), m[q] = vd_load(row[q] + c + o);
    vd g = n[0] * m[0] + n[1] * m[1] + n[2] * m[2], arm = vd_load(row[ROW_ARM] + c),
       far = vd_load(row[ROW_ARM] + c + o);
    vd least = vd_max(vd_load(row[ROW_WIDTH] + c), vd_load(row[ROW_WIDTH] + c + o)), inner = arm * g;
    vd d2 = vd_max(far * (far - (inner + inner)) + arm * arm, least);
    influence i = influence_of(far - inner, far * g - arm, g, d2, poisson);
    vd_store(row[ROW_GIVEN] + c, vd_load(row[ROW_GIVEN] + c) + vd_load(row[ROW_FORCE] + c + o) * i.to);
    if (both)
      vd_store(row[ROW_BACK] + c + o, vd_load(row[ROW_BACK] + c + o) + vd_only(vm_first(z - c < DEM_W ? z - c : DEM_W),
                                                                               vd_load(row[ROW_FORCE] + c) * i.back));
  }
}

DEM_KERNEL void share(dem_loop_task *task) {
  dem_data *d = task->data;
  const dem_notes *notes = &d->work.notes;
  double *row[DEM_NOTE_ROWS], *room = notes->room + (size_t)task->chunk * DEM_NOTE_ROWS * notes->row;
  for (size_t r = 0; r < DEM_NOTE_ROWS; r++)
    row[r] = room + r * notes->row;
  int *place = (int *)row[DEM_NOTE_ROWS - 1];
  for (int p = task->chunk * DEM_CHUNK, end = dem_chunk_end(d, task->chunk); p < end; p++) {
    const dem_material *of = &task->model->material[d->state.material[p]];
    const double poisson = of->poisson, unit = -(1 + poisson) / (2 * M_PI * of->young);
    const int z = gather(d, p, row, place);
    memset(row[ROW_GIVEN], 0, (size_t)(z + DEM_LANES_MAX) * sizeof(double));
    memset(row[ROW_BACK], 0, (size_t)(2 * z + DEM_LANES_MAX) * sizeof(double));
    for (int o = 1; 2 * o <= z; o++)
      give(row, z, o, poisson);
    for (int c = 0; c < z; c++) {
      double *side = notes->column + (DEM_NOTE_SIDE + (size_t)(place[c] & 1)) * notes->stride;
      side[place[c] / 2] = unit * (row[ROW_GIVEN][c] + (row[ROW_BACK][c] + row[ROW_BACK][c + z]));
    }
  }
}

/* ---- iterations ---- */

/* places from `begin` on */
DEM_KERNEL double renew(dem_notes *notes, size_t begin, size_t end, double *largest) {
  double *column[DEM_NOTES], change = 0;
  for (size_t q = 0; q < DEM_NOTES; q++)
    column[q] = notes->column + q * notes->stride;
  for (size_t k = begin; k < end; k++) {
    if (!(column[DEM_NOTE_WIDTH][k] > 0))
      continue;
    double shift = column[DEM_NOTE_WEIGHT][k] * (column[DEM_NOTE_SIDE][k] + column[DEM_NOTE_OTHER][k]);
    double overlap = column[DEM_NOTE_OVERLAP][k] + shift, before = column[DEM_NOTE_FORCE][k];
    overlap = overlap > 0 ? overlap : 0;
    double force = column[DEM_NOTE_HERTZ][k] * (overlap * sqrt(overlap));
    column[DEM_NOTE_FORCE][k] = force;
    double changed = fabs(force - before);
    change = changed > change ? changed : change;
    *largest = force > *largest ? force : *largest;
  }
  return change;
}

DEM_KERNEL double again(dem_loop_task *task, double *largest) {
  dem_data *d = task->data;
  *largest = 0;
  double pairs =
      renew(&d->work.notes, d->lists.pairs.chunk[task->chunk], d->lists.pairs.chunk[task->chunk + 1], largest);
  double walls =
      renew(&d->work.notes, dem_note_of_wall(d, task->wall_first), dem_note_of_wall(d, task->wall_end), largest);
  return fmax(pairs, walls);
}

#define DEM_LAW mc_strain
#define DEM_LAW_KERNEL kernel
#define DEM_LAW_COLUMNS 1
#define DEM_LAW_CIRCLE true
#define DEM_LAW_PLANES 1
#define DEM_LAW_NOTES_KERNEL note
#define DEM_LAW_NOTES_SHARE share
#define DEM_LAW_NOTES_AGAIN again
#define DEM_LAW_NOTES_ITERATIONS(model) (long)(model)->multi_setting[ITERATIONS]
#define DEM_LAW_NOTES_TOLERANCE(model) (model)->multi_setting[TOLERANCE]
#include "dem/contact/loop/loops.h"

#if DEM_SIMD == 0

static void read_settings(dem_model *m, tdm_object *o) {
  static const char *const forces[] = {"last", "hertz"};
  m->multi_setting[FROM_HERTZ] = tdm_get_choice(o, "first_forces", forces, 2, 0) == 1;
  m->multi_setting[TOLERANCE] = tdm_get_number(o, "tolerance", 0, TDM_NOT_NEGATIVE);
  m->multi_setting[ITERATIONS] = (double)tdm_get_integer(o, "iterations", m->multi_setting[TOLERANCE] > 0 ? 100 : 1, 1);
  if (m->multi_setting[TOLERANCE] > 0 && m->multi_setting[ITERATIONS] < 2)
    tdm_object_fail(o, "tolerance", "needs 2 iterations or more to compare; remove it, or raise \"iterations\"");
}

static void read(const dem_model *m, tdm_object *o, const dem_material *a, const dem_material *b, dem_pair *p) {
  (void)m, (void)a, (void)b;
  p->multi[GAMMA] = dem_need(o, "gamma", "multi_contact", "mc-strain", TDM_NOT_NEGATIVE);
}

/* ---- a contact among others ---- */

static double shift_of(const dem_data *d, const dem_among *c) {
  if (!d->work.among)
    return 0;
  const double *side = d->work.notes.column + DEM_NOTE_SIDE * d->work.notes.stride;
  return c->pair->multi[GAMMA] * (side[c->place] + (c->other < 0 ? 0 : side[d->work.notes.stride + c->place]));
}

static double overlap_of(const dem_data *d, const dem_among *c) {
  return fmax(c->overlap + shift_of(d, c), 0);
}

/* With forces that all grow alike the shift grows with them: dF = S (d delta + s/F dF). The share that comes back is
 * taken as at most 0.9 of what went out: at 1 nothing holds. */
static double stiffness_of(const dem_data *d, const dem_among *c) {
  double shift = shift_of(d, c), overlap = fmax(c->overlap + shift, 1e-12 * c->overlap);
  double back = fmin(fmax(1.5 * shift / overlap, 0), 0.9);
  return dem_normal_stiffness(d->model, c->pair, c->at, overlap) / (1 - back);
}

static double elastic_of(const dem_data *d, const dem_among *c) {
  double shift = shift_of(d, c), overlap = c->overlap + shift;
  return overlap > 0 ? dem_normal_force(d->model, c->pair, c->at, overlap) * (0.4 * overlap - 0.5 * shift) : 0;
}

const dem_multi_law dem_multi_mc_strain = {
    .head = {.name = "mc-strain",
             .needs_young = true,
             .ncolumn = DEM_LAW_COLUMNS,
             .keys = {{.name = "gamma", .example = 1}}},
    .setting_keys = {"first_forces", "iterations", "tolerance"},
    .read_settings = read_settings,
    .read = read,
    .overlap = overlap_of,
    .stiffness = stiffness_of,
    .elastic = elastic_of,
    .loops = DEM_LAW_LOOPS,
};
#endif
