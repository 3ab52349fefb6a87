/* Particles that visit other ranks: see visits.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/seam/visits.h"

#include "dem/seam/crossings.h"
#include "dem/seam/sums.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* ---- who visits whom ---- */

static int rank_of_crossing(const dem_data *d, int place) {
  return d->work.homes.rank_of[d->lists.crossings.particle[place] / DEM_CHUNK];
}

static tdm_status reserve(dem_parcels *p, int size, int count) {
  if (!p->first)
    p->first = malloc(((size_t)size + 1) * sizeof *p->first);
  if (!p->first)
    return TDM_ERR_MEMORY;
  if (count <= p->capacity && p->item)
    return TDM_OK;
  const int capacity = count + count / 4 + 64;
  int *item = realloc(p->item, (size_t)capacity * sizeof *item);
  if (!item)
    return TDM_ERR_MEMORY;
  p->item = item;
  p->capacity = capacity;
  return TDM_OK;
}

/* With whom rank `from`'s crossing at this place is shared, as this rank sees it; -1: it is none of its business. */
static int partner(const dem_data *d, int from, int place) {
  const int here = d->work.homes.ranks->rank, to = rank_of_crossing(d, place);
  if (from == to)
    return -1;
  return from == here ? to : to == here ? from : -1;
}

/* The places of crossings that leave this rank (mine) or come to it, by the other rank, ascending; those of rank r's
 * own chunks are place[r] ... place[r + 1] - 1. */
static tdm_status collect(const dem_data *d, const int *place, bool mine, dem_parcels *out) {
  const int size = d->work.homes.ranks->size, here = d->work.homes.ranks->rank;
  const int low = mine ? here : 0, high = mine ? here + 1 : here; /* reactions go to later chunks */
  int count = 0;
  for (int p = place[low]; p < place[high]; p++)
    count += mine ? rank_of_crossing(d, p) != here : rank_of_crossing(d, p) == here;
  if (reserve(out, size, count))
    return TDM_ERR_MEMORY;
  memset(out->first, 0, ((size_t)size + 1) * sizeof *out->first);
  for (int r = low; r < high; r++)
    for (int p = place[r], with; p < place[r + 1]; p++)
      if ((with = partner(d, r, p)) >= 0)
        out->first[with + 1]++;
  for (int r = 0; r < size; r++)
    out->first[r + 1] += out->first[r];
  for (int r = high - 1; r >= low; r--) /* filled from the ends */
    for (int p = place[r + 1] - 1, with; p >= place[r]; p--)
      if ((with = partner(d, r, p)) >= 0)
        out->item[--out->first[with + 1]] = p;
  for (int r = 0; r < size; r++) /* first[r + 1] is now where rank r begins */
    out->first[r] = out->first[r + 1];
  out->first[size] = count;
  return TDM_OK;
}

static int ascending(const void *a, const void *b) {
  const int x = *(const int *)a, y = *(const int *)b;
  return (x > y) - (x < y);
}

/* the particles of crossings, each once for a rank, ascending */
static tdm_status particles_of(const dem_data *d, const dem_parcels *places, dem_parcels *out) {
  const int size = d->work.homes.ranks->size;
  if (reserve(out, size, places->first[size]))
    return TDM_ERR_MEMORY;
  int n = 0;
  for (int r = 0; r < size; r++) {
    const int begin = n, count = places->first[r + 1] - places->first[r];
    out->first[r] = begin;
    for (int k = 0; k < count; k++)
      out->item[begin + k] = d->lists.crossings.particle[places->item[places->first[r] + k]];
    qsort(out->item + begin, (size_t)count, sizeof *out->item, ascending);
    for (int k = 0; k < count; k++)
      if (k == 0 || out->item[begin + k] != out->item[n - 1])
        out->item[n++] = out->item[begin + k];
  }
  out->first[size] = n;
  return TDM_OK;
}

/* where the places of the crossings of each rank's chunks begin (size + 1) */
static void place_ranks(const dem_data *d, int *place) {
  const dem_ranks *ranks = d->work.homes.ranks;
  long count[DEM_RANKS_MAX];
  dem_homes_number(d, d->lists.crossings.end - d->lists.crossings.first, count);
  place[0] = 0;
  for (int r = 0; r < ranks->size; r++)
    place[r + 1] = place[r] + (int)count[r];
  assert(place[ranks->size] == d->lists.crossings.count);
}

/* Does a contact of the chunk name a particle of another rank? */
static bool has_visitors(const dem_data *d, int chunk) {
  const dem_crossings *x = &d->lists.crossings;
  for (int p = x->from[chunk]; p < x->from[chunk + 1]; p++)
    if (x->particle[p] / DEM_CHUNK >= dem_home_end(d))
      return true;
  return false;
}

