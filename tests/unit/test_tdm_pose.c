/* Pose mathematics: quaternions, SLERP, 3-1-3 Euler angles. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/math/pose.h"
#include "protocol/math/random.h"
#include "tests/test_main.h"

static const double close_enough = 1e-13;

static double uniform(void) {
  static uint64_t draw;
  return 2 * tdm_random_next(&draw) - 1;
}

static tdm_quat random_quat(void) {
  return tdm_quat_unit((tdm_quat){uniform(), uniform(), uniform(), uniform()});
}

static double matrix_distance(tdm_mat3 a, tdm_mat3 b) {
  double worst = 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      worst = fmax(worst, fabs(a.m[i][j] - b.m[i][j]));
  return worst;
}

static tdm_mat3 rotation_x(double a) {
  return (tdm_mat3){{{1, 0, 0}, {0, cos(a), -sin(a)}, {0, sin(a), cos(a)}}};
}

static tdm_mat3 rotation_z(double a) {
  return (tdm_mat3){{{cos(a), -sin(a), 0}, {sin(a), cos(a), 0}, {0, 0, 1}}};
}

START_TEST(quaternion_matrix_and_back) {
  for (int i = 0; i < 200; i++) {
    tdm_quat q = random_quat();
    tdm_mat3 m = tdm_quat_to_matrix(q);
    ck_assert_double_lt(matrix_distance(tdm_m3_mat(m, tdm_m3_transpose(m)), tdm_m3_identity()), close_enough);
    ck_assert_double_lt(matrix_distance(tdm_quat_to_matrix(tdm_quat_from_matrix(m)), m), close_enough);
    tdm_vec3 v = tdm_v3(uniform(), uniform(), uniform());
    ck_assert_double_lt(tdm_norm(tdm_sub(tdm_quat_rotate(q, v), tdm_m3_mul(m, v))), close_enough);
  }
}
END_TEST

START_TEST(half_turns_survive_the_matrix) {
  const tdm_quat half[] = {{0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}, {0, 0.6, 0.8, 0}, {0, 0, -0.6, 0.8}};
  for (int i = 0; i < 5; i++) {
    tdm_mat3 m = tdm_quat_to_matrix(half[i]);
    ck_assert_double_lt(matrix_distance(tdm_quat_to_matrix(tdm_quat_from_matrix(m)), m), close_enough);
  }
}
END_TEST

START_TEST(product_turns_one_after_the_other) {
  tdm_quat a = random_quat(), b = random_quat();
  tdm_vec3 v = tdm_v3(1, 2, 3);
  tdm_vec3 once = tdm_quat_rotate(tdm_quat_mul(a, b), v), twice = tdm_quat_rotate(a, tdm_quat_rotate(b, v));
  ck_assert_double_lt(tdm_norm(tdm_sub(once, twice)), close_enough * 10);
}
END_TEST

START_TEST(rotation_vector_and_back) {
  const double angles[] = {0, 1e-12, 1e-5, 9e-5, 1.1e-4, 0.3, 2, 3.14159};
  for (int i = 0; i < 8; i++) {
    tdm_vec3 r = tdm_scale(angles[i], tdm_unit(tdm_v3(1, -2, 0.5)));
    tdm_vec3 back = tdm_quat_to_rotvec(tdm_quat_from_rotvec(r));
    ck_assert_double_lt(tdm_norm(tdm_sub(back, r)), close_enough);
  }
}
END_TEST

START_TEST(a_turn_leads_from_one_orientation_to_the_other) {
  for (int i = 0; i < 20; i++) {
    tdm_quat a = random_quat(), b = random_quat();
    tdm_vec3 turn = tdm_quat_turn(a, b), v = tdm_v3(1, 2, 3);
    ck_assert_double_lt(tdm_norm(turn), M_PI + close_enough);
    tdm_vec3 there = tdm_quat_rotate(tdm_quat_turned(a, turn), v), wanted = tdm_quat_rotate(b, v);
    ck_assert_double_lt(tdm_norm(tdm_sub(there, wanted)), close_enough * 10);
  }
  /* in world axes */
  tdm_quat tilted = tdm_quat_from_rotvec(tdm_v3(1, 0, 0));
  tdm_vec3 about_z = tdm_quat_turn(tilted, tdm_quat_turned(tilted, tdm_v3(0, 0, 0.1)));
  ck_assert_double_lt(tdm_norm(tdm_sub(about_z, tdm_v3(0, 0, 0.1))), close_enough);
}
END_TEST

START_TEST(slerp_turns_at_constant_rate) {
  tdm_quat a = random_quat();
  tdm_vec3 axis = tdm_unit(tdm_v3(0.3, -1, 2));
  const double turns[] = {1e-9, 1e-4, 0.5, 2.5, 3.1};
  for (int i = 0; i < 5; i++) {
    tdm_quat b = tdm_quat_mul(tdm_quat_from_rotvec(tdm_scale(turns[i], axis)), a);
    for (double s = 0; s <= 1; s += 0.125) {
      tdm_quat exact = tdm_quat_mul(tdm_quat_from_rotvec(tdm_scale(s * turns[i], axis)), a);
      tdm_quat q = tdm_quat_slerp(a, b, s);
      ck_assert_double_lt(matrix_distance(tdm_quat_to_matrix(q), tdm_quat_to_matrix(exact)), 1e-12);
    }
  }
}
END_TEST

