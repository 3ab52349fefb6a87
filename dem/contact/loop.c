/* The contact loops, over pairs of particles and over particles and walls.
 *
 * One source, compiled once for each instruction set and normal law (DEM_LAW, set by the build), in it once for each
 * row of the table: the kernels are constants of an always-inlined function, so no call and no branch on a law is left
 * in a loop. With `more` there is one pair of loops for a normal law, in which the scene's other laws are switches.
 * DEM_W contacts go at a time, one a lane, whether they touch or not; what does not touch adds nothing. Forces are
 * added lane after lane, in the order of the list, so the sums are those of a loop over one contact at a time.
 */
#include "dem/contact/loop.h"

#include "dem/contact/cohesion.h"
#include "dem/contact/normal.h"
#include "dem/contact/rolling.h"
#include "dem/contact/tangential.h"
#include "dem/data.h"

#include <stdlib.h>

typedef void normal_law(dem_contact *, vd *history);
typedef dem_tangential tangential_law(dem_contact *, vd *history);

typedef struct batch batch;

/* one row: all of it constant in a loop, but `ncolumn` and `column` with `more` */
typedef struct {
  normal_law *normal;
  tangential_law *tangential;
  int ncolumn, column; /* of history; first of the normal law */
  bool more;
  bool rubs;                               /* there are tangential forces or more: spins matter */
  void (*flush)(dem_loop_task *, batch *); /* wall_batch of this row */
} row;

/* what comes out of a law */
typedef struct {
  vd3 force, twist; /* twist: normal x force */
  vd3 couple;       /* with more: rolling and twisting [N m] */
} outcome;

/* ---- what `more` adds ---- */

DEM_KERNEL dem_tangential tangential_of_scene(dem_contact *c, vd *history) {
  switch (c->model->law->tangential) {
#define X(law, name, ncolumn, vectors, keys) \
  case DEM_TANGENTIAL_##law:                 \
    return dem_tangential_##law(c, history);
    DEM_TANGENTIAL_LIST(X)
#undef X
  default:
    return dem_tangential_none(c, history);
  }
}

DEM_KERNEL void cohesion_of_scene(dem_contact *c, vd *history) {
  switch (c->model->cohesion) {
#define X(law, name, ncolumn, vectors, keys) \
  case DEM_COHESION_##law:                   \
    dem_cohesion_##law(c, history);          \
    break;
    DEM_COHESION_LIST(X)
#undef X
  default:
    break;
  }
}

DEM_KERNEL dem_couple rolling_of_scene(const dem_contact *c, vd3 roll, vd *history) {
  switch (c->model->rolling) {
#define X(law, name, ncolumn, vectors, keys) \
  case DEM_ROLLING_##law:                    \
    return dem_rolling_##law(c, roll, history);
    DEM_ROLLING_LIST(X)
#undef X
  default:
    return dem_rolling_none(c, roll, history);
  }
}

DEM_KERNEL dem_couple twisting_of_scene(const dem_contact *c, vd3 twist) {
  switch (c->model->twisting) {
#define X(law, name, ncolumn, vectors, keys) \
  case DEM_TWISTING_##law:                   \
    return dem_twisting_##law(c, twist);
    DEM_TWISTING_LIST(X)
#undef X
  default:
    return dem_twisting_none(c, twist);
  }
}

/* add the lanes that touch to a mechanism's power and store */
DEM_INLINE void add_flux(dem_flux *flux, int mechanism, const dem_contact *c, vd power, vd elastic) {
  double p[DEM_W], e[DEM_W];
  vd_store(p, vd_only(c->touching, power));
  vd_store(e, vd_only(c->touching, elastic));
  for (int l = 0; l < DEM_W; l++) {
    flux->power[mechanism] += p[l];
    flux->elastic[mechanism] += e[l];
  }
}

DEM_KERNEL void energy_of_scene(dem_flux *flux, int walls, const dem_contact *c, const dem_tangential *t,
                                const dem_couple *couple) {
  int normal = c->model->law->normal == DEM_NORMAL_hysteretic ? DEM_ENERGY_PLASTIC : DEM_ENERGY_NORMAL;
  add_flux(flux, walls + normal, c, (c->force + c->pull) * c->rate, c->elastic);
  add_flux(flux, walls + DEM_ENERGY_TANGENTIAL, c, -vd3_dot(t->force, c->slip), t->elastic);
  add_flux(flux, walls + DEM_ENERGY_ROLLING, c, -vd3_dot(couple->couple, c->spin), couple->elastic);
}

