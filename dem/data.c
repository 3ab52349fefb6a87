/* Creating, copying and destroying the data, and particles that come and go: see data.h. */
#include "dem/data.h"

#include "dem/geometry/walls.h"
#include "dem/search/pairs.h"
#include "dem/step.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* The arrays of particles that are state: X(field, entries a particle). */
#define PARTICLE_STATE(X) \
  X(sphere, 1)            \
  X(rotor, 1)             \
  X(pace, 1)              \
  X(position_at_list, 1)  \
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

/* The same for the arrays of particles, with room for d->capacity and the particle that is none. */
static size_t layout_particles(dem_data *d, char *block) {
  size_t np = (size_t)d->capacity + 1, used = 0;
#define X(field, n) PLACE(field, np *(size_t)(n));
  PARTICLE_STATE(X)
#undef X
  PLACE(pairs.first, np);
  PLACE(spare_pairs.first, np);
  PLACE(number, np);
  size_t nchunk = (size_t)dem_chunks(d->capacity);
  PLACE(pairs.chunk, nchunk + 1);
  PLACE(walls.chunk, nchunk + 1);
  PLACE(spare_pairs.chunk, nchunk + 1);
  PLACE(spare_walls.chunk, nchunk + 1);
  PLACE(crossings.chunk, nchunk + 1);
  PLACE(chunk_load, nchunk * (size_t)d->model->nbody);
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
#define X(field, n)         \
  if (np * (size_t)(n) > 0) \
    memcpy(dst->field, d->field, np *(size_t)(n) * sizeof *d->field);
  PARTICLE_STATE(X)
#undef X
  size_t nchunk = (size_t)d->nchunk + 1;
  memcpy(dst->pairs.first, d->pairs.first, (np + 1) * sizeof *d->pairs.first);
  memcpy(dst->pairs.chunk, d->pairs.chunk, nchunk * sizeof *d->pairs.chunk);
  memcpy(dst->walls.chunk, d->walls.chunk, nchunk * sizeof *d->walls.chunk);
  memcpy(dst->crossings.chunk, d->crossings.chunk, nchunk * sizeof *d->crossings.chunk);
}

/* put the particle that is none behind the last: nowhere, so that it touches nothing */
static void end_particles(dem_data *d) {
  d->sphere[d->nparticle] = (dem_sphere){.position = {NAN, NAN, NAN}, .inverse_mass = 1};
  d->rotor[d->nparticle] = (dem_rotor){0};
}

