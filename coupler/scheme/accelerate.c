/* Acceleration of a fixed-point iteration c = H(c) over the windows of a run: see accelerate.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/scheme/accelerate.h"

#include "protocol/math/gsl_errors.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS_MAX = 32 };

/* Share of the largest singular value, of columns scaled to length 1, below which a direction is noise. */
static const double rank_tolerance = 1e-6;

/* A difference that two iterations of a window have shown. */
typedef struct {
  double *residual; /* (size) dR */
  double *value;    /* (size) d(c + R) */
  int age;          /* windows */
} column;

struct cpl_accelerator {
  cpl_accelerator_kind kind;
  int size, reuse;
  bool first;               /* no residual in this window yet */
  double factor;            /* Aitken's */
  double *value, *residual; /* (size) c + R and R of the iteration before */
  int ncolumn;
  column column[COLUMNS_MAX]; /* the newest first */
  double *matrix;             /* (size x COLUMNS_MAX) for least squares */
  double *block;              /* what the pointers above point into */
};

cpl_accelerator *cpl_accelerator_create(cpl_accelerator_kind kind, int size, int reuse) {
  cpl_accelerator *a = calloc(1, sizeof *a);
  size_t n = (size_t)size;
  if (!a)
    return NULL;
  *a = (cpl_accelerator){.kind = kind, .size = size, .reuse = reuse, .first = true, .factor = 1};
  a->block = calloc((2 * (COLUMNS_MAX + 1) + COLUMNS_MAX) * n + 1, sizeof *a->block);
  if (!a->block) {
    free(a);
    return NULL;
  }
  a->value = a->block;
  a->residual = a->block + n;
  for (int i = 0; i < COLUMNS_MAX; i++) {
    a->column[i].residual = a->block + (2 + 2 * (size_t)i) * n;
    a->column[i].value = a->column[i].residual + n;
  }
  a->matrix = a->block + 2 * (COLUMNS_MAX + 1) * n;
  tdm_gsl_return_errors();
  return a;
}

void cpl_accelerator_destroy(cpl_accelerator **accelerator) {
  if (*accelerator)
    free((*accelerator)->block);
  free(*accelerator);
  *accelerator = NULL;
}

void cpl_accelerator_begin(cpl_accelerator *a) {
  a->first = true;
  for (int i = 0; i < a->ncolumn; i++)
    a->column[i].age++;
  while (a->ncolumn > 0 && a->column[a->ncolumn - 1].age > a->reuse)
    a->ncolumn--;
}

static double dot(int n, const double *a, const double *b) {
  double sum = 0;
  for (int i = 0; i < n; i++)
    sum += a[i] * b[i];
  return sum;
}

/* ---- Aitken ----
 *
 *   c_{i+1} = c_i + w_i R_i,   w_i = -w_{i-1} R_{i-1} . (R_i - R_{i-1}) / |R_i - R_{i-1}|^2
 *
 * Irons & Tuck, Int. J. Numer. Methods Eng. 1 (1969) 275-277. A window begins with the factor that the last one ended
 * with, at most 1 in size.
 */
static void aitken(cpl_accelerator *a, const double *c, const double *residual, double *next) {
  if (a->first)
    a->factor = fmax(-1, fmin(a->factor, 1));
  else {
    double along = 0, square = 0;
    for (int i = 0; i < a->size; i++) {
      double change = residual[i] - a->residual[i];
      along += a->residual[i] * change;
      square += change * change;
    }
    if (square > 0)
      a->factor *= -along / square;
  }
  memcpy(a->residual, residual, (size_t)a->size * sizeof *residual);
  for (int i = 0; i < a->size; i++)
    next[i] = c[i] + a->factor * residual[i];
}

/* ---- IQN-ILS ----
 *
 *   V = [dR ...], W = [d(c + R) ...]      differences of successive iterations
 *   alpha = argmin |V alpha + R_i|        least squares
 *   c_{i+1} = c_i + R_i + W alpha
 *
 * Degroote, Bathe & Vierendeels, Comput. Struct. 87 (2009) 793-801. Directions that the columns show only in their
 * noise are left out: singular values of the scaled V.
 */
static void keep_difference(cpl_accelerator *a, const double *c, const double *residual) {
  const int most = a->size < COLUMNS_MAX ? a->size : COLUMNS_MAX;
  int last = a->ncolumn < most ? a->ncolumn++ : most - 1;
  column newest = a->column[last];
  memmove(a->column + 1, a->column, (size_t)last * sizeof *a->column);
  newest.age = 0;
  for (int i = 0; i < a->size; i++) {
    newest.residual[i] = residual[i] - a->residual[i];
    newest.value[i] = c[i] + residual[i] - a->value[i];
  }
  a->column[0] = newest;
  if (!(dot(a->size, newest.residual, newest.residual) > 0)) { /* says nothing */
    memmove(a->column, a->column + 1, (size_t)last * sizeof *a->column);
    a->column[last] = newest;
    a->ncolumn--;
  }
}

/* alpha (ncolumn): smallest |V alpha + residual|; false when GSL finds no singular values. Its matrices lie in
 * memory that is there: nothing is allocated in a window. */
static bool least_squares(cpl_accelerator *a, const double *residual, double *alpha) {
  const size_t m = (size_t)a->size, n = (size_t)a->ncolumn;
  double length[COLUMNS_MAX], right[COLUMNS_MAX * COLUMNS_MAX], values[COLUMNS_MAX], work[COLUMNS_MAX];
  gsl_matrix_view U = gsl_matrix_view_array(a->matrix, m, n), Q = gsl_matrix_view_array(right, n, n);
  gsl_vector_view s = gsl_vector_view_array(values, n), w = gsl_vector_view_array(work, n);
  for (size_t j = 0; j < n; j++) {
    length[j] = sqrt(dot(a->size, a->column[j].residual, a->column[j].residual));
    for (size_t i = 0; i < m; i++)
      gsl_matrix_set(&U.matrix, i, j, a->column[j].residual[i] / length[j]);
  }
  if (gsl_linalg_SV_decomp(&U.matrix, &Q.matrix, &s.vector, &w.vector) != GSL_SUCCESS)
    return false;
  for (size_t j = 0; j < n; j++)
    if (values[j] < rank_tolerance * values[0])
      values[j] = 0;
  gsl_vector_const_view b = gsl_vector_const_view_array(residual, m);
  gsl_vector_view x = gsl_vector_view_array(alpha, n);
  const bool good = gsl_linalg_SV_solve(&U.matrix, &Q.matrix, &s.vector, &b.vector, &x.vector) == GSL_SUCCESS;
  for (size_t j = 0; j < n; j++)
    alpha[j] /= -length[j];
  return good;
}

static void iqn_ils(cpl_accelerator *a, const double *c, const double *residual, double *next) {
  double alpha[COLUMNS_MAX];
  if (!a->first)
    keep_difference(a, c, residual);
  for (int i = 0; i < a->size; i++) {
    a->residual[i] = residual[i];
    a->value[i] = c[i] + residual[i];
    next[i] = a->value[i];
  }
  if (a->ncolumn == 0 || !least_squares(a, residual, alpha))
    return;
  for (int j = 0; j < a->ncolumn; j++)
    for (int i = 0; i < a->size; i++)
      next[i] += alpha[j] * a->column[j].value[i];
}

void cpl_accelerator_step(cpl_accelerator *a, const double *c, const double *residual, double *next) {
  if (a->kind == CPL_AITKEN)
    aitken(a, c, residual, next);
  else
    iqn_ils(a, c, residual, next);
  a->first = false;
}
