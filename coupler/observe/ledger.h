/* The ledger: what goes through the interface in every window, whatever the scheme, and whether energy appears from
 * nowhere. docs/theory/coupling.md has the equations.
 *
 *   impulse    of the load on a body, m0 H from DEM's kicks (mean H from a DEM solver without "interface")
 *   work       of the load that DEM found along DEM's path of the body, and of the load that MBD felt along MBD's;
 *              the interface residual is what the second has more
 *   blending   work of the load along the closing of drift
 *   exchange   sum of residuals - blending: energy that the exchange has made, of both paths' works and loads that
 *              differ. Dissipation does not hide it. Bodies whose motion is prescribed are left out: no load moves
 *              them, and what the works differ by is the drivers'
 *   drift      between the two end states of a window
 *   balance    G = stored - supplied of both solvers, less what was left out of the exchange, from its first value on:
 *              friction and damping lower it, nothing may raise it
 *   momentum   of bodies that nothing holds: momentum.h
 *
 * ledger.csv has sums since the start, drifts as the largest since the row before, energies as last looked at, all as
 * of the end of the last window that was over at the row's time.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_OBSERVE_LEDGER_H
#define CPL_OBSERVE_LEDGER_H

#include "coupler/state/loop.h"
#include "protocol/wire/nodes.h"

/* Work of W(s) = sum_j load[j] s^j, s = (t - t0)/duration, on a body that goes from start to end: its velocity is that
 * of the cubic Hermite path between the two states, its angular velocity likewise the parabola with the values at both
 * ends whose mean is the turn. In closed form; [J]. */
double cpl_work_along(const tdm_state *start, const tdm_state *end, double duration, const tdm_wrench *load, int nload);

/* The same on a body that goes from `start` at t0 to the last node of a path, through all of its nodes: by quadrature
 * between nodes, exact for positions where nload <= 5 [J]. */
double cpl_work_through(const tdm_nodes *path, int body, const tdm_state *start, double t0, const tdm_wrench *load,
                        int nload);

/* Work of the window's load on a body in MBD, along MBD's path (`through`: with nodes if any were told), in closed
 * form; and in DEM, by its own word, or of the mean load along the path that was asked for [J]. */
double cpl_work_on_mbd(const cpl_loop *loop, const tdm_nodes *through, int body);
double cpl_work_on_dem(const cpl_loop *loop, int body);

#endif
