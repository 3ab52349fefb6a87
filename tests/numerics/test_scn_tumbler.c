/* The closed form of the tumbler screening machine: against its own differences, against the printed equations where
 * those are consistent, and that the defects of the print are where the errata say; the scenes' mechanism. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/tumbler/machine.h"
#include "tests/test_main.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>

static const scn_tumbler machine = {
    .omega = 7.3, .alpha = 0.31, .beta = -0.47, .eccentricity = 0.04, .u = 0.15, .e = 0.23};
static const double omega_b = 2.9;

static double apart(tdm_mat3 a, tdm_mat3 b) {
  double most = 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      most = fmax(most, fabs(a.m[i][j] - b.m[i][j]));
  return most;
}

static void same(tdm_mat3 a, tdm_mat3 b, double most) {
  ck_assert_msg(apart(a, b) <= most, "%g", apart(a, b));
}

static void near(tdm_vec3 a, tdm_vec3 b, double most) {
  ck_assert_msg(tdm_norm(tdm_sub(a, b)) <= most, "%g", tdm_norm(tdm_sub(a, b)));
}

static scn_tumbler_frame steady(double t, double rate) {
  return scn_tumbler_barrel(&machine, t, rate * t, rate);
}

/* (after - before) / 2h */
static tdm_mat3 slope(tdm_mat3 before, tdm_mat3 after, double h) {
  tdm_mat3 d;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      d.m[i][j] = (after.m[i][j] - before.m[i][j]) / (2 * h);
  return d;
}

START_TEST(test_printed) {
  for (double t = 0; t < 3; t += 0.137) {
    const scn_tumbler_frame plate = scn_tumbler_plate(&machine, t), barrel = steady(t, omega_b), held = steady(t, 0);
    near(plate.r, scn_tumbler_eq_4_1(&machine, t), 4e-15);
    near(plate.v, scn_tumbler_eq_4_11(&machine, t), 1e-14);
    near(barrel.r, plate.r, 0);
    same(barrel.A, scn_tumbler_eq_4_3(&machine, t, omega_b), 4e-15);
    same(plate.A, scn_tumbler_eq_4_4(&machine, t), 4e-15);
    same(held.A, scn_tumbler_eq_4_5(&machine, t), 4e-15);
    same(scn_tumbler_holder(&machine, t).A, scn_tumbler_eq_4_19(&machine, t), 4e-15);
    same(plate.dA, scn_tumbler_eq_4_14(&machine, t), 1e-14);
    same(held.dA, scn_tumbler_eq_4_15(&machine, t), 1e-14);
  }
}
END_TEST

/* of Eq. (4.13) the elements 11, 12 and 22 are wrong, the others are not */
START_TEST(test_misprints) {
  double off[3][3] = {{0}};
  for (double t = 0.1; t < 3; t += 0.137) {
    const tdm_mat3 printed = scn_tumbler_eq_4_13(&machine, t, omega_b), is = steady(t, omega_b).dA;
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        off[i][j] = fmax(off[i][j], fabs(printed.m[i][j] - is.m[i][j]));
  }
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      const bool wrong = (i == 0 && j < 2) || (i == 1 && j == 1);
      ck_assert_msg(wrong ? off[i][j] > 0.1 : off[i][j] < 1e-14, "element %d%d: %g", i + 1, j + 1, off[i][j]);
    }
}
END_TEST

START_TEST(test_differences) {
  const double h = 1e-5;
  for (double t = 0; t < 2; t += 0.0937) {
    const scn_tumbler_frame lo = steady(t - h, omega_b), at = steady(t, omega_b), hi = steady(t + h, omega_b);
    near(at.v, tdm_scale(0.5 / h, tdm_sub(hi.r, lo.r)), 1e-8);
    same(at.dA, slope(lo.A, hi.A, h), 1e-7);
    same(tdm_m3_mat(at.A, tdm_m3_transpose(at.A)), tdm_m3_identity(), 4e-15);
    /* a particle that moves with the barrel, and one that does not */
    const tdm_vec3 place = {0.3, -0.2, 0.5}, velocity = {0.1, 0.7, -0.4};
    const tdm_vec3 carried = tdm_add(at.v, tdm_cross(at.w, tdm_sub(place, at.r)));
    near(scn_tumbler_relative_velocity(&at, place, carried), tdm_v3(0, 0, 0), 1e-14);
    const tdm_vec3 before = scn_tumbler_relative_place(&lo, tdm_axpy(-h, velocity, place)),
                   after = scn_tumbler_relative_place(&hi, tdm_axpy(h, velocity, place));
    near(scn_tumbler_relative_velocity(&at, place, velocity), tdm_scale(0.5 / h, tdm_sub(after, before)), 1e-7);
  }
}
END_TEST

