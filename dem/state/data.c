/* Allocating, copying and destroying the data: see data.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/state/data.h"

#include "dem/base/pages.h"
#include "dem/model/integrator.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* The next `bytes` of the block, or only add up the size when block is NULL. */
static void *place(char *block, size_t *used, size_t bytes) {
  void *array = block ? block + *used : NULL;
  *used += (bytes + 63) & ~(size_t)63;
  return array;
}

#define PLACE(field, n) d->field = place(block, &used, (n) * sizeof *d->field);

/* Lay the arrays of fixed size out in one block; returns its size. */
static size_t layout(dem_data *d, char *block) {
  size_t nb = (size_t)d->model->nbody, nw = (size_t)d->model->nwall, nl = (size_t)d->model->nload, used = 0;
  DEM_FIXED_STATE(PLACE)
  return used;
}

/* The same for the arrays of particles, with room for d->work.capacity and the dummy particle. */
static size_t layout_particles(dem_data *d, char *block) {
  size_t np = (size_t)d->work.capacity + 1, used = 0;
#define X(field, n, name) PLACE(field, np *(size_t)(n))
  DEM_PARTICLE_STATE(X)
#undef X
  PLACE(lists.pairs.first, np)
  PLACE(work.hole, d->model->screening.watched ? np : 0)
  PLACE(work.number, d->model->nsink > 0 || d->model->domain.open ? np : 0)
  size_t nchunk = (size_t)dem_chunks(d->work.capacity);
  PLACE(lists.pairs.chunk, nchunk + 1)
  PLACE(lists.walls.chunk, nchunk + 1)
  PLACE(work.spare_walls.chunk, nchunk + 1)
  PLACE(work.chunk_spare, nchunk + 1)
  PLACE(lists.crossings.chunk, nchunk + 1)
  PLACE(lists.crossings.from, nchunk + 1)
  PLACE(work.givers.first, nchunk + 1)
  PLACE(work.givers.all, nchunk)
  PLACE(work.givers.left, nchunk)
  PLACE(work.givers.seen, nchunk)
  PLACE(work.chunk_load, nchunk * (size_t)d->model->nload)
  PLACE(work.chunk_flux, nchunk)
  PLACE(work.chunk_sum, nchunk * DEM_CHUNK_SUMS)
  PLACE(work.section, (size_t)d->work.nthread)
  PLACE(work.chunk_supplied, nchunk)
  return used;
}

/* a block that is all zero; it takes no memory until it is used */
static void *zeroed(size_t size) {
  void *block = aligned_alloc(64, (size + 127) & ~(size_t)63);
  if (block)
    dem_pages_zero(block, size);
  return block;
}

/* Numbers, the particles' state, rows of pairs and chunks, from one layout to another that is large enough. */
static void copy_particles(dem_data *dst, const dem_data *d) {
  size_t np = (size_t)d->state.nparticle;
#define X(object, field, ...) memcpy(&dst->object.field, &d->object.field, sizeof d->object.field);
  DEM_NUMBER_STATE(X)
  DEM_DERIVED_STATE(X)
  DEM_LIST_NUMBERS(X)
#undef X
#define X(field, n, name)   \
  if (np * (size_t)(n) > 0) \
    dem_pages_copy(dst->field, d->field, np *(size_t)(n) * sizeof *d->field);
  DEM_PARTICLE_STATE(X)
#undef X
  size_t nchunk = (size_t)d->lists.nchunk + 1;
  dem_pages_copy(dst->lists.pairs.first, d->lists.pairs.first, (np + 1) * sizeof *d->lists.pairs.first);
  memcpy(dst->lists.pairs.chunk, d->lists.pairs.chunk, nchunk * sizeof *d->lists.pairs.chunk);
  memcpy(dst->lists.walls.chunk, d->lists.walls.chunk, nchunk * sizeof *d->lists.walls.chunk);
  memcpy(dst->lists.crossings.chunk, d->lists.crossings.chunk, nchunk * sizeof *d->lists.crossings.chunk);
  memcpy(dst->lists.crossings.from, d->lists.crossings.from, nchunk * sizeof *d->lists.crossings.from);
}

/* nowhere, so that it touches nothing */
void dem_data_end(dem_data *d) {
  d->state.sphere[d->state.nparticle] = (dem_sphere){.position = {NAN, NAN, NAN}, .inverse_mass = 1};
  d->state.rotor[d->state.nparticle] = (dem_rotor){0};
}

/* An aligned array of n entries, the first `keep` of them those of the old one. Large arrays are moved by the C library
 * without a copy, in whole pages: so they are never there twice. */
