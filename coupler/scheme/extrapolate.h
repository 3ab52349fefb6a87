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

/* [L18] Eq. 12: what a polynomial of n coefficients in s has come to at the window's end, s = 1. */
tdm_wrench cpl_load_at_end(int n, const tdm_wrench *c);

/* Two simpler loads with the same value at the end, in place of a polynomial's n coefficients: that value, held; or the
 * straight way to it from `last`, which becomes it. Both return their number of coefficients. */
int cpl_hold_end(int n, tdm_wrench *c);
int cpl_ramp_to_end(int n, tdm_wrench *c, tdm_wrench *last);

/* ---- schemes whose memory begins with a history for each body ---- */

/* cpl_scheme.memory: the histories alone [bytes]. */
size_t cpl_history_memory(int nbody);

/* cpl_scheme.open: the first load is DEM's at t = 0. */
tdm_status cpl_history_begin(cpl_loop *loop, tdm_error *err);

/* Set loop->load to the polynomials through the last nmean (1 to 3) means, continued into the window. Returns how many
 * coefficients they have. */
int cpl_history_continue(cpl_loop *loop, int nmean);

/* A whole window: MBD under loop->load (its first `ncoefficient` entries a body), DEM on the path from state_start to
 * state_end that comes of it, whose mean load goes into the history. */
tdm_status cpl_mbd_first(cpl_loop *loop, int ncoefficient, tdm_error *err);

#endif
