/* Reactions, torsional springs over full turns, and the consistent start. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/numerics/test_mbd_support.h"
#include "tests/test_main.h"

START_TEST(test_cantilever) {
  run r;
  run_open_good(&r,
                "{'bodies':[{'name':'arm','mass':3,'inertia':[1,1,1],'position':[2,0.5,1]}],"
                "'joints':[{'name':'wall','type':'fixed','bodies':['ground','arm'],'point':[0,0,1]}]}",
                "arm");
  tdm_wrench load = {{10, -20, 30}, {1, 2, 3}};
  /* at the start without the load, then with it */
  CLOSE(r.ready.initial[run_channel(&r, "joint.wall.fz")], 3 * 9.81, 1e-9);
  CLOSE(r.ready.initial[run_channel(&r, "joint.wall.my")], -2 * 3 * 9.81, 1e-9);
  double at = 0.1;
  run_window(&r, at, &load, 1, 1, &at);
  tdm_vec3 force = {10, -20, 30 - 3 * 9.81}, arm = {2, 0.5, 0};
  tdm_vec3 moment = tdm_add(load.moment, tdm_cross(arm, force));
  CLOSE(run_value(&r, "joint.wall.fx"), -force.x, 1e-9);
  CLOSE(run_value(&r, "joint.wall.fy"), -force.y, 1e-9);
  CLOSE(run_value(&r, "joint.wall.fz"), -force.z, 1e-9);
  CLOSE(run_value(&r, "joint.wall.mx"), -moment.x, 1e-9);
  CLOSE(run_value(&r, "joint.wall.my"), -moment.y, 1e-9);
  CLOSE(run_value(&r, "joint.wall.mz"), -moment.z, 1e-9);
  CLOSE(r.state[0].pose.position.x, 2, 1e-12);
  ck_assert_int_eq((int)json_integer_value(json_object_get(r.ready.report, "degrees_of_freedom")), 0);
  run_close(&r);
}
END_TEST

/* a swinging pendulum: R = m (a - g) with a = alpha x r - w^2 r, in both orders of the bodies */
START_TEST(test_pendulum_reaction) {
  for (int order = 0; order < 2; order++) {
    run r;
    char scene[512];
    snprintf(scene, sizeof scene,
             "{'bodies':[{'name':'bob','mass':2,'inertia':[0.3,0.3,0.4],'position':[0.7,0,0]}],"
             "'joints':[{'name':'pin','type':'revolute','bodies':[%s],'point':[0,0,0],'axis':[0,1,0]}]}",
             order ? "'bob','ground'" : "'ground','bob'");
    run_open_good(&r, scene, "bob");
    const double m = 2, d = 0.7, I = 0.3 + m * d * d, sign = order ? -1 : 1;
    for (int i = 1; i <= 10; i++) {
      run_to(&r, 0.1 * i);
      tdm_vec3 p = r.state[0].pose.position, w = r.state[0].twist.angular;
      double alpha = m * 9.81 * p.x / I; /* about y */
      double ax = alpha * p.z - w.y * w.y * p.x, az = -alpha * p.x - w.y * w.y * p.z;
      CLOSE(run_value(&r, "joint.pin.fx"), sign * m * ax, 1e-7);
      CLOSE(run_value(&r, "joint.pin.fz"), sign * m * (az + 9.81), 1e-7);
      CLOSE(run_value(&r, "joint.pin.fy"), 0, 1e-9);
      CLOSE(run_value(&r, "joint.pin.my"), 0, 1e-9); /* free about its axis */
    }
    run_close(&r);
  }
}
END_TEST

/* amplitude 20 rad, more than three turns each way, with an offset axis */
START_TEST(test_torsional_turns) {
  run r;
  const double I = 2, k = 8, A = 20, w = sqrt(k / I);
  run_open_good(
      &r,
      "{'gravity':[0,0,0],'bodies':[{'name':'wheel','mass':5,'inertia':[1.5,1.5,2],'position':[1,0,0],"
      "'angular_velocity':[0,0,40]}],"
      "'joints':[{'name':'axle','type':'revolute','bodies':['ground','wheel'],'point':[1,0,3],'axis':[0,0,1]}],"
      "'forces':[{'name':'coil','type':'torsional_spring_damper','joint':'axle','stiffness':8}]}",
      "wheel");
  for (int i = 1; i <= 60; i++) {
    run_to(&r, 0.1 * i);
    double angle = A * sin(w * 0.1 * i);
    CLOSE(run_value(&r, "force.coil.angle"), angle, 2e-5);
    CLOSE(run_value(&r, "force.coil.value"), k * angle, 2e-4);
    CLOSE(run_value(&r, "energy.kinetic") + run_value(&r, "energy.springs"), 0.5 * k * A * A, 2e-3);
  }
  run_close(&r);
}
END_TEST

