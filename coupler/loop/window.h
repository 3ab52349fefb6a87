/* The coupled loop: windows, the exchange with both solvers, the output grid. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_LOOP_WINDOW_H
#define CPL_LOOP_WINDOW_H

#include "coupler/loop/loop.h"

/* Set up the loop after both solvers are READY, and open what observes it: the rows of cpl_observers. */
tdm_status cpl_loop_init(cpl_loop *loop, const cpl_settings *settings, cpl_session *session, struct cpl_record *record,
                         tdm_error *err);
void cpl_loop_free(cpl_loop *loop);

/* Solve one window by the scheme and tell the observers. */
tdm_status cpl_loop_advance(cpl_loop *loop, tdm_error *err);

/* The run has come to its end in order: tell the observers. */
void cpl_loop_end(cpl_loop *loop);

/* What the scheme and the observers say for summary.json. */
void cpl_loop_enter(const cpl_loop *loop, json_t *summary);

/* ---- what schemes use ---- */

/* MBD over the window under loop->load (its first `ncoefficient` entries a body): sets state_end. */
tdm_status cpl_solve_mbd(cpl_loop *loop, int ncoefficient, tdm_error *err);

/* DEM over the window with a proxy: it carries the mechanism, as MBD left it, through the window itself, and ends
 * beside that by `correction` (nbody x 12, see tdm_proxy; NULL: zeros). Sets mean, dem_end, and load to the polynomial
 * with the moments that DEM found (nload coefficients: the mean alone for one step a window, a line for two and three)
 * and with the further coefficients that end where its proxy did, if both solvers know them.
 */
tdm_status cpl_solve_dem_proxy(cpl_loop *loop, const double *correction, tdm_error *err);

/* DEM over the window along a path (nbody states at t0 and t1): sets mean. */
tdm_status cpl_solve_dem_along(cpl_loop *loop, const tdm_state *start, const tdm_state *end, tdm_error *err);

/* A whole window: MBD on the polynomial through the last nmean (1 to 3) means, DEM on the path from state_start to
 * state_end that comes of it. */
tdm_status cpl_mbd_first(cpl_loop *loop, int nmean, tdm_error *err);

#endif
