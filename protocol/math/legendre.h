/* Legendre's polynomials over a window: the functions that moments of loads are taken with. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_MATH_LEGENDRE_H
#define TDM_MATH_LEGENDRE_H

/* P_degree(2 s - 1) = sum_p out[p] s^p, p = 0 ... degree (at most 16, whose coefficients are still whole numbers). */
void tdm_legendre_powers(int degree, double *out);

#endif
