/* Particles that come and go, and their order: see particles.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/particles/particles.h"

#include "dem/model/integrator.h"
#include "dem/particles/field.h"
#include "dem/state/crossings.h"
#include "dem/state/wall_gap.h"

#include <string.h>

/* the energy of particle i, which came (1) or goes (-1) */
static void note_flow(dem_data *d, int i, double sign) {
  double potential, kinetic = dem_particle_energy(d, i, &potential);
  d->state.energy_balance.flow += sign * (kinetic + potential);
}

tdm_status dem_data_add(dem_data *d, const dem_newcomer *newcomer) {
  if (dem_data_reserve(d, d->state.nparticle + 1))
    return TDM_ERR_MEMORY;
  int i = d->state.nparticle++;
  d->state.id[i] = d->state.ledger.created++;
  d->state.mass[i] = newcomer->mass;
  d->state.material[i] = newcomer->material;
  d->state.touched[i] = 0;
  if (d->model->ncontainer > 0)
    d->state.held[i] = 0;
  const dem_model *m = d->model;
  tdm_vec3 velocity = dem_flatten(m, newcomer->velocity, 0);
  d->state.sphere[i] = (dem_sphere){newcomer->position, newcomer->radius, velocity, 1 / newcomer->mass};
  d->state.rotor[i] = (dem_rotor){.radius = newcomer->radius};
  d->state.pace[i] = (dem_pace){.velocity = velocity};
  d->state.push[i] = (dem_push){0};
  if (d->state.spare_push)
    d->state.spare_push[i] = (dem_push){0};
  if (m->driven)
    d->state.drive[i] = (dem_pace){0};
  if (m->oriented)
    d->state.orientation[i] = tdm_quat_identity();
  if (m->screening.watched)
    d->state.spot[i] = (dem_spot){0};
  if (m->integrator->remember && !d->state.restart)
    m->integrator->remember(d, i, i + 1, d->state.memory_dt);
  d->lists.position_at_list[i] = newcomer->position;
  dem_data_end(d);
  dem_exact_sum_add(&d->state.ledger.mass, newcomer->mass);
  note_flow(d, i, 1);
  dem_mark_front(d, i);
  /* an empty row, so that the histories of the others are carried over at the rebuild */
  d->lists.pairs.first[i + 1] = d->lists.pairs.first[i];
  dem_crossings_forget(d); /* their places follow the last particle, and are empty between steps */
  d->lists.stale = true;
  return TDM_OK;
}

/* Drop the rows of particles that go and the entries that name one. The rest is renumbered; the entries of one chunk
 * are filled up again. */
static void remove_pairs(dem_pairs *list, int before, int after, const int *number, int ncolumn) {
  size_t out = 0;
  for (int i = 0; i < before; i++) {
    int begin = list->first[i], end = list->first[i + 1];
    if (number[i] < 0)
      continue;
    list->first[number[i]] = (int)out; /* number[i] <= i: the rows to come are untouched */
    for (int k = begin; k < end; k++) {
      int other = list->other[k];
      if (other >= before || number[other] < 0) /* none, or gone */
        continue;
      list->one[out] = number[i];
      list->other[out] = list->reaction_slot[out] = number[other];
      for (size_t q = 0; q < (size_t)ncolumn; q++)
        list->history[q * list->capacity + out] = list->history[q * list->capacity + (size_t)k];
      out++;
    }
  }
  for (; out % DEM_LANES_MAX != 0; out++)
    list->one[out] = list->other[out] = list->reaction_slot[out] = after;
  list->first[after] = (int)out;
  list->count = out;
}

static void remove_walls(dem_wall_contacts *list, const int *number, int ncolumn) {
  size_t out = 0;
  for (size_t k = 0; k < list->count; k++) {
    dem_wall_entry e = list->entry[k];
    if (number[e.particle] < 0)
      continue;
    e.particle = number[e.particle];
    list->entry[out] = e;
    for (size_t q = 0; q < (size_t)ncolumn; q++)
      list->history[q * list->capacity + out] = list->history[q * list->capacity + k];
    out++;
  }
  list->count = out;
}

