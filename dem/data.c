/* Creating, copying and destroying the data: see data.h. */
#include "dem/data.h"

#include "dem/geometry/walls.h"
#include "dem/step.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* The next `bytes` of the block, or only add up the size when block is NULL. */
static void *place(char *block, size_t *used, size_t bytes) {
  void *array = block ? block + *used : NULL;
  *used += (bytes + 63) & ~(size_t)63;
  return array;
}

/* Lay the arrays of fixed size out in one block; returns its size. */
static size_t layout(dem_data *d, char *block) {
  size_t np = (size_t)d->model->nparticle, nb = (size_t)d->model->nbody, nw = (size_t)d->model->nwall;
  size_t nc = (size_t)d->model->ncoupled, used = 0;
#define PLACE(field, n) d->field = place(block, &used, (n) * sizeof *d->field)
  PLACE(position, np);
  PLACE(velocity, np);
  PLACE(spin, np);
  PLACE(velocity_ahead, np);
  PLACE(spin_ahead, np);
  PLACE(force, np);
  PLACE(torque, np);
  PLACE(position_at_list, np);
  PLACE(pose, nb);
  PLACE(twist, nb);
  PLACE(twist_mid, nb);
  PLACE(body_load, nb);
  PLACE(body_inverse, nb);
  PLACE(pose_at_list, nb);
  PLACE(margin, nb);
  PLACE(reach, nb);
  PLACE(wall, nw);
  PLACE(front, np * nw);
  PLACE(sample_sum, nc);
  PLACE(sample_mean, nc);
  /* the lists change places with the spare ones, and scratch is not copied */
  d->block_size = used;
  PLACE(pairs.first, np + 1);
  PLACE(walls.first, np + 1);
  PLACE(spare_pairs.first, np + 1);
  PLACE(spare_walls.first, np + 1);
  PLACE(grid.cell, np);
  PLACE(grid.particle, np);
#undef PLACE
  return used;
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
  for (int i = 0; i < m->nparticle; i++) {
    d->position[i] = m->position[i];
    d->velocity[i] = d->velocity_ahead[i] = m->velocity[i];
    d->spin[i] = d->spin_ahead[i] = m->spin[i];
  }
  for (int b = 0; b < m->nbody; b++) {
    d->pose[b] = m->body[b].start.pose;
    d->twist[b] = d->twist_mid[b] = m->body[b].start.twist;
    d->body_inverse[b] = 1 / (m->wall_mass > 0 ? m->wall_mass : m->body[b].mass);
  }
}

dem_data *dem_data_create(const dem_model *model) {
  dem_data *d = calloc(1, sizeof *d);
  if (!d)
    return NULL;
  d->model = model;
  size_t size = layout(d, NULL);
  d->block = aligned_alloc(64, size + 64);
  if (!d->block) {
    dem_data_destroy(&d);
    return NULL;
  }
  memset(d->block, 0, size);
  layout(d, d->block);
  begin(d);
  if (!dem_forces_now(d, false)) {
    dem_data_destroy(&d);
    return NULL;
  }
  dem_mark_front(d);
  return d;
}

static bool copy_list(dem_list *dst, const dem_list *src, int nparticle, bool history) {
  memcpy(dst->first, src->first, ((size_t)nparticle + 1) * sizeof *src->first);
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
  memcpy(dst->block, src->block, src->block_size);
  int np = src->model->nparticle;
  if (!copy_list(&dst->pairs, &src->pairs, np, history) || !copy_list(&dst->walls, &src->walls, np, history))
    return false;
  dst->nstep = src->nstep;
  dst->list_valid = src->list_valid;
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
  free(d->block);
  free(d);
  *data = NULL;
}
