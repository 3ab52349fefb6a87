/* Particles that come and go, and their order: see particles.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/particles/particles.h"

#include "dem/model/integrator.h"
#include "dem/particles/field.h"
#include "dem/seam/crossings.h"
#include "dem/state/wall_gap.h"

#include <stdlib.h>
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
  dem_mark_front(d, i, i + 1);
  /* an empty row, so that the histories of the others are carried over at the rebuild */
  d->lists.pairs.first[i + 1] = d->lists.pairs.first[i];
  dem_crossings_forget(d); /* their places follow the last particle, and are empty between steps */
  d->lists.stale = true;
  d->work.notes.valid = d->work.among = false;
  return TDM_OK;
}

/* ---- particles go ---- */

/* The entry of a pair moves to an earlier or later place, with its history. */
static void move_entries(dem_pairs *list, size_t to, size_t from, size_t count, int ncolumn) {
  if (to == from || count == 0)
    return;
  memmove(list->one + to, list->one + from, count * sizeof *list->one);
  memmove(list->other + to, list->other + from, count * sizeof *list->other);
  for (size_t q = 0; q < (size_t)ncolumn; q++)
    memmove(list->history + q * list->capacity + to, list->history + q * list->capacity + from, count * sizeof(double));
}

/* Drop the rows of particles that go and the entries that name one; renumber the rest, without gaps. */
static void drop_pairs(dem_pairs *list, int before, int after, const int *number, int ncolumn) {
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
      list->other[out] = number[other];
      for (size_t q = 0; q < (size_t)ncolumn && out < (size_t)k; q++)
        list->history[q * list->capacity + out] = list->history[q * list->capacity + (size_t)k];
      out++;
    }
  }
  list->first[after] = (int)out;
  list->count = out;
}

/* Part a list of pairs without gaps into chunks again, each filled up to whole lanes with the dummy particle's. */
static tdm_status part_pairs(dem_data *d) {
  dem_pairs *list = &d->lists.pairs;
  int none = d->state.nparticle, nchunk = d->lists.nchunk, ncolumn = d->model->columns.ncolumn;
  size_t at = 0, end = list->count;
  for (int c = 0; c < nchunk; c++) {
    list->chunk[c] = at;
    at += (size_t)(list->first[dem_chunk_end(d, c)] - list->first[c * DEM_CHUNK]);
    at = (at + DEM_LANES_MAX - 1) / DEM_LANES_MAX * DEM_LANES_MAX;
  }
  list->chunk[nchunk] = at;
  if (dem_pairs_reserve(list, at, ncolumn, 0, list->count))
    return TDM_ERR_MEMORY;
  for (int c = nchunk - 1; c >= 0; c--) { /* entries move to later places: the last first */
    size_t from = (size_t)list->first[c * DEM_CHUNK], filled = list->chunk[c] + (end - from);
    move_entries(list, list->chunk[c], from, end - from, ncolumn);
    for (int i = c * DEM_CHUNK; i < dem_chunk_end(d, c); i++)
      list->first[i] += (int)(list->chunk[c] - from);
    for (size_t k = filled; k < list->chunk[c + 1]; k++)
      list->one[k] = list->other[k] = none;
    end = from;
  }
  list->first[none] = (int)at;
  list->count = at;
  if (at > 0)
    memcpy(list->reaction_slot, list->other, at * sizeof *list->other);
  return TDM_OK;
}

/* Drop the entries of particles that go; renumber the rest. */
static void drop_walls(dem_wall_contacts *list, const int *number, int ncolumn) {
  size_t out = 0;
  for (size_t k = 0; k < list->count; k++) {
    dem_wall_entry e = list->entry[k];
    if (number[e.particle] < 0)
      continue;
    e.particle = number[e.particle];
    list->entry[out] = e;
    for (size_t q = 0; q < (size_t)ncolumn && out < k; q++)
      list->history[q * list->capacity + out] = list->history[q * list->capacity + k];
    out++;
  }
  list->count = out;
}

/* The entries of walls in the order of the particles' chunks now, in each by wall: particles went from chunk to chunk,
 * in order. Into the spare list, which takes the place of the other. */