void dem_data_remove(dem_data *d, const int *gone) {
  int before = d->state.nparticle, after = 0, *number = d->work.number;
  for (int i = 0; i < before; i++)
    number[i] = gone[i] >= 0 ? -1 : after++;
  if (after == before)
    return;
  int ncolumn = d->model->columns.ncolumn;
  remove_pairs(&d->lists.pairs, before, after, number, ncolumn);
  remove_walls(&d->lists.walls, number, ncolumn);
  for (int i = 0; i < before; i++) {
    if (number[i] < 0) {
      d->state.ledger.removed++;
      dem_exact_sum_add(&d->state.ledger.mass, -d->state.mass[i]);
      note_flow(d, i, -1);
      continue;
    }
    d->state.push[number[i]] = d->state.push[i];
    if (d->state.spare_push)
      d->state.spare_push[number[i]] = d->state.spare_push[i];
#define X(field, n, name)                                                                 \
  memmove(&d->field[(size_t)number[i] * (size_t)(n)], &d->field[(size_t)i * (size_t)(n)], \
          (size_t)(n) * sizeof *d->field);
    DEM_PARTICLE_STATE(X)
#undef X
  }
  d->state.nparticle = after;
  dem_crossings_forget(d); /* their places follow the last particle, and are empty between steps */
  dem_data_end(d);
  d->state.push[after] = (dem_push){0};
  if (d->state.spare_push)
    d->state.spare_push[after] = (dem_push){0};
  if (d->lists.nchunk > 1) {
    d->lists.stale = true; /* chunks have other particles now */
    return;
  }
  d->lists.pairs.chunk[1] = d->lists.pairs.count;
  d->lists.walls.chunk[1] = d->lists.walls.count;
}

/* ---- order ---- */

/* an array of n records of `words` 64-bit words, or of n ints, in a new order; copy: room for a word of each */
static void reorder_words(uint64_t *array, size_t n, size_t words, const int *from, uint64_t *copy) {
  for (size_t w = 0; w < words; w++) {
    for (size_t p = 0; p < n; p++)
      copy[p] = array[p * words + w];
    for (size_t p = 0; p < n; p++)
      array[p * words + w] = copy[from[p]];
  }
}

static void reorder_bytes(char *array, size_t n, size_t size, const int *from, char *copy) {
  for (size_t b = 0; b < size; b++) {
    for (size_t p = 0; p < n; p++)
      copy[p] = array[p * size + b];
    for (size_t p = 0; p < n; p++)
      array[p * size + b] = copy[from[p]];
  }
}

tdm_status dem_data_permute(dem_data *d, const int *from) {
  size_t n = (size_t)d->state.nparticle;
  dem_scratch_mark mark = dem_scratch_now(&d->work.scratch);
  uint64_t *copy = dem_scratch_take(&d->work.scratch, (n + 1) * sizeof *copy); /* a word of each particle at a time */
  if (!copy)
    return TDM_ERR_MEMORY;
#define X(field, each, name)                                                                                      \
  if ((size_t)(each) * sizeof *d->field % sizeof *copy == 0)                                                      \
    reorder_words((uint64_t *)(void *)d->field, n, (size_t)(each) * sizeof *d->field / sizeof *copy, from, copy); \
  else                                                                                                            \
    reorder_bytes((char *)d->field, n, (size_t)(each) * sizeof *d->field, from, (char *)copy);
  DEM_PARTICLE_STATE(X)
#undef X
  if (d->state.spare_push)
    reorder_words((uint64_t *)(void *)d->state.spare_push, n, sizeof *d->state.spare_push / sizeof *copy, from, copy);
  dem_scratch_back(&d->work.scratch, mark);
  return TDM_OK;
}
