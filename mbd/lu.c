#include "mbd/lu.h"

#include <klu.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* above this size most entries are zero, and sparse wins (measured on chains of pendulums) */
enum { DENSE_MAX = 60 };

typedef struct {
  int row, col;
  double value;
} entry;

struct mbd_lu {
  int n;
  bool good; /* factored */
  /* dense */
  double *matrix; /* (n x n) row-major, factored in place; NULL: sparse */
  int *pivot;     /* (n) row that was exchanged with row i */
  /* sparse */
  int nentry, capacity;
  entry *entry;      /* (nentry) as they came */
  bool out_of_room;  /* an entry was lost */
  int *start, *row;  /* columns of the summed matrix: (n + 1), (start[n]) */
  double *value;     /* (start[n]) */
  int *seen, *place; /* (n), (nentry) workspace */
  klu_common common;
  klu_symbolic *symbolic;
  klu_numeric *numeric;
};

mbd_lu *mbd_lu_create(int n) {
  mbd_lu *lu = calloc(1, sizeof *lu);
  if (!lu)
    return NULL;
  size_t size = (size_t)n + 1;
  lu->n = n;
  bool dense = n <= DENSE_MAX;
  if (dense) {
    lu->matrix = calloc(size * size, sizeof *lu->matrix);
    lu->pivot = calloc(size, sizeof *lu->pivot);
  } else {
    klu_defaults(&lu->common);
    lu->start = calloc(size, sizeof *lu->start);
    lu->seen = calloc(size, sizeof *lu->seen);
  }
  if (dense ? !lu->matrix || !lu->pivot : !lu->start || !lu->seen)
    mbd_lu_destroy(&lu);
  return lu;
}

static void free_factors(mbd_lu *lu) {
  if (lu->numeric)
    klu_free_numeric(&lu->numeric, &lu->common);
  if (lu->symbolic)
    klu_free_symbolic(&lu->symbolic, &lu->common);
}

void mbd_lu_destroy(mbd_lu **pointer) {
  mbd_lu *lu = pointer ? *pointer : NULL;
  if (!lu)
    return;
  free_factors(lu);
  free(lu->matrix);
  free(lu->pivot);
  free(lu->entry);
  free(lu->start);
  free(lu->row);
  free(lu->value);
  free(lu->seen);
  free(lu->place);
  free(lu);
  *pointer = NULL;
}

void mbd_lu_clear(mbd_lu *lu) {
  if (lu->matrix)
    memset(lu->matrix, 0, (size_t)lu->n * (size_t)lu->n * sizeof(double));
  lu->nentry = 0;
  lu->out_of_room = false;
}

/* room for `capacity` entries, all arrays alike */
static bool reserve(mbd_lu *lu, int capacity) {
  if (capacity <= lu->capacity)
    return true;
  size_t size = (size_t)capacity;
  entry *e = realloc(lu->entry, size * sizeof *e);
  lu->entry = e ? e : lu->entry;
  int *row = realloc(lu->row, size * sizeof *row);
  lu->row = row ? row : lu->row;
  int *place = realloc(lu->place, size * sizeof *place);
  lu->place = place ? place : lu->place;
  double *value = realloc(lu->value, size * sizeof *value);
  lu->value = value ? value : lu->value;
  if (!e || !row || !place || !value)
    return false;
  lu->capacity = capacity;
  return true;
}

void mbd_lu_add(void *context, int row, int col, double value) {
  mbd_lu *lu = context;
  if (lu->matrix) {
    lu->matrix[row * lu->n + col] += value;
    return;
  }
  if (lu->nentry == lu->capacity && !reserve(lu, 2 * lu->capacity + 1024)) {
    lu->out_of_room = true;
    return;
  }
  lu->entry[lu->nentry++] = (entry){row, col, value};
}

/* ---- dense ---- */