START_TEST(slerp_takes_the_short_way) {
  tdm_quat a = tdm_quat_identity(), b = tdm_quat_from_rotvec(tdm_v3(0, 0, 1));
  tdm_quat opposite = {-b.w, -b.x, -b.y, -b.z};
  tdm_quat p = tdm_quat_slerp(a, b, 0.3), q = tdm_quat_slerp(a, opposite, 0.3);
  ck_assert_double_lt(matrix_distance(tdm_quat_to_matrix(p), tdm_quat_to_matrix(q)), close_enough);
  tdm_quat same = tdm_quat_slerp(a, (tdm_quat){-1, 0, 0, 0}, 0.5);
  ck_assert_double_lt(fabs(fabs(same.w) - 1), close_enough);
}
END_TEST

START_TEST(euler_matrix_is_the_product) {
  /* [L18] Eq. 16 = Rz(phi) Rx(theta) Rz(psi) */
  for (int i = 0; i < 100; i++) {
    tdm_euler313 e = {3 * uniform(), 3 * uniform(), 3 * uniform()};
    tdm_mat3 product = tdm_m3_mat(tdm_m3_mat(rotation_z(e.phi), rotation_x(e.theta)), rotation_z(e.psi));
    ck_assert_double_lt(matrix_distance(tdm_euler313_to_matrix(e), product), close_enough);
    ck_assert_double_lt(matrix_distance(tdm_quat_to_matrix(tdm_euler313_to_quat(e)), product), close_enough);
  }
}
END_TEST

START_TEST(euler_angles_and_back) {
  for (int i = 0; i < 200; i++) {
    tdm_mat3 m = tdm_quat_to_matrix(random_quat());
    tdm_euler313 e = tdm_euler313_from_matrix(m);
    ck_assert(e.theta >= 0 && e.theta <= M_PI && fabs(e.phi) <= M_PI && fabs(e.psi) <= M_PI);
    ck_assert_double_lt(matrix_distance(tdm_euler313_to_matrix(e), m), 1e-12);
  }
  tdm_euler313 e = tdm_euler313_from_matrix(tdm_euler313_to_matrix((tdm_euler313){0.4, 1.1, -2.2}));
  ck_assert_double_eq_tol(e.phi, 0.4, close_enough);
  ck_assert_double_eq_tol(e.theta, 1.1, close_enough);
  ck_assert_double_eq_tol(e.psi, -2.2, close_enough);
}
END_TEST

START_TEST(euler_singular_angles) {
  /* theta = 0: only phi + psi is defined; theta = pi: only phi - psi; psi = 0 is returned */
  tdm_euler313 e = tdm_euler313_from_matrix(tdm_euler313_to_matrix((tdm_euler313){0.4, 0, 0.5}));
  ck_assert_double_eq_tol(e.theta, 0, 1e-12);
  ck_assert_double_eq_tol(e.phi, 0.9, 1e-12);
  ck_assert_double_eq(e.psi, 0);
  e = tdm_euler313_from_quat(tdm_euler313_to_quat((tdm_euler313){0.4, M_PI, 0.5}));
  ck_assert_double_eq_tol(e.theta, M_PI, 1e-12);
  ck_assert_double_eq_tol(e.phi, -0.1, 1e-12);
  ck_assert_double_eq(e.psi, 0);
  e = tdm_euler313_from_matrix(tdm_m3_identity());
  ck_assert_double_eq(e.phi, 0);
  ck_assert_double_eq(e.theta, 0);
  /* close to the singular angle nothing is lost */
  tdm_mat3 near = tdm_euler313_to_matrix((tdm_euler313){0.4, 1e-6, 0.5});
  ck_assert_double_lt(matrix_distance(tdm_euler313_to_matrix(tdm_euler313_from_matrix(near)), near), 1e-12);
}
END_TEST

START_TEST(points_and_their_velocities) {
  tdm_state s = {.pose = {tdm_v3(1, 2, 3), tdm_quat_from_rotvec(tdm_v3(0, 0, M_PI / 2))},
                 .twist = {tdm_v3(0.5, 0, 0), tdm_v3(0, 0, 2)}};
  tdm_vec3 p = tdm_pose_point(s.pose, tdm_v3(1, 0, 0));
  ck_assert_double_lt(tdm_norm(tdm_sub(p, tdm_v3(1, 3, 3))), close_enough);
  tdm_vec3 v = tdm_point_velocity(&s, p);
  ck_assert_double_lt(tdm_norm(tdm_sub(v, tdm_v3(0.5 - 2, 0, 0))), close_enough);
  tdm_vec3 t = tdm_translation(tdm_v3(1, 1, 1), tdm_v3(0, 1, 2)); /* [L18] Eq. 15 */
  ck_assert_double_eq_tol(tdm_degrees(-M_PI / 3), -60, 1e-13);    /* Eq. 16 */
  ck_assert_double_lt(tdm_norm(tdm_sub(t, tdm_v3(1, 0, -1))), close_enough);
}
END_TEST

TEST_MAIN("pose", quaternion_matrix_and_back, half_turns_survive_the_matrix, product_turns_one_after_the_other,
          rotation_vector_and_back, a_turn_leads_from_one_orientation_to_the_other, slerp_turns_at_constant_rate,
          slerp_takes_the_short_way, euler_matrix_is_the_product, euler_angles_and_back, euler_singular_angles,
          points_and_their_velocities)
