/* The length of the next window, and the measure that it follows. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/state/mismatch.h"
#include "tests/test_main.h"

#include <math.h>

static const cpl_auto settings = {.on = true, .tolerance = 1e-3, .absolute = 1e-7, .n_min = 2, .n_max = 400};

START_TEST(windows_grow_and_shrink_within_limits) {
  ck_assert_int_eq(cpl_adapt_next(&settings, 3, 100, 0), 150);
  ck_assert_int_eq(cpl_adapt_next(&settings, 3, 100, 1e-9), 150);
  ck_assert_int_eq(cpl_adapt_next(&settings, 3, 300, 1e-9), 400);
  ck_assert_int_eq(cpl_adapt_next(&settings, 3, 100, 1e9), 20);
  ck_assert_int_eq(cpl_adapt_next(&settings, 3, 100, INFINITY), 20);
  ck_assert_int_eq(cpl_adapt_next(&settings, 3, 4, 1e9), 2);
  ck_assert_int_eq(cpl_adapt_next(&settings, 3, 2, 0.1), 3); /* out of the smallest, too */
}
END_TEST

START_TEST(windows_settle_where_the_mismatch_is_allowed) {
  /* a mismatch of (n / 80)^order times what is allowed: the window that safety leaves of 80 */
  for (int order = 2; order <= 4; order++) {
    long n = 2;
    for (int k = 0; k < 30; k++)
      n = cpl_adapt_next(&settings, order, n, pow((double)n / 80, order));
    ck_assert_int_ge(n, 70);
    ck_assert_int_le(n, 73);
  }
}
END_TEST

START_TEST(states_are_apart_by_lengths) {
  tdm_assigned_body body = {.mass = 2, .inertia = {{{8, 0, 0}, {0, 6, 0}, {0, 0, 10}}}};
  tdm_state a = {.pose.orientation.w = 1}, b = a;
  double out[CPL_APART];
  ck_assert_double_eq_tol(cpl_body_radius(&body), 2, 1e-15);
  body.mass = INFINITY;
  ck_assert_double_eq(cpl_body_radius(&body), 1);
  a.pose.position.y = 3;
  a.pose.orientation = tdm_quat_from_rotvec((tdm_vec3){0, 0, 0.25});
  a.twist.velocity.x = 5;
  b.twist.angular.x = 7;
  cpl_apart(&a, &b, 2, 0.5, out);
  const double expected[CPL_APART] = {0, 3, 0, 0, 0, 0.5, 2.5, 0, 0, -7, 0, 0};
  for (int i = 0; i < CPL_APART; i++)
    ck_assert_double_eq_tol(out[i], expected[i], 1e-14);
  ck_assert_double_eq_tol(cpl_length(CPL_APART, out), sqrt(9 + 0.25 + 6.25 + 49), 1e-12);
}
END_TEST

TEST_MAIN("adapt", windows_grow_and_shrink_within_limits, windows_settle_where_the_mismatch_is_allowed,
          states_are_apart_by_lengths)
