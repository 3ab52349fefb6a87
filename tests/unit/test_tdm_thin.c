/* Time histories thinned for plots: nothing is left out of short ones, extremes and their order stay in long ones. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/results/thin.h"
#include "tests/test_main.h"

#include <math.h>
#include <stdlib.h>

/* sin 3 t with one spike, a ramp, and now and then not a number */
static void row(int i, double out[3]) {
  out[0] = i == 12345 ? 7 : sin(3e-3 * i);
  out[1] = -0.5 * i;
  out[2] = i % 100 == 7 ? NAN : i;
}

static tdm_thin history(int n) {
  tdm_thin thin;
  ck_assert(tdm_thin_begin(&thin, 3));
  for (int i = 0; i < n; i++) {
    double values[3];
    row(i, values);
    tdm_thin_add(&thin, 1e-3 * i, values);
  }
  return thin;
}

START_TEST(short_histories_are_whole) {
  tdm_thin thin = history(1800);
  ck_assert_int_eq(tdm_thin_rows(&thin), 1800);
  for (int i = 0; i < 1800; i++) {
    double values[3];
    row(i, values);
    ck_assert_double_eq(tdm_thin_time(&thin, i), 1e-3 * i);
    for (int c = 0; c < 2; c++)
      ck_assert_double_eq(tdm_thin_value(&thin, i, c), values[c]);
  }
  tdm_thin_free(&thin);
}
END_TEST

START_TEST(long_histories_keep_their_shape) {
  const int lengths[] = {1801, 3600, 3601, 54321};
  for (int k = 0; k < 4; k++) {
    const int n = lengths[k];
    tdm_thin thin = history(n);
    const int rows = tdm_thin_rows(&thin);
    double most = -INFINITY;
    ck_assert(rows > TDM_THIN_BINS && rows <= 4 * TDM_THIN_BINS);
    for (int i = 0; i < rows; i++) {
      ck_assert(i == 0 || tdm_thin_time(&thin, i) >= tdm_thin_time(&thin, i - 1));
      ck_assert(i == 0 || tdm_thin_value(&thin, i, 1) <= tdm_thin_value(&thin, i - 1, 1)); /* it only falls */
      ck_assert(isfinite(tdm_thin_value(&thin, i, 2)));
      most = fmax(most, tdm_thin_value(&thin, i, 0));
    }
    ck_assert_double_eq(tdm_thin_time(&thin, 0), 0);
    ck_assert_double_eq(tdm_thin_time(&thin, rows - 1), 1e-3 * (n - 1));
    ck_assert_double_eq(tdm_thin_value(&thin, rows - 1, 1), -0.5 * (n - 1));
    ck_assert(n > 12345 ? most == 7 : most <= 1); /* a spike of one row stays */
    tdm_thin_free(&thin);
  }
}
END_TEST

START_TEST(tables_are_for_numbers) {
  tdm_thin thin;
  const double nothing[] = {NAN, 1};
  const int both[] = {1, 0};
  ck_assert(tdm_thin_begin(&thin, 2));
  tdm_thin_add(&thin, 0.5, nothing);
  ck_assert_ptr_null(tdm_thin_table(&thin, both + 1, 1)); /* a column without a number */
  double *table = tdm_thin_table(&thin, both, 2);
  ck_assert_double_eq(table[0], 0.5);
  ck_assert_double_eq(table[1], 1);
  ck_assert(isnan(table[2]));
  free(table);
  tdm_thin_free(&thin);
}
END_TEST

TEST_MAIN("thin", short_histories_are_whole, long_histories_keep_their_shape, tables_are_for_numbers)
