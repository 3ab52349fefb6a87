/* What `tandem advise` chooses from limits, and the signs that it reads from time histories. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/choice/choice.h"
#include "coupler/choice/signs.h"
#include "protocol/scene/scene.h"
#include "tests/test_main.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* [L18] Section 4.1, both sides of a coordination number of 4 */
START_TEST(the_step_keeps_all_limits) {
  cpl_limits l = {.time = {[CPL_RAYLEIGH] = 1e-3, [CPL_EIGENFREQUENCY] = 1, [CPL_CONTACT] = 1}, .coordination = 4};
  cpl_step s = cpl_choose_step(&l);
  ck_assert_int_eq(s.by, CPL_RAYLEIGH);
  ck_assert_double_eq_tol(s.exact, 0.4e-3, 1e-18);
  ck_assert_double_eq(s.dt, 4e-4);
  l.coordination = 4.1;
  s = cpl_choose_step(&l);
  ck_assert_double_eq_tol(s.exact, 0.2e-3, 1e-18);
  l.time[CPL_EIGENFREQUENCY] = 2e-4;
  s = cpl_choose_step(&l);
  ck_assert_int_eq(s.by, CPL_EIGENFREQUENCY);
  ck_assert_double_eq_tol(s.exact, 0.8 * 2e-4, 1e-18);
  ck_assert_double_eq(s.dt, 1.5e-4);
  l.time[CPL_CONTACT] = 1.7e-3;
  s = cpl_choose_step(&l);
  ck_assert_int_eq(s.by, CPL_CONTACT);
  ck_assert_double_eq_tol(s.exact, 1.7e-3 / 20, 1e-18);
  ck_assert_double_eq(s.dt, 8e-5);
}
END_TEST

START_TEST(without_particles_nothing_limits_the_step) {
  const cpl_limits l = {.time = {INFINITY, INFINITY, INFINITY}};
  ck_assert_double_eq(cpl_choose_step(&l).dt, 0);
}
END_TEST

START_TEST(steps_are_round) {
  ck_assert_double_eq(cpl_round_down(1e-5), 1e-5);
  ck_assert_double_eq(cpl_round_down(9.99e-5), 9e-5);
  ck_assert_double_eq(cpl_round_down(1.49e-4), 1.2e-4);
  ck_assert_double_eq(cpl_round_down(7.9), 7);
  ck_assert_double_eq(cpl_round_down(340), 300);
}
END_TEST

START_TEST(the_formulation_follows_the_contacts) {
  cpl_facts f = {.coordination = 5};
  ck_assert_int_eq(cpl_choose_formulation(&f), CPL_LOW_ORDER);
  f.flows = true;
  ck_assert_int_eq(cpl_choose_formulation(&f), CPL_ONE_STEP);
  f = (cpl_facts){.coordination = 5, .abrupt = "stop"};
  ck_assert_int_eq(cpl_choose_formulation(&f), CPL_ONE_STEP);
  f = (cpl_facts){.coordination = 3};
  ck_assert_int_eq(cpl_choose_formulation(&f), CPL_ONE_STEP);
}
END_TEST

START_TEST(a_small_step_and_a_heavy_body_begin_with_a_larger_n) {
  cpl_facts f = {.body = 100, .heaviest = 0.5};
  ck_assert_int_eq(cpl_first_n(&f, 1e-4, 1e-4), 5);
  ck_assert_int_eq(cpl_first_n(&f, 2.5e-5, 1e-4), 20);
  ck_assert_int_eq(cpl_first_n(&f, 1e-7, 1e-4), 50);
  ck_assert_int_eq(cpl_first_n(&f, 1e-5, INFINITY), 5);
  f.body = 49; /* less than 100 particles */
  ck_assert_int_eq(cpl_first_n(&f, 2.5e-5, 1e-4), 5);
}
END_TEST

