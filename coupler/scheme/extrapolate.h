/* Extrapolation of window means into the next window ([L18] Eq. 4-12), and the window of schemes that go by it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_SCHEME_EXTRAPOLATE_H
#define CPL_SCHEME_EXTRAPOLATE_H

#include "coupler/state/loop.h"

enum { CPL_HISTORY_MAX = 3 };

/* The last loads of one body with the times they are assigned to; entry 0 is the newest. */
typedef struct {
  int n;
  double time[CPL_HISTORY_MAX]; /* [s] */
  tdm_wrench load[CPL_HISTORY_MAX];
} cpl_history;

void cpl_history_push(cpl_history *history, double time, tdm_wrench load);

/* Solve sum_j c[j] tau_i^j = f_i, i, j < n <= 3, by Cramer's rule with the Vandermonde matrix of [L18] Eq. 6-11. `tau`
 * are distinct and in *local* time: with absolute times the determinants lose all digits. c[0] belongs to tau^0. */
void cpl_cramer(int n, const double *tau, const double *f, double *c);

/* The polynomial through the last `n` loads (fewer if the history is shorter, at least 1 must be there), continued into
 * the window [t0, t1]: coefficients in s = (t - t0)/(t1 - t0), out[0..n-1]. Returns how many were set: 1 (hold),
 * 2 (linear) or 3 (quadratic). */
int cpl_extrapolate(const cpl_history *history, int n, double t0, double t1, tdm_wrench *out);

/* ---- schemes whose memory begins with a history for each body ---- */

/* cpl_scheme.memory: the histories alone [bytes]. */
size_t cpl_history_memory(int nbody);

/* cpl_scheme.open: the first load is DEM's at t = 0. */
tdm_status cpl_history_begin(cpl_loop *loop, tdm_error *err);

/* A whole window: MBD on the polynomial through the last nmean (1 to 3) means, DEM on the path from state_start to
 * state_end that comes of it. */
tdm_status cpl_mbd_first(cpl_loop *loop, int nmean, tdm_error *err);

#endif
