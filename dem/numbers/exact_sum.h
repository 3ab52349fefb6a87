/* Exact sums of doubles, for balances that must close to the last bit.
 *
 * A sum is kept as numbers that do not overlap, smallest first, whose sum is exact (Shewchuk 1997, grow-expansion). As
 * many are needed as the terms' exponents span; adding what was subtracted before brings it back to nothing. The
 * numbers may be short of bits, so they are compressed when room gets scarce.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_NUMBERS_EXACT_SUM_H
#define DEM_NUMBERS_EXACT_SUM_H

enum { DEM_EXACT_PARTS = 48 }; /* compressed: at most 2098 bits of exponent and mantissa over 53, 40 */

typedef struct {
  int n;
  double part[DEM_EXACT_PARTS];
} dem_exact_sum;

/* high + low = a + b exactly, |a| >= |b| (Dekker) */
static inline double dem_exact_sum_fast(double a, double b, double *low) {
  double high = a + b;
  *low = b - (high - a);
  return high;
}

/* as few numbers as hold the sum (Shewchuk's compress) */
static inline void dem_exact_sum_compress(dem_exact_sum *sum) {
  double low, q = sum->part[sum->n - 1];
  int bottom = sum->n - 1, n = 0;
  for (int i = sum->n - 2; i >= 0; i--) {
    q = dem_exact_sum_fast(q, sum->part[i], &low);
    if (low != 0) {
      sum->part[bottom--] = q;
      q = low;
    }
  }
  sum->part[bottom] = q;
  for (int i = bottom + 1; i < sum->n; i++) {
    q = dem_exact_sum_fast(sum->part[i], q, &low);
    if (low != 0)
      sum->part[n++] = low;
  }
  sum->part[n++] = q;
  sum->n = n;
}

static inline void dem_exact_sum_add(dem_exact_sum *sum, double x) {
  if (sum->n == DEM_EXACT_PARTS)
    dem_exact_sum_compress(sum);
  int n = 0;
  for (int i = 0; i < sum->n; i++) {
    double y = sum->part[i], high = x + y, of_y = high - x; /* two-sum (Knuth) */
    double low = (x - (high - of_y)) + (y - of_y);
    if (low != 0)
      sum->part[n++] = low;
    x = high;
  }
  if (x != 0)
    sum->part[n++] = x;
  sum->n = n;
}

static inline double dem_exact_sum_value(const dem_exact_sum *sum) {
  double x = 0;
  for (int i = 0; i < sum->n; i++)
    x += sum->part[i];
  return x;
}

#endif