START_TEST(windows_are_long_enough_when_they_cost_a_twentieth) {
  ck_assert_int_eq(cpl_cheap_n(1e-4, 1e-4), 20);
  ck_assert_int_eq(cpl_cheap_n(2e-4, 1e-3), 4);
  ck_assert_int_eq(cpl_cheap_n(0, 1e-3), 1);
  ck_assert_int_eq(cpl_cheap_n(1, 1e-9), 100000);
}
END_TEST

/* The n that the search from 5 on comes to, where those up to `limit` do well. */
static long found_below(double limit, double most) {
  cpl_n_search s = cpl_n_search_from(5, most);
  long n, last = 0;
  for (int tries = 0; (n = cpl_n_search_next(&s)) > 0; tries++) {
    ck_assert_int_lt(tries, 6);
    ck_assert_msg(n != last && n > s.good && (double)n < s.bad && (double)n <= most, "%ld after %ld", n, last);
    cpl_n_search_tell(&s, n, (double)n <= limit);
    last = n;
  }
  return s.good;
}

START_TEST(the_longest_window_is_found_by_bisection) {
  static const double limits[] = {5, 8, 30, 137, 400, 1999};
  for (int k = 0; k < 6; k++) {
    const double found = (double)found_below(limits[k], 2000);
    ck_assert_msg(found <= limits[k] && limits[k] < 1.8 * found, "%g of %g", found, limits[k]);
  }
  ck_assert_int_eq(found_below(INFINITY, 2000), 2000); /* the first try is enough */
  ck_assert_int_eq(found_below(INFINITY, 137), 120);
  ck_assert_int_eq(found_below(4, 2000), 5); /* nothing does better: where it began */
}
END_TEST

/* 395 is more than 1.3 times 300, and rounds down to it: it is not tried again */
START_TEST(no_window_is_tried_twice) {
  cpl_n_search s = cpl_n_search_from(300, 395);
  ck_assert_int_eq(cpl_n_search_next(&s), 0);
  s = cpl_n_search_from(1, 1000);
  ck_assert_int_eq(cpl_n_search_next(&s), 1000);
  cpl_n_search_tell(&s, 1000, false);
  ck_assert_int_eq(cpl_n_search_next(&s), 30); /* the root of 1000 */
  cpl_n_search_tell(&s, 30, false);
  ck_assert_int_eq(cpl_n_search_next(&s), 5);
  cpl_n_search_tell(&s, 5, true);
  ck_assert_int_eq(cpl_n_search_next(&s), 12);
  ck_assert_int_eq(cpl_n_search_next(&(cpl_n_search){.good = 1, .bad = 2, .left = 1}), 0);
  ck_assert_int_eq(cpl_n_search_next(&(cpl_n_search){.good = 5, .bad = 500, .left = 0}), 0);
}
END_TEST

/* half of the way that an acceleration of 8 m/s2 has in a quarter of the time, at the middle: 8 H^2/8 */
START_TEST(the_path_of_a_driven_body_stays_near_the_straight_one) {
  ck_assert_double_eq_tol(cpl_path_n(8, 0.01, 1e-4), 100, 1e-9);
  ck_assert_double_eq_tol(cpl_path_n(8, 0.04, 1e-4), 200, 1e-9);
  ck_assert_double_eq(cpl_path_n(1e9, 0.01, 1e-4), 1);
  ck_assert(isinf(cpl_path_n(0, 0.01, 1e-4)));
}
END_TEST

/* a slow sine of amplitude 2 over blocks that it hardly changes in, and in every block + - + - of size 1 */
START_TEST(an_estimate_counts_beside_that_of_single_steps) {
  ck_assert(cpl_estimate_too_large(0.011, 0, 0.01));
  ck_assert(!cpl_estimate_too_large(0.009, 0, 0.01));
  ck_assert(!cpl_estimate_too_large(0.05, 0.03, 0.01));
  ck_assert(cpl_estimate_too_large(0.07, 0.03, 0.01));
  ck_assert(cpl_estimate_too_large(0.07, NAN, 0.01));
  ck_assert(!cpl_estimate_too_large(NAN, 0, 0.01));
}
END_TEST