/* rolling and twisting, energies; `walls`: 0, or DEM_ENERGY_WALL_NORMAL for contacts with walls */
DEM_KERNEL vd3 law_more(dem_loop_task *task, dem_contact *c, const dem_tangential *t, vd *h, int walls) {
  const dem_columns *columns = &c->model->columns;
  vd along = vd3_dot(c->spin, c->normal);
  vd3 twist = vd3_scale(along, c->normal);
  dem_couple couple = rolling_of_scene(c, vd3_sub(c->spin, twist), h + (columns->rolling < 0 ? 0 : columns->rolling));
  dem_couple twisting = twisting_of_scene(c, twist);
  couple.couple = vd3_add(couple.couple, twisting.couple);
  if (columns->sliding >= 0)
    h[columns->sliding] = c->sliding;
  if (c->model->energy)
    energy_of_scene(&task->flux, walls, c, t, &couple);
  return vd3_only(c->touching, couple.couple);
}

/* ---- the laws ---- */

/* The laws on DEM_W contacts; `velocity` is the relative velocity at the contact, `history` their slots at stride. */
DEM_KERNEL outcome law(dem_loop_task *task, dem_contact *c, vd3 velocity, double *history, size_t stride, const row r,
                       int walls) {
  vd away = vd3_dot(velocity, c->normal);
  c->rate = -away;
  c->slip = vd3_axpy(-away, c->normal, velocity);
  vd h[DEM_HISTORY_MAX];
  for (int q = 0; q < r.ncolumn; q++)
    h[q] = vd_load(history + (size_t)q * stride);
  r.normal(c, h + r.column);
  if (r.more) {
    const dem_columns *columns = &c->model->columns;
    c->pull = vd_set(0);
    cohesion_of_scene(c, h + (columns->cohesion < 0 ? 0 : columns->cohesion));
    c->sliding = columns->sliding < 0 ? vd_set(0) : h[columns->sliding];
  }
  dem_tangential t = r.tangential(c, h);
  outcome out = {0};
  if (r.more)
    out.couple = law_more(task, c, &t, h, walls);
  for (int q = 0; q < r.ncolumn; q++)
    vd_store(history + (size_t)q * stride, vd_only(c->touching, h[q]));
  vd along = c->force;
  if (r.more)
    along = along + c->pull;
  out.force = vd3_only(c->touching, vd3_axpy(along, c->normal, t.force));
  out.twist = vd3_only(c->touching, vd3_cross(c->normal, t.force));
  return out;
}

/* the row as it is: with `more` the columns are the scene's */
DEM_INLINE row row_of(const dem_model *m, row r) {
  if (r.more) {
    r.ncolumn = m->columns.ncolumn;
    r.column = m->columns.normal < 0 ? 0 : m->columns.normal;
  }
  return r;
}

DEM_INLINE void close_history(double *history, size_t stride, const int ncolumn) {
  for (int q = 0; q < ncolumn; q++)
    vd_store(history + (size_t)q * stride, vd_set(0));
}

/* ---- pairs ---- */

/* relative spins and the rolling inertia of pairs; couples count with both of a pair only if one of them is asked for
 */
DEM_KERNEL void pair_spins(const dem_data *d, const int *i, const int *j, dem_contact *c) {
  double spin[3][DEM_W], inertia[DEM_W];
  for (int l = 0; l < DEM_W; l++) {
    const dem_rotor *a = &d->rotor[i[l]], *b = &d->rotor[j[l]];
    tdm_vec3 w = tdm_sub(tdm_scale(1 / a->radius, a->surface), tdm_scale(1 / b->radius, b->surface));
    spin[0][l] = w.x, spin[1][l] = w.y, spin[2][l] = w.z;
    inertia[l] = d->sphere[i[l]].inverse_mass / (1.4 * a->radius * a->radius) +
                 d->sphere[j[l]].inverse_mass / (1.4 * b->radius * b->radius);
  }
  c->spin = (vd3){vd_load(spin[0]), vd_load(spin[1]), vd_load(spin[2])};
  c->inverse_inertia = vd_load(inertia);
}

