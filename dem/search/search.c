/* The table of searches, and the sorted rows made of the pairs they find: see search.h and method.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/search/search.h"

#include "dem/search/nearby.h"

#include <assert.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#define SEARCHES(X)                 \
  X(cells, "cells")                 \
  X(sweep, "sweep")                 \
  X(linked_linear, "linked-linear") \
  X(grid, "grid")                   \
  X(verlet_1967, "verlet-1967")     \
  X(all, "all")

#define X(symbol, name) name,
const char *const dem_search_names[] = {SEARCHES(X) NULL};
#undef X

#define X(symbol, name) &dem_search_##symbol,
static const dem_search_method *const methods[] = {SEARCHES(X)};
#undef X

struct dem_search {
  const dem_search_method *method;
  void *state;
  double expected;     /* pairs a sphere */
  dem_scratch scratch; /* for callers without */
};

dem_search *dem_search_create(const char *name) {
  int m = 0;
  while (dem_search_names[m] && strcmp(dem_search_names[m], name) != 0)
    m++;
  if (!dem_search_names[m])
    return NULL;
  dem_search *search = calloc(1, sizeof *search);
  void *state = calloc(1, methods[m]->state_size + 1);
  if (!search || !state) {
    free(search);
    free(state);
    return NULL;
  }
  *search = (dem_search){.method = methods[m], .state = state, .expected = 4};
  return search;
}

void dem_search_destroy(dem_search **search) {
  dem_search *s = *search;
  if (!s)
    return;
  if (s->method->release)
    s->method->release(s->state);
  dem_scratch_free(&s->scratch);
  free(s->state);
  free(s);
  *search = NULL;
}

const char *dem_search_name(const dem_search *search) {
  int m = 0;
  while (methods[m] != search->method)
    m++;
  return dem_search_names[m];
}

int dem_search_interval(const dem_search *search) {
  return search->method->interval;
}

bool dem_search_wants_all(const dem_search *search) {
  return search->method->state_size > 0;
}

double dem_search_skin(const dem_search *search, double asked, double largest_radius) {
  double own = search->method->skin_radii * largest_radius;
  return own > 0 ? own : asked;
}

typedef struct {
  const dem_found *found;
  dem_rows *rows;
  int nthread;
} sorting;

/* the part of the rows that is thread t's begins here */
static int row_part(const sorting *s, int t) {
  return s->rows->begin + dem_search_part(s->rows->end - s->rows->begin, t, s->nthread);
}

static inline int lesser(dem_found_pair p) {
  return p.a < p.b ? p.a : p.b;
}

static inline int greater(dem_found_pair p) {
  return p.a < p.b ? p.b : p.a;
}

/* Each thread reads all pairs and takes those whose row is its own: so no two write to one place, and the order in a
 * row is that of the pairs. The length of row i stands where row i + 1 will begin. */
static void count_rows(void *context, int t) {
  const sorting *s = context;
  const int begin = row_part(s, t), end = row_part(s, t + 1);
  int *length = s->rows->first + 1 + (begin - s->rows->begin);
  memset(length, 0, (size_t)(end - begin) * sizeof *length);
  for (int f = 0; f < s->nthread; f++)
    for (size_t k = 0; k < s->found[f].count; k++) {
      int i = lesser(s->found[f].pair[k]);
      if (i >= begin && i < end)
        length[i - begin]++;
    }
}

/* each number is carried past the sorted ones before it: exchanges without a branch, which would be guessed wrong */
static void sort_row(int *row, int n) {
  for (int k = 1; k < n; k++) {
    int carried = row[k];
    for (int at = 0; at < k; at++) {
      int there = row[at];
      row[at] = there < carried ? there : carried;
      carried = there < carried ? carried : there;
    }
    row[k] = carried;
  }
}

static int compare_int(const void *a, const void *b) {
  int x = *(const int *)a, y = *(const int *)b;
  return (x > y) - (x < y);
}

/* at[k] stands at the start of row begin + k before, at its end after; then the rows are sorted */
static void fill_rows(void *context, int t) {
  const sorting *s = context;
  const int begin = row_part(s, t), end = row_part(s, t + 1);
  int *at = s->rows->first + 1 + (begin - s->rows->begin), *other = s->rows->other, start = begin < end ? at[0] : 0;
  for (int f = 0; f < s->nthread; f++)
    for (size_t k = 0; k < s->found[f].count; k++) {
      dem_found_pair p = s->found[f].pair[k];
      int i = lesser(p);
      if (i >= begin && i < end)
        other[at[i - begin]++] = greater(p);
    }
  for (int k = 0; k < end - begin; start = at[k++])
    if (at[k] - start > 32)
      qsort(other + start, (size_t)(at[k] - start), sizeof *other, compare_int);
    else
      sort_row(other + start, at[k] - start);
}

