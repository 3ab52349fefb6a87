/* Motions with known solutions: free fall, pendulum, double pendulum, free body, heavy top; constraint drift. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/numerics/test_mbd_support.h"
#include "tests/test_main.h"

#define TIGHT "'solver':{'relative_tolerance':1e-10,'absolute_tolerance':1e-11}"

/* a compound pendulum whose reduced length is 1 m: d = 0.9 m, I = 0.09 kg m2 */
#define PENDULUM(solver)                                                                                        \
  "{'gravity':[0,-9.81,0],'bodies':[{'name':'bob','mass':1,'inertia':[0.05,0.05,0.09],'position':[-0.9,0,0]}]," \
  "'joints':[{'name':'pin','type':'revolute','bodies':['ground','bob'],'point':[0,0,0],'axis':[0,0,1]}]," solver "}"

START_TEST(test_free_fall) {
  run r;
  run_open_good(&r,
                "{'bodies':[{'name':'stone','mass':2,'inertia':[1,1,1],'position':[1,2,3],'velocity':[1,0,5],"
                "'angular_velocity':[0,0,2]}]}",
                "stone");
  for (int k = 1; k <= 20; k++)
    run_window(&r, 0.1 * k, NULL, 0, 0, NULL);
  CLOSE(r.state[0].pose.position.x, 1 + 2, 1e-6);
  CLOSE(r.state[0].pose.position.y, 2, 1e-12);
  CLOSE(r.state[0].pose.position.z, 3 + 5 * 2 - 0.5 * 9.81 * 4, 1e-6);
  CLOSE(r.state[0].twist.velocity.z, 5 - 9.81 * 2, 1e-6);
  CLOSE(tdm_quat_to_rotvec(r.state[0].pose.orientation).z, 4 - 2 * M_PI, 1e-6); /* 2 rad/s for 2 s */
  run_close(&r);
}
END_TEST

START_TEST(test_pendulum) {
  run r;
  double row[5];
  run_open_good(&r, PENDULUM(TIGHT), "bob");
  for (int k = 1; k <= 100; k++) {
    run_to(&r, 0.1 * k);
    reference_row("pendulum_A01_exact.csv", 0.1 * k, row, 5);
    CLOSE(r.state[0].pose.position.x, 0.9 * row[1], 3e-8);
    CLOSE(r.state[0].pose.position.y, 0.9 * row[2], 3e-8);
    CLOSE(run_value(&r, "energy.kinetic") + run_value(&r, "energy.potential"), 0, 2e-7);
  }
  run_close(&r);
}
END_TEST

/* default tolerances: the constraints hold to 1e-9 over a long run */
START_TEST(test_drift) {
  run r;
  double worst = 0;
  run_open_good(&r, PENDULUM("'solver':{}"), "bob");
  for (int k = 1; k <= 500; k++) {
    run_to(&r, 0.1 * k);
    worst = fmax(worst, run_value(&r, "constraint.drift"));
  }
  ck_assert_msg(worst > 0 && worst < 1e-9, "drift %g", worst);
  run_close(&r);
}
END_TEST

START_TEST(test_double_pendulum) {
  run r;
  double row[5];
  run_open_good(
      &r,
      "{'gravity':[0,-9.81,0],'bodies':["
      "{'name':'upper','mass':1,'inertia':[1e-4,0.08333333333333333,0.08333333333333333],'position':[0.5,0,0]},"
      "{'name':'lower','mass':1,'inertia':[1e-4,0.08333333333333333,0.08333333333333333],'position':[1.5,0,0]}],"
      "'joints':[{'name':'shoulder','type':'revolute','bodies':['ground','upper'],'point':[0,0,0],'axis':[0,0,1]},"
      "{'name':'elbow','type':'revolute','bodies':['upper','lower'],'point':[1,0,0],'axis':[0,0,1]}]," TIGHT "}",
      "upper lower");
  for (int k = 1; k <= 20; k++)
    run_to(&r, 0.1 * k);
  reference_row("double_pendulum_rods_computed.csv", 2, row, 5);
  /* angles from the vertical: both start at pi/2 */
  double phi1 = tdm_quat_to_rotvec(r.state[0].pose.orientation).z + M_PI / 2;
  double phi2 = tdm_quat_to_rotvec(r.state[1].pose.orientation).z + M_PI / 2;
  CLOSE(phi1, row[1], 1e-7);
  CLOSE(phi2, row[2], 1e-7);
  CLOSE(r.state[0].twist.angular.z, row[3], 1e-6);
  CLOSE(r.state[1].twist.angular.z, row[4], 1e-6);
  run_close(&r);
}
END_TEST

