/* Signs in time histories: see signs.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/choice/signs.h"

#include <math.h>

double cpl_velocity_gap(const double *x, const double *v, int n, double h) {
  double mean = 0, square = 0, gap = 0;
  if (n < 5)
    return NAN;
  for (int i = 0; i < n; i++)
    mean += v[i] / n;
  for (int i = 0; i < n; i++)
    square += (v[i] - mean) * (v[i] - mean) / n;
  for (int i = 1; i + 1 < n; i++) {
    const double lacks = (x[i + 1] - x[i - 1]) / (2 * h) - (v[i - 1] + 4 * v[i] + v[i + 1]) / 6;
    gap += lacks * lacks / (n - 2);
  }
  return square > 0 ? sqrt(gap / square) : NAN;
}

double cpl_variance_ratio(const double *load, int n, int width) {
  const int nblock = width < 2 ? 0 : n / width;
  double all = 0, within = 0, between = 0;
  if (nblock < 4)
    return NAN;
  for (int i = 0; i < nblock * width; i++)
    all += load[i] / (nblock * width);
  for (int b = 0; b < nblock; b++) {
    double mean = 0;
    for (int i = 0; i < width; i++)
      mean += load[b * width + i] / width;
    for (int i = 0; i < width; i++)
      within += (load[b * width + i] - mean) * (load[b * width + i] - mean) / (nblock * width);
    between += (mean - all) * (mean - all) / nblock;
  }
  return between > 0 ? within / between : NAN;
}