/* couples on the particles of pairs, lane after lane: the torque is -radius x twist */
DEM_KERNEL void push_couples(dem_data *d, const int *i, const int *j, const int *sink, unsigned touching, vd3 couple) {
  double m[3][DEM_W];
  vd_store(m[0], couple.x), vd_store(m[1], couple.y), vd_store(m[2], couple.z);
  for (int l = 0; l < DEM_W; l++) {
    if (!(touching >> l & 1))
      continue;
    tdm_vec3 one = {m[0][l], m[1][l], m[2][l]};
    dem_push *a = &d->push[i[l]], *b = &d->push[sink[l]];
    a->twist = tdm_axpy(-1 / d->rotor[i[l]].radius, one, a->twist);
    b->twist = tdm_axpy(1 / d->rotor[j[l]].radius, one, b->twist);
  }
}

/* fetch the partners to come; there is room behind the list */
DEM_INLINE void fetch_ahead(const dem_data *d, const int *j) {
  for (int l = 0; l < DEM_W; l++) {
    __builtin_prefetch(&d->sphere[j[l]]);
    __builtin_prefetch(&d->rotor[j[l]]);
    __builtin_prefetch(&d->push[j[l]], 1);
  }
}

/* To the nearest image, which moves along when the box is strained; s: columns of vd_sphere_difference. */
DEM_INLINE void nearest_image(const dem_data *d, vd s[8]) {
  for (int a = 0; a < 3; a++) {
    if (!d->domain.periodic[a])
      continue;
    vd boxes = vd_rint(s[a] * vd_set(1 / d->domain.length[a]));
    s[a] = s[a] - boxes * vd_set(d->domain.length[a]);
    s[4 + a] = s[4 + a] - boxes * vd_set(d->domain_rate[a]);
  }
}

DEM_KERNEL void pair_loop(dem_loop_task *task, const row constants) {
  const dem_model *m = task->model;
  const row law_row = row_of(m, constants);
  const int ncolumn = law_row.ncolumn;
  dem_data *d = task->data;
  const dem_pairs *list = &d->pairs;
  const dem_sphere *sphere = d->sphere;
  const dem_rotor *rotor = d->rotor;
  dem_push *push = d->push;
  dem_contact c = {.dt = task->dt, .model = m, .more = constants.more};
  const vd reach = vd_set(constants.more ? m->reach : 0);
  c.pair.table = task->settling ? m->settle_pair : m->pair;
  c.pair.one = m->nmaterial == 1;
  const bool repeats = m->domain.repeats, shared = constants.more && task->share != DEM_ALL;
  const bool many = d->nparticle > 20000; /* more than a cache of the second level holds */
  long touching = 0;

  for (size_t k = list->chunk[task->chunk]; k < list->chunk[task->chunk + 1]; k += DEM_W) {
    const int *i = list->one + k, *j = list->other + k;
    if (many)
      fetch_ahead(d, j + 2 * DEM_W);
    vd s[8], b[4] = {vd_set(0), vd_set(0), vd_set(0), vd_set(0)};
    vd_sphere_difference(sphere, i, j, s);
    if (constants.rubs)
      vd_rotor_sum(rotor, i, j, b);
    else
      b[3] = vd_radii(sphere, i) + vd_radii(sphere, j);
    if (repeats)
      nearest_image(d, s);
    vd3 x = {s[0], s[1], s[2]};
    vd r2 = vd3_dot(x, x), sum = b[3], far = sum;
    if (constants.more)
      far = far + reach;
    c.touching = vm_less(r2, far * far);
    vm own = c.touching;
    vd kept[DEM_HISTORY_MAX];
    if (shared) { /* the histories of the other contacts stay */
      vm fast = vm_less(vd_set(1 / m->multi_step.mass), s[7]), all = vm_first(DEM_W);
      own = task->share == DEM_FAST ? fast : vm_without(all, fast);
      c.touching = vm_and(c.touching, own);
      if (!vm_any(own))
        continue;
      for (int q = 0; q < ncolumn; q++)
        kept[q] = vd_load(list->history + (size_t)q * list->capacity + k);
    }
    if (!shared && !vm_any(c.touching)) {
      close_history(list->history + k, list->capacity, ncolumn);
      continue;
    }
    /* one division for the three reciprocals of the distance, the sum of the radii and of the inverse masses */
    vd r = vd_sqrt(vd_max(r2, vd_set(1e-200))), both = r * sum;
    vd per_all = vd_set(1) / (both * s[7]), per_r = per_all * (sum * s[7]), per_sum = per_all * (r * s[7]);
    c.normal = vd3_scale(per_r, x);
    c.normal.z = vd_pick(vm_equal(r2, vd_set(0)), vd_set(1), c.normal.z); /* coincident centres: any direction */
    c.overlap = sum - r;
    c.radius = vd_set(0.25) * (sum * sum - s[3] * s[3]) * per_sum;
    c.inverse_mass = s[7];
    c.mass = per_all * both;
    if (!c.pair.one)
      for (int l = 0; l < DEM_W; l++)
        c.pair.index[l] = d->kind[i[l]] * m->nmaterial + d->kind[j[l]];

    /* the contact divides the distance of the centres as the radii: arms r_i r / (r_i + r_j) */
    vd share = r * per_sum;
    vd3 surface = {b[0], b[1], b[2]};
    c.turn = vd3_dot(surface, c.normal) * per_sum;
    vd3 velocity = {s[4], s[5], s[6]};
    if (constants.rubs)
      velocity = vd3_axpy(-share, vd3_cross(surface, c.normal), velocity);
    if (constants.more)
      pair_spins(d, i, j, &c);
    if (!constants.more)
      touching += __builtin_popcount(vm_bits(c.touching));
    outcome out = law(task, &c, velocity, list->history + k, list->capacity, law_row, 0);
    for (int q = 0; shared && q < ncolumn; q++) {
      double *history = list->history + (size_t)q * list->capacity + k;
      vd_store(history, vd_pick(own, vd_load(history), kept[q]));
    }
    if (constants.more) /* cohesion may have opened some */
      touching += __builtin_popcount(vm_bits(c.touching));
    if (constants.rubs) {
      vd3 twist = vd3_scale(share, out.twist);
      vd_push_pairs(push, i, list->sink + k, (vd[3]){out.force.x, out.force.y, out.force.z},
                    (vd[3]){twist.x, twist.y, twist.z});
    } else {
      vd_push_forces(push, i, list->sink + k, (vd[3]){out.force.x, out.force.y, out.force.z});
    }
    if (constants.more && m->couples)
      push_couples(d, i, j, list->sink + k, vm_bits(c.touching), out.couple);
  }
  task->touching += touching;
}

