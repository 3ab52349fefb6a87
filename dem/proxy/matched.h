/* The load that ends where the proxy ended: further coefficients of the load polynomial of a window.
 *
 * The multibody solver gets a window's load as m_0 + 3 m_1 P_1 + c_2 P_2 + ..., P_j Legendre's polynomials of
 * x = 2 s - 1. Where the mechanism itself swings within the window (omega H above about 1.3), that parabola leads it
 * elsewhere than the kicks did in the proxy; without damping the difference grows from window to window. The
 * coefficients c_3 ... c_8 take it away. With z = (delta u, delta u'), the linear reduced model (PROTOCOL.md, section
 * 6), its flow E over one step and X the change of z by a unit load's kick, loads W_i with the weights w_i
 * (1/2, 1, ..., 1, 1/2) lead to
 *   z = n <phi, W>,   phi_i = E^(n-i) X,   <a, b> = (1/n) sum_i w_i a_i b_i.
 * p is the polynomial of degree 8 nearest to the load, and what it leaves of the end is made up for by the least load:
 *   <phi, sum_j d_j Q_j> = <phi, W - p> = r,   c = c of p + d,
 *   least sum_j |d_j|^2 / (2 j + 1),   |d|^2 = sum over components Y_ii d_i^2, j = 3 ... 8.
 * Q_j is P_j less what the kicks make 1 and x of it, so that loads on a parabola give zeros, and impulse and first
 * moment stay exact: P_j adds nothing to either. B is that of the window's middle.
 *
 * Even and odd functions are needed in pairs: with P_3, P_4, P_5 alone omega H = 16.4, a zero of the spherical Bessel
 * function j_4(omega H/2), would leave one of the two conditions to nobody.
 *
 * What a polynomial of degree 8 cannot lead is left alone: with N what <phi, phi> has beside 1, x, x^2, and G that of
 * Q_3 ... Q_8, G G^T v = mu N v, directions v with mu below 1/100 (vibrations of more than about ten to a window, or of
 * a few steps each) get nothing. So d is at most ten times what p leaves of the load, for each direction.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_PROXY_MATCHED_H
#define DEM_PROXY_MATCHED_H

#include "protocol/wire/message.h"

typedef struct dem_matched dem_matched;

/* For k coupled bodies. NULL: no memory. */
dem_matched *dem_matched_create(int k);
void dem_matched_destroy(dem_matched **matched);

/* A window of n steps of dt [s] begins. E (2f x 2f, borrowed until the end of the window) is the flow of
 * (delta u, dt delta u') over a step. Where the parabola is good enough (the mechanism hardly swings, no reduced model,
 * fewer than five steps) the window is left out: dem_matched_end gives zeros. Errors: TDM_ERR_MEMORY. */
tdm_status dem_matched_begin(dem_matched *matched, const tdm_mobility *model, uint64_t n, double dt, const double *E);

/* Half a kick by the loads W (6k) on the bodies; the flow over a step. */
void dem_matched_half_kick(dem_matched *matched, const double *W);
void dem_matched_flow(dem_matched *matched);

/* After the last step: c_3 ... c_8 of each body (k x TDM_FURTHER) from the moments in `body` (k). */
void dem_matched_end(dem_matched *matched, const tdm_interface *body, tdm_wrench *further);

/* After dem_matched_end: what the load beside the polynomial of degree 8 made of the rates delta u' (f), before it was
 * made up for. Where it is not small, the mechanism vibrates too fast for the window, whose inside the polynomial gets
 * wrong. NULL: this window was left out. */
const double *dem_matched_rest(const dem_matched *matched);

#endif
