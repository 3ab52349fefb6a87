/* Extrapolation of window means into the next window: see extrapolate.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/scheme/extrapolate.h"

#include "coupler/loop/solve.h"

#include <assert.h>
#include <string.h>

void cpl_history_push(cpl_history *h, double time, tdm_wrench load) {
  for (int i = CPL_HISTORY_MAX - 1; i > 0; i--) {
    h->time[i] = h->time[i - 1];
    h->load[i] = h->load[i - 1];
  }
  h->time[0] = time;
  h->load[0] = load;
  if (h->n < CPL_HISTORY_MAX)
    h->n++;
}

/* determinant of an n x n matrix, n <= 3 */
static double determinant(int n, double m[3][3]) {
  if (n == 1)
    return m[0][0];
  if (n == 2)
    return m[0][0] * m[1][1] - m[0][1] * m[1][0];
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

void cpl_cramer(int n, const double *tau, const double *f, double *c) {
  assert(n >= 1 && n <= 3);
  double vandermonde[3][3] = {{0}};
  for (int i = 0; i < n; i++) {
    double power = 1;
    for (int j = 0; j < n; j++, power *= tau[i])
      vandermonde[i][j] = power;
  }
  double whole = determinant(n, vandermonde);
  assert(whole != 0);
  for (int j = 0; j < n; j++) {
    double replaced[3][3];
    memcpy(replaced, vandermonde, sizeof replaced);
    for (int i = 0; i < n; i++)
      replaced[i][j] = f[i];
    c[j] = determinant(n, replaced) / whole;
  }
}

int cpl_extrapolate(const cpl_history *h, int n, double t0, double t1, tdm_wrench *out) {
  assert(h->n >= 1);
  if (n > h->n)
    n = h->n;
  /* local time in windows: tau = (t - t0)/(t1 - t0), so that the polynomial is the one in s at once */
  double tau[CPL_HISTORY_MAX];
  for (int i = 0; i < n; i++)
    tau[i] = (h->time[i] - t0) / (t1 - t0);
  for (int component = 0; component < TDM_WRENCH_DOUBLES; component++) {
    double f[CPL_HISTORY_MAX] = {0}, c[CPL_HISTORY_MAX];
    for (int i = 0; i < n; i++)
      f[i] = ((const double *)(const void *)&h->load[i])[component];
    cpl_cramer(n, tau, f, c);
    for (int j = 0; j < n; j++)
      ((double *)(void *)&out[j])[component] = c[j];
  }
  return n;
}

tdm_wrench cpl_load_at_end(int n, const tdm_wrench *c) {
  tdm_wrench sum = c[0];
  for (int j = 1; j < n; j++)
    sum = (tdm_wrench){tdm_add(sum.force, c[j].force), tdm_add(sum.moment, c[j].moment)};
  return sum;
}

int cpl_hold_end(int n, tdm_wrench *c) {
  c[0] = cpl_load_at_end(n, c);
  return 1;
}

int cpl_ramp_to_end(int n, tdm_wrench *c, tdm_wrench *last) {
  const tdm_wrench end = cpl_load_at_end(n, c);
  c[0] = *last;
  c[1] = (tdm_wrench){tdm_sub(end.force, last->force), tdm_sub(end.moment, last->moment)};
  *last = end;
  return 2;
}

size_t cpl_history_memory(int nbody) {
  return (size_t)nbody * sizeof(cpl_history);
}

tdm_status cpl_history_begin(cpl_loop *loop, tdm_error *err) {
  (void)err;
  cpl_history *history = (cpl_history *)(void *)loop->memory;
  for (int i = 0; i < loop->nbody; i++)
    cpl_history_push(&history[i], 0, loop->session->load[i]);
  return TDM_OK;
}

int cpl_history_continue(cpl_loop *loop, int nmean) {
  const cpl_history *history = (const cpl_history *)(const void *)loop->memory;
  int ncoefficient = 1;
  for (int i = 0; i < loop->nbody; i++)
    ncoefficient = cpl_extrapolate(&history[i], nmean, loop->t0, loop->t1, &loop->load[i * TDM_LOAD_MAX]);
  return ncoefficient;
}

tdm_status cpl_mbd_first(cpl_loop *loop, int ncoefficient, tdm_error *err) {
  cpl_history *history = (cpl_history *)(void *)loop->memory;
  if (cpl_solve_mbd(loop, ncoefficient, err) != TDM_OK)
    return err->status;
  if (cpl_solve_dem_along(loop, loop->state_start, loop->state_end, err) != TDM_OK)
    return err->status;
  for (int i = 0; i < loop->nbody; i++)
    cpl_history_push(&history[i], loop->t1, loop->mean[i]);
  return TDM_OK;
}