/* ---- walls ---- */

enum { NX, NY, NZ, OVERLAP, VX, VY, VZ, TURN, RADIUS, PER_MASS, ARM, SX, SY, SZ, PER_INERTIA, WALL_NUMBERS };

/* contacts of walls, gathered until there are DEM_W; columns */
struct batch {
  double number[WALL_NUMBERS][DEM_W];
  double history[DEM_HISTORY_MAX][DEM_W];
  int entry[DEM_W], body[DEM_W], index[DEM_W];
  tdm_vec3 lever[DEM_W], velocity[DEM_W]; /* of the contact point from the body's centre; of the wall there */
  int count;
};

/* couples of wall contacts, on the particle and on the body, and the power of the wall */
DEM_KERNEL void push_wall_more(dem_loop_task *task, const batch *b, int l, tdm_vec3 force, tdm_vec3 couple) {
  const dem_model *m = task->model;
  dem_data *d = task->data;
  dem_push *push = &d->push[d->walls.entry[b->entry[l]].particle];
  push->twist = tdm_axpy(-1 / b->number[RADIUS][l], couple, push->twist);
  tdm_wrench *load = &d->chunk_load[task->chunk * m->nbody + b->body[l]];
  load->moment = tdm_sub(load->moment, couple);
  if (m->energy)
    task->flux.wall_power += tdm_dot(force, b->velocity[l]) + tdm_dot(couple, d->twist[b->body[l]].angular);
}

