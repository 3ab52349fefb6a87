/* The velocities that LIGGGHTS' mesh movers get: step by step they lead along the path, and to its end to rounding. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/foreign/liggghts/motion.h"
#include "tests/test_main.h"

#include <check.h>
#include <math.h>

static const double dt = 1e-4;

static tdm_state some_state(double x, double turn) {
  return (tdm_state){.pose = {{x, 2 * x, 1 - x}, tdm_quat_from_rotvec(tdm_v3(turn, -0.3 * turn, 0.7 * turn))},
                     .twist = {{3 + x, -1, 2 * x}, {1, 2, 3}}};
}

/* What the movers do in step k: a translation, then turns about x, y, z through the centre of mass. */
static void move(tdm_pose *p, const lig_motion *m, double k) {
  for (int i = 0; i < 3; i++)
    p->position = tdm_axpy(dt * pow(k, i), m->c[i], p->position);
  const double *rate = &m->rate.x;
  for (int i = 0; i < 3; i++)
    p->orientation = tdm_quat_turned(
        p->orientation, tdm_v3(i == 0 ? dt * rate[0] : 0, i == 1 ? dt * rate[1] : 0, i == 2 ? dt * rate[2] : 0));
}

static tdm_vec3 on_path(const tdm_state *a, const tdm_state *b, tdm_interpolation way, double s, double window) {
  if (way == TDM_LINEAR)
    return tdm_axpy(s, tdm_sub(b->pose.position, a->pose.position), a->pose.position);
  const double h01 = s * s * (3 - 2 * s), h10 = s * (1 - s) * (1 - s), h11 = s * s * (s - 1);
  tdm_vec3 x = tdm_axpy(h01, tdm_sub(b->pose.position, a->pose.position), a->pose.position);
  x = tdm_axpy(h10 * window, a->twist.velocity, x);
  return tdm_axpy(h11 * window, b->twist.velocity, x);
}

START_TEST(leads_along_the_path) {
  static const int steps[] = {1, 5, 100};
  for (int way = 0; way < 2; way++)
    for (int t = 0; t < 3; t++) {
      const int n = steps[t];
      const tdm_state a = some_state(0, 0.2), b = some_state(0.01, 0.5);
      const lig_motion m = lig_motion_make(a.pose, &a, &b, (tdm_interpolation)way, n, dt);
      tdm_pose p = a.pose;
      ck_assert(m.turns);
      for (int k = 1; k <= n; k++) {
        move(&p, &m, k);
        const tdm_vec3 x = on_path(&a, &b, (tdm_interpolation)way, (double)k / n, n * dt);
        ck_assert_double_lt(tdm_norm(tdm_sub(p.position, x)), 1e-14);
        const tdm_quat q = tdm_quat_slerp(a.pose.orientation, b.pose.orientation, (double)k / n);
        ck_assert_double_lt(tdm_norm(tdm_quat_turn(p.orientation, q)), 1e-13);
      }
    }
}
END_TEST

/* The mesh stands elsewhere than where the window begins: at its end it does not. */
START_TEST(closes_a_gap) {
  const tdm_state a = some_state(0, 0), b = some_state(0.01, 0.1);
  const tdm_pose elsewhere = some_state(1e-3, 0.01).pose;
  const lig_motion m = lig_motion_make(elsewhere, &a, &b, TDM_HERMITE, 7, dt);
  tdm_pose p = elsewhere;
  for (int k = 1; k <= 7; k++)
    move(&p, &m, k);
  ck_assert_double_lt(tdm_norm(tdm_sub(p.position, b.pose.position)), 1e-15);
  ck_assert_double_lt(tdm_norm(tdm_quat_turn(p.orientation, b.pose.orientation)), 1e-14);
}
END_TEST

START_TEST(rests) {
  tdm_state a = some_state(0.5, 1);
  a.twist = (tdm_twist){0};
  const lig_motion m = lig_motion_make(a.pose, &a, &a, TDM_HERMITE, 5, dt);
  ck_assert(!m.turns);
  for (int i = 0; i < 3; i++)
    ck_assert_double_eq(tdm_norm(m.c[i]), 0);
  ck_assert_double_eq(tdm_norm(m.rate), 0);
}
END_TEST

START_TEST(angles_make_the_turn) {
  for (double size = 1e-9; size < 1.5; size *= 10) {
    const tdm_quat q = tdm_quat_from_rotvec(tdm_scale(size, tdm_v3(0.5, -0.6, 0.3)));
    const tdm_vec3 angle = lig_motion_angles(q);
    tdm_quat made = tdm_quat_identity();
    for (int i = 0; i < 3; i++)
      made = tdm_quat_turned(made, tdm_v3(i == 0 ? angle.x : 0, i == 1 ? angle.y : 0, i == 2 ? angle.z : 0));
    ck_assert_double_lt(tdm_norm(tdm_quat_turn(made, q)), 1e-15 + 1e-14 * size);
  }
}
END_TEST

TEST_MAIN("liggghts_motion", leads_along_the_path, closes_a_gap, rests, angles_make_the_turn)
