/* What ranks tell each other of the state: see homes.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/state/homes.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

void dem_homes_begin(dem_data *d, const dem_ranks *ranks) {
  d->work.homes.ranks = ranks;
  d->work.homes.planned = false;
  for (int r = 0; ranks && r <= ranks->size; r++)
    d->lists.home[r] = (double)r / ranks->size;
  dem_united(d);
}

/* ---- whole arrays ---- */

/* what the entries of an array belong to, and who is to have them */
typedef enum { PARTICLES, CHUNKS, ENTRIES } owners;
typedef enum { ALL, FIRST } readers;

/* entries first[r] ... first[r + 1] - 1 of an array become those of rank r, on rank 0 */
static void send_to_first(const dem_ranks *ranks, char *array, size_t size, const int *first) {
  dem_mail *mail = malloc((size_t)ranks->size * sizeof *mail);
  int n = 0;
  if (!mail)
    ranks->abandon("no memory for the letters to rank 0");
  for (int r = 1; r < ranks->size; r++) {
    char *at = array + (size_t)first[r] * size;
    const size_t bytes = (size_t)(first[r + 1] - first[r]) * size;
    if (ranks->rank == 0)
      mail[n++] = (dem_mail){.rank = r, .receive = at, .received = bytes};
    else if (ranks->rank == r)
      mail[n++] = (dem_mail){.rank = 0, .send = at, .sent = bytes};
  }
  ranks->begin(mail, n);
  ranks->finish();
  free(mail);
}

/* chunk: of ENTRIES, the first one of each chunk */
static void gather_for(dem_data *d, void *array, size_t size, owners of, const size_t *chunk, readers who) {
  dem_homes *s = &d->work.homes;
  int first[DEM_RANKS_MAX + 1];
  if (!array || size == 0)
    return;
  for (int r = 0; r <= s->ranks->size; r++) {
    const int c = dem_chunk_of_rank(d, r);
    first[r] = of == CHUNKS ? c : of == ENTRIES ? (int)chunk[c] : dem_chunk_start(d, c);
  }
  const double begin = tdm_clock();
  if (who == ALL)
    s->ranks->gather(array, size, first);
  else
    send_to_first(s->ranks, array, size, first);
  s->spent += tdm_clock() - begin;
}

static void gather(dem_data *d, void *array, size_t size, const size_t *chunk, readers who) {
  gather_for(d, array, size, chunk ? ENTRIES : PARTICLES, chunk, who);
}

void dem_unite_particles(dem_data *d, void *array, size_t size) {
  if (!dem_alone(d))
    gather(d, array, size, NULL, ALL);
}

void dem_unite_chunks(dem_data *d, void *array, size_t size) {
  if (!dem_alone(d))
    gather_for(d, array, size, CHUNKS, NULL, ALL);
}

void dem_unite_entries(dem_data *d, void *array, size_t size, const size_t *chunk) {
  if (!dem_alone(d))
    gather(d, array, size, chunk, ALL);
}

void dem_lay_out(dem_data *d, size_t *chunk) {
  size_t at = 0;
  dem_unite_chunks(d, chunk, sizeof *chunk);
  for (int c = 0; c < d->lists.nchunk; c++) {
    const size_t count = chunk[c];
    chunk[c] = at;
    at += count;
  }
  chunk[d->lists.nchunk] = at;
}

/* the arrays of particles: of the places those that tell them, else the others */
static void gather_particles(dem_data *d, bool places, readers who) {
#define X(field, n, name)                                                                                \
  if (((const void *)d->field == d->state.sphere || (const void *)d->field == d->state.rotor) == places) \
    gather(d, d->field, (size_t)(n) * sizeof *d->field, NULL, who);
  DEM_PARTICLE_STATE(X)
#undef X
}

static void gather_forces(dem_data *d, readers who) {
#define X(field, name) gather(d, d->field, sizeof *d->field, NULL, who);
  DEM_FORCE_STATE(X)
#undef X
}

static void gather_histories(dem_data *d, readers who) {
  const dem_pairs *p = &d->lists.pairs;
  const dem_wall_contacts *w = &d->lists.walls;
  for (size_t q = 0; q < (size_t)d->model->columns.ncolumn; q++) {
    if (p->history)
      gather(d, p->history + q * p->capacity, sizeof *p->history, p->chunk, who);
    if (w->history)
      gather(d, w->history + q * w->capacity, sizeof *w->history, w->chunk, who);
  }
}