DEM_KERNEL void wall_batch(dem_loop_task *task, batch *b, const row r) {
  const dem_model *m = task->model;
  dem_data *d = task->data;
  const dem_wall_contacts *list = &d->walls;
  const int ncolumn = r.ncolumn;
  dem_contact c = {.dt = task->dt, .touching = vm_first(b->count), .model = m, .more = r.more};
  c.pair.table = task->settling ? m->settle_pair : m->pair;
  c.pair.one = m->nmaterial == 1;
  memcpy(c.pair.index, b->index, sizeof b->index);
  double(*v)[DEM_W] = b->number;
  c.normal = (vd3){vd_load(v[NX]), vd_load(v[NY]), vd_load(v[NZ])};
  c.overlap = vd_load(v[OVERLAP]);
  c.radius = vd_load(v[RADIUS]);
  c.inverse_mass = vd_load(v[PER_MASS]);
  c.mass = vd_set(1) / c.inverse_mass;
  c.turn = vd_load(v[TURN]);
  vd3 velocity = {vd_load(v[VX]), vd_load(v[VY]), vd_load(v[VZ])};
  if (r.more) {
    c.spin = (vd3){vd_load(v[SX]), vd_load(v[SY]), vd_load(v[SZ])};
    c.inverse_inertia = vd_load(v[PER_INERTIA]);
  }
  outcome out = law(task, &c, velocity, b->history[0], DEM_W, r, DEM_ENERGY_WALL_NORMAL);

  double f[6][DEM_W], couple[3][DEM_W];
  if (r.more)
    vd_store(couple[0], out.couple.x), vd_store(couple[1], out.couple.y), vd_store(couple[2], out.couple.z);
  vd_store(f[0], out.force.x), vd_store(f[1], out.force.y), vd_store(f[2], out.force.z);
  vd_store(f[3], out.twist.x), vd_store(f[4], out.twist.y), vd_store(f[5], out.twist.z);
  for (int l = 0; l < b->count; l++) {
    size_t k = (size_t)b->entry[l];
    for (int q = 0; q < ncolumn; q++)
      list->history[(size_t)q * list->capacity + k] = b->history[q][l];
    dem_push *push = &d->push[list->entry[k].particle];
    tdm_vec3 force = {f[0][l], f[1][l], f[2][l]}, twist = {f[3][l], f[4][l], f[5][l]};
    push->force = tdm_add(push->force, force);
    push->twist = tdm_axpy(v[ARM][l], twist, push->twist);
    tdm_wrench *load = &d->chunk_load[task->chunk * m->nbody + b->body[l]];
    load->force = tdm_sub(load->force, force);
    load->moment = tdm_sub(load->moment, tdm_cross(b->lever[l], force));
    if (r.more)
      push_wall_more(task, b, l, force, (tdm_vec3){couple[0][l], couple[1][l], couple[2][l]});
  }
  task->touching += __builtin_popcount(vm_bits(c.touching));
  b->count = 0;
}

DEM_INLINE void close_entry(const dem_wall_contacts *list, size_t k, const int ncolumn) {
  for (int q = 0; q < ncolumn; q++)
    list->history[(size_t)q * list->capacity + k] = 0;
}

/* does this evaluation leave the particle's contacts with a body out? */
DEM_INLINE bool left_out(const dem_loop_task *task, const dem_sphere *s, int body) {
  if (task->share != DEM_ALL && (task->share == DEM_FAST) != (s->inverse_mass * task->model->multi_step.mass > 1))
    return true;
  return s->inverse_mass == 0 && (task->settling || task->data->body_inverse[body] == 0); /* neither can move */
}