/* the triangle is continuous and has its extremes at multiples of half a period; the oscillating barrel with it */
START_TEST(test_triangle) {
  double psi, rate, before;
  for (int k = 1; k < 9; k++) {
    const double corner = 0.01 * k;
    scn_tumbler_triangle(omega_b, 0.02, corner - 1e-9, &before, &rate);
    ck_assert_double_eq(rate, k % 2 ? omega_b : -omega_b);
    scn_tumbler_triangle(omega_b, 0.02, corner + 1e-9, &psi, &rate);
    ck_assert_double_eq(rate, k % 2 ? -omega_b : omega_b);
    ck_assert(fabs(psi - before) < 1e-14 && fabs(psi - (k % 2 ? 0.01 * omega_b : 0)) < 1e-8);
  }
  const double h = 1e-6, t = 0.0137; /* on the way down */
  scn_tumbler_frame at[3];
  for (int i = 0; i < 3; i++) {
    scn_tumbler_triangle(omega_b, 0.02, t + (i - 1) * h, &psi, &rate);
    at[i] = scn_tumbler_barrel(&machine, t + (i - 1) * h, psi, rate);
  }
  same(at[1].dA, slope(at[0].A, at[2].A, h), 1e-7);
}
END_TEST

/* ---- the mechanism ---- */

#define SET(...) ((const char *const[]){"parameters.alpha_deg=0", "parameters.beta_deg=0", __VA_ARGS__, NULL})

static void open_machine(scn_machine *m, const char *const *set, double window, bool ahead) {
  tdm_error err = {0};
  *m = (scn_machine){0};
  ck_assert_msg(scn_machine_open(m, TANDEM_SOURCE_DIR "/scenarios/tumbler/two_deck.json", set, window, ahead, &err) ==
                    TDM_OK,
                "%s: %s", err.path, err.message);
}

static void step_machine(scn_machine *m) {
  tdm_error err = {0};
  ck_assert_msg(scn_machine_step(m, &err) == TDM_OK, "%s", err.message);
}

/* Joints that old factors of Newton's matrix had left open by 3e-11 rad. The rotor, which turns by a tenth of a radian
 * in a window, bends nobody's path: no nodes. */
START_TEST(test_driven) {
  scn_machine m;
  open_machine(&m, SET("parameters.barrel_mode=1", "parameters.rpm=250"), 2e-3, true);
  ck_assert_int_eq(m.start->freedom, 0);
  while (m.t < 0.1) {
    ck_assert_int_eq(m.path.nnode, 0);
    step_machine(&m);
    const tdm_state should = scn_machine_barrel_state(&m, m.t);
    near(tdm_quat_turn(m.state.pose.orientation, should.pose.orientation), tdm_v3(0, 0, 0), 2e-12);
    near(m.state.pose.position, should.pose.position, 1e-13);
    near(m.state.twist.velocity, should.twist.velocity, 1e-11);
  }
  scn_machine_close(&m);
}
END_TEST

/* IDA goes over the corners, also where one lies at the end of a window and the solution was carried on to just before
 * it: IDA does not start for so short a rest. */
START_TEST(test_corner_at_the_end) {
  scn_machine m;
  open_machine(&m, SET("parameters.barrel_mode=2", "parameters.rpm=50", "mbd.formulation=ggl"), 5e-3, false);
  while (m.t < 0.65)
    step_machine(&m);
  scn_machine_close(&m);
}
END_TEST

/* on its springs the barrel has one freedom and hardly turns */
START_TEST(test_on_springs) {
  scn_machine m;
  open_machine(&m, SET("parameters.barrel_mode=3"), 2e-3, false);
  ck_assert_int_eq(m.start->freedom, 1);
  ck_assert_int_eq(m.start->nwarning, 0);
  while (m.t < 2) {
    step_machine(&m);
    const double turn = scn_machine_channel(&m, "joint.auxiliary_shaft.angle") + m.law.omega * m.t;
    ck_assert_msg(fabs(turn) < 0.05, "%g rad at %g s", turn, m.t);
  }
  scn_machine_close(&m);
}
END_TEST

TEST_MAIN("tumbler", test_printed, test_misprints, test_differences, test_triangle, test_driven, test_corner_at_the_end,
          test_on_springs)
