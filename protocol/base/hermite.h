/* Hermite's cubic between two values. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_BASE_HERMITE_H
#define TDM_BASE_HERMITE_H

/* At the share s, from 0 to 1, of an interval of length h: the cubic with values f0, f1 and derivatives d0, d1 at its
 * ends. With h = 1 the derivatives are by s. */
static inline double tdm_hermite(double s, double h, double f0, double d0, double f1, double d1) {
  const double r = 1 - s;
  return r * r * (1 + 2 * s) * f0 + s * s * (3 - 2 * s) * f1 + s * r * h * (r * d0 - s * d1);
}

#endif
