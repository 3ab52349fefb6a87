/* A square matrix that is filled entry by entry, factored and solved with: see lu.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/linear/lu.h"

#include "mbd/linear/sparse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* above this size most entries are zero, and sparse wins (measured on chains of pendulums) */
enum { DENSE_MAX = 60 };

struct mbd_lu {
  int n;
  bool good;          /* factored */
  double *matrix;     /* (n x n) row-major, factored in place; NULL: sparse */
  int *pivot;         /* (n) row that was exchanged with row i */
  double *factor;     /* (n x n) what is not zero of the factors, row by row, diagonals at the rows' ends */
  int *column;        /* (n x n) its columns */
  int *end;           /* (2n) where row i's part left of the diagonal ends, and where its diagonal stands */
  mbd_sparse *sparse; /* NULL: dense */
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
    lu->factor = calloc(size * size, sizeof *lu->factor);
    lu->column = calloc(size * size, sizeof *lu->column);
    lu->end = calloc(2 * size, sizeof *lu->end);
  } else {
    lu->sparse = mbd_sparse_create(n);
  }
  if (dense ? !lu->matrix || !lu->pivot || !lu->factor || !lu->column || !lu->end : !lu->sparse)
    mbd_lu_destroy(&lu);
  return lu;
}

void mbd_lu_destroy(mbd_lu **pointer) {
  mbd_lu *lu = pointer ? *pointer : NULL;
  if (!lu)
    return;
  mbd_sparse_destroy(&lu->sparse);
  free(lu->matrix);
  free(lu->pivot);
  free(lu->factor);
  free(lu->column);
  free(lu->end);
  free(lu);
  *pointer = NULL;
}

void mbd_lu_clear(mbd_lu *lu) {
  if (lu->matrix) {
    memset(lu->matrix, 0, (size_t)lu->n * (size_t)lu->n * sizeof(double));
    return;
  }
  mbd_sparse_reset(lu->sparse); /* pivots must not depend on what was factored before */
  mbd_sparse_begin(lu->sparse);
}

void mbd_lu_add(void *context, int row, int col, double value) {
  mbd_lu *lu = context;
  if (lu->matrix)
    lu->matrix[row * lu->n + col] += value;
  else
    mbd_sparse_add(lu->sparse, row, col, value);
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

/* Gather what is not zero: mechanisms' factors are mostly zeros, and many solutions follow. */
static void gather(mbd_lu *lu) {
  int k = 0;
  for (int i = 0; i < lu->n; i++) {
    const double *row = lu->matrix + i * lu->n;
    for (int j = 0; j < lu->n; j++) {
      if (j == i)
        lu->end[2 * i] = k;
      else if (row[j] != 0) {
        lu->column[k] = j;
        lu->factor[k++] = row[j];
      }
    }
    lu->end[2 * i + 1] = k;
    lu->factor[k++] = row[i];
  }
}

static void solve_dense(const mbd_lu *lu, double *x) {
  const int n = lu->n;
  for (int i = 0; i < n; i++) {
    double swap = x[lu->pivot[i]];
    x[lu->pivot[i]] = x[i];
    x[i] = swap;
  }
  for (int i = 1; i < n; i++) {
    double sum = x[i];
    for (int k = lu->end[2 * i - 1] + 1; k < lu->end[2 * i]; k++)
      sum -= lu->factor[k] * x[lu->column[k]];
    x[i] = sum;
  }
  for (int i = n - 1; i >= 0; i--) {
    double sum = x[i];
    for (int k = lu->end[2 * i]; k < lu->end[2 * i + 1]; k++)
      sum -= lu->factor[k] * x[lu->column[k]];
    x[i] = sum / lu->factor[lu->end[2 * i + 1]];
  }
}

/* ---- both ---- */

bool mbd_lu_factor(mbd_lu *lu) {
  lu->good = lu->matrix ? factor_dense(lu)
                        : mbd_sparse_end(lu->sparse) != MBD_SPARSE_NO_MEMORY && mbd_sparse_factor(lu->sparse);
  if (lu->good && lu->matrix)
    gather(lu);
  return lu->good;
}

void mbd_lu_solve(mbd_lu *lu, double *x) {
  if (lu->matrix)
    solve_dense(lu, x);
  else
    mbd_sparse_solve(lu->sparse, x);
}

bool mbd_lu_copy(mbd_lu *to, const mbd_lu *from) {
  const size_t n = (size_t)from->n;
  to->good = from->good;
  if (!from->good)
    return true;
  if (from->sparse)
    return mbd_sparse_copy(to->sparse, from->sparse);
  const size_t used = n > 0 ? (size_t)from->end[2 * n - 1] + 1 : 0;
  memcpy(to->factor, from->factor, used * sizeof(double));
  memcpy(to->column, from->column, used * sizeof(int));
  memcpy(to->end, from->end, 2 * n * sizeof(int));
  memcpy(to->pivot, from->pivot, n * sizeof(int));
  return true;
}