START_TEST(variance_above_and_below_a_frequency) {
  enum { N = 40000, WIDTH = 20 };
  double *f = malloc(N * sizeof *f);
  for (int i = 0; i < N; i++)
    f[i] = 7 + 2 * sin(2 * M_PI * i / N) + (i % 2 ? -1 : 1);
  ck_assert_double_eq_tol(cpl_variance_ratio(f, N, WIDTH), 1. / 2, 1e-4); /* 1 against 2^2/2 */
  ck_assert(isnan(cpl_variance_ratio(f, N, 1)));
  ck_assert(isnan(cpl_variance_ratio(f, 3 * WIDTH, WIDTH)));
  for (int i = 0; i < N; i++)
    f[i] = i % 2 ? -1 : 1;
  ck_assert(isnan(cpl_variance_ratio(f, N, WIDTH))); /* nothing below */
  free(f);
}
END_TEST

START_TEST(a_velocity_that_is_the_derivative_has_no_gap) {
  enum { N = 500 };
  const double h = 0.01, w = 2;
  double x[N], v[N];
  for (int i = 0; i < N; i++) {
    x[i] = sin(w * i * h);
    v[i] = w * cos(w * i * h);
  }
  ck_assert_double_lt(cpl_velocity_gap(x, v, N, h), 1e-8);
  for (int i = 0; i < N; i++)
    v[i] *= 1.1;
  ck_assert_double_eq_tol(cpl_velocity_gap(x, v, N, h), 0.1 / 1.1, 1e-3);
  for (int i = 0; i < N; i++)
    v[i] = 0;
  ck_assert(isnan(cpl_velocity_gap(x, v, N, h)));
}
END_TEST

static void expect_text(const char *text, const char *path, const char *value, const char *expected) {
  char *out = tdm_scene_text_with(text, path, value);
  if (expected)
    ck_assert_str_eq(out, expected);
  else
    ck_assert_ptr_null(out);
  free(out);
}

START_TEST(a_value_changes_and_the_rest_of_the_text_stays) {
  const char text[] = "{ \"a\": {\"b\":  \"=x, 2\", \"c\": [1, {\"d\": 2}]},\n  \"e\": {}\n}\n";
  expect_text(text, "a.b", "3", "{ \"a\": {\"b\":  3, \"c\": [1, {\"d\": 2}]},\n  \"e\": {}\n}\n");
  expect_text(text, "a.c[1].d", "3", "{ \"a\": {\"b\":  \"=x, 2\", \"c\": [1, {\"d\": 3}]},\n  \"e\": {}\n}\n");
  expect_text(text, "a.c", "3", "{ \"a\": {\"b\":  \"=x, 2\", \"c\": 3},\n  \"e\": {}\n}\n");
  expect_text(text, "a.f", "3", "{ \"a\": {\"b\":  \"=x, 2\", \"c\": [1, {\"d\": 2}], \"f\": 3},\n  \"e\": {}\n}\n");
  expect_text(text, "e.f.g", "3",
              "{ \"a\": {\"b\":  \"=x, 2\", \"c\": [1, {\"d\": 2}]},\n  \"e\": {\"f\": {\"g\": 3}}\n}\n");
  expect_text("{\n  \"a\": 1\n}", "b", "2", "{\n  \"a\": 1,\n  \"b\": 2\n}");
  expect_text(text, "a.c[7]", "3", NULL);
  expect_text(text, "a.b.f", "3", NULL);
}
END_TEST

TEST_MAIN("advise", the_step_keeps_all_limits, without_particles_nothing_limits_the_step, steps_are_round,
          the_formulation_follows_the_contacts, a_small_step_and_a_heavy_body_begin_with_a_larger_n,
          windows_are_long_enough_when_they_cost_a_twentieth, the_longest_window_is_found_by_bisection,
          no_window_is_tried_twice, the_path_of_a_driven_body_stays_near_the_straight_one,
          an_estimate_counts_beside_that_of_single_steps, variance_above_and_below_a_frequency,
          a_velocity_that_is_the_derivative_has_no_gap, a_value_changes_and_the_rest_of_the_text_stays)