/* whose home each chunk is, and room for the times of chunks */
static tdm_status know_chunks(dem_data *d) {
  dem_homes *s = &d->work.homes;
  const int n = d->lists.nchunk;
  if (n > s->ncost) {
    int *rank_of = realloc(s->rank_of, (size_t)n * sizeof *rank_of);
    s->rank_of = rank_of ? rank_of : s->rank_of;
    double *cost = realloc(s->cost, (size_t)n * sizeof *cost);
    s->cost = cost ? cost : s->cost;
    if (!rank_of || !cost)
      return TDM_ERR_MEMORY;
    memset(cost + s->ncost, 0, (size_t)(n - s->ncost) * sizeof *cost);
    s->ncost = n;
  }
  for (int r = 0; r < s->ranks->size; r++)
    for (int c = dem_chunk_of_rank(d, r); c < dem_chunk_of_rank(d, r + 1); c++)
      s->rank_of[c] = r;
  return TDM_OK;
}

/* Home chunks in the order of their evaluation: half of those without visitors while visitors come, those with, and the
 * others while reactions return. */
static tdm_status order_chunks(dem_data *d) {
  dem_homes *s = &d->work.homes;
  const int first = dem_home_first(d), end = dem_home_end(d);
  int *chunk = realloc(s->chunk, (size_t)(end - first + 1) * sizeof *chunk);
  if (!chunk)
    return TDM_ERR_MEMORY;
  s->chunk = chunk;
  int inner = 0;
  for (int c = first; c < end; c++)
    inner += !has_visitors(d, c);
  s->first_outer = inner / 2;
  s->end_outer = end - first - (inner - inner / 2);
  int before = 0, outer = s->first_outer, after = s->end_outer;
  for (int c = first; c < end; c++)
    chunk[has_visitors(d, c) ? outer++ : before < s->first_outer ? before++ : after++] = c;
  return TDM_OK;
}

static size_t larger(size_t a, size_t b) {
  return a > b ? a : b;
}

/* What a visitor brings: each time, and the first time after a plan. */
typedef struct {
  tdm_vec3 position, velocity, surface;
} visit;
typedef struct {
  visit now;
  double radius, inverse_mass;
} introduction;

/* a reaction on its way */
typedef struct {
  tdm_vec3 force, twist;
} reaction;

enum { LETTER = sizeof(introduction) }; /* the longest about a particle or a contact */

static tdm_status reserve_mail(dem_data *d) {
  dem_homes *s = &d->work.homes;
  const size_t size = (size_t)s->ranks->size;
  const size_t out = larger((size_t)s->immigrants.first[size], (size_t)s->returning.first[size]) * LETTER,
               in = larger((size_t)s->visitors.first[size], (size_t)s->returned.first[size]) * LETTER,
               room = larger(out, in);
  if (!s->mail)
    s->mail = malloc(size * sizeof *s->mail);
  if (room > s->room || !s->out) {
    free(s->out);
    free(s->in);
    s->room = room + room / 4 + 64;
    s->out = malloc(s->room);
    s->in = malloc(s->room);
  }
  return s->mail && s->out && s->in ? TDM_OK : TDM_ERR_MEMORY;
}

/* begin to exchange parcels, an item of so many bytes */
static void post(dem_homes *s, const dem_parcels *out, const dem_parcels *in, size_t each) {
  int n = 0;
  for (int r = 0; r < s->ranks->size; r++) {
    const size_t sent = (size_t)(out->first[r + 1] - out->first[r]) * each,
                 received = (size_t)(in->first[r + 1] - in->first[r]) * each;
    if (sent + received > 0)
      s->mail[n++] = (dem_mail){.rank = r,
                                .send = s->out + (size_t)out->first[r] * each,
                                .receive = s->in + (size_t)in->first[r] * each,
                                .sent = sent,
                                .received = received};
  }
  s->ranks->begin(s->mail, n);
}

static void learn(dem_data *d, int *array) {
  dem_homes *s = &d->work.homes;
  int *out = (int *)(void *)s->out, *in = (int *)(void *)s->in;
  for (int k = 0; k < s->immigrants.first[s->ranks->size]; k++)
    out[k] = array[s->immigrants.item[k]];
  post(s, &s->immigrants, &s->visitors, sizeof *out);
  s->ranks->finish();
  for (int k = 0; k < s->visitors.first[s->ranks->size]; k++)
    array[s->visitors.item[k]] = in[k];
}

static tdm_status plan_visits(dem_data *d) {
  dem_homes *s = &d->work.homes;
  int place[DEM_RANKS_MAX + 1];
  if (know_chunks(d))
    return TDM_ERR_MEMORY;
  place_ranks(d, place);
  if (collect(d, place, true, &s->returning) || collect(d, place, false, &s->returned) ||
      particles_of(d, &s->returning, &s->visitors) || particles_of(d, &s->returned, &s->immigrants) ||
      order_chunks(d) || reserve_mail(d) || dem_sums_reserve(d))
    return TDM_ERR_MEMORY;
  if (d->model->nmaterial > 1)
    learn(d, d->state.material); /* visitors keep theirs until there are others */
  s->introduced = false;
  return TDM_OK;
}