static tdm_status grow(void *array, size_t n, size_t keep, size_t size) {
  void **p = array;
  size_t bytes = (n * size + 127) & ~(size_t)63;
  void *grown = *p ? realloc(*p, bytes) : aligned_alloc(64, bytes);
  if (grown)
    *p = grown;
  if (!grown || (uintptr_t)grown % 64 == 0)
    return grown ? TDM_OK : TDM_ERR_MEMORY;
  void *aligned = aligned_alloc(64, bytes);
  if (!aligned)
    return TDM_ERR_MEMORY;
  if (keep > 0)
    memcpy(aligned, grown, keep * size);
  free(grown);
  *p = aligned;
  return TDM_OK;
}

/* forces of the particles there are, zeros for the dummy particle and `more`; the rest is not touched, so it costs no
 * memory until it is used */
static tdm_status grow_push(const dem_data *d, dem_push **push, int capacity, int more) {
  size_t keep = *push ? (size_t)d->state.nparticle : 0, end = (size_t)(d->state.nparticle + 1 + more);
  if (grow(push, (size_t)capacity, keep, sizeof **push))
    return TDM_ERR_MEMORY;
  dem_pages_zero(*push + keep, (end - keep) * sizeof **push);
  return TDM_OK;
}

tdm_status dem_crossings_reserve(dem_data *d, int count) {
  int need = d->state.nparticle + 1 + count;
  if (need > d->work.push_capacity) {
    int capacity = need + (need > DEM_CHUNK ? need / 2 : 64); /* about what the crossings take */
    bool two = d->model->integrator->keeps == DEM_KEEPS_FAST_FORCES;
    if (grow_push(d, &d->state.push, capacity, count) || (two && grow_push(d, &d->state.spare_push, capacity, count)))
      return TDM_ERR_MEMORY;
    size_t nsum = (size_t)d->model->nsum;
    if (nsum > 0 && grow(&d->work.contact_sum, (size_t)capacity * nsum, 0, sizeof *d->work.contact_sum))
      return TDM_ERR_MEMORY;
    d->work.push_capacity = capacity;
  }
  dem_crossings *c = &d->lists.crossings;
  if (count > c->capacity) {
    int capacity = count + count / 4 + 64;
    int *particle = realloc(c->particle, (size_t)capacity * sizeof *particle);
    if (particle)
      c->particle = particle;
    int *order = realloc(c->order, (size_t)capacity * sizeof *order);
    if (order)
      c->order = order;
    if (!particle || !order)
      return TDM_ERR_MEMORY;
    c->capacity = capacity;
  }
  return TDM_OK;
}

tdm_status dem_data_reserve(dem_data *d, int n) {
  if (n > d->work.capacity) {
    dem_data grown = *d;
    int more = d->work.capacity + d->work.capacity / 2 + 64;
    grown.work.capacity = d->work.particle_block && more > n ? more : n;
    grown.work.particle_block = zeroed(layout_particles(&grown, NULL));
    if (!grown.work.particle_block)
      return TDM_ERR_MEMORY;
    layout_particles(&grown, grown.work.particle_block);
    if (d->work.particle_block)
      copy_particles(&grown, d);
    free(d->work.particle_block);
    *d = grown;
    d->work.homes.planned = false;
  }
  return dem_crossings_reserve(d, n - d->state.nparticle);
}

tdm_status dem_pairs_reserve(dem_pairs *list, size_t count, int ncolumn, size_t first, size_t end) {
  if (count <= list->capacity && list->one) /* arrays also for no entries */
    return TDM_OK;
  size_t before = list->capacity, capacity = (count + count / 16 + 64) & ~(size_t)7;
  if (grow(&list->one, capacity, 0, sizeof(int)) || grow(&list->other, capacity, before, sizeof(int)) ||
      grow(&list->reaction_slot, capacity, 0, sizeof(int)) ||
      (ncolumn > 0 && grow(&list->history, capacity * (size_t)ncolumn, before * (size_t)ncolumn, sizeof(double))))
    return TDM_ERR_MEMORY;
  for (int q = ncolumn - 1; q > 0; q--) /* columns move apart, the last first */
    memmove(list->history + (size_t)q * capacity + first, list->history + (size_t)q * before + first,
            (end - first) * sizeof(double));
  list->capacity = capacity;
  return TDM_OK;
}

tdm_status dem_walls_reserve(dem_wall_contacts *list, size_t count, int ncolumn) {
  if (count <= list->capacity)
    return TDM_OK;
  size_t capacity = count + count / 4 + 64;
  list->capacity = 0;
  if (grow(&list->entry, capacity, 0, sizeof *list->entry) ||
      (ncolumn > 0 && grow(&list->history, capacity * (size_t)ncolumn, 0, sizeof(double))))
    return TDM_ERR_MEMORY;
  list->capacity = capacity;
  return TDM_OK;
}

dem_data *dem_data_allocate(const dem_model *model) {
  dem_data *d = calloc(1, sizeof *d);
  if (!d)
    return NULL;
  d->model = model;
  d->work.block_size = layout(d, NULL);
  d->work.block = zeroed(d->work.block_size);
  d->work.nthread = model->threads > 0 ? model->threads : 1;
  d->work.traction.wanted = model->triangle_forces;
  if (d->work.block)
    layout(d, d->work.block);
  if (!d->work.block || dem_data_reserve(d, model->nparticle > 0 ? model->nparticle : 1))
    dem_data_destroy(&d);
  return d;
}

