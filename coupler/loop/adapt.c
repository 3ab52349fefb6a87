/* The length of the next window from the mismatch of this one: see adapt.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/loop/adapt.h"

#include <math.h>

/* So that the mismatch, which is rough where particles collide, mostly stays below what is allowed; and so that one
 * quiet window does not make the next one blind. */
static const double safety = 0.9, shrink = 0.2, growth = 1.5;

long cpl_adapt_next(const cpl_auto *s, int order, long n, double excess) {
  double factor = excess > 0 ? safety * pow(excess, -1.0 / order) : growth;
  factor = fmax(shrink, fmin(factor, growth));
  double next = factor > 1 ? ceil(factor * (double)n) : floor(factor * (double)n);
  return (long)fmax((double)s->n_min, fmin(next, (double)s->n_max));
}

long cpl_adapt_longest(const cpl_auto *s, long n) {
  return cpl_adapt_next(s, 1, n, 0);
}
