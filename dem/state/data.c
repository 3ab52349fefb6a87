/* Creating, copying and destroying the data, and particles that come and go: see data.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/state/data.h"

#include "dem/bodies/traction.h"
#include "dem/bodies/walls.h"
#include "dem/model/group_options.h"
#include "dem/search/pairs.h"
#include "dem/state/domain.h"
#include "dem/step/integrate.h"
#include "dem/step/step.h"
#include "dem/watch/energy_balance.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* The next `bytes` of the block, or only add up the size when block is NULL. */
static void *place(char *block, size_t *used, size_t bytes) {
  void *array = block ? block + *used : NULL;
  *used += (bytes + 63) & ~(size_t)63;
  return array;
}

#define PLACE(field, n) d->field = place(block, &used, (n) * sizeof *d->field)

/* Lay the arrays of fixed size out in one block; returns its size. */
static size_t layout(dem_data *d, char *block) {
  size_t nb = (size_t)d->model->nbody, nw = (size_t)d->model->nwall, nl = (size_t)d->model->nload, used = 0;
  PLACE(pose, nb);
  PLACE(twist, nb);
  PLACE(body_load, nl);
  PLACE(mobility, nb);
  PLACE(pose_at_list, nb);
  PLACE(margin, nb);
  PLACE(reach, nb);
  PLACE(fast_load, nl);
  PLACE(wall, nw);
  PLACE(lid, nw);
  PLACE(sample_sum, nl + 1);
  PLACE(sample_mean, nl + 1);
  PLACE(source, (size_t)d->model->nsource);
  PLACE(sink, (size_t)d->model->nsink);
  return used;
}

/* The same for the arrays of particles, with room for d->capacity and the particle that is none. */
static size_t layout_particles(dem_data *d, char *block) {
  size_t np = (size_t)d->capacity + 1, used = 0;
#define X(field, n, name) PLACE(field, np *(size_t)(n));
  DEM_PARTICLE_STATE(X)
#undef X
  PLACE(pairs.first, np);
  PLACE(number, d->model->nsink > 0 || d->model->domain.open ? np : 0);
  size_t nchunk = (size_t)dem_chunks(d->capacity);
  PLACE(pairs.chunk, nchunk + 1);
  PLACE(walls.chunk, nchunk + 1);
  PLACE(spare_walls.chunk, nchunk + 1);
  PLACE(chunk_spare, nchunk + 1);
  PLACE(crossings.chunk, nchunk + 1);
  PLACE(chunk_load, nchunk * (size_t)d->model->nload);
  PLACE(chunk_flux, nchunk);
  return used;
}

/* a block that is all zero */
static void *zeroed(size_t size) {
  void *block = aligned_alloc(64, (size + 127) & ~(size_t)63);
  if (block)
    memset(block, 0, size);
  return block;
}

/* the particles' state, rows of pairs and chunks included, from one layout to another that is large enough */
static void copy_particles(dem_data *dst, const dem_data *d) {
  size_t np = (size_t)d->nparticle;
  dst->nparticle = d->nparticle;
  dst->nchunk = d->nchunk;
#define X(field, n, name)   \
  if (np * (size_t)(n) > 0) \
    memcpy(dst->field, d->field, np *(size_t)(n) * sizeof *d->field);
  DEM_PARTICLE_STATE(X)
#undef X
  size_t nchunk = (size_t)d->nchunk + 1;
  memcpy(dst->pairs.first, d->pairs.first, (np + 1) * sizeof *d->pairs.first);
  memcpy(dst->pairs.chunk, d->pairs.chunk, nchunk * sizeof *d->pairs.chunk);
  memcpy(dst->walls.chunk, d->walls.chunk, nchunk * sizeof *d->walls.chunk);
  memcpy(dst->crossings.chunk, d->crossings.chunk, nchunk * sizeof *d->crossings.chunk);
}

/* nowhere, so that it touches nothing */
void dem_data_end(dem_data *d) {
  d->sphere[d->nparticle] = (dem_sphere){.position = {NAN, NAN, NAN}, .inverse_mass = 1};
  d->rotor[d->nparticle] = (dem_rotor){0};
}

/* An aligned array of n entries, the first `keep` of them those of the old one. Large arrays are moved by the C library
 * without a copy, in whole pages: so they are never there twice. */
static bool grow(void *array, size_t n, size_t keep, size_t size) {
  void **p = array;
  size_t bytes = (n * size + 127) & ~(size_t)63;
  void *grown = *p ? realloc(*p, bytes) : aligned_alloc(64, bytes);
  if (grown)
    *p = grown;
  if (!grown || (uintptr_t)grown % 64 == 0)
    return grown;
  void *aligned = aligned_alloc(64, bytes);
  if (!aligned)
    return false;
  if (keep > 0)
    memcpy(aligned, grown, keep * size);
  free(grown);
  *p = aligned;
  return true;
}

