/* Aitken and IQN-ILS on fixed-point problems whose solution is known. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/scheme/accelerate.h"
#include "tests/test_main.h"

#include <math.h>
#include <string.h>

enum { SIZE = 5 };

/* H(c) = A c + b, with A of a spectral radius above 1, so that the plain iteration runs away */
static const double A[SIZE][SIZE] = {
    {-6, 1, 0, 0, 2}, {0, 3, 1, 0, 0}, {0.5, 0, -9, 1, 0}, {0, 0.2, 0, 0.4, 1}, {1, 0, 0, 0, 5}};
static const double b[SIZE] = {1, -2, 3, 0.5, -1};

/* R(c) = H(c) - c, scaled by `power` beyond the linear part; its size */
static double residual(const double *c, double bend, double *r) {
  double square = 0;
  for (int i = 0; i < SIZE; i++) {
    r[i] = b[i] - c[i] + bend * c[i] * c[i];
    for (int j = 0; j < SIZE; j++)
      r[i] += A[i][j] * c[j];
    square += r[i] * r[i];
  }
  return sqrt(square);
}

/* evaluations of the residual until it is below the tolerance, at most 50 */
static int iterate(cpl_accelerator *a, double bend, double *c) {
  double r[SIZE];
  cpl_accelerator_begin(a);
  for (int i = 1; i < 50; i++) {
    if (residual(c, bend, r) < 1e-9)
      return i;
    cpl_accelerator_step(a, c, r, c);
  }
  return 50;
}

START_TEST(iqn_ils_is_exact_after_n_differences) {
  cpl_accelerator *a = cpl_accelerator_create(CPL_IQN_ILS, SIZE, 0);
  double c[SIZE] = {0}, r[SIZE];
  /* SIZE differences need SIZE + 1 residuals, the next is zero */
  ck_assert_int_eq(iterate(a, 0, c), SIZE + 2);
  ck_assert_double_lt(residual(c, 0, r), 1e-9);
  /* nothing is kept: the next window learns anew */
  memset(c, 0, sizeof c);
  ck_assert_int_eq(iterate(a, 0, c), SIZE + 2);
  cpl_accelerator_destroy(&a);
  ck_assert_ptr_null(a);
}
END_TEST

START_TEST(iqn_ils_reuses_windows) {
  cpl_accelerator *a = cpl_accelerator_create(CPL_IQN_ILS, SIZE, 2);
  double c[SIZE] = {0};
  ck_assert_int_eq(iterate(a, 0, c), SIZE + 2);
  for (int i = 0; i < 3; i++) { /* what the first has shown serves for two windows; each adds one difference */
    for (int j = 0; j < SIZE; j++)
      c[j] = i + 0.1 * j;
    int most = i < 2 ? 3 : SIZE + 2;
    ck_assert_int_le(iterate(a, 0, c), most);
  }
  cpl_accelerator_destroy(&a);
}
END_TEST

START_TEST(iqn_ils_follows_a_bent_problem) {
  cpl_accelerator *a = cpl_accelerator_create(CPL_IQN_ILS, SIZE, 3);
  double c[SIZE] = {0}, r[SIZE];
  int n = iterate(a, 0.05, c);
  ck_assert_int_le(n, 16);
  ck_assert_double_lt(residual(c, 0.05, r), 1e-9);
  for (int i = 0; i < SIZE; i++)
    c[i] *= 1.01;
  ck_assert_int_le(iterate(a, 0.05, c), n - 4);
  cpl_accelerator_destroy(&a);
}
END_TEST

START_TEST(a_difference_of_nothing_is_left_out) {
  /* the same point twice: no column, no division by zero */
  cpl_accelerator *a = cpl_accelerator_create(CPL_IQN_ILS, 2, 1);
  double c[2] = {1, 2}, r[2] = {0.5, 0}, next[2];
  cpl_accelerator_begin(a);
  cpl_accelerator_step(a, c, r, next);
  cpl_accelerator_step(a, c, r, next);
  ck_assert_double_eq(next[0], 1.5);
  ck_assert_double_eq(next[1], 2);
  cpl_accelerator_destroy(&a);
}
END_TEST

/* c = gain c + 1: residuals until 1e-12 */
static int scalar(cpl_accelerator *a, double gain) {
  double c = 0;
  cpl_accelerator_begin(a);
  for (int i = 1; i < 50; i++) {
    double r = gain * c + 1 - c;
    if (fabs(r) < 1e-12)
      return i;
    cpl_accelerator_step(a, &c, &r, &c);
  }
  return 50;
}

START_TEST(aitken_solves_one_linear_equation) {
  static const double gains[] = {0.5, -0.9, -30, 4};
  for (int i = 0; i < 4; i++) {
    cpl_accelerator *a = cpl_accelerator_create(CPL_AITKEN, 1, 0);
    ck_assert_int_eq(scalar(a, gains[i]), 3); /* two residuals tell the gain */
    ck_assert_int_le(scalar(a, gains[i]), 3); /* the factor of before may serve at once */
    cpl_accelerator_destroy(&a);
  }
}
END_TEST

START_TEST(aitken_converges_where_the_plain_iteration_does_not) {
  /* three components with gains of one sign */
  static const double gain[3] = {-3, -2, -0.5};
  cpl_accelerator *a = cpl_accelerator_create(CPL_AITKEN, 3, 0);
  double c[3] = {0}, r[3], size = 1;
  cpl_accelerator_begin(a);
  for (int k = 0; k < 40 && size > 1e-10; k++) {
    size = 0;
    for (int i = 0; i < 3; i++) {
      r[i] = gain[i] * c[i] + 1 + i - c[i];
      size = fmax(size, fabs(r[i]));
    }
    cpl_accelerator_step(a, c, r, c);
  }
  ck_assert_double_le(size, 1e-10);
  cpl_accelerator_destroy(&a);
}
END_TEST

TEST_MAIN("accelerate", iqn_ils_is_exact_after_n_differences, iqn_ils_reuses_windows, iqn_ils_follows_a_bent_problem,
          a_difference_of_nothing_is_left_out, aitken_solves_one_linear_equation,
          aitken_converges_where_the_plain_iteration_does_not)