/* preload, free angle and damping: rests where k (theta - free) + preload = load */
START_TEST(test_torsional_rest) {
  run r;
  run_open_good(
      &r,
      "{'gravity':[0,0,0],'bodies':[{'name':'wheel','mass':5,'inertia':[1,1,1],'position':[0,0,0]}],"
      "'joints':[{'name':'axle','type':'revolute','bodies':['ground','wheel'],'point':[0,0,0],'axis':[1,0,0]}],"
      "'forces':[{'name':'coil','type':'torsional_spring_damper','bodies':['ground','wheel'],'axis':[1,0,0],"
      "'stiffness':10,'damping':6,'preload':4,'free_angle':0.3}]}",
      "wheel");
  tdm_wrench load = {{0, 0, 0}, {9, 0, 0}};
  double at = 30;
  run_window(&r, at, &load, 1, 1, &at);
  CLOSE(run_value(&r, "force.coil.angle"), 0.3 + (9.0 - 4) / 10, 1e-7);
  CLOSE(run_value(&r, "force.coil.value"), 9, 1e-6);
  run_close(&r);
}
END_TEST

/* a slider whose given point is 0.1 m off its line and whose given velocities leave it */
START_TEST(test_inconsistent_start) {
  run r;
  run_open_good(&r,
                "{'bodies':[{'name':'s','mass':2,'inertia':[1,1,1],'position':[0,0,0],'velocity':[1,2,3],"
                "'angular_velocity':[0,0.5,0]}],"
                "'joints':[{'name':'rail','type':'prismatic','bodies':['ground','s'],'points':[[0,0.1,0],[0,0,0]],"
                "'axes':[[0,0,1],[0,0.1,1]]}]}",
                "s");
  tdm_state s = r.ready.body[0].state;
  ck_assert_int_eq(r.ready.nwarning, 2);
  ck_assert_str_eq(r.ready.warning[0].path, "mbd.bodies[0].position");
  ck_assert_str_eq(r.ready.warning[1].path, "mbd.bodies[0].velocity");
  CLOSE(s.pose.position.y, 0.1, 1e-12);
  CLOSE(s.pose.position.z, 0, 1e-12); /* free along the rail: stays */
  CLOSE(tdm_quat_to_rotvec(s.pose.orientation).x, atan(0.1), 1e-12);
  CLOSE(tdm_norm(s.twist.angular), 0, 1e-12);
  CLOSE(s.twist.velocity.x, 0, 1e-12);
  CLOSE(s.twist.velocity.y, 0, 1e-12);
  CLOSE(s.twist.velocity.z, 3, 1e-12);
  run_to(&r, 0.01);
  CLOSE(r.state[0].twist.velocity.z, 3 - 0.0981, 1e-7);
  run_close(&r);
}
END_TEST

/* a chain bent at the start, its end 0.2 m from where it belongs: Newton closes it */
START_TEST(test_assembly) {
  run r;
  run_open_good(&r,
                "{'bodies':[{'name':'a','mass':1,'inertia':[0.1,0.1,0.1],'position':[0.5,0,0.5]},"
                "{'name':'b','mass':1,'inertia':[0.1,0.1,0.1],'position':[1.5,0,0.5]}],"
                "'joints':[{'name':'j1','type':'spherical','bodies':['ground','a'],'point':[0,0,0]},"
                "{'name':'j2','type':'spherical','bodies':['a','b'],'point':[1,0,1]},"
                "{'name':'j3','type':'spherical','bodies':['b','ground'],'points':[[2,0,0],[2.2,0,0.1]]}]}",
                "");
  ck_assert_int_eq(r.ready.nwarning, 1);
  ck_assert_double_lt(r.ready.initial[run_channel(&r, "constraint.drift")], 1e-12);
  ck_assert_int_eq((int)json_integer_value(json_object_get(r.ready.report, "degrees_of_freedom")), 3);
  double moved = json_real_value(json_object_get(json_object_get(r.ready.report, "assembly"), "translation"));
  ck_assert(moved > 0.02 && moved < 0.5);
  run_close(&r);
}
END_TEST

/* the first acceleration holds the first load: no transient at the start */
START_TEST(test_first_load) {
  run r;
  run_open_good(&r, "{'gravity':[0,0,0],'bodies':[{'name':'m','mass':2,'inertia':[1,1,1],'position':[0,0,0]}]}", "m");
  tdm_wrench load = {{1000, 0, 0}, {0, 0, 0}};
  run_window(&r, 1e-3, &load, 1, 0, NULL);
  CLOSE(r.state[0].twist.velocity.x, 0.5, 1e-9);
  CLOSE(r.state[0].pose.position.x, 0.00025, 1e-9);
  run_close(&r);
}
END_TEST

TEST_MAIN("mbd statics", test_cantilever, test_pendulum_reaction, test_torsional_turns, test_torsional_rest,
          test_inconsistent_start, test_assembly, test_first_load)