/* One contact of entry k, on the wall's surface at `gap` from the particle's centre, into the batch. */
DEM_KERNEL void add_to_batch(dem_loop_task *task, batch *b, size_t k, double gap, tdm_vec3 n, const row r) {
  const dem_model *m = task->model;
  dem_data *d = task->data;
  const dem_wall_contacts *list = &d->walls;
  int i = list->entry[k].particle, w = list->entry[k].wall, body = m->wall[w].body, l = b->count++;
  const dem_sphere *s = &d->sphere[i];
  tdm_vec3 point = tdm_axpy(-gap, n, s->position), lever = tdm_sub(point, d->pose[body].position);
  tdm_twist now = d->twist[body];
  tdm_vec3 wall_v = tdm_add(now.velocity, tdm_cross(now.angular, lever));
  if (m->wall[w].moves && !task->settling) { /* along itself */
    tdm_vec3 belt = dem_wall_surface(&m->wall[w], &d->wall[w], point);
    wall_v = tdm_add(wall_v, tdm_axpy(-tdm_dot(belt, n), n, belt));
  }
  double arm = gap / s->radius;
  tdm_vec3 v = r.rubs ? tdm_axpy(-arm, tdm_cross(d->rotor[i].surface, n), s->velocity) : s->velocity;
  v = tdm_sub(v, wall_v);
  /* a held body is immovable; a coupled one has its own mass */
  double per_mass = s->inverse_mass + (task->settling ? 0 : d->body_inverse[body]);
  const double numbers[] = {n.x,       n.y,      n.z, s->radius - gap, v.x, v.y, v.z, tdm_dot(now.angular, n),
                            s->radius, per_mass, arm};
  for (int q = 0; q <= ARM; q++)
    b->number[q][l] = numbers[q];
  if (r.more) {
    tdm_vec3 spin = tdm_axpy(1 / s->radius, d->rotor[i].surface, tdm_scale(-1, now.angular));
    b->number[SX][l] = spin.x, b->number[SY][l] = spin.y, b->number[SZ][l] = spin.z;
    b->number[PER_INERTIA][l] = s->inverse_mass / (1.4 * s->radius * s->radius);
    b->velocity[l] = wall_v;
  }
  for (int q = 0; q < r.ncolumn; q++)
    b->history[q][l] = list->history[(size_t)q * list->capacity + k];
  b->entry[l] = (int)k;
  b->body[l] = body;
  b->index[l] = d->kind[i] * m->nmaterial + m->body[body].material;
  b->lever[l] = lever;
  if (b->count == DEM_W)
    r.flush(task, b);
}

/* ---- walls with one contact ---- */

DEM_KERNEL void simple_wall(dem_loop_task *task, batch *b, size_t begin, size_t end, const row r) {
  const dem_model *m = task->model;
  dem_data *d = task->data;
  const dem_wall_contacts *list = &d->walls;
  if (begin == end)
    return;
  const dem_wall *wall = &m->wall[list->entry[begin].wall];
  const dem_wall_place *place = &d->wall[list->entry[begin].wall];
  const double reach = r.more ? m->reach : 0;
  const bool endless = dem_wall_endless(wall);
  for (size_t k = begin; k < end; k++) {
    const dem_sphere *s = &d->sphere[list->entry[k].particle];
    if (left_out(task, s, wall->body))
      continue;
    tdm_vec3 n;
    double gap = dem_wall_gap(wall, place, s->position, &n);
    if (gap >= s->radius + reach || (endless && gap <= -s->radius))
      close_entry(list, k, r.ncolumn);
    else
      add_to_batch(task, b, k, gap, n, r);
  }
}

/* ---- planes, DEM_W particles at a time ---- */

/* end - begin is a multiple of DEM_W; the same numbers, in the same order, as simple_wall */
DEM_KERNEL void plane(dem_loop_task *task, size_t begin, size_t end, const row r) {
  const dem_model *m = task->model;
  dem_data *d = task->data;
  const dem_wall_contacts *list = &d->walls;
  if (begin == end)
    return;
  int w = list->entry[begin].wall, body = m->wall[w].body;
  tdm_vec3 normal = d->wall[w].normal, on = d->wall[w].point, center = d->pose[body].position;
  tdm_twist now = d->twist[body];
  dem_contact c = {.dt = task->dt, .model = m};
  c.pair.table = task->settling ? m->settle_pair : m->pair;
  c.pair.one = m->nmaterial == 1;
  c.normal = (vd3){vd_set(normal.x), vd_set(normal.y), vd_set(normal.z)};
  c.turn = vd_set(tdm_dot(now.angular, normal));
  const vd3 spin = {vd_set(now.angular.x), vd_set(now.angular.y), vd_set(now.angular.z)};
  const vd3 drift = {vd_set(now.velocity.x), vd_set(now.velocity.y), vd_set(now.velocity.z)};
  const vd per_body = vd_set(task->settling ? 0 : d->body_inverse[body]);
  tdm_wrench *load = &d->chunk_load[task->chunk * m->nbody + body];

  for (size_t k = begin; k < end; k += DEM_W) {
    int i[DEM_W];
    for (int l = 0; l < DEM_W; l++)
      i[l] = list->entry[k + (size_t)l].particle;
    vd s[8], b[4];
    vd_spheres(d->sphere, i, s);
    vd3 x = {s[0], s[1], s[2]};
    vd3 above = {x.x - vd_set(on.x), x.y - vd_set(on.y), x.z - vd_set(on.z)};
    vd gap = vd3_dot(above, c.normal), radius = s[3];
    c.touching = vm_and(vm_less(gap, radius), vm_less(-radius, gap));
    double *history = list->history + k;
    if (!vm_any(c.touching)) {
      close_history(history, list->capacity, r.ncolumn);
      continue;
    }
    vd3 velocity = {s[4], s[5], s[6]};
    vd3 lever = vd3_sub(vd3_axpy(-gap, c.normal, x), (vd3){vd_set(center.x), vd_set(center.y), vd_set(center.z)});
    vd3 of_wall = vd3_add(drift, vd3_cross(spin, lever));
    vd arm = gap / radius;
    if (r.rubs) {
      vd_rotor_sum(d->rotor, i, i, b);
      vd3 surface = {vd_set(0.5) * b[0], vd_set(0.5) * b[1], vd_set(0.5) * b[2]};
      velocity = vd3_axpy(-arm, vd3_cross(surface, c.normal), velocity);
    }
    velocity = vd3_sub(velocity, of_wall);
    c.overlap = radius - gap;
    c.radius = radius;
    c.inverse_mass = s[7] + per_body;
    c.mass = vd_set(1) / c.inverse_mass;
    if (!c.pair.one)
      for (int l = 0; l < DEM_W; l++)
        c.pair.index[l] = d->kind[i[l]] * m->nmaterial + m->body[body].material;
    outcome out = law(task, &c, velocity, history, list->capacity, r, 0);
    vd3 twist = vd3_scale(vd_pick(c.touching, arm, vd_set(0)), out.twist);
    vd3 moment = vd3_only(c.touching, vd3_cross(lever, out.force));
    vd_push_walls(d->push, i, (vd[3]){out.force.x, out.force.y, out.force.z}, (vd[3]){twist.x, twist.y, twist.z},
                  (vd[3]){moment.x, moment.y, moment.z}, load);
    task->touching += __builtin_popcount(vm_bits(c.touching));
  }
}