static tdm_status part_walls(dem_data *d) {
  dem_wall_contacts *from = &d->lists.walls, *to = &d->work.spare_walls;
  size_t nwall = (size_t)d->model->nwall, nbin = (size_t)d->lists.nchunk * nwall;
  int ncolumn = d->model->columns.ncolumn;
  size_t *bin = calloc(nbin + 1, sizeof *bin); /* where the entries of a chunk and a wall begin */
  if (!bin || dem_walls_reserve(to, from->count, ncolumn)) {
    free(bin);
    return TDM_ERR_MEMORY;
  }
  for (size_t k = 0; k < from->count; k++)
    bin[(size_t)(from->entry[k].particle / DEM_CHUNK) * nwall + (size_t)from->entry[k].wall + 1]++;
  for (size_t b = 0; b < nbin; b++)
    bin[b + 1] += bin[b];
  for (int c = 0; c <= d->lists.nchunk; c++)
    to->chunk[c] = bin[(size_t)c * nwall];
  for (size_t k = 0; k < from->count; k++) {
    size_t place = bin[(size_t)(from->entry[k].particle / DEM_CHUNK) * nwall + (size_t)from->entry[k].wall]++;
    to->entry[place] = from->entry[k];
    for (size_t q = 0; q < (size_t)ncolumn; q++)
      to->history[q * to->capacity + place] = from->history[q * from->capacity + k];
  }
  to->count = from->count;
  free(bin);
  const dem_wall_contacts walls = *from;
  *from = *to;
  *to = walls;
  return TDM_OK;
}

/* Particles first to end - 1 take the places from `to` on. */
static void move_particles(dem_data *d, int to, int first, int end) {
  size_t count = (size_t)(end - first);
  memmove(&d->state.push[to], &d->state.push[first], count * sizeof *d->state.push);
  if (d->state.spare_push)
    memmove(&d->state.spare_push[to], &d->state.spare_push[first], count * sizeof *d->state.spare_push);
#define X(field, n, name)                                                              \
  memmove(&d->field[(size_t)to * (size_t)(n)], &d->field[(size_t)first * (size_t)(n)], \
          count *(size_t)(n) * sizeof *d->field);
  DEM_PARTICLE_STATE(X)
#undef X
}

/* The lists when particles have gone: the entries that are left, parted into chunks as a new list would be. */
static tdm_status part_lists(dem_data *d) {
  bool several = d->lists.nchunk > 1;
  d->lists.nchunk = dem_chunks(d->state.nparticle);
  if (part_pairs(d))
    return TDM_ERR_MEMORY;
  if (several)
    return part_walls(d) ? TDM_ERR_MEMORY : dem_crossings_place(d);
  d->lists.walls.chunk[1] = d->lists.walls.count;
  return TDM_OK;
}

tdm_status dem_data_remove(dem_data *d, const int *gone) {
  int before = d->state.nparticle, after = 0, *number = d->work.number;
  for (int i = 0; i < before; i++)
    number[i] = gone[i] >= 0 ? -1 : after++;
  if (after == before)
    return TDM_OK;
  int ncolumn = d->model->columns.ncolumn;
  drop_pairs(&d->lists.pairs, before, after, number, ncolumn);
  drop_walls(&d->lists.walls, number, ncolumn);
  for (int i = 0; i < before; i++)
    if (number[i] < 0) {
      d->state.ledger.removed++;
      dem_exact_sum_add(&d->state.ledger.mass, -d->state.mass[i]);
      note_flow(d, i, -1);
    }
  for (int i = 0, end; i < before; i = end) { /* in runs that stay together */
    for (end = i + 1; number[i] >= 0 && end < before && number[end] >= 0;)
      end++;
    if (number[i] >= 0 && number[i] < i)
      move_particles(d, number[i], i, end);
  }
  d->state.nparticle = after;
  d->work.notes.valid = d->work.among = false;
  d->work.homes.spread = true; /* all was gathered; where particles were, there will be places of crossings */
  dem_crossings_forget(d);     /* their places follow the last particle, and are empty between steps */
  dem_data_end(d);
  d->state.push[after] = (dem_push){0};
  if (d->state.spare_push)
    d->state.spare_push[after] = (dem_push){0};
  return d->lists.valid && !d->lists.stale ? part_lists(d) : TDM_OK;
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