START_TEST(test_free_body) {
  run r;
  double row[8];
  run_open_good(&r,
                "{'gravity':[0,0,0],'bodies':[{'name':'t','mass':1,'inertia':[1,2,3],'position':[0,0,0],"
                "'angular_velocity':[0.006283185307179586,6.283185307179586,0.006283185307179586]}],"
                "'solver':{'relative_tolerance':1e-12}}", /* an unstable axis: errors grow by 1e8 in 5 s */
                "t");
  for (int k = 1; k <= 50; k++)
    run_to(&r, 0.1 * k);
  reference_row("torque_free_asymmetric_computed.csv", 5, row, 8);
  tdm_quat q = r.state[0].pose.orientation;
  tdm_vec3 w = tdm_quat_rotate(tdm_quat_conj(q), r.state[0].twist.angular);
  double sign = q.w * row[4] + q.x * row[5] + q.y * row[6] + q.z * row[7] < 0 ? -1 : 1;
  CLOSE(w.x, row[1], 5e-6);
  CLOSE(w.y, row[2], 5e-6);
  CLOSE(w.z, row[3], 5e-6);
  CLOSE(sign * q.w, row[4], 1e-7);
  CLOSE(sign * q.x, row[5], 1e-7);
  CLOSE(sign * q.y, row[6], 1e-7);
  CLOSE(sign * q.z, row[7], 1e-7);
  CLOSE(run_value(&r, "energy.kinetic"), 39.4784965611926, 1e-7);
  run_close(&r);
}
END_TEST

START_TEST(test_heavy_top) {
  run r;
  double row[7];
  run_open_good(&r,
                "{'bodies':[{'name':'top','mass':15,'inertia':[0.234375,0.46875,0.234375],'position':[0,1,0],"
                "'velocity':[4.61538,0,0],'angular_velocity':[0,150,-4.61538]}],"
                "'joints':[{'name':'tip','type':'spherical','bodies':['ground','top'],'point':[0,0,0]}]," TIGHT "}",
                "top");
  for (int k = 1; k <= 20; k++) {
    run_to(&r, 0.05 * k);
    reference_row("heavy_top_GeradinCardona_computed.csv", 0.05 * k, row, 7);
    CLOSE(r.state[0].pose.position.x, row[1], 1e-6);
    CLOSE(r.state[0].pose.position.y, row[2], 1e-6);
    CLOSE(r.state[0].pose.position.z, row[3], 1e-6);
    CLOSE(r.state[0].twist.velocity.x, row[4], 1e-5);
  }
  run_close(&r);
}
END_TEST

/* the same run twice gives the same bits */
START_TEST(test_repeat) {
  run r[2];
  for (int i = 0; i < 2; i++) {
    run_open_good(&r[i], PENDULUM("'solver':{}"), "bob");
    for (int k = 1; k <= 200; k++) {
      tdm_wrench load[2] = {{{sin(k), 0, 0}, {0, 0, cos(k)}}, {{0.1, 0, 0}, {0, 0, 0}}};
      double at = 0.01 * k;
      run_window(&r[i], at, load, 2, 1, &at);
    }
  }
  ck_assert_int_eq(memcmp(&r[0].state[0], &r[1].state[0], sizeof(tdm_state)), 0);
  ck_assert_int_eq(memcmp(r[0].channel, r[1].channel, (size_t)r[0].ready.nchannel * sizeof(double)), 0);
  run_close(&r[0]);
  run_close(&r[1]);
}
END_TEST

TEST_MAIN("mbd motion", test_free_fall, test_pendulum, test_drift, test_double_pendulum, test_free_body, test_heavy_top,
          test_repeat)
