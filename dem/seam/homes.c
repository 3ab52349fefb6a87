/* What ranks tell each other of the state: see homes.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/seam/homes.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

void dem_homes_begin(dem_data *d, const dem_ranks *ranks) {
  d->work.homes.ranks = ranks;
  d->work.homes.planned = false;
  for (int r = 0; ranks && r <= ranks->size; r++)
    d->lists.home[r] = dem_home_at_start(r, ranks->size);
  dem_united(d);
}

void dem_each_chunk(dem_data *d, dem_chunk_work *work, void *context) {
  const int first = dem_home_first(d), end = dem_home_end(d);
  if (d->work.nthread == 1)
    for (int c = first; c < end; c++)
      work(d, c, context);
  else
#pragma omp parallel for schedule(static) num_threads(d->work.nthread)
    for (int c = first; c < end; c++)
      work(d, c, context);
}

void dem_zero(const dem_data *d, void *array, size_t bytes) {
  const size_t piece = (size_t)1 << 16;
#pragma omp parallel for schedule(static) num_threads(d->work.nthread) if (d->work.nthread > 1)
  for (size_t at = 0; at < bytes; at += piece)
    memset((char *)array + at, 0, bytes - at < piece ? bytes - at : piece);
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
  d->work.homes.spread = d->work.homes.spread || who == ALL || dem_homes_writes(d);
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

void dem_homes_number(const dem_data *d, long x, long *all) {
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
  dem_homes_number(d, n, count);
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

tdm_status dem_homes_alive(dem_data *d, tdm_participant *p) {
  dem_homes *s = &d->work.homes;
  const tdm_status status = tdm_participant_alive(p);
  if (!s->ranks)
    return status;
  s->stop = s->stop || status;
  return s->stopped ? TDM_ERR_INTERRUPTED : TDM_OK;
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