tdm_status dem_homes_plan(dem_data *d) {
  dem_homes *s = &d->work.homes;
  if (!s->ranks || s->planned)
    return TDM_OK;
  if (plan_visits(d) || (d->work.nthread == 1 && dem_givers_find(d)))
    return TDM_ERR_MEMORY;
  s->planned = true;
  return TDM_OK;
}

tdm_status dem_visitors_learn(dem_data *d, int *array) {
  if (dem_homes_plan(d))
    return TDM_ERR_MEMORY;
  learn(d, array);
  return TDM_OK;
}

/* ---- a step ---- */

void dem_visitors_begin(dem_data *d) {
  dem_homes *s = &d->work.homes;
  if (!s->ranks || s->united & DEM_PLACES)
    return;
  assert(s->planned && !s->visiting);
  const double begin = tdm_clock();
  const size_t each = s->introduced ? sizeof(visit) : sizeof(introduction);
  for (int k = 0; k < s->immigrants.first[s->ranks->size]; k++) {
    const int i = s->immigrants.item[k];
    const dem_sphere *sphere = &d->state.sphere[i];
    const introduction all = {
        {sphere->position, sphere->velocity, d->state.rotor[i].surface}, sphere->radius, sphere->inverse_mass};
    memcpy(s->out + (size_t)k * each, &all, each);
  }
  post(s, &s->immigrants, &s->visitors, each);
  s->visiting = true;
  s->spent += tdm_clock() - begin;
}

void dem_visitors_end(dem_data *d) {
  dem_homes *s = &d->work.homes;
  if (!s->visiting)
    return;
  const double begin = tdm_clock();
  const size_t each = s->introduced ? sizeof(visit) : sizeof(introduction);
  s->ranks->finish();
  for (int k = 0; k < s->visitors.first[s->ranks->size]; k++) {
    const int j = s->visitors.item[k];
    dem_sphere *sphere = &d->state.sphere[j];
    introduction came = {.radius = sphere->radius, .inverse_mass = sphere->inverse_mass};
    memcpy(&came, s->in + (size_t)k * each, each);
    *sphere = (dem_sphere){came.now.position, came.radius, came.now.velocity, came.inverse_mass};
    d->state.rotor[j] = (dem_rotor){came.now.surface, came.radius};
  }
  s->visiting = false;
  s->introduced = true;
  s->spent += tdm_clock() - begin;
}

void dem_homes_tell(dem_data *d, dem_course course, int n, dem_letter *write, dem_letter *read) {
  dem_homes *s = &d->work.homes;
  const size_t size = (size_t)n * sizeof(double);
  if (!s->ranks)
    return;
  assert(s->planned && !s->visiting && size <= LETTER);
  const dem_parcels *const courses[][2] = {
      {&s->returning, &s->returned}, {&s->returned, &s->returning}, {&s->immigrants, &s->visitors}};
  const dem_parcels *out = courses[course][0], *in = courses[course][1];
  const double begin = tdm_clock();
  for (int k = 0; k < out->first[s->ranks->size]; k++)
    write(d, k, (double *)(void *)(s->out + (size_t)k * size));
  post(s, out, in, size);
  s->ranks->finish();
  for (int k = 0; k < in->first[s->ranks->size]; k++)
    read(d, k, (double *)(void *)(s->in + (size_t)k * size));
  s->spent += tdm_clock() - begin;
}

void dem_reactions_begin(dem_data *d) {
  dem_homes *s = &d->work.homes;
  if (!s->ranks)
    return;
  assert(s->planned && !s->visiting);
  const double begin = tdm_clock();
  reaction *out = (reaction *)(void *)s->out;
  for (int k = 0; k < s->returning.first[s->ranks->size]; k++) {
    dem_push *from = &d->state.push[dem_crossing_slot(d, s->returning.item[k])];
    out[k] = (reaction){from->force, from->twist};
    *from = (dem_push){0};
  }
  post(s, &s->returning, &s->returned, sizeof *out);
  s->spent += tdm_clock() - begin;
}

void dem_reactions_end(dem_data *d) {
  dem_homes *s = &d->work.homes;
  if (!s->ranks)
    return;
  const double begin = tdm_clock();
  const reaction *in = (const reaction *)(const void *)s->in;
  s->ranks->finish();
  for (int k = 0; k < s->returned.first[s->ranks->size]; k++)
    d->state.push[dem_crossing_slot(d, s->returned.item[k])] = (dem_push){.force = in[k].force, .twist = in[k].twist};
  s->spent += tdm_clock() - begin;
}