/* ---- meshes ---- */

/* Hand the history of a contact that ended on a triangle to the one that begins on a neighbour. Entries begin ... end
 * are those of one particle; holds[k - begin]: a contact is there now. */
static void pass_histories(const dem_mesh *mesh, const dem_wall_contacts *list, size_t begin, size_t end,
                           const bool *holds, int ncolumn) {
  for (size_t to = begin; to < end; to++) {
    bool fresh = holds[to - begin];
    for (int q = 0; q < ncolumn && fresh; q++)
      fresh = list->history[(size_t)q * list->capacity + to] == 0;
    for (size_t from = begin; from < end && fresh; from++) {
      bool kept = false;
      for (int q = 0; q < ncolumn && !holds[from - begin]; q++)
        kept = kept || list->history[(size_t)q * list->capacity + from] != 0;
      if (!kept || !dem_mesh_passes(mesh, list->entry[from].part, list->entry[to].part))
        continue;
      for (int q = 0; q < ncolumn; q++) {
        double *column = list->history + (size_t)q * list->capacity;
        column[to] = column[from];
        column[from] = 0;
      }
      fresh = false;
    }
  }
}

/* the contacts of one particle with a mesh: entries begin ... end */
DEM_KERNEL void mesh_of_one(dem_loop_task *task, batch *b, size_t begin, size_t end, const row r) {
  const dem_model *m = task->model;
  dem_data *d = task->data;
  const dem_wall_contacts *list = &d->walls;
  int i = list->entry[begin].particle, w = list->entry[begin].wall;
  const dem_mesh *mesh = m->wall[w].mesh;
  const dem_sphere *s = &d->sphere[i];
  if (left_out(task, s, m->wall[w].body))
    return;
  size_t many = end - begin;
  int small_near[256], *near = many <= 256 ? small_near : malloc(many * sizeof *near);
  bool small_holds[256], *holds = many <= 256 ? small_holds : malloc(many * sizeof *holds);
  memset(holds, 0, many * sizeof *holds);
  size_t at[DEM_MESH_CONTACTS_MAX];
  dem_mesh_contact found[DEM_MESH_CONTACTS_MAX];
  for (size_t k = begin; k < end; k++)
    near[k - begin] = list->entry[k].part;
  int n = dem_mesh_contacts(mesh, near, (int)(end - begin), dem_wall_own(&d->wall[w], s->position),
                            s->radius + (r.more ? m->reach : 0), found, DEM_MESH_CONTACTS_MAX);
  size_t k = begin;
  for (int c = 0; c < n; c++) { /* both ascend */
    while (list->entry[k].part != found[c].triangle)
      k++;
    holds[k - begin] = true;
    at[c] = k;
  }
  pass_histories(mesh, list, begin, end, holds, r.ncolumn);
  for (k = begin; k < end; k++)
    if (!holds[k - begin])
      close_entry(list, k, r.ncolumn);
  for (int c = 0; c < n; c++)
    add_to_batch(task, b, at[c], found[c].gap, tdm_m3_mul(d->wall[w].axes, found[c].normal), r);
  if (many > 256) {
    free(near);
    free(holds);
  }
}