bool dem_crossings_reserve(dem_data *d, int count) {
  int need = d->nparticle + 1 + count;
  if (need > d->push_capacity) {
    int capacity = need + need / 8 + 64;
    dem_push *push = zeroed((size_t)capacity * sizeof *push);
    if (!push)
      return false;
    if (d->push)
      memcpy(push, d->push, (size_t)d->nparticle * sizeof *push);
    free(d->push);
    d->push = push;
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
    grown.capacity = d->particle_block ? n + n / 2 + 64 : n;
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

/* a new array of n entries in place of the old one, whose contents go */
static bool renew(void *array, size_t n, size_t size) {
  void **p = array;
  free(*p);
  *p = aligned_alloc(64, (n * size + 127) & ~(size_t)63);
  return *p != NULL;
}

bool dem_pairs_reserve(dem_pairs *list, size_t count, int ncolumn) {
  if (count <= list->capacity && list->one) /* arrays also for no entries */
    return true;
  size_t capacity = (count + count / 8 + 64) & ~(size_t)7;
  list->capacity = 0;
  if (!renew(&list->one, capacity, sizeof(int)) || !renew(&list->other, capacity, sizeof(int)) ||
      !renew(&list->sink, capacity, sizeof(int)) ||
      (ncolumn > 0 && !renew(&list->history, capacity * (size_t)ncolumn, sizeof(double))))
    return false;
  list->capacity = capacity;
  return true;
}

bool dem_walls_reserve(dem_wall_contacts *list, size_t count, int ncolumn) {
  if (count <= list->capacity)
    return true;
  size_t capacity = count + count / 4 + 64;
  list->capacity = 0;
  if (!renew(&list->entry, capacity, sizeof *list->entry) ||
      (ncolumn > 0 && !renew(&list->history, capacity * (size_t)ncolumn, sizeof(double))))
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
  d->nparticle = m->nparticle - m->npoured;
  for (int i = 0; i < d->nparticle; i++) {
    d->id[i] = (uint64_t)i;
    d->mass[i] = m->mass[i];
    d->kind[i] = m->kind[i];
    d->sphere[i] = (dem_sphere){m->position[i], m->radius[i], m->velocity[i], 1 / m->mass[i]};
    d->rotor[i] = (dem_rotor){tdm_scale(m->radius[i], m->spin[i]), m->radius[i]};
    d->pace[i] = (dem_pace){.velocity = m->velocity[i], .spin = m->spin[i]};
    dem_exact_add(&d->ledger.mass, m->mass[i]);
  }
  end_particles(d);
  d->ledger.created = (uint64_t)d->nparticle;
  d->since_sort = DEM_SORT_STEPS;
  for (int b = 0; b < m->nbody; b++) {
    d->pose[b] = m->body[b].start.pose;
    d->twist[b] = m->body[b].start.twist;
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
  d->search = dem_search_create("cells");
  d->nthread = 1;
  if (d->block)
    layout(d, d->block);
  if (!d->block || !d->search || !dem_data_reserve(d, model->nparticle > 0 ? model->nparticle : 1)) {
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
  int ncolumn = src->model->law->ncolumn;
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
    memcpy(dst->pairs.sink, p->sink, p->count * sizeof *p->sink);
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
  end_particles(dst);
  if (!copy_lists(dst, src))
    return false;
  memcpy(dst->push, src->push, (size_t)src->nparticle * sizeof *src->push);
  memset(dst->push + src->nparticle, 0, (size_t)(src->crossings.count + 1) * sizeof *src->push);
  dst->nstep = src->nstep;
  dst->since_sort = src->since_sort;
  dst->ledger = src->ledger;
  dst->list_valid = src->list_valid;
  dst->list_stale = src->list_stale;
  dst->nrebuild = src->nrebuild;
  dst->ncontact = src->ncontact;
  dst->sample_count = src->sample_count;
  return true;
}

void dem_data_destroy(dem_data **data) {
  dem_data *d = *data;
  if (!d)
    return;
  void *arrays[] = {d->pairs.one,
                    d->pairs.other,
                    d->pairs.sink,
                    d->pairs.history,
                    d->spare_pairs.one,
                    d->spare_pairs.other,
                    d->spare_pairs.sink,
                    d->spare_pairs.history,
                    d->walls.entry,
                    d->walls.history,
                    d->spare_walls.entry,
                    d->spare_walls.history,
                    d->crossings.particle,
                    d->crossings.order,
                    d->push,
                    d->particle_block,
                    d->block};
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
    free(arrays[i]);
  dem_rows_free(&d->rows);
  dem_search_destroy(&d->search);
  free(d);
  *data = NULL;
}

/* ---- particles that come and go ---- */

bool dem_data_add(dem_data *d, const dem_newcomer *newcomer) {
  if (!dem_data_reserve(d, d->nparticle + 1))
    return false;
  int i = d->nparticle++;
  d->id[i] = d->ledger.created++;
  d->mass[i] = newcomer->mass;
  d->kind[i] = newcomer->kind;
  d->touched[i] = 0;
  d->sphere[i] = (dem_sphere){newcomer->position, newcomer->radius, newcomer->velocity, 1 / newcomer->mass};
  d->rotor[i] = (dem_rotor){.radius = newcomer->radius};
  d->pace[i] = (dem_pace){.velocity = newcomer->velocity};
  d->push[i] = (dem_push){0};
  d->position_at_list[i] = newcomer->position;
  end_particles(d);
  dem_exact_add(&d->ledger.mass, newcomer->mass);
  dem_mark_front(d, i);
  /* an empty row, so that the histories of the others are carried over at the rebuild */
  d->pairs.first[i + 1] = d->pairs.first[i];
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
      list->other[out] = list->sink[out] = number[other];
      for (size_t q = 0; q < (size_t)ncolumn; q++)
        list->history[q * list->capacity + out] = list->history[q * list->capacity + (size_t)k];
      out++;
    }
  }
  for (; out % DEM_LANES_MAX != 0; out++)
    list->one[out] = list->other[out] = list->sink[out] = after;
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
  int ncolumn = d->model->law->ncolumn;
  remove_pairs(&d->pairs, before, after, number, ncolumn);
  remove_walls(&d->walls, number, ncolumn);
  for (int i = 0; i < before; i++) {
    if (number[i] < 0) {
      d->ledger.removed++;
      dem_exact_add(&d->ledger.mass, -d->mass[i]);
      continue;
    }
    d->push[number[i]] = d->push[i];
#define X(field, n)                                                                       \
  memmove(&d->field[(size_t)number[i] * (size_t)(n)], &d->field[(size_t)i * (size_t)(n)], \
          (size_t)(n) * sizeof *d->field);
    PARTICLE_STATE(X)
#undef X
  }
  d->nparticle = after;
  end_particles(d);
  d->push[after] = (dem_push){0};
  if (d->nchunk > 1) {
    d->list_stale = true; /* chunks have other particles now */
    return;
  }
  d->pairs.chunk[1] = d->pairs.count;
  d->walls.chunk[1] = d->walls.count;
}

/* ---- order ---- */

/* Put the particles in a new order: place p gets what was at from[p]. The lists keep the old numbers. */
bool dem_data_permute(dem_data *d, const int *from) {
  size_t np = (size_t)d->nparticle, largest = 0;
#define X(field, n) largest = (size_t)(n) * sizeof *d->field > largest ? (size_t)(n) * sizeof *d->field : largest;
  PARTICLE_STATE(X)
#undef X
  if (sizeof *d->push > largest)
    largest = sizeof *d->push;
  char *copy = malloc(np * largest + 1);
  if (!copy)
    return false;
#define MOVE(field, n)                                                          \
  {                                                                             \
    size_t size = (size_t)(n) * sizeof *d->field;                               \
    memcpy(copy, d->field, np *size);                                           \
    for (size_t p = 0; p < np; p++)                                             \
      memcpy((char *)d->field + p * size, copy + (size_t)from[p] * size, size); \
  }
#define X(field, n) MOVE(field, n)
  PARTICLE_STATE(X)
#undef X
  MOVE(push, 1)
  free(copy);
  return true;
}
