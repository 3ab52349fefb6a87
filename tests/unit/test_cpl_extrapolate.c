/* Extrapolation of window means: Cramer's rule, exactness for polynomials, the start. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/scheme/extrapolate.h"
#include "tests/test_main.h"

#include <math.h>
#include <stdbool.h>

static tdm_wrench all(double value) {
  return (tdm_wrench){{value, 2 * value, -value}, {value, 0, 3 * value}};
}

/* the polynomial at local time s */
static double value_at(const tdm_wrench *c, int n, double s) {
  double sum = 0;
  for (int j = n - 1; j >= 0; j--)
    sum = sum * s + c[j].force.x;
  return sum;
}

START_TEST(cramer_solves_the_system) {
  const double tau[] = {0, -1, -2.5}, c[] = {3, -2, 0.5};
  double f[3], out[3];
  for (int i = 0; i < 3; i++)
    f[i] = c[0] + c[1] * tau[i] + c[2] * tau[i] * tau[i];
  cpl_cramer(3, tau, f, out);
  for (int j = 0; j < 3; j++)
    ck_assert_double_eq_tol(out[j], c[j], 1e-14);
}
END_TEST

START_TEST(three_means_give_the_paper_s_weights) {
  /* F(t + H) = 3 F(t) - 3 F(t - H) + F(t - 2H), at any absolute time */
  const double starts[] = {0, 100, 1e5};
  for (int k = 0; k < 3; k++) {
    double h = 1e-5, t = starts[k];
    cpl_history history = {0};
    cpl_history_push(&history, t - 2 * h, all(7));
    cpl_history_push(&history, t - h, all(-2));
    cpl_history_push(&history, t, all(5));
    tdm_wrench c[3];
    ck_assert_int_eq(cpl_extrapolate(&history, 3, t, t + h, c), 3);
    double tolerance = 1e-9 + 1e-10 * t / h * 1e-5; /* the times themselves are rounded */
    ck_assert_double_eq_tol(value_at(c, 3, 1), 3 * 5 - 3 * -2 + 7, 1e-5 * (1 + t) * tolerance / 1e-9);
    ck_assert_double_eq_tol(c[0].force.x, 5, 1e-12); /* continuous with the last mean */
    ck_assert_double_eq_tol(c[0].force.y, 10, 1e-12);
    ck_assert_double_eq_tol(c[0].moment.z, 15, 1e-12);
  }
}
END_TEST

START_TEST(the_value_at_the_end_alone) {
  /* means 2, 5, 11, the newest last: 3 x 11 - 3 x 5 + 2 = 20, held, or ramped to from what it was before */
  cpl_history history = {0};
  tdm_wrench c[3], last = all(-4);
  for (int k = 0; k < 3; k++)
    cpl_history_push(&history, 0.1 * k, all((double[]){2, 5, 11}[k]));
  int n = cpl_extrapolate(&history, 3, 0.2, 0.3, c);
  ck_assert_double_eq_tol(cpl_load_at_end(n, c).force.x, 20, 1e-12);
  ck_assert_double_eq_tol(cpl_load_at_end(n, c).moment.z, 60, 1e-12);
  ck_assert_int_eq(cpl_ramp_to_end(n, c, &last), 2);
  ck_assert_double_eq(value_at(c, 2, 0), -4);
  ck_assert_double_eq_tol(value_at(c, 2, 0.5), 8, 1e-12);
  ck_assert_double_eq_tol(value_at(c, 2, 1), 20, 1e-12);
  ck_assert_double_eq_tol(last.force.x, 20, 1e-12); /* where the next window begins */
  ck_assert_double_eq_tol(last.moment.z, 60, 1e-12);
  n = cpl_extrapolate(&history, 3, 0.2, 0.3, c);
  ck_assert_int_eq(cpl_hold_end(n, c), 1);
  ck_assert_double_eq_tol(c[0].force.x, 20, 1e-12);
  ck_assert_double_eq_tol(c[0].force.y, 40, 1e-12);
  /* of a constant it is the constant */
  c[0] = all(7);
  ck_assert_int_eq(cpl_hold_end(1, c), 1);
  ck_assert_double_eq(c[0].force.x, 7);
}
END_TEST

START_TEST(polynomials_are_continued_exactly) {
  /* f = 2 - 3 t + 5 t^2 by the parabola, f = 2 - 3 t by the line, inside a window that is shorter than the others */
  cpl_history history = {0};
  for (double t = 0.1; t < 0.35; t += 0.1)
    cpl_history_push(&history, t, all(2 - 3 * t + 5 * t * t));
  tdm_wrench c[3];
  ck_assert_int_eq(cpl_extrapolate(&history, 3, 0.3, 0.34, c), 3);
  for (double s = 0; s <= 1; s += 0.25) {
    double t = 0.3 + 0.04 * s;
    ck_assert_double_eq_tol(value_at(c, 3, s), 2 - 3 * t + 5 * t * t, 1e-13);
  }
}
END_TEST

START_TEST(the_start_holds_then_goes_linear) {
  cpl_history history = {0};
  tdm_wrench c[3];
  cpl_history_push(&history, 0, all(4));
  ck_assert_int_eq(cpl_extrapolate(&history, 3, 0, 0.1, c), 1);
  ck_assert_double_eq(c[0].force.x, 4);
  cpl_history_push(&history, 0.1, all(6));
  ck_assert_int_eq(cpl_extrapolate(&history, 3, 0.1, 0.2, c), 2);
  ck_assert_double_eq_tol(value_at(c, 2, 1), 8, 1e-14);
  /* hold looks at the last mean alone */
  ck_assert_int_eq(cpl_extrapolate(&history, 1, 0.1, 0.2, c), 1);
  ck_assert_double_eq(c[0].force.x, 6);
}
END_TEST

START_TEST(the_history_keeps_the_last_three) {
  cpl_history history = {0};
  for (int i = 0; i < 10; i++)
    cpl_history_push(&history, i, all(i));
  ck_assert_int_eq(history.n, 3);
  ck_assert_double_eq(history.time[0], 9);
  ck_assert_double_eq(history.time[2], 7);
  ck_assert_double_eq(history.load[1].force.x, 8);
}
END_TEST

TEST_MAIN("extrapolate", cramer_solves_the_system, three_means_give_the_paper_s_weights, the_value_at_the_end_alone,
          polynomials_are_continued_exactly, the_start_holds_then_goes_linear, the_history_keeps_the_last_three)
