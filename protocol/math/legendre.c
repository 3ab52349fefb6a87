/* Legendre's polynomials over a window: see legendre.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/math/legendre.h"

/* P_n(2 s - 1) = sum_p (-1)^(n+p) (n over p) (n+p over p) s^p; from one coefficient to the next by their ratio. */
void tdm_legendre_powers(int degree, double *out) {
  double c = degree % 2 ? -1 : 1;
  for (int p = 0; p <= degree; p++) {
    out[p] = c;
    c = -c * (degree - p) * (degree + p + 1) / ((p + 1) * (p + 1));
  }
}