/* entries and histories of the lists, whose rows and chunks are there already */
static tdm_status copy_lists(dem_data *dst, const dem_data *src) {
  int ncolumn = src->model->columns.ncolumn;
  const dem_pairs *p = &src->lists.pairs;
  const dem_wall_contacts *w = &src->lists.walls;
  const dem_crossings *c = &src->lists.crossings;
  if (dem_pairs_reserve(&dst->lists.pairs, p->count, ncolumn, 0, 0) ||
      dem_walls_reserve(&dst->lists.walls, w->count, ncolumn) || dem_crossings_reserve(dst, c->count))
    return TDM_ERR_MEMORY;
  dst->lists.pairs.count = p->count;
  dst->lists.walls.count = w->count;
  dst->lists.crossings.count = c->count;
  dst->lists.crossings.first = c->first;
  dst->lists.crossings.end = c->end;
  if (p->count > 0) {
    dem_pages_copy(dst->lists.pairs.one, p->one, p->count * sizeof *p->one);
    dem_pages_copy(dst->lists.pairs.other, p->other, p->count * sizeof *p->other);
    dem_pages_copy(dst->lists.pairs.reaction_slot, p->reaction_slot, p->count * sizeof *p->reaction_slot);
  }
  if (w->count > 0)
    dem_pages_copy(dst->lists.walls.entry, w->entry, w->count * sizeof *w->entry);
  if (c->count > 0) {
    dem_pages_copy(dst->lists.crossings.particle, c->particle, (size_t)c->count * sizeof *c->particle);
    dem_pages_copy(dst->lists.crossings.order, c->order, (size_t)c->chunk[src->lists.nchunk] * sizeof *c->order);
  }
  for (size_t q = 0; q < (size_t)ncolumn; q++) {
    if (p->count > 0)
      dem_pages_copy(dst->lists.pairs.history + q * dst->lists.pairs.capacity, p->history + q * p->capacity,
                     p->count * sizeof(double));
    if (w->count > 0)
      dem_pages_copy(dst->lists.walls.history + q * dst->lists.walls.capacity, w->history + q * w->capacity,
                     w->count * sizeof(double));
  }
  return TDM_OK;
}

tdm_status dem_data_copy(dem_data *dst, const dem_data *src) {
  assert(dst->model == src->model && dst != src);
  if (dem_data_reserve(dst, src->state.nparticle))
    return TDM_ERR_MEMORY;
  memcpy(dst->work.block, src->work.block, src->work.block_size);
  copy_particles(dst, src);
  dem_data_end(dst);
  dst->work.notes.valid = dst->work.among = dst->work.homes.planned = false;
  if (copy_lists(dst, src)) {
    dst->lists.valid = false;
    return TDM_ERR_MEMORY;
  }
  size_t np = (size_t)src->state.nparticle, behind = (size_t)src->lists.crossings.count + 1;
#define X(field, name)                                               \
  if (src->field) {                                                  \
    dem_pages_copy(dst->field, src->field, np * sizeof *src->field); \
    dem_pages_zero(dst->field + np, behind * sizeof *src->field);    \
  }
  DEM_FORCE_STATE(X)
#undef X
  return TDM_OK;
}

void dem_data_destroy(dem_data **data) {
  dem_data *d = *data;
  if (!d)
    return;
  dem_scratch_free(&d->work.scratch);
  dem_homes *homes = &d->work.homes;
  void *arrays[] = {d->lists.pairs.one,
                    d->lists.pairs.other,
                    d->lists.pairs.reaction_slot,
                    d->lists.pairs.history,
                    d->lists.walls.entry,
                    d->lists.walls.history,
                    d->work.spare_walls.entry,
                    d->work.spare_walls.history,
                    d->lists.crossings.particle,
                    d->lists.crossings.order,
                    d->work.givers.to,
                    d->work.traction.force,
                    d->work.traction.entry_force,
                    d->state.push,
                    d->state.spare_push,
                    d->work.contact_sum,
                    d->work.notes.column,
                    d->work.notes.first,
                    d->work.notes.place,
                    d->work.notes.sent,
                    d->work.notes.room,
                    homes->immigrants.item,
                    homes->immigrants.first,
                    homes->visitors.item,
                    homes->visitors.first,
                    homes->returning.item,
                    homes->returning.first,
                    homes->returned.item,
                    homes->returned.first,
                    homes->rank_of,
                    homes->cost,
                    homes->chunk,
                    homes->mail,
                    homes->out,
                    homes->in,
                    homes->sums,
                    d->work.particle_block,
                    d->work.block};
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
    free(arrays[i]);
  if (d->work.search)
    d->work.search_destroy(&d->work.search);
  free(d);
  *data = NULL;
}