/* counting sort of the pairs by their lesser particle, then each row by itself: rows begin ... end - 1 of the input */
static tdm_status make_rows(const dem_found *found, const dem_search_input *input, dem_rows *rows) {
  const int nthread = input->nthread, n = input->end - input->begin;
  size_t count = 0;
  for (int t = 0; t < nthread; t++) {
    if (found[t].failed)
      return TDM_ERR_MEMORY;
    count += found[t].count;
  }
  rows->begin = input->begin;
  rows->end = input->end;
  rows->first = dem_scratch_take(input->scratch, ((size_t)n + 1) * sizeof *rows->first);
  rows->other = dem_scratch_take(input->scratch, count * sizeof *rows->other);
  if (count > INT_MAX || !rows->first || !rows->other)
    return TDM_ERR_MEMORY;
  sorting s = {found, rows, nthread};
  dem_search_parallel(nthread, count_rows, &s);
  int at = 0;
  rows->first[0] = 0;
  for (int k = 0; k < n; k++) {
    int length = rows->first[k + 1];
    rows->first[k + 1] = at;
    at += length;
  }
  rows->count = (size_t)at;
  dem_search_parallel(nthread, fill_rows, &s);
  return TDM_OK;
}

/* From here on the search is one among the spheres that the wanted rows can name; a search with a state knows spheres
 * by their numbers and gets all. */
static tdm_status choose_spheres(const dem_search *search, dem_search_input *in) {
  if (in->some && !in->number && !dem_search_wants_all(search) && dem_nearby_choose(in))
    return TDM_ERR_MEMORY;
  if (!in->some || in->number) {
    in->end = in->some ? in->end - in->begin : in->n;
    in->begin = 0;
  }
  return TDM_OK;
}

/* the numbers that the particles of the rows have in the whole input */
static void number_rows(dem_rows *rows, const int *number, const dem_search_input *input) {
  if (!number)
    return;
  for (size_t k = 0; k < rows->count; k++)
    rows->other[k] = number[rows->other[k]];
  rows->begin = input->begin;
  rows->end = input->end;
}

/* one list of pairs a thread, empty, with room for its share of what is expected */
static dem_found *make_lists(const dem_search *search, const dem_search_input *input) {
  dem_found *found = dem_scratch_take(input->scratch, (size_t)input->nthread * sizeof *found);
  const double more = input->nthread > 1 ? 1.25 : 1.05; /* threads do not find equally many */
  size_t share = (size_t)(more * search->expected * input->n / input->nthread) + 64;
  for (int t = 0; found && t < input->nthread; t++) {
    dem_found_pair *pair = dem_scratch_take(input->scratch, share * sizeof *pair);
    found[t] = (dem_found){.pair = pair, .capacity = pair ? share : 0};
  }
  return found;
}

tdm_status dem_search_run(dem_search *search, const dem_search_input *input, dem_rows *rows) {
  assert(input->n >= 0 && input->nthread >= 1 && input->skin >= 0);
  dem_search_input in = *input;
  if (!in.scratch) {
    in.scratch = &search->scratch;
    dem_scratch_done(in.scratch);
  }
  if (choose_spheres(search, &in))
    return TDM_ERR_MEMORY;
  in.nthread = dem_search_threads(&in, in.n);
  dem_found *found = make_lists(search, &in);
  if (!found)
    return TDM_ERR_MEMORY;
  dem_scratch_mark mark = dem_scratch_now(in.scratch);
  tdm_status status = search->method->find(search->state, &in, found);
  dem_scratch_back(in.scratch, mark);
  if (!status)
    status = make_rows(found, &in, rows);
  size_t count = 0;
  for (int t = 0; t < in.nthread; t++) {
    count += found[t].count;
    free(found[t].own);
  }
  if (!status && in.n > 0)
    search->expected = (double)count / in.n;
  if (!status)
    number_rows(rows, in.number, input);
  return status;
}

const char *dem_search_choose(const dem_search_input *input) {
  double largest = 0, cubes = 0;
  for (int i = 0; i < input->n; i++) {
    double r = input->sphere[i].radius + input->skin / 2;
    largest = r > largest ? r : largest;
    cubes += r * r * r;
  }
  const double worth = 30; /* measured with bench_search: cells are faster at 25, the grid at 40 */
  return dem_cells_fit(input->n, largest, cubes, worth) ? "cells" : "grid";
}
