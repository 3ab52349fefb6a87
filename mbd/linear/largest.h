/* The largest of some numbers. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_LINEAR_LARGEST_H
#define MBD_LINEAR_LARGEST_H

#include <math.h>

/* The largest |x| of x (n); not a number counts as larger than any. */
static inline double mbd_largest(const double *x, int n) {
  double most = 0;
  for (int i = 0; i < n; i++)
    if (!(fabs(x[i]) <= most))
      most = fabs(x[i]);
  return most;
}

#endif
