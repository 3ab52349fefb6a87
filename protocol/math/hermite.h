/* Hermite's cubic between two values, and the weights of it for vectors. */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_MATH_HERMITE_H
#define TDM_MATH_HERMITE_H

/* At the share s, from 0 to 1, of an interval of length h: the cubic with values f0, f1 and derivatives d0, d1 at its
 * ends. With h = 1 the derivatives are by s. */
static inline double tdm_hermite(double s, double h, double f0, double d0, double f1, double d1) {
  const double r = 1 - s;
  return r * r * (1 + 2 * s) * f0 + s * s * (3 - 2 * s) * f1 + h * s * r * (r * d0 - s * d1);
}

/* What the values and the derivatives at the ends are multiplied with. */
typedef struct {
  double f0, d0, f1, d1;
} tdm_hermite_weights;

/* For the value at the share s of an interval of length h. f0 + f1 = 1, but for rounding: who has the difference of the
 * values needs f1 alone. */
static inline tdm_hermite_weights tdm_hermite_at(double s, double h) {
  const double r = 1 - s;
  return (tdm_hermite_weights){
      .f0 = (1 + 2 * s) * r * r, .d0 = h * s * r * r, .f1 = s * s * (3 - 2 * s), .d1 = -(h * s * s * r)};
}

/* Likewise for the derivative there; f0 = -f1. */
static inline tdm_hermite_weights tdm_hermite_rate_at(double s, double h) {
  const double r = 1 - s, f1 = 6 * s * r / h;
  return (tdm_hermite_weights){.f0 = -f1, .d0 = r * (1 - 3 * s), .f1 = f1, .d1 = s * (3 * s - 2)};
}

#endif
