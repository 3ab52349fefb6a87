/* How well the best values are determined: tries a little beside them, one parameter at a time. See calibration.h.
 *
 * With the change of all rows by a parameter's place u, J = dr/du (central differences), where r are the weighted
 * differences whose squares add up to that of the misfit, the best place is off by inv(J'J) J' e for errors e of the
 * rows. Their variance is taken to be that of the differences that are left (with N - n degrees of freedom), or that of
 * the mean over the seeds, whichever is larger; rows are taken for independent. Nor is it less than what comes of rows
 * that are off a straight line over the three tries: where a little change makes another run of it, that is scatter (of
 * variance 1/6 of the mean square of the second differences), which moves all rows of a run together.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/calibrate/calibration.h"

#include <gsl/gsl_linalg.h>
#include <stdlib.h>

static const double beside = 0.05; /* of the range */

/* What a row's difference is divided by so that all squares add up to that of the misfit. */
static double weight_of(const cpl_target *t, int ntarget) {
  return 1 / (t->scale * sqrt((double)t->n * ntarget));
}

/* dr/du of parameter k (nrow), from the tries on both sides, or from one and the best; false: both failed. */
static bool derivative(const cpl_calibration *c, int low, int high, int k, double *out) {
  const cpl_try *best = &c->tried[c->best];
  const cpl_try *a = low >= 0 && c->tried[low].row ? &c->tried[low] : best;
  const cpl_try *b = high >= 0 && c->tried[high].row ? &c->tried[high] : best;
  const double way = b->place[k] - a->place[k];
  if (!(way > 0))
    return false;
  for (int j = 0, i = 0; j < c->ntarget; j++)
    for (int row = 0; row < c->target[j].n; row++, i++)
      out[i] = weight_of(&c->target[j], c->ntarget) * (b->row[i] - a->row[i]) / way;
  return true;
}

/* What rows are off a straight line over low, best and high; 0: there is one of both only. */
static double scatter_of(const cpl_calibration *c, int low, int high) {
  if (low < 0 || high < 0 || !c->tried[low].row || !c->tried[high].row)
    return 0;
  const double *a = c->tried[low].row, *b = c->tried[c->best].row, *d = c->tried[high].row;
  double sum = 0;
  for (int j = 0, i = 0; j < c->ntarget; j++)
    for (int row = 0; row < c->target[j].n; row++, i++)
      sum += pow(weight_of(&c->target[j], c->ntarget) * (a[i] - 2 * b[i] + d[i]), 2) / 6;
  return sqrt(sum);
}

/* The variance of row i of target j, weighted; NaN: unknown. */
static double variance_of(const cpl_calibration *c, int j, int first, int row) {
  const cpl_try *best = &c->tried[c->best];
  const cpl_target *t = &c->target[j];
  double left = NAN;
  if (c->nrow > c->nparameter) {
    left = 0;
    for (int i = 0; i < t->n; i++)
      left += pow(best->row[first + i] - t->y[i], 2) / t->n * c->nrow / (c->nrow - c->nparameter);
  }
  return fmax(left, best->variance ? best->variance[first + row] : NAN) * pow(weight_of(t, c->ntarget), 2);
}

