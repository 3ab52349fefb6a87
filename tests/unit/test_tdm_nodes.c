/* Paths between nodes: ends, derivatives, order. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/wire/nodes.h"
#include "tests/test_main.h"

/* A body on a circle of 0.5 m about z, which tilts as it goes: turns about an axis that moves. */
static tdm_state tilting(double t) {
  const double w = 3, a = 0.4 * sin(2 * t), rate = 0.8 * cos(2 * t);
  tdm_state s;
  s.pose.position = tdm_v3(0.5 * cos(w * t), 0.5 * sin(w * t), 0.1 * t);
  s.twist.velocity = tdm_v3(-0.5 * w * sin(w * t), 0.5 * w * cos(w * t), 0.1);
  tdm_quat about_z = tdm_quat_from_rotvec(tdm_v3(0, 0, w * t));
  s.pose.orientation = tdm_quat_mul(about_z, tdm_quat_from_rotvec(tdm_v3(a, 0, 0)));
  s.twist.angular = tdm_add(tdm_v3(0, 0, w), tdm_quat_rotate(about_z, tdm_v3(rate, 0, 0)));
  return s;
}

/* largest of the differences of positions, orientations, velocities and angular velocities */
static double apart(const tdm_state *a, const tdm_state *b, double of_twist) {
  double way = tdm_norm(tdm_sub(a->pose.position, b->pose.position));
  double turn = tdm_norm(tdm_quat_turn(b->pose.orientation, a->pose.orientation));
  double v = tdm_norm(tdm_sub(a->twist.velocity, b->twist.velocity));
  double w = tdm_norm(tdm_sub(a->twist.angular, b->twist.angular));
  return fmax(fmax(way, turn), of_twist * fmax(v, w));
}

START_TEST(ends_are_exact) {
  tdm_state a = tilting(0.3), b = tilting(0.5), at = tdm_state_between(&a, &b, 0.2, 0);
  ck_assert_double_eq(apart(&at, &a, 1), 0);
  at = tdm_state_between(&a, &b, 0.2, 1);
  ck_assert_double_eq(apart(&at, &b, 1), 0);
  for (int k = 0; k < 2; k++) { /* and come up to */
    at = tdm_state_between(&a, &b, 0.2, k ? 1 - 1e-9 : 1e-9);
    ck_assert_double_lt(apart(&at, k ? &b : &a, 1), 1e-7);
  }
  a.twist = b.twist = (tdm_twist){0}; /* what does not move stays as it is, to the bit */
  b.pose = a.pose;
  at = tdm_state_between(&a, &b, 0.2, 0.37);
  ck_assert_mem_eq(&at.pose, &a.pose, sizeof at.pose);
}
END_TEST

START_TEST(the_twist_is_the_derivative) {
  const double h = 0.3, d = 1e-6;
  for (int turns = 0; turns < 2; turns++) { /* a turn near half a radian, and a tiny one, which has series of its own */
    tdm_state a = tilting(0.2), b = tilting(turns ? 0.2 + 1e-4 : 0.5);
    for (double s = 0.05; s < 1; s += 0.1) {
      tdm_state before = tdm_state_between(&a, &b, h, s - d / h), after = tdm_state_between(&a, &b, h, s + d / h);
      tdm_state at = tdm_state_between(&a, &b, h, s);
      tdm_vec3 v = tdm_scale(0.5 / d, tdm_sub(after.pose.position, before.pose.position));
      tdm_vec3 w = tdm_scale(0.5 / d, tdm_quat_turn(before.pose.orientation, after.pose.orientation));
      ck_assert_double_lt(tdm_norm(tdm_sub(v, at.twist.velocity)), 1e-8);
      ck_assert_double_lt(tdm_norm(tdm_sub(w, at.twist.angular)), 1e-8);
    }
  }
}
END_TEST

/* largest error over 1 s with n nodes */
static double error(int n) {
  double time[64], worst = 0;
  tdm_state state[64], start = tilting(0);
  for (int k = 0; k < n; k++) {
    time[k] = (k + 1.0) / n;
    state[k] = tilting(time[k]);
  }
  tdm_nodes nodes = {n, 1, time, state};
  for (double t = 0.001; t < 1; t += 0.01) {
    tdm_state at = tdm_nodes_at(&nodes, 0, &start, 0, t), exact = tilting(t);
    worst = fmax(worst, apart(&at, &exact, 0));
  }
  return worst;
}

START_TEST(of_fourth_order) {
  double coarse = error(16), fine = error(32);
  ck_assert_double_lt(coarse, 2e-5);
  ck_assert_double_eq_tol(log2(coarse / fine), 4, 0.3);
}
END_TEST

START_TEST(beyond_its_ends) {
  double time[2] = {1, 2};
  tdm_state state[2] = {tilting(1), tilting(2)}, start = tilting(0.5);
  tdm_nodes nodes = {2, 1, time, state};
  tdm_state before = tdm_nodes_at(&nodes, 0, &start, 0.5, 0.4), behind = tdm_nodes_at(&nodes, 0, &start, 0.5, 2.1);
  ck_assert_double_eq(apart(&before, &start, 1), 0);
  ck_assert_double_eq(apart(&behind, &state[1], 1), 0);
  tdm_state middle = tdm_nodes_at(&nodes, 0, &start, 0.5, 1);
  ck_assert_double_eq(apart(&middle, &state[0], 1), 0);
}
END_TEST

TEST_MAIN("nodes", ends_are_exact, the_twist_is_the_derivative, of_fourth_order, beyond_its_ends)