/* forces of the particles there are, zeros for the one that is none and `more`; the rest is not touched, so it costs no
 * memory until it is used */
static bool grow_push(const dem_data *d, dem_push **push, int capacity, int more) {
  size_t keep = *push ? (size_t)d->nparticle : 0, end = (size_t)(d->nparticle + 1 + more);
  if (!grow(push, (size_t)capacity, keep, sizeof **push))
    return false;
  memset(*push + keep, 0, (end - keep) * sizeof **push);
  return true;
}

bool dem_crossings_reserve(dem_data *d, int count) {
  int need = d->nparticle + 1 + count;
  if (need > d->push_capacity) {
    int capacity = need + (need > DEM_CHUNK ? need / 2 : 64); /* about what the crossings take */
    bool two = d->model->integrator->keeps == DEM_KEEPS_FAST_FORCES;
    if (!grow_push(d, &d->push, capacity, count) || (two && !grow_push(d, &d->spare_push, capacity, count)))
      return false;
    d->push_capacity = capacity;
  }
  dem_crossings *c = &d->crossings;
  if (count > c->capacity) {
    int capacity = count + count / 4 + 64;
    int *particle = realloc(c->particle, (size_t)capacity * sizeof *particle);
    if (particle)
      c->particle = particle;
    int *order = realloc(c->order, (size_t)capacity * sizeof *order);
    if (order)
      c->order = order;
    if (!particle || !order)
      return false;
    c->capacity = capacity;
  }
  return true;
}

bool dem_data_reserve(dem_data *d, int n) {
  if (n > d->capacity) {
    dem_data grown = *d;
    int more = d->capacity + d->capacity / 2 + 64;
    grown.capacity = d->particle_block && more > n ? more : n;
    grown.particle_block = zeroed(layout_particles(&grown, NULL));
    if (!grown.particle_block)
      return false;
    layout_particles(&grown, grown.particle_block);
    if (d->particle_block)
      copy_particles(&grown, d);
    free(d->particle_block);
    *d = grown;
  }
  return dem_crossings_reserve(d, n - d->nparticle);
}

bool dem_pairs_reserve(dem_pairs *list, size_t count, int ncolumn) {
  if (count <= list->capacity && list->one) /* arrays also for no entries */
    return true;
  size_t before = list->capacity, capacity = (count + count / 16 + 64) & ~(size_t)7;
  if (!grow(&list->one, capacity, 0, sizeof(int)) || !grow(&list->other, capacity, before, sizeof(int)) ||
      !grow(&list->reaction_slot, capacity, 0, sizeof(int)) ||
      (ncolumn > 0 && !grow(&list->history, capacity * (size_t)ncolumn, before * (size_t)ncolumn, sizeof(double))))
    return false;
  for (int q = ncolumn - 1; q > 0; q--) /* columns move apart, the last first */
    memmove(list->history + (size_t)q * capacity, list->history + (size_t)q * before, before * sizeof(double));
  list->capacity = capacity;
  return true;
}

bool dem_walls_reserve(dem_wall_contacts *list, size_t count, int ncolumn) {
  if (count <= list->capacity)
    return true;
  size_t capacity = count + count / 4 + 64;
  list->capacity = 0;
  if (!grow(&list->entry, capacity, 0, sizeof *list->entry) ||
      (ncolumn > 0 && !grow(&list->history, capacity * (size_t)ncolumn, 0, sizeof(double))))
    return false;
  list->capacity = capacity;
  return true;
}

/* particles and bodies as the model has them at the start */
static void begin(dem_data *d) {
  const dem_model *m = d->model;
  d->nparticle = m->nparticle - m->npoured;
  for (int i = 0; i < d->nparticle; i++) {
    d->id[i] = (uint64_t)i;
    d->mass[i] = m->mass[i];
    d->material[i] = m->particle_material[i];
    d->sphere[i] = (dem_sphere){m->position[i], m->radius[i], m->velocity[i], 1 / m->mass[i]};
    d->rotor[i] = (dem_rotor){tdm_scale(m->radius[i], m->spin[i]), m->radius[i]};
    d->pace[i] = (dem_pace){.velocity = m->velocity[i], .spin = m->spin[i]};
    dem_exact_sum_add(&d->ledger.mass, m->mass[i]);
  }
  dem_drive_particles(d);
  dem_data_end(d);
  d->restart = true;
  dem_domain_begin(d);
  d->ledger.created = (uint64_t)d->nparticle;
  d->since_sort = DEM_SORT_STEPS;
  d->skin = m->skin > 0 ? m->skin : 0.05 * m->mean_radius;
  for (int b = 0; b < m->nbody; b++) {
    d->pose[b] = m->body[b].start.pose;
    d->twist[b] = m->body[b].start.twist;
    d->mobility[b].per_mass = 1 / (m->wall_mass > 0 ? m->wall_mass : m->body[b].mass);
  }
  dem_bodies_drive(d, m->time_start);
  dem_lids_away(d);
}