/* Standard errors and correlations from J (nparameter x nrow). */
static void take_errors(cpl_calibration *c, const double *J) {
  double store[3][CPL_PARAMETERS * CPL_PARAMETERS] = {{0}};
  const int n = c->nparameter;
  for (int a = 0; a < n; a++)
    for (int b = 0; b < n; b++)
      for (int j = 0, i = 0, first = 0; j < c->ntarget; first += c->target[j++].n)
        for (int row = 0; row < c->target[j].n; row++, i++) {
          const double both = J[a * c->nrow + i] * J[b * c->nrow + i];
          store[0][a * n + b] += both;
          store[1][a * n + b] += both * variance_of(c, j, first, row);
        }
  gsl_matrix_view inverse = gsl_matrix_view_array(store[0], (size_t)n, (size_t)n);
  gsl_matrix_view middle = gsl_matrix_view_array(store[1], (size_t)n, (size_t)n);
  if (gsl_linalg_cholesky_decomp1(&inverse.matrix) != 0 || gsl_linalg_cholesky_invert(&inverse.matrix) != 0)
    return;
  for (int a = 0; a < n; a++)
    for (int b = 0; b < n; b++)
      for (int p = 0; p < n; p++)
        for (int q = 0; q < n; q++)
          store[2][a * n + b] += gsl_matrix_get(&inverse.matrix, (size_t)a, (size_t)p) *
                                 gsl_matrix_get(&middle.matrix, (size_t)p, (size_t)q) *
                                 gsl_matrix_get(&inverse.matrix, (size_t)q, (size_t)b);
  for (int a = 0; a < n; a++) {
    c->parameter[a].error = sqrt(store[2][a * n + a]);
    for (int b = 0; b < n; b++)
      c->correlation[a][b] = store[2][a * n + b] / sqrt(store[2][a * n + a] * store[2][b * n + b]);
  }
}

/* By place so far: to values. */
static void to_values(cpl_parameter *p, double value) {
  const double slope = p->log ? value * log(p->to / p->from) : p->to - p->from;
  p->error = isnan(p->error) ? NAN : slope * fmax(p->error, p->scatter / p->sensitivity);
  p->percent = 0.01 / p->sensitivity * slope;
}

static void take_noise(cpl_calibration *c) {
  const cpl_try *best = &c->tried[c->best];
  double sum = 0;
  for (int j = 0, i = 0; best->variance && j < c->ntarget; j++)
    for (int row = 0; row < c->target[j].n; row++, i++)
      sum += best->variance[i] * pow(weight_of(&c->target[j], c->ntarget), 2);
  c->noise = best->variance ? sqrt(sum) : NAN;
}

tdm_status cpl_determine(cpl_calibration *c, tdm_error *err) {
  double place[2 * CPL_PARAMETERS][CPL_PARAMETERS] = {{0}};
  int side[CPL_PARAMETERS][2], which[2 * CPL_PARAMETERS], n = 0;
  const double *best = c->tried[c->best].place;
  for (int k = 0; k < c->nparameter; k++)
    for (int s = 0; s < 2; s++) {
      const double u = best[k] + (s == 0 ? -beside : beside);
      side[k][s] = u < 0 || u > 1 ? -1 : n;
      for (int i = 0; i < c->nparameter && side[k][s] >= 0; i++)
        place[n][i] = i == k ? u : best[i];
      n += side[k][s] >= 0;
    }
  if (cpl_try_all(c, n, place, true, which, err) != TDM_OK)
    return err->status;
  double *J = calloc((size_t)c->nparameter * (size_t)c->nrow, sizeof *J);
  if (!J)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  bool all = true;
  for (int k = 0; k < c->nparameter; k++) {
    double *row = J + (size_t)k * (size_t)c->nrow, sum = 0;
    const int low = side[k][0] < 0 ? -1 : which[side[k][0]], high = side[k][1] < 0 ? -1 : which[side[k][1]];
    const bool there = derivative(c, low, high, k, row);
    for (int i = 0; i < c->nrow; i++)
      sum += row[i] * row[i];
    c->parameter[k].sensitivity = there ? sqrt(sum) : NAN;
    c->parameter[k].scatter = scatter_of(c, low, high);
    all = all && there && sum > 0;
  }
  if (all)
    take_errors(c, J);
  for (int k = 0; k < c->nparameter; k++)
    to_values(&c->parameter[k], c->tried[c->best].value[k]);
  for (int i = 0; i < n; i++)
    c->better_nearby = c->better_nearby || c->tried[which[i]].misfit < c->tried[c->best].misfit;
  take_noise(c);
  free(J);
  return TDM_OK;
}