DEM_KERNEL void mesh_wall(dem_loop_task *task, batch *b, size_t begin, size_t end, const row r) {
  const dem_wall_contacts *list = &task->data->walls;
  for (size_t k = begin, next; k < end; k = next) {
    next = k + 1;
    while (next < end && list->entry[next].particle == list->entry[k].particle)
      next++;
    mesh_of_one(task, b, k, next, r);
  }
}

/* ---- all walls ---- */

DEM_KERNEL void wall_loop(dem_loop_task *task, const row constants) {
  const dem_model *m = task->model;
  const row r = row_of(m, constants);
  const dem_wall_contacts *list = &task->data->walls;
  batch b = {0};
  for (int l = 0; l < DEM_W; l++) /* lanes that stay empty compute with harmless numbers */
    b.number[RADIUS][l] = b.number[PER_MASS][l] = b.number[OVERLAP][l] = b.number[PER_INERTIA][l] = 1;

  size_t last = list->chunk[task->chunk + 1];
  for (size_t k = list->chunk[task->chunk], next; k < last; k = next) {
    const dem_wall *wall = &m->wall[list->entry[k].wall];
    for (next = k + 1; next < last && list->entry[next].wall == list->entry[k].wall;)
      next++;
    if (wall->primitive == DEM_MESH) {
      mesh_wall(task, &b, k, next, r);
    } else {
      bool whole = !constants.more && wall->primitive == DEM_PLANE && !wall->moves && !m->driven;
      size_t rest = whole ? next - (next - k) % DEM_W : k;
      plane(task, k, rest, r);
      simple_wall(task, &b, rest, next, r);
    }
    if (b.count > 0) /* so that sums are in the order of the list */
      r.flush(task, &b);
  }
}

/* ---- the rows of this normal law ---- */

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define ROWS JOIN(DEM_LAWS_, DEM_LAW)

#define ROW(n, t)                                                                                 \
  ((row){dem_normal_##n, dem_tangential_##t, DEM_NORMAL_COLUMNS_##n + DEM_TANGENTIAL_COLUMNS_##t, \
         DEM_TANGENTIAL_COLUMNS_##t, false, DEM_TANGENTIAL_##t != DEM_TANGENTIAL_none, batch_##t})
#define X(n, t)                                                                    \
  static __attribute__((noinline)) void batch_##t(dem_loop_task *task, batch *b) { \
    wall_batch(task, b, ROW(n, t));                                                \
  }                                                                                \
  static void pairs_##t(dem_loop_task *task) {                                     \
    pair_loop(task, ROW(n, t));                                                    \
  }                                                                                \
  static void walls_##t(dem_loop_task *task) {                                     \
    wall_loop(task, ROW(n, t));                                                    \
  }
ROWS(X)
#undef X

#define ROW_MORE ((row){JOIN(dem_normal_, DEM_LAW), tangential_of_scene, 0, 0, true, true, batch_more})

static __attribute__((noinline)) void batch_more(dem_loop_task *task, batch *b) {
  wall_batch(task, b, row_of(task->model, ROW_MORE));
}

static void pairs_more(dem_loop_task *task) {
  pair_loop(task, ROW_MORE);
}

static void walls_more(dem_loop_task *task) {
  wall_loop(task, ROW_MORE);
}

const dem_law DEM_ISA(JOIN(dem_laws_, DEM_LAW))[] = {
#define X(n, t)                                                      \
  {DEM_NORMAL_##n, DEM_TANGENTIAL_##t, false, pairs_##t, walls_##t}, \
      {DEM_NORMAL_##n, DEM_TANGENTIAL_##t, true, pairs_more, walls_more},
    ROWS(X)
#undef X
        {0}};
