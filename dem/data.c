/* Creating, copying and destroying the data, and particles that come and go: see data.h. */
#include "dem/data.h"

#include "dem/geometry/walls.h"
#include "dem/step.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* The arrays of particles that are state: X(field, entries a particle). */
#define PARTICLE_STATE(X) \
  X(position, 1)          \
  X(velocity, 1)          \
  X(spin, 1)              \
  X(velocity_ahead, 1)    \
  X(spin_ahead, 1)        \
  X(force, 1)             \
  X(torque, 1)            \
  X(position_at_list, 1)  \
  X(radius, 1)            \
  X(mass, 1)              \
  X(kind, 1)              \
  X(id, 1)                \
  X(touched, 1)           \
  X(front, d->model->nwall)

/* The next `bytes` of the block, or only add up the size when block is NULL. */
static void *place(char *block, size_t *used, size_t bytes) {
  void *array = block ? block + *used : NULL;
  *used += (bytes + 63) & ~(size_t)63;
  return array;
}

#define PLACE(field, n) d->field = place(block, &used, (n) * sizeof *d->field)

/* Lay the arrays of fixed size out in one block; returns its size. */
static size_t layout(dem_data *d, char *block) {
  size_t nb = (size_t)d->model->nbody, nw = (size_t)d->model->nwall, nc = (size_t)d->model->ncoupled, used = 0;
  PLACE(pose, nb);
  PLACE(twist, nb);
  PLACE(twist_mid, nb);
  PLACE(body_load, nb);
  PLACE(body_inverse, nb);
  PLACE(pose_at_list, nb);
  PLACE(margin, nb);
  PLACE(reach, nb);
  PLACE(wall, nw);
  PLACE(lid, nw);
  PLACE(sample_sum, nc);
  PLACE(sample_mean, nc);
  PLACE(source, (size_t)d->model->nsource);
  PLACE(sink, (size_t)d->model->nsink);
  return used;
}

/* The same for the arrays of particles, with room for d->capacity. */
static size_t layout_particles(dem_data *d, char *block) {
  size_t np = (size_t)d->capacity, used = 0;
#define X(field, n) PLACE(field, np *(size_t)(n));
  PARTICLE_STATE(X)
#undef X
  /* the lists change places with the spare ones, and scratch is not copied */
  PLACE(pairs.first, np + 1);
  PLACE(walls.first, np + 1);
  PLACE(spare_pairs.first, np + 1);
  PLACE(spare_walls.first, np + 1);
  PLACE(grid.cell, np);
  PLACE(grid.particle, np);
  return used;
}

/* a block that is all zero */
static void *zeroed(size_t size) {
  void *block = aligned_alloc(64, size + 64);
  if (block)
    memset(block, 0, size);
  return block;
}

/* the particles' state, rows of both lists included, from one layout to another that is large enough */
static void copy_particles(dem_data *dst, const dem_data *d) {
  size_t np = (size_t)d->nparticle;
  dst->nparticle = d->nparticle;
#define X(field, n)         \
  if (np * (size_t)(n) > 0) \
    memcpy(dst->field, d->field, np *(size_t)(n) * sizeof *d->field);
  PARTICLE_STATE(X)
#undef X
  memcpy(dst->pairs.first, d->pairs.first, (np + 1) * sizeof *d->pairs.first);
  memcpy(dst->walls.first, d->walls.first, (np + 1) * sizeof *d->walls.first);
}

bool dem_data_reserve(dem_data *d, int n) {
  if (n <= d->capacity)
    return true;
  dem_data grown = *d;
  grown.capacity = d->particle_block ? n + n / 2 + 64 : n;
  grown.particle_block = zeroed(layout_particles(&grown, NULL));
  if (!grown.particle_block)
    return false;
  layout_particles(&grown, grown.particle_block);
  if (d->particle_block)
    copy_particles(&grown, d);
  free(d->particle_block);
  *d = grown;
  return true;
}

bool dem_list_reserve(dem_list *list, size_t count, bool history) {
  if (count <= list->capacity)
    return true;
  size_t capacity = count + count / 2 + 64;
  int *other = realloc(list->other, capacity * sizeof *other);
  if (other)
    list->other = other;
  dem_slot *slot = history ? realloc(list->slot, capacity * sizeof *slot) : NULL;
  if (slot)
    list->slot = slot;
  if (!other || (history && !slot))
    return false;
  list->capacity = capacity;
  return true;
}

void dem_set_body_mass(dem_data *d, int i, double mass) {
  assert(i >= 0 && i < d->model->ncoupled);
  if (d->model->wall_mass == 0)
    d->body_inverse[d->model->coupled_body[i]] = 1 / mass;
}

/* particles and bodies as the model has them at the start */
static void begin(dem_data *d) {
  const dem_model *m = d->model;
  d->nparticle = m->nparticle;
  for (int i = 0; i < m->nparticle; i++) {
    d->id[i] = (uint64_t)i;
    d->radius[i] = m->radius[i];
    d->mass[i] = m->mass[i];
    d->kind[i] = m->kind[i];
    d->position[i] = m->position[i];
    d->velocity[i] = d->velocity_ahead[i] = m->velocity[i];
    d->spin[i] = d->spin_ahead[i] = m->spin[i];
    dem_exact_add(&d->ledger.mass, m->mass[i]);
  }
  d->ledger.created = (uint64_t)m->nparticle;
  for (int b = 0; b < m->nbody; b++) {
    d->pose[b] = m->body[b].start.pose;
    d->twist[b] = d->twist_mid[b] = m->body[b].start.twist;
    d->body_inverse[b] = 1 / (m->wall_mass > 0 ? m->wall_mass : m->body[b].mass);
  }
  dem_lids_away(d);
}