/* with partial pivoting */
static bool factor_dense(mbd_lu *lu) {
  const int n = lu->n;
  double *A = lu->matrix;
  for (int k = 0; k < n; k++) {
    int best = k;
    for (int i = k + 1; i < n; i++)
      if (fabs(A[i * n + k]) > fabs(A[best * n + k]))
        best = i;
    lu->pivot[k] = best;
    if (!(fabs(A[best * n + k]) > 1e-300)) /* singular, or not a number */
      return false;
    for (int j = 0; j < n && best != k; j++) {
      double swap = A[k * n + j];
      A[k * n + j] = A[best * n + j];
      A[best * n + j] = swap;
    }
    double inverse = 1 / A[k * n + k];
    for (int i = k + 1; i < n; i++) {
      double factor = A[i * n + k] *= inverse;
      if (factor != 0)
        for (int j = k + 1; j < n; j++)
          A[i * n + j] -= factor * A[k * n + j];
    }
  }
  return true;
}

static void solve_dense(const mbd_lu *lu, double *x) {
  const int n = lu->n;
  const double *A = lu->matrix;
  for (int i = 0; i < n; i++) {
    double swap = x[lu->pivot[i]];
    x[lu->pivot[i]] = x[i];
    x[i] = swap;
  }
  for (int i = 1; i < n; i++) {
    double sum = x[i];
    for (int j = 0; j < i; j++)
      sum -= A[i * n + j] * x[j];
    x[i] = sum;
  }
  for (int i = n - 1; i >= 0; i--) {
    double sum = x[i];
    for (int j = i + 1; j < n; j++)
      sum -= A[i * n + j] * x[j];
    x[i] = sum / A[i * n + i];
  }
}

/* ---- sparse ---- */

/* Sum the entries into columns: a counting sort by column, then equal rows of a column together. */
static void compress(mbd_lu *lu) {
  const int n = lu->n;
  memset(lu->start, 0, ((size_t)n + 1) * sizeof *lu->start);
  for (int i = 0; i < lu->nentry; i++)
    lu->start[lu->entry[i].col + 1]++;
  for (int j = 0; j < n; j++)
    lu->start[j + 1] += lu->start[j];
  memcpy(lu->seen, lu->start, (size_t)n * sizeof *lu->seen);
  for (int i = 0; i < lu->nentry; i++)
    lu->place[lu->seen[lu->entry[i].col]++] = i;
  for (int i = 0; i < n; i++)
    lu->seen[i] = -1;
  int filled = 0;
  for (int j = 0; j < n; j++) {
    int first = filled;
    for (int k = lu->start[j]; k < lu->start[j + 1]; k++) {
      const entry *e = &lu->entry[lu->place[k]];
      if (lu->seen[e->row] < first) {
        lu->seen[e->row] = filled;
        lu->row[filled] = e->row;
        lu->value[filled++] = 0;
      }
      lu->value[lu->seen[e->row]] += e->value;
    }
    lu->start[j] = first;
  }
  lu->start[n] = filled;
}

static bool factor_sparse(mbd_lu *lu) {
  free_factors(lu);
  lu->symbolic = klu_analyze(lu->n, lu->start, lu->row, &lu->common);
  if (lu->symbolic)
    lu->numeric = klu_factor(lu->start, lu->row, lu->value, lu->symbolic, &lu->common);
  return lu->numeric && lu->common.status == KLU_OK;
}

/* ---- both ---- */

bool mbd_lu_factor(mbd_lu *lu) {
  if (!lu->matrix && !lu->out_of_room)
    compress(lu);
  lu->good = lu->matrix ? factor_dense(lu) : !lu->out_of_room && factor_sparse(lu);
  return lu->good;
}

void mbd_lu_solve(mbd_lu *lu, double *x) {
  if (lu->matrix)
    solve_dense(lu, x);
  else
    klu_solve(lu->symbolic, lu->numeric, lu->n, 1, x, &lu->common);
}

bool mbd_lu_copy(mbd_lu *to, const mbd_lu *from) {
  const size_t n = (size_t)from->n;
  to->good = from->good;
  if (!from->good)
    return true;
  if (from->matrix) {
    memcpy(to->matrix, from->matrix, n * n * sizeof(double));
    memcpy(to->pivot, from->pivot, n * sizeof(int));
    return true;
  }
  const size_t filled = (size_t)from->start[n];
  if (!reserve(to, (int)filled))
    return false;
  memcpy(to->start, from->start, (n + 1) * sizeof(int));
  memcpy(to->row, from->row, filled * sizeof(int));
  memcpy(to->value, from->value, filled * sizeof(double));
  return factor_sparse(to);
}