/* what contacts are among others, of laws that ask */
static void gather_among(dem_data *d, readers who) {
  static const int told[] = {DEM_NOTE_WIDTH, DEM_NOTE_SIDE, DEM_NOTE_OTHER};
  const dem_notes *notes = &d->work.notes;
  if (d->work.among && d->model->nsum > 0)
    gather(d, d->work.contact_sum, (size_t)d->model->nsum * sizeof *d->work.contact_sum, NULL, who);
  for (int q = 0; notes->valid && q < 3; q++) {
    double *column = notes->column + (size_t)told[q] * notes->stride;
    gather(d, column, sizeof *column, d->lists.pairs.chunk, who);
    gather(d, column + d->lists.pairs.count, sizeof *column, d->lists.walls.chunk, who);
  }
}

static void gather_lists(dem_data *d, readers who) {
  const dem_pairs *p = &d->lists.pairs;
  const dem_wall_contacts *w = &d->lists.walls;
  gather(d, p->first, sizeof *p->first, NULL, who);
  gather(d, p->one, sizeof *p->one, p->chunk, who);
  gather(d, p->other, sizeof *p->other, p->chunk, who);
  gather(d, w->entry, sizeof *w->entry, w->chunk, who);
}

static void gather_what(dem_data *d, unsigned what, readers who) {
  if (what & DEM_PLACES)
    gather_particles(d, true, who);
  if (what & DEM_MOTION)
    gather_particles(d, false, who);
  if (what & DEM_FORCES)
    gather_forces(d, who);
  if (what & DEM_CONTACTS) {
    gather_histories(d, who);
    gather_among(d, who);
  }
  if (what & DEM_LISTS)
    gather_lists(d, who);
}

void dem_unite(dem_data *d, unsigned what) {
  dem_homes *s = &d->work.homes;
  what &= ~s->united;
  if (!s->ranks || !what)
    return;
  gather_what(d, what, ALL);
  s->united |= what | what << DEM_ON_FIRST;
}

void dem_collect(dem_data *d, unsigned what) {
  dem_homes *s = &d->work.homes;
  what &= ~(s->united >> DEM_ON_FIRST);
  if (!s->ranks || !what)
    return;
  assert(!s->visiting); /* letters do not mix */
  gather_what(d, what, FIRST);
  s->united |= what << DEM_ON_FIRST;
}

/* ---- numbers ---- */

void dem_homes_largest_of(const dem_data *d, double *x, int n) {
  if (!dem_alone(d) && n > 0)
    d->work.homes.ranks->largest(x, n);
}

double dem_homes_largest(const dem_data *d, double x) {
  dem_homes_largest_of(d, &x, 1);
  return x;
}

/* each rank's number (size), on all */
static void tell_all(const dem_data *d, long x, long *all) {
  const dem_ranks *ranks = d->work.homes.ranks;
  int own[DEM_RANKS_MAX + 1];
  for (int r = 0; r <= ranks->size; r++)
    own[r] = r;
  all[ranks->rank] = x;
  ranks->gather(all, sizeof *all, own);
}

void *dem_homes_join(const dem_data *d, const void *own, int n, size_t size, int *all) {
  const dem_ranks *ranks = d->work.homes.ranks;
  long count[DEM_RANKS_MAX];
  int first[DEM_RANKS_MAX + 1] = {0};
  tell_all(d, n, count);
  for (int r = 0; r < ranks->size; r++)
    first[r + 1] = first[r] + (int)count[r];
  *all = first[ranks->size];
  char *joined = malloc((size_t)*all * size + 1);
  if (!joined)
    ranks->abandon("no memory for what ranks tell each other");
  if (n > 0)
    memcpy(joined + (size_t)first[ranks->rank] * size, own, (size_t)n * size);
  ranks->gather(joined, size, first);
  return joined;
}

long dem_homes_sum(const dem_data *d, long x) {
  double sum = (double)x;
  if (!dem_alone(d))
    d->work.homes.ranks->sum(&sum, 1);
  return (long)sum;
}

bool dem_homes_any(const dem_data *d, bool here) {
  return dem_alone(d) ? here : dem_homes_largest(d, here) > 0;
}

tdm_status dem_homes_follow(const dem_data *d, void *found, size_t size, tdm_error *err) {
  const dem_ranks *ranks = d->work.homes.ranks;
  int status = err ? (int)err->status : 0;
  if (ranks) {
    ranks->broadcast(&status, sizeof status);
    if (size > 0)
      ranks->broadcast(found, size);
    if (err && status && !err->status)
      tdm_fail(err, (tdm_status)status, NULL, "rank 0 failed");
  }
  return (tdm_status)status;
}