dem_data *dem_data_create(const dem_model *model) {
  dem_data *d = calloc(1, sizeof *d);
  if (!d)
    return NULL;
  d->model = model;
  d->block_size = layout(d, NULL);
  d->block = zeroed(d->block_size);
  d->nthread = model->threads > 0 ? model->threads : 1;
  d->traction.wanted = model->triangle_forces;
  if (d->block)
    layout(d, d->block);
  if (!d->block || !dem_data_reserve(d, model->nparticle > 0 ? model->nparticle : 1)) {
    dem_data_destroy(&d);
    return NULL;
  }
  begin(d);
  if (!dem_forces_now(d, false)) {
    dem_data_destroy(&d);
    return NULL;
  }
  dem_mark_front(d, 0);
  return d;
}

/* entries and histories of the lists, whose rows and chunks are there already */
static bool copy_lists(dem_data *dst, const dem_data *src) {
  int ncolumn = src->model->columns.ncolumn;
  const dem_pairs *p = &src->pairs;
  const dem_wall_contacts *w = &src->walls;
  const dem_crossings *c = &src->crossings;
  if (!dem_pairs_reserve(&dst->pairs, p->count, ncolumn) || !dem_walls_reserve(&dst->walls, w->count, ncolumn) ||
      !dem_crossings_reserve(dst, c->count))
    return false;
  dst->pairs.count = p->count;
  dst->walls.count = w->count;
  dst->crossings.count = c->count;
  if (p->count > 0) {
    memcpy(dst->pairs.one, p->one, p->count * sizeof *p->one);
    memcpy(dst->pairs.other, p->other, p->count * sizeof *p->other);
    memcpy(dst->pairs.reaction_slot, p->reaction_slot, p->count * sizeof *p->reaction_slot);
  }
  if (w->count > 0)
    memcpy(dst->walls.entry, w->entry, w->count * sizeof *w->entry);
  if (c->count > 0) {
    memcpy(dst->crossings.particle, c->particle, (size_t)c->count * sizeof *c->particle);
    memcpy(dst->crossings.order, c->order, (size_t)c->count * sizeof *c->order);
  }
  for (size_t q = 0; q < (size_t)ncolumn; q++) {
    if (p->count > 0)
      memcpy(dst->pairs.history + q * dst->pairs.capacity, p->history + q * p->capacity, p->count * sizeof(double));
    if (w->count > 0)
      memcpy(dst->walls.history + q * dst->walls.capacity, w->history + q * w->capacity, w->count * sizeof(double));
  }
  return true;
}

bool dem_data_copy(dem_data *dst, const dem_data *src) {
  assert(dst->model == src->model && dst != src);
  if (!dem_data_reserve(dst, src->nparticle))
    return false;
  memcpy(dst->block, src->block, src->block_size);
  copy_particles(dst, src);
  dem_data_end(dst);
  if (!copy_lists(dst, src))
    return false;
  memcpy(dst->push, src->push, (size_t)src->nparticle * sizeof *src->push);
  memset(dst->push + src->nparticle, 0, (size_t)(src->crossings.count + 1) * sizeof *src->push);
  if (src->spare_push) {
    memcpy(dst->spare_push, src->spare_push, (size_t)src->nparticle * sizeof *src->push);
    memset(dst->spare_push + src->nparticle, 0, (size_t)(src->crossings.count + 1) * sizeof *src->push);
  }
  dst->nstep = src->nstep;
  dst->since_sort = src->since_sort;
  dst->since_list = src->since_list;
  dst->skin = src->skin;
  dst->memory_dt = src->memory_dt;
  dst->restart = src->restart;
  dst->domain = src->domain;
  memcpy(dst->domain_rate, src->domain_rate, sizeof src->domain_rate);
  memcpy(dst->length_at_list, src->length_at_list, sizeof src->length_at_list);
  dst->strained = src->strained;
  dst->strain_steps = src->strain_steps;
  dst->strain_dt = src->strain_dt;
  dst->guard = src->guard;
  dst->ledger = src->ledger;
  dst->energy_balance = src->energy_balance;
  dst->list_valid = src->list_valid;
  dst->list_stale = src->list_stale;
  dst->nrebuild = src->nrebuild;
  dst->ncontact = src->ncontact;
  dst->energy = src->energy;
  dst->sample_steps = src->sample_steps;
  return true;
}

