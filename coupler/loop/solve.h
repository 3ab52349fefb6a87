/* What schemes use: one solver over the window under way. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_LOOP_SOLVE_H
#define CPL_LOOP_SOLVE_H

#include "coupler/state/loop.h"

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

#endif
