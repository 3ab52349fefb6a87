/* Particles go to new homes: see renewal.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/exchange/renewal.h"

#include "dem/base/pages.h"
#include "dem/exchange/transfer.h"
#include "dem/seam/visits.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
  dem_data *d;
  const dem_ranks *ranks;
  int chunk, end_chunk; /* home of before: its chunks */
  int first, end;       /* and its particles */
  int *begin;           /* (ranks + 1) first particle of each new home */
  int *rank_of;         /* (nchunk) whose home a chunk is now */
  int *now;             /* (nparticle) new numbers, of the home particles of before and of their visitors */
} renewal;

static int rank_of(const renewal *r, int particle) {
  return r->rank_of[particle / DEM_CHUNK];
}

/* ---- the new order ---- */

/* Particles come in the order of these: no two are the same. */
typedef struct {
  uint64_t code; /* 63 bits */
  int particle;  /* the number it had, 31 bits */
} key;

enum { CODE_BITS = 63, PARTICLE_BITS = 31 };

static bool before(const key *a, const key *b) {
  return a->code != b->code ? a->code < b->code : a->particle < b->particle;
}

static int compare_keys(const void *a, const void *b) {
  return before(a, b) ? -1 : before(b, a);
}

/* how many of n keys, which ascend, are before one */
static int count_before(const key *own, int n, const key *k) {
  int low = 0, high = n;
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (before(&own[middle], k))
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* The first key of each new home: the largest that no more keys of all ranks are before than particles in the homes
 * before, bit by bit. `own` ascends. */
static tdm_status find_bounds(const renewal *r, const key *own, key *bound) {
  const int n = r->end - r->first, size = r->ranks->size;
  double *count = malloc((size_t)size * sizeof *count);
  if (!count)
    return TDM_ERR_MEMORY;
  memset(bound, 0, (size_t)size * sizeof *bound);
  for (int bit = CODE_BITS + PARTICLE_BITS - 1; bit >= 0; bit--) {
    const key with = bit >= PARTICLE_BITS ? (key){(uint64_t)1 << (bit - PARTICLE_BITS), 0} : (key){0, 1 << bit};
    for (int h = 0; h < size; h++)
      count[h] = count_before(own, n, &(key){bound[h].code | with.code, bound[h].particle | with.particle});
    r->ranks->sum(count, size);
    for (int h = 0; h < size; h++)
      if (count[h] <= r->begin[h])
        bound[h] = (key){bound[h].code | with.code, bound[h].particle | with.particle};
  }
  free(count);
  return TDM_OK;
}

typedef struct {
  key key;
  int arrival;
} arrived_key;

/* the new numbers of n keys that came to this home, in the order of arrival */
static void number_keys(const renewal *r, arrived_key *came, size_t n, int *numbers) {
  qsort(came, n, sizeof *came, compare_keys); /* a key is the first member */
  for (size_t k = 0; k < n; k++)
    numbers[came[k].arrival] = r->begin[r->ranks->rank] + (int)k;
}

/* Keys go to the ranks where they belong, which answer with their numbers: of own[k] numbers[k]. */
static tdm_status ask_numbers(const renewal *r, const key *own, const int *rank, int *numbers) {
  dem_transfer t;
  key *keys = NULL;
  arrived_key *came = NULL;
  int *answer = NULL;
  tdm_status status = dem_transfer_open(&t, r->ranks, 0, r->end - r->first, rank);
  if (!status) {
    keys = malloc((t.nin + 1) * sizeof *keys);
    came = malloc((t.nin + 1) * sizeof *came);
    answer = malloc((t.nin + 1) * sizeof *answer);
    status = keys && came && answer ? dem_transfer_fetch(&t, own, sizeof *own, keys) : TDM_ERR_MEMORY;
  }
  for (size_t k = 0; !status && k < t.nin; k++)
    came[k] = (arrived_key){keys[k], (int)k};
  free(keys);
  if (!status) {
    number_keys(r, came, t.nin, answer);
    status = dem_transfer_answer(&t, answer, sizeof *answer, numbers);
  }
  free(came);
  free(answer);
  dem_transfer_close(&t);
  return status;
}

/* the numbers that home particles will have */
static tdm_status number_home(renewal *r, const uint64_t *code) {
  const int n = r->end - r->first, size = r->ranks->size;
  key *own = malloc(((size_t)n + 1) * sizeof *own), *bound = malloc((size_t)size * sizeof *bound);
  int *rank = malloc(((size_t)n + 1) * sizeof *rank), *numbers = malloc(((size_t)n + 1) * sizeof *numbers);
  tdm_status status = own && bound && rank && numbers ? TDM_OK : TDM_ERR_MEMORY;
  if (!status) {
    for (int k = 0; k < n; k++)
      own[k] = (key){code[k], r->first + k};
    qsort(own, (size_t)n, sizeof *own, compare_keys);
    status = find_bounds(r, own, bound);
  }
  if (!status) {
    for (int h = 0, k = 0; h < size; h++)
      for (const int end = h + 1 < size ? count_before(own, n, &bound[h + 1]) : n; k < end; k++)
        rank[k] = h;
    status = ask_numbers(r, own, rank, numbers);
  }
  for (int k = 0; !status && k < n; k++)
    r->now[own[k].particle] = numbers[k];
  free(own);
  free(bound);
  free(rank);
  free(numbers);
  return status;
}

/* the same, and those of visitors */
static tdm_status number_all(renewal *r, const uint64_t *code, bool visitors) {
  r->now = malloc((size_t)(r->d->state.nparticle + 1) * sizeof *r->now); /* places of others take no memory */
  if (!r->now)
    return TDM_ERR_MEMORY;
  for (int i = r->first; !code && i < r->end; i++)
    r->now[i] = i;
  if (code && number_home(r, code))
    return TDM_ERR_MEMORY;
  return visitors ? dem_visitors_learn(r->d, r->now) : TDM_OK;
}

/* ---- pairs ---- */

/* New numbers in the entries begin ... end - 1, the lesser first; histories turn round with them. rank: where each
 * goes, -1: nowhere, it is of the dummy particle. */
static void renumber_pairs(const renewal *r, size_t begin, size_t end, int *rank) {
  const dem_columns *columns = &r->d->model->columns;
  const dem_pairs *list = &r->d->lists.pairs;
  for (size_t k = begin; k < end; k++) {
    rank[k - begin] = -1;
    if (list->other[k] >= r->d->state.nparticle)
      continue;
    const int i = r->now[list->one[k]], j = r->now[list->other[k]];
    list->one[k] = i < j ? i : j;
    list->other[k] = i < j ? j : i;
    rank[k - begin] = rank_of(r, list->one[k]);
    for (size_t q = 0; i > j && q < (size_t)columns->ncolumn; q++)
      if (columns->vectors >> q & 1)
        list->history[q * list->capacity + k] *= -1;
  }
}

/* Rows of n entries that came: row[i - begin] is where that of particle i begins, and row[end - begin] = n; entry[k]:
 * which one is in place k. */
static void make_rows(int begin, int end, int n, const int *one, const int *other, int *row, int *entry) {
  const int nrow = end - begin;
  memset(row, 0, (size_t)(nrow + 1) * sizeof *row);
  for (int k = 0; k < n; k++)
    row[one[k] - begin + 1]++;
  for (int i = 0; i < nrow; i++)
    row[i + 1] += row[i];
  for (int k = 0; k < n; k++) /* a row's begin becomes its end */
    entry[row[one[k] - begin]++] = k;
  for (int i = nrow; i > 0; i--)
    row[i] = row[i - 1];
  row[0] = 0;
  for (int i = 0; i < nrow; i++)
    for (int k = row[i] + 1; k < row[i + 1]; k++) { /* partners ascend */
      const int carried = entry[k];
      int at = k;
      for (; at > row[i] && other[entry[at - 1]] > other[carried]; at--)
        entry[at] = entry[at - 1];
      entry[at] = carried;
    }
}

/* Lay out the entries that came, by their rows, as those of home chunks; where each goes. */
static void place_pairs(const renewal *r, dem_transfer *t, const int *one, const int *other, int *entry) {
  dem_data *d = r->d;
  dem_pairs *list = &d->lists.pairs;
  const int begin = r->begin[r->ranks->rank], end = r->begin[r->ranks->rank + 1], n = (int)t->nin;
  int *row = list->first + begin;
  make_rows(begin, end, n, one, other, row, entry);
  for (int c = dem_home_first(d); c < dem_home_end(d); c++)
    list->chunk[c] = (size_t)(row[dem_chunk_start(d, c + 1) - begin] - row[dem_chunk_start(d, c) - begin]);
  dem_lay_out(d, list->chunk);
  const int base = (int)list->chunk[dem_home_first(d)];
  for (int i = 0; i <= end - begin; i++)
    row[i] += base;
  for (int k = 0; k < n; k++)
    t->to[entry[k]] = base + k;
  list->count = list->chunk[d->lists.nchunk]; /* no more than before: without those of the dummy particle */
  list->first[d->state.nparticle] = (int)list->count;
}

static tdm_status move_pairs(const renewal *r) {
  dem_pairs *list = &r->d->lists.pairs;
  const size_t begin = list->chunk[r->chunk], end = list->chunk[r->end_chunk];
  dem_transfer t = {0};
  int *rank = malloc((end - begin + 1) * sizeof *rank), *one = NULL, *other = NULL, *entry = NULL;
  tdm_status status = rank ? TDM_OK : TDM_ERR_MEMORY;
  if (!status) {
    renumber_pairs(r, begin, end, rank);
    status = dem_transfer_open(&t, r->ranks, (int)begin, (int)(end - begin), rank);
  }
  free(rank);
  if (!status) {
    one = malloc((t.nin + 1) * sizeof *one);
    other = malloc((t.nin + 1) * sizeof *other);
    entry = malloc((t.nin + 1) * sizeof *entry);
    status = one && other && entry ? TDM_OK : TDM_ERR_MEMORY;
  }
  if (!status && (dem_transfer_fetch(&t, list->one, sizeof *one, one) ||
                  dem_transfer_fetch(&t, list->other, sizeof *other, other)))
    status = TDM_ERR_MEMORY;
  if (!status)
    place_pairs(r, &t, one, other, entry);
  for (size_t k = 0; !status && k < t.nin; k++) {
    list->one[t.to[k]] = one[k];
    list->other[t.to[k]] = other[k];
  }
  free(one);
  free(other);
  free(entry);
  for (size_t q = 0; !status && q < (size_t)r->d->model->columns.ncolumn; q++)
    status = dem_transfer_move(&t, list->history + q * list->capacity, sizeof *list->history);
  dem_transfer_close(&t);
  return status;
}

/* ---- walls ---- */

/* The entries that came, chunk by chunk, in each in the order of arrival; where each goes. */
static void place_walls(const renewal *r, dem_transfer *t, const dem_wall_entry *came, size_t *next) {
  dem_data *d = r->d;
  dem_wall_contacts *list = &d->lists.walls;
  for (int c = dem_home_first(d); c < dem_home_end(d); c++)
    list->chunk[c] = 0;
  for (size_t k = 0; k < t->nin; k++)
    list->chunk[came[k].particle / DEM_CHUNK]++;
  dem_lay_out(d, list->chunk);
  memcpy(next, list->chunk, (size_t)d->lists.nchunk * sizeof *next);
  for (size_t k = 0; k < t->nin; k++) {
    t->to[k] = (int)next[came[k].particle / DEM_CHUNK]++;
    list->entry[t->to[k]] = came[k];
  }
  list->count = list->chunk[d->lists.nchunk]; /* as many as before */
}

static tdm_status move_walls(const renewal *r) {
  dem_wall_contacts *list = &r->d->lists.walls;
  const size_t begin = list->chunk[r->chunk], end = list->chunk[r->end_chunk];
  dem_transfer t = {0};
  dem_wall_entry *came = NULL;
  int *rank = malloc((end - begin + 1) * sizeof *rank);
  tdm_status status = rank ? TDM_OK : TDM_ERR_MEMORY;
  for (size_t k = begin; !status && k < end; k++) {
    list->entry[k].particle = r->now[list->entry[k].particle];
    rank[k - begin] = rank_of(r, list->entry[k].particle);
  }
  if (!status)
    status = dem_transfer_open(&t, r->ranks, (int)begin, (int)(end - begin), rank);
  free(rank);
  if (!status) {
    came = malloc((t.nin + 1) * sizeof *came);
    status = came ? dem_transfer_fetch(&t, list->entry, sizeof *came, came) : TDM_ERR_MEMORY;
  }
  if (!status)
    place_walls(r, &t, came, r->d->work.chunk_spare);
  free(came);
  for (size_t q = 0; !status && q < (size_t)r->d->model->columns.ncolumn; q++)
    status = dem_transfer_move(&t, list->history + q * list->capacity, sizeof *list->history);
  dem_transfer_close(&t);
  return status;
}

/* ---- particles ---- */

static tdm_status move_particles(const renewal *r) {
  dem_data *d = r->d;
  const int n = r->end - r->first;
  dem_transfer t = {0};
  int *rank = malloc(((size_t)n + 1) * sizeof *rank);
  tdm_status status = rank ? TDM_OK : TDM_ERR_MEMORY;
  for (int k = 0; !status && k < n; k++)
    rank[k] = rank_of(r, r->now[r->first + k]);
  if (!status)
    status = dem_transfer_open(&t, r->ranks, r->first, n, rank);
  free(rank);
  if (!status)
    status = dem_transfer_fetch(&t, r->now, sizeof *r->now, t.to);
#define X(field, each, name) \
  if (!status)               \
    status = dem_transfer_move(&t, d->field, (size_t)(each) * sizeof *d->field);
  DEM_PARTICLE_STATE(X)
#undef X
  if (!status)
    status = dem_transfer_move(&t, d->state.spare_push, sizeof *d->state.spare_push);
  dem_transfer_close(&t);
  return status;
}

/* ---- all ---- */

/* whose home is what, before and after */
static tdm_status begin_renewal(renewal *r, const double *home) {
  dem_data *d = r->d;
  const int size = r->ranks->size;
  r->chunk = dem_home_first(d);
  r->end_chunk = dem_home_end(d);
  r->first = dem_home_first_particle(d);
  r->end = dem_home_end_particle(d);
  r->begin = malloc(((size_t)size + 1) * sizeof *r->begin);
  r->rank_of = malloc((size_t)d->lists.nchunk * sizeof *r->rank_of);
  if (!r->begin || !r->rank_of)
    return TDM_ERR_MEMORY;
  for (int h = 0; h <= size; h++)
    r->begin[h] = dem_chunk_start(d, dem_chunk_of_share(d->lists.nchunk, home[h]));
  for (int h = 0; h < size; h++)
    for (int i = r->begin[h]; i < r->begin[h + 1]; i += DEM_CHUNK)
      r->rank_of[i / DEM_CHUNK] = h;
  return TDM_OK;
}

tdm_status dem_renew_homes(dem_data *d, const uint64_t *code, const double *home) {
  renewal r = {.d = d, .ranks = d->work.homes.ranks};
  const bool carry = d->lists.valid && d->model->columns.ncolumn > 0;
  tdm_status status = begin_renewal(&r, home);
  if (!status)
    status = number_all(&r, code, carry);
  if (!status) {
    memcpy(d->lists.home, home, ((size_t)r.ranks->size + 1) * sizeof *home);
    if ((carry && (move_pairs(&r) || move_walls(&r))) || move_particles(&r))
      status = TDM_ERR_MEMORY;
  }
  if (!status) {
    const int first = dem_home_first_particle(d);
    dem_pages_zero(d->state.push + first, (size_t)(dem_home_end_particle(d) - first) * sizeof *d->state.push);
  }
  free(r.begin);
  free(r.rank_of);
  free(r.now);
  d->work.homes.planned = false;
  d->work.homes.spread = true;
  dem_parted(d, DEM_WHOLE);
  return status;
}