tdm_status dem_homes_alive(dem_data *d, tdm_participant *p) {
  dem_homes *s = &d->work.homes;
  const tdm_status status = tdm_participant_alive(p);
  if (!s->ranks)
    return status;
  s->stop = s->stop || status;
  return s->stopped ? TDM_ERR_INTERRUPTED : TDM_OK;
}

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
  const dem_pairs *p = &d->lists.pairs;
  long here = 0, count[DEM_RANKS_MAX];
  for (size_t k = p->chunk[dem_home_first(d)]; k < p->chunk[dem_home_end(d)]; k++)
    here += p->reaction_slot[k] > d->state.nparticle;
  tell_all(d, here, count);
  place[0] = 0;
  for (int r = 0; r < ranks->size; r++)
    place[r + 1] = place[r] + (int)count[r];
  assert(place[ranks->size] == d->lists.crossings.count);
}

/* Does a contact of the chunk name a particle of another rank? */
static bool has_visitors(const dem_data *d, int chunk) {
  const dem_pairs *p = &d->lists.pairs;
  for (size_t k = p->chunk[chunk]; k < p->chunk[chunk + 1]; k++)
    if (p->reaction_slot[k] > d->state.nparticle && p->other[k] / DEM_CHUNK >= dem_home_end(d))
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

/* home chunks, those without visitors first */
static tdm_status order_chunks(dem_data *d) {
  dem_homes *s = &d->work.homes;
  const int first = dem_home_first(d), n = dem_home_end(d) - first;
  int *chunk = realloc(s->chunk, (size_t)(n + 1) * sizeof *chunk);
  if (!chunk)
    return TDM_ERR_MEMORY;
  s->chunk = chunk;
  int inner = 0, outer = n;
  for (int c = first; c < first + n; c++)
    if (has_visitors(d, c))
      chunk[--outer] = c;
    else
      chunk[inner++] = c;
  s->ninner = inner;
  return TDM_OK;
}

static size_t larger(size_t a, size_t b) {
  return a > b ? a : b;
}

enum { VISIT = sizeof(dem_sphere) + sizeof(dem_rotor) };

enum { OF_RANK = 3 }; /* doubles that a rank tells of itself in the sums, besides those of chunks */

static size_t sums_of_chunk(const dem_data *d) {
  return (size_t)d->model->nload * (sizeof(tdm_wrench) / sizeof(double)) +
         (d->model->energy ? sizeof(dem_flux) / sizeof(double) : 0);
}

static tdm_status reserve_mail(dem_data *d) {
  dem_homes *s = &d->work.homes;
  const size_t size = (size_t)s->ranks->size;
  const size_t out = larger((size_t)s->immigrants.first[size] * VISIT,
                            (size_t)s->returning.first[size] * sizeof(dem_push)),
               in = larger((size_t)s->visitors.first[size] * VISIT, (size_t)s->returned.first[size] * sizeof(dem_push)),
               room = larger(out, in), nsums = OF_RANK * size + (size_t)d->lists.nchunk * sums_of_chunk(d);
  if (!s->mail)
    s->mail = malloc(size * sizeof *s->mail);
  if (room > s->room || !s->out) {
    free(s->out);
    free(s->in);
    s->room = room + room / 4 + 64;
    s->out = malloc(s->room);
    s->in = malloc(s->room);
  }
  if (nsums > s->nsums || !s->sums) {
    free(s->sums);
    s->nsums = nsums + nsums / 4 + 64;
    s->sums = malloc(s->nsums * sizeof *s->sums);
  }
  return s->mail && s->out && s->in && s->sums ? TDM_OK : TDM_ERR_MEMORY;
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

tdm_status dem_homes_plan(dem_data *d) {
  dem_homes *s = &d->work.homes;
  int place[DEM_RANKS_MAX + 1];
  if (!s->ranks || s->planned)
    return TDM_OK;
  if (know_chunks(d))
    return TDM_ERR_MEMORY;
  place_ranks(d, place);
  if (collect(d, place, true, &s->returning) || collect(d, place, false, &s->returned) ||
      particles_of(d, &s->returning, &s->visitors) || particles_of(d, &s->returned, &s->immigrants) ||
      order_chunks(d) || reserve_mail(d))
    return TDM_ERR_MEMORY;
  if (d->model->nmaterial > 1)
    learn(d, d->state.material); /* visitors keep theirs until there are others */
  s->planned = true;
  return TDM_OK;
}

tdm_status dem_visitors_learn(dem_data *d, int *array) {
  if (dem_homes_plan(d))
    return TDM_ERR_MEMORY;
  learn(d, array);
  return TDM_OK;
}

/* ---- times ---- */

double (*dem_homes_clock)(void) = tdm_clock;

void dem_homes_measure(dem_data *d) {
  dem_homes *s = &d->work.homes;
  s->looked = d->state.nstep;
  s->all_busiest += s->busiest;
  s->all_mean += s->mean;
  s->busiest = s->mean = 0;
  if (s->ncost > 0)
    memset(s->cost, 0, (size_t)s->ncost * sizeof *s->cost);
}

/* ---- a step ---- */

void dem_visitors_begin(dem_data *d) {
  dem_homes *s = &d->work.homes;
  if (!s->ranks || s->united & DEM_PLACES)
    return;
  assert(s->planned && !s->visiting);
  const double begin = tdm_clock();
  for (int k = 0; k < s->immigrants.first[s->ranks->size]; k++) {
    const int i = s->immigrants.item[k];
    char *to = s->out + (size_t)k * VISIT;
    memcpy(to, &d->state.sphere[i], sizeof(dem_sphere));
    memcpy(to + sizeof(dem_sphere), &d->state.rotor[i], sizeof(dem_rotor));
  }
  post(s, &s->immigrants, &s->visitors, VISIT);
  s->visiting = true;
  s->spent += tdm_clock() - begin;
}

void dem_visitors_end(dem_data *d) {
  dem_homes *s = &d->work.homes;
  if (!s->visiting)
    return;
  const double begin = tdm_clock();
  s->ranks->finish();
  for (int k = 0; k < s->visitors.first[s->ranks->size]; k++) {
    const int j = s->visitors.item[k];
    const char *from = s->in + (size_t)k * VISIT;
    memcpy(&d->state.sphere[j], from, sizeof(dem_sphere));
    memcpy(&d->state.rotor[j], from + sizeof(dem_sphere), sizeof(dem_rotor));
  }
  s->visiting = false;
  s->spent += tdm_clock() - begin;
}

void dem_homes_tell(dem_data *d, dem_course course, int n, dem_letter *write, dem_letter *read) {
  dem_homes *s = &d->work.homes;
  const size_t size = (size_t)n * sizeof(double);
  if (!s->ranks)
    return;
  assert(s->planned && !s->visiting && size <= sizeof(dem_push) && size <= VISIT);
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

static void write_reaction(dem_data *d, int k, double *entry) {
  dem_push *from = &d->state.push[dem_crossing_slot(d, d->work.homes.returning.item[k])];
  memcpy(entry, from, sizeof *from);
  *from = (dem_push){0};
}

static void read_reaction(dem_data *d, int k, double *entry) {
  memcpy(&d->state.push[dem_crossing_slot(d, d->work.homes.returned.item[k])], entry, sizeof(dem_push));
}

void dem_reactions_return(dem_data *d) {
  dem_homes_tell(d, DEM_TO_HOME, sizeof(dem_push) / sizeof(double), write_reaction, read_reaction);
}

/* a chunk's loads and energies to or from a place among the sums */
static void copy_sums(dem_data *d, int chunk, double *place, bool to) {
  const size_t nload = (size_t)d->model->nload * sizeof(tdm_wrench), of = d->model->energy ? sizeof(dem_flux) : 0;
  char *sums = (char *)place;
  void *load = &d->work.chunk_load[(size_t)chunk * (size_t)d->model->nload], *flux = &d->work.chunk_flux[chunk];
  memcpy(to ? sums : load, to ? load : sums, nload);
  memcpy(to ? sums + nload : flux, to ? flux : sums + nload, of);
}

long dem_homes_sums(dem_data *d, long touching) {
  dem_homes *s = &d->work.homes;
  if (!s->ranks)
    return touching;
  const double begin = tdm_clock();
  const size_t each = sums_of_chunk(d);
  int first[DEM_RANKS_MAX + 1];
  for (int r = 0; r <= s->ranks->size; r++)
    first[r] = OF_RANK * r + dem_chunk_of_rank(d, r) * (int)each;
  double *own = s->sums + first[s->ranks->rank];
  own[0] = (double)touching;
  s->touching = touching;
  own[1] = s->stop;
  own[2] = 0;
  for (int c = dem_home_first(d), k = 0; c < dem_home_end(d); c++, k++) {
    own[2] += s->cost[c];
    copy_sums(d, c, own + OF_RANK + (size_t)k * each, true);
  }
  s->ranks->gather(s->sums, sizeof *s->sums, first);
  double sum = 0;
  s->busiest = s->mean = 0;
  for (int r = 0; r < s->ranks->size; r++) {
    double *of = s->sums + first[r];
    sum += of[0];
    s->busiest = fmax(s->busiest, of[2]);
    s->mean += of[2] / s->ranks->size;
    s->stopped = s->stopped || of[1] > 0;
    for (int c = dem_chunk_of_rank(d, r), k = 0; c < dem_chunk_of_rank(d, r + 1); c++, k++)
      copy_sums(d, c, of + OF_RANK + (size_t)k * each, false);
  }
  s->spent += tdm_clock() - begin;
  return (long)sum;
}