dem_data *dem_data_create(const dem_model *model) {
  dem_data *d = calloc(1, sizeof *d);
  if (!d)
    return NULL;
  d->model = model;
  d->block_size = layout(d, NULL);
  d->block = zeroed(d->block_size);
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

/* partners and histories of a list whose rows are there already */
static bool copy_entries(dem_list *dst, const dem_list *src, bool history) {
  dst->count = 0;
  if (!dem_list_reserve(dst, src->count, history))
    return false;
  dst->count = src->count;
  if (src->count > 0) {
    memcpy(dst->other, src->other, src->count * sizeof *src->other);
    if (history)
      memcpy(dst->slot, src->slot, src->count * sizeof *src->slot);
  }
  return true;
}

bool dem_data_copy(dem_data *dst, const dem_data *src) {
  assert(dst->model == src->model && dst != src);
  bool history = src->model->law->history;
  if (!dem_data_reserve(dst, src->nparticle))
    return false;
  memcpy(dst->block, src->block, src->block_size);
  copy_particles(dst, src);
  if (!copy_entries(&dst->pairs, &src->pairs, history) || !copy_entries(&dst->walls, &src->walls, history))
    return false;
  dst->nstep = src->nstep;
  dst->ledger = src->ledger;
  dst->list_valid = src->list_valid;
  dst->list_stale = src->list_stale;
  dst->nrebuild = src->nrebuild;
  dst->ngrow = src->ngrow;
  dst->ncontact = src->ncontact;
  dst->sample_count = src->sample_count;
  return true;
}

void dem_data_destroy(dem_data **data) {
  dem_data *d = *data;
  if (!d)
    return;
  dem_list *lists[] = {&d->pairs, &d->walls, &d->spare_pairs, &d->spare_walls};
  for (int i = 0; i < 4; i++) {
    free(lists[i]->other);
    free(lists[i]->slot);
  }
  free(d->grid.first);
  free(d->particle_block);
  free(d->block);
  free(d);
  *data = NULL;
}

/* ---- particles that come and go ---- */

bool dem_data_add(dem_data *d, const dem_newcomer *newcomer) {
  if (!dem_data_reserve(d, d->nparticle + 1))
    return false;
  int i = d->nparticle++;
  d->id[i] = d->ledger.created++;
  d->radius[i] = newcomer->radius;
  d->mass[i] = newcomer->mass;
  d->kind[i] = newcomer->kind;
  d->touched[i] = 0;
  d->position[i] = d->position_at_list[i] = newcomer->position;
  d->velocity[i] = d->velocity_ahead[i] = newcomer->velocity;
  d->spin[i] = d->spin_ahead[i] = d->force[i] = d->torque[i] = tdm_v3(0, 0, 0);
  dem_exact_add(&d->ledger.mass, newcomer->mass);
  dem_mark_front(d, i);
  /* an empty row, so that the histories of the others are carried over at the rebuild */
  d->pairs.first[i + 1] = d->pairs.first[i];
  d->walls.first[i + 1] = d->walls.first[i];
  d->list_stale = true;
  return true;
}

/* Drop the rows of particles that go; of pairs also the entries that name one. The rest is renumbered. */
static void remove_rows(dem_list *list, int nparticle, const int *number, bool partners, bool history) {
  int out = 0;
  for (int i = 0; i < nparticle; i++) {
    int begin = list->first[i], end = list->first[i + 1];
    if (number[i] < 0)
      continue;
    list->first[number[i]] = out; /* number[i] <= i: the rows to come are untouched */
    for (int k = begin; k < end; k++) {
      int other = partners ? number[list->other[k]] : list->other[k];
      if (other < 0)
        continue;
      list->other[out] = other;
      if (history)
        list->slot[out] = list->slot[k];
      out++;
    }
  }
  list->count = (size_t)out;
}

void dem_data_remove(dem_data *d, const int *gone) {
  int before = d->nparticle, after = 0, *number = d->grid.cell; /* scratch */
  for (int i = 0; i < before; i++)
    number[i] = gone[i] >= 0 ? -1 : after++;
  if (after == before)
    return;
  bool history = d->model->law->history;
  remove_rows(&d->pairs, before, number, true, history);
  remove_rows(&d->walls, before, number, false, history);
  d->pairs.first[after] = (int)d->pairs.count;
  d->walls.first[after] = (int)d->walls.count;
  for (int i = 0; i < before; i++) {
    if (number[i] < 0) {
      d->ledger.removed++;
      dem_exact_add(&d->ledger.mass, -d->mass[i]);
      continue;
    }
#define X(field, n)                                                                       \
  memmove(&d->field[(size_t)number[i] * (size_t)(n)], &d->field[(size_t)i * (size_t)(n)], \
          (size_t)(n) * sizeof *d->field);
    PARTICLE_STATE(X)
#undef X
  }
  d->nparticle = after;
}