void dem_data_destroy(dem_data **data) {
  dem_data *d = *data;
  if (!d)
    return;
  void *arrays[] = {d->pairs.one,
                    d->pairs.other,
                    d->pairs.reaction_slot,
                    d->pairs.history,
                    d->walls.entry,
                    d->walls.history,
                    d->spare_walls.entry,
                    d->spare_walls.history,
                    d->crossings.particle,
                    d->crossings.order,
                    d->push,
                    d->spare_push,
                    d->particle_block,
                    d->block};
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
    free(arrays[i]);
  dem_traction_free(d);
  dem_search_destroy(&d->search);
  free(d);
  *data = NULL;
}

/* ---- particles that come and go ---- */

/* The places of the crossings follow the last particle: they are no longer where they were. All of them are empty
 * between steps, and the lists that are made next place them anew. */
static void forget_crossings(dem_data *d) {
  d->crossings.count = 0;
  memset(d->crossings.chunk, 0, (size_t)(d->nchunk + 1) * sizeof *d->crossings.chunk);
}

bool dem_data_add(dem_data *d, const dem_newcomer *newcomer) {
  if (!dem_data_reserve(d, d->nparticle + 1))
    return false;
  int i = d->nparticle++;
  d->id[i] = d->ledger.created++;
  d->mass[i] = newcomer->mass;
  d->material[i] = newcomer->material;
  d->touched[i] = 0;
  const dem_model *m = d->model;
  tdm_vec3 velocity = dem_flatten(m, newcomer->velocity, 0);
  d->sphere[i] = (dem_sphere){newcomer->position, newcomer->radius, velocity, 1 / newcomer->mass};
  d->rotor[i] = (dem_rotor){.radius = newcomer->radius};
  d->pace[i] = (dem_pace){.velocity = velocity};
  d->push[i] = (dem_push){0};
  if (d->spare_push)
    d->spare_push[i] = (dem_push){0};
  if (m->driven)
    d->drive[i] = (dem_pace){0};
  if (m->integrator->remember && !d->restart)
    m->integrator->remember(d, i, i + 1, d->memory_dt);
  d->position_at_list[i] = newcomer->position;
  dem_data_end(d);
  dem_exact_sum_add(&d->ledger.mass, newcomer->mass);
  dem_energy_balance_flow(d, i, 1);
  dem_mark_front(d, i);
  /* an empty row, so that the histories of the others are carried over at the rebuild */
  d->pairs.first[i + 1] = d->pairs.first[i];
  forget_crossings(d);
  d->list_stale = true;
  return true;
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
  int before = d->nparticle, after = 0, *number = d->number;
  for (int i = 0; i < before; i++)
    number[i] = gone[i] >= 0 ? -1 : after++;
  if (after == before)
    return;
  int ncolumn = d->model->columns.ncolumn;
  remove_pairs(&d->pairs, before, after, number, ncolumn);
  remove_walls(&d->walls, number, ncolumn);
  for (int i = 0; i < before; i++) {
    if (number[i] < 0) {
      d->ledger.removed++;
      dem_exact_sum_add(&d->ledger.mass, -d->mass[i]);
      dem_energy_balance_flow(d, i, -1);
      continue;
    }
    d->push[number[i]] = d->push[i];
    if (d->spare_push)
      d->spare_push[number[i]] = d->spare_push[i];
#define X(field, n, name)                                                                 \
  memmove(&d->field[(size_t)number[i] * (size_t)(n)], &d->field[(size_t)i * (size_t)(n)], \
          (size_t)(n) * sizeof *d->field);
    DEM_PARTICLE_STATE(X)
#undef X
  }
  d->nparticle = after;
  forget_crossings(d);
  dem_data_end(d);
  d->push[after] = (dem_push){0};
  if (d->spare_push)
    d->spare_push[after] = (dem_push){0};
  if (d->nchunk > 1) {
    d->list_stale = true; /* chunks have other particles now */
    return;
  }
  d->pairs.chunk[1] = d->pairs.count;
  d->walls.chunk[1] = d->walls.count;
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

bool dem_data_permute(dem_data *d, const int *from) {
  size_t n = (size_t)d->nparticle;
  dem_scratch_mark mark = dem_scratch_now(&d->scratch);
  uint64_t *copy = dem_scratch_take(&d->scratch, (n + 1) * sizeof *copy); /* a word of each particle at a time */
  if (!copy)
    return false;
#define X(field, each, name)                                                                                      \
  if ((size_t)(each) * sizeof *d->field % sizeof *copy == 0)                                                      \
    reorder_words((uint64_t *)(void *)d->field, n, (size_t)(each) * sizeof *d->field / sizeof *copy, from, copy); \
  else                                                                                                            \
    reorder_bytes((char *)d->field, n, (size_t)(each) * sizeof *d->field, from, (char *)copy);
  DEM_PARTICLE_STATE(X)
#undef X
  if (d->spare_push)
    reorder_words((uint64_t *)(void *)d->spare_push, n, sizeof *d->spare_push / sizeof *copy, from, copy);
  dem_scratch_back(&d->scratch, mark);
  return true;
}
