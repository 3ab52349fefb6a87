/* The table of searches, and the sorted rows made of the pairs they find: see search.h and method.h. */
#include "dem/search/search.h"

#include "dem/search/method.h"

#include <assert.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#define SEARCHES(X)             \
  X(cells, "cells")             \
  X(sweep, "sweep")             \
  X(grid, "grid")               \
  X(verlet_1967, "verlet-1967") \
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
  dem_found *found; /* (nfound), one a thread */
  int nfound;
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
  *search = (dem_search){.method = methods[m], .state = state};
  return search;
}

void dem_search_destroy(dem_search **search) {
  dem_search *s = *search;
  if (!s)
    return;
  if (s->method->release)
    s->method->release(s->state);
  for (int t = 0; t < s->nfound; t++)
    free(s->found[t].pair);
  free(s->found);
  free(s->state);
  free(s);
  *search = NULL;
}

int dem_search_interval(const dem_search *search) {
  return search->method->interval;
}

double dem_search_skin(const dem_search *search, double asked, double largest_radius) {
  double own = search->method->skin_radii * largest_radius;
  return own > 0 ? own : asked;
}

bool dem_found_grow(dem_found *pairs, size_t more) {
  size_t capacity = (pairs->count + more) + (pairs->count + more) / 4 + 64;
  dem_found_pair *pair = realloc(pairs->pair, capacity * sizeof *pair);
  if (!pair) {
    pairs->failed = true;
    return false;
  }
  pairs->pair = pair;
  pairs->capacity = capacity;
  return true;
}

bool dem_rows_reserve(dem_rows *rows, int n, size_t more) {
  if (rows->first_capacity < (size_t)n + 1) {
    size_t capacity = (size_t)n + (size_t)n / 8 + 1;
    int *first = realloc(rows->first, capacity * sizeof *first);
    if (!first)
      return false;
    rows->first = first;
    rows->first_capacity = capacity;
  }
  if (rows->capacity - rows->count < more || !rows->other) {
    size_t capacity = (rows->count + more) + (rows->count + more) / 8 + 16;
    int *other = realloc(rows->other, capacity * sizeof *other);
    if (!other)
      return false;
    rows->other = other;
    rows->capacity = capacity;
  }
  return true;
}

void dem_rows_free(dem_rows *rows) {
  free(rows->first);
  free(rows->other);
  *rows = (dem_rows){0};
}

void dem_search_parallel(int nthread, void (*work)(void *context, int t), void *context) {
  if (nthread == 1) {
    work(context, 0);
    return;
  }
#ifdef _OPENMP
#pragma omp parallel for num_threads(nthread) schedule(static, 1)
#endif
  for (int t = 0; t < nthread; t++)
    work(context, t);
}

typedef struct {
  const dem_found *found;
  dem_rows *rows;
  int n, nthread;
} sorting;

static inline int lesser(dem_found_pair p) {
  return p.a < p.b ? p.a : p.b;
}

static inline int greater(dem_found_pair p) {
  return p.a < p.b ? p.b : p.a;
}

/* Each thread reads all pairs and takes those whose row is its own: so no two write to one place, and the order in a
 * row is that of the pairs. first[i + 1] = length of row i */
static void count_rows(void *context, int t) {
  const sorting *s = context;
  int begin = dem_part(s->n, t, s->nthread), end = dem_part(s->n, t + 1, s->nthread);
  int *length = s->rows->first + 1;
  memset(length + begin, 0, (size_t)(end - begin) * sizeof *length);
  for (int f = 0; f < s->nthread; f++)
    for (size_t k = 0; k < s->found[f].count; k++) {
      int i = lesser(s->found[f].pair[k]);
      if (i >= begin && i < end)
        length[i]++;
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

/* first[i + 1] stands at the start of row i before, at its end after; then the rows are sorted */
static void fill_rows(void *context, int t) {
  const sorting *s = context;
  int begin = dem_part(s->n, t, s->nthread), end = dem_part(s->n, t + 1, s->nthread);
  int *at = s->rows->first + 1, *other = s->rows->other, start = begin < end ? at[begin] : 0;
  for (int f = 0; f < s->nthread; f++)
    for (size_t k = 0; k < s->found[f].count; k++) {
      dem_found_pair p = s->found[f].pair[k];
      int i = lesser(p);
      if (i >= begin && i < end)
        other[at[i]++] = greater(p);
    }
  for (int i = begin; i < end; start = at[i++])
    if (at[i] - start > 32)
      qsort(other + start, (size_t)(at[i] - start), sizeof *other, compare_int);
    else
      sort_row(other + start, at[i] - start);
}

/* counting sort of the pairs by their lesser particle, then each row by itself */
static bool make_rows(const dem_found *found, int n, int nthread, dem_rows *rows) {
  size_t count = 0;
  for (int t = 0; t < nthread; t++) {
    if (found[t].failed)
      return false;
    count += found[t].count;
  }
  rows->count = 0;
  if (count > INT_MAX || !dem_rows_reserve(rows, n, count))
    return false;
  sorting s = {found, rows, n, nthread};
  dem_search_parallel(nthread, count_rows, &s);
  int at = 0;
  rows->first[0] = 0;
  for (int i = 0; i < n; i++) {
    int length = rows->first[i + 1];
    rows->first[i + 1] = at;
    at += length;
  }
  dem_search_parallel(nthread, fill_rows, &s);
  rows->count = count;
  return true;
}

/* one list of pairs a thread, empty */
static bool prepare_lists(dem_search *search, int nthread) {
  if (search->nfound < nthread) {
    dem_found *found = realloc(search->found, (size_t)nthread * sizeof *found);
    if (!found)
      return false;
    memset(found + search->nfound, 0, (size_t)(nthread - search->nfound) * sizeof *found);
    search->found = found;
    search->nfound = nthread;
  }
  for (int t = 0; t < nthread; t++) {
    search->found[t].count = 0;
    search->found[t].failed = false;
  }
  return true;
}

bool dem_search_run(dem_search *search, const dem_search_input *input, dem_rows *rows) {
  assert(input->n >= 0 && input->nthread >= 1 && input->skin >= 0);
  dem_search_input in = *input;
  in.nthread = dem_search_threads(&in, in.n);
  return prepare_lists(search, in.nthread) && search->method->find(search->state, &in, search->found) &&
         make_rows(search->found, in.n, in.nthread, rows);
}

bool dem_cells_fit(int n, double largest, double cubes) {
  const double worth = 10; /* measured with bench_search */
  return n * largest * largest * largest <= worth * cubes;
}

const char *dem_search_choose(const dem_search_input *input) {
  double largest = 0, cubes = 0;
  for (int i = 0; i < input->n; i++) {
    double r = input->sphere[i].radius + input->skin / 2;
    largest = r > largest ? r : largest;
    cubes += r * r * r;
  }
  return dem_cells_fit(input->n, largest, cubes) ? "cells" : "grid";
}
