/* Friction that sticks: modes, times, loads and energies against closed forms, in every formulation. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/numerics/test_mbd_support.h"
#include "tests/test_main.h"

static const char *const formulation[] = {"ggl", "index3", "one_step"};
static const double g = 9.81;

/* A scene of this relative tolerance; further arguments follow the formulation, which comes first. */
static void open_with(run *r, int which, const char *tolerance, const char *format, const char *more,
                      const char *names) {
  char scene[4096];
  snprintf(scene, sizeof scene, "{'formulation':'%s','solver':{'relative_tolerance':%s%s},%s%s", formulation[which],
           tolerance, which == 1 ? ",'absolute_tolerance':1e-10" : "", format, more);
  run_open_good(r, scene, names);
}

static void open_scene(run *r, int which, const char *format, const char *more, const char *names) {
  open_with(r, which, "1e-10", format, more, names);
}

#define BODY(name, mass, rest) "{'name':'" name "','mass':" mass ",'inertia':[1,1,0.08],'position':[0,0,0]" rest "}"
#define RAIL(axis) \
  "'joints':[{'name':'rail','type':'prismatic','bodies':['ground','b'],'point':[0,0,0],'axis':" axis "}],"
#define AXLE "'joints':[{'name':'axle','type':'revolute','bodies':['ground','b'],'point':[0,0,0],'axis':[0,0,1]}],"

/* Up a slope of 3:4 by its reaction's friction: it stops at v/(g (sin + mu cos)), and stays there to 1e-9 m/s where mu
 * holds it, or slides back */
START_TEST(test_slope) {
  for (int back = 0; back < 2; back++) {
    run r;
    const double mu = back ? 0.5 : 0.8, up = g * (0.6 + 0.8 * mu), down = g * (0.6 - 0.8 * mu), stop = 3 / up;
    open_scene(&r, _i, "'bodies':[" BODY("b", "5", ",'velocity':[2.4,0,1.8]") "]," RAIL("[0.8,0,0.6]"),
               back ? "'forces':[{'name':'f','type':'friction','joint':'rail','coefficient':0.5}]}"
                    : "'forces':[{'name':'f','type':'friction','joint':'rail','coefficient':0.8}]}",
               "");
    for (int k = 1; k <= 40; k++) {
      run_to(&r, 0.025 * k);
      const double t = r.t, after = fmax(0, t - stop), moved = 4.5 / up;
      double v = t < stop ? 3 - up * t : back ? -down * after : 0;
      double x = t < stop ? 3 * t - 0.5 * up * t * t : moved - (back ? 0.5 * down * after * after : 0);
      CLOSE(run_value(&r, "joint.rail.translation"), x, 1e-8);
      CLOSE(run_value(&r, "joint.rail.speed"), v, t > stop && !back ? 1e-9 : 1e-8);
      CLOSE(run_value(&r, "force.f.sliding"), t < stop ? 1 : back ? -1 : 0, 0);
      CLOSE(run_value(&r, "force.f.value"), t < stop ? 4 * mu * g : back ? -4 * mu * g : -3 * g, 1e-6);
      CLOSE(run_value(&r, "energy.balance"), 0, 2e-6);
    }
    run_close(&r);
  }
}
END_TEST

/* A pull that grows by 10 N/s breaks a weight loose at mu_s m g and works against mu_d m g from then on */
START_TEST(test_breakaway) {
  run r;
  const double weight = 3 * g, loose = 0.5 * weight / 10;
  open_scene(&r, _i, "'bodies':[" BODY("b", "3", "") "]," RAIL("[1,0,0]"),
             "'forces':[{'name':'f','type':'friction','joint':'rail','coefficient':{'static':0.5,'dynamic':0.3}},"
             "{'name':'w','type':'wrench','body':'b','force':[1,0,0],'factor':{'type':'polynomial','coefficients':"
             "[0,10]}}]}",
             "");
  for (int k = 1; k <= 40; k++) {
    run_to(&r, 0.05 * k);
    const double s = fmax(0, r.t - loose);
    CLOSE(run_value(&r, "joint.rail.speed"), s > 0 ? (0.2 * weight * s + 5 * s * s) / 3 : 0, s > 0 ? 1e-7 : 1e-12);
    CLOSE(run_value(&r, "force.f.value"), s > 0 ? 0.3 * weight : 10 * r.t, 1e-7);
    CLOSE(run_value(&r, "energy.balance"), 0, 1e-6);
  }
  run_close(&r);
}
END_TEST

/* A mass on a belt, held by a spring: it sticks until the spring pulls with mu_s N, slides on a circle of the phase
 * plane about mu_d N/k until it is as fast as the belt, and so on: period 2 D/(k v) + 2 (pi - atan(w D/(k v)))/w with
 * D = (mu_s - mu_d) N */
START_TEST(test_stick_slip) {
  const double m = 2, k = 500, v = 0.1, N = m * g, D = 0.3 * N, w = sqrt(k / m), stick = 2 * D / (k * v);
  const double slip = 2 / w * (M_PI - atan(w * D / (k * v))), first = 0.6 * N / (k * v);
  run r;
  open_scene(&r, _i,
             "'bodies':[" BODY("belt", "1", ",'velocity':[0.1,0,0]") "," BODY(
                 "b", "2",
                 ",'velocity':[0.1,0,0]") "],'joints':[{'name':'rail','type':'prismatic','bodies':['ground','belt'],"
                                          "'point':[0,0,0],'axis':[1,0,0]},{'name':'top','type':'prismatic','bodies':"
                                          "['belt','b'],'point':[0,0,0],'axis':[1,0,0]}],",
             "'drivers':[{'name':'d','type':'linear_motor','joint':'rail','motion':{'type':'constant_rate','rate':0.1,"
             "'start':'step'}}],'forces':[{'name':'f','type':'friction','joint':'top','coefficient':{'static':0.6,"
             "'dynamic':0.3}},{'name':'s','type':'spring_damper','bodies':['ground','b'],'points':[[-10,0,0],"
             "[0,0,0]],'stiffness':500}]}",
             "");
  const double h = _i == 2 ? 0.0005 : 0.004, tolerance = _i == 2 ? 5e-6 : 2e-7;
  int turns = 0;
  double before = 0;
  while (r.t < 2.2) {
    run_to(&r, r.t + h);
    const double in = r.t < first ? 0 : fmod(r.t - first, stick + slip), sliding = run_value(&r, "force.f.sliding");
    double x = 0.3 * N / k + D / k * cos(w * in) + v / w * sin(w * in);
    if (r.t < first)
      x = v * r.t;
    else if (in > slip)
      x = 0.3 * N / k - D / k + v * (in - slip);
    CLOSE(run_value(&r, "body.b.x"), x, tolerance);
    if (fmin(fabs(in - slip), fabs(r.t - first)) > 1e-3)
      CLOSE(sliding, r.t > first && in < slip ? -1 : 0, 0);
    if (sliding == 0)
      CLOSE(run_value(&r, "joint.top.speed"), 0, 1e-9);
    turns += sliding != before;
    before = sliding;
  }
  ck_assert_int_eq(turns, 8); /* no chatter: four times off, four times on */
  CLOSE(run_value(&r, "energy.balance"), 0, _i == 2 ? 1e-4 : 1e-5);
  run_close(&r);
}
END_TEST

/* A drawer pulled beside its middle jams where 2 mu e/L is 1 or more, else it is pulled by F (1 - 2 mu e/L) */
START_TEST(test_drawer) {
  for (int jams = 0; jams < 2; jams++) {
    run r;
    open_scene(&r, _i, "'gravity':[0,0,0],'bodies':[" BODY("b", "3", "") "]," RAIL("[1,0,0]"),
               jams ? "'forces':[{'name':'f','type':'friction','joint':'rail','coefficient':0.5,'length':0.5},"
                      "{'name':'w','type':'wrench','body':'b','point':[0,0.501,0],'force':[10,0,0]}]}"
                    : "'forces':[{'name':'f','type':'friction','joint':'rail','coefficient':0.5,'length':0.5},"
                      "{'name':'w','type':'wrench','body':'b','point':[0,0.3,0],'force':[10,0,0]}]}",
               "");
    run_on(&r, 1, 0.1);
    CLOSE(run_value(&r, "joint.rail.speed"), jams ? 0 : 10 * 0.4 / 3, 1e-8);
    CLOSE(run_value(&r, "force.f.value"), jams ? 10 : 6, 1e-8);
    run_close(&r);
  }
}
END_TEST

/* A shaft in a bearing: torque mu (R F_radial + R_t F_axial); it comes to rest at the angle w^2 J/2 over it */
START_TEST(test_bearing) {
  run r;
  const double torque = 0.2 * (0.03 * 4 * 6 + 0.05 * 4 * 8);
  open_scene(&r, _i, "'gravity':[6,0,8],'bodies':[" BODY("b", "4", ",'angular_velocity':[0,0,3]") "]," AXLE,
             "'forces':[{'name':'f','type':'friction','joint':'axle','coefficient':0.2,'radius':0.03,'thrust_radius':"
             "0.05}]}",
             "");
  run_to(&r, 0.1);
  CLOSE(run_value(&r, "force.f.value"), torque, 1e-9);
  CLOSE(run_value(&r, "joint.axle.rate"), 3 - 0.1 * torque / 0.08, 1e-8);
  run_on(&r, 1.2, 0.1);
  CLOSE(run_value(&r, "joint.axle.angle"), 4.5 * 0.08 / torque, 1e-7);
  CLOSE(run_value(&r, "joint.axle.rate"), 0, 1e-9);
  CLOSE(run_value(&r, "energy.dissipated"), 4.5 * 0.08, 1e-7);
  run_close(&r);
}
END_TEST

/* A pendulum's bearing: the friction bears part of the weight's moment, so it changes the reaction that it comes from.
 * Energy is kept, one_step to second order, and all formulations end at the same angle. */
START_TEST(test_pendulum) {
#define BEARING "'gravity':[0,-9.81,0],'bodies':[{'name':'b','mass':4,'inertia':[1,1,0.08],'position':[0.5,0,0]}]," AXLE
  double angle[4], balance[4];
  for (int k = 0; k < 4; k++) {
    const double h = k == 3 ? 0.0025 : 0.005;
    run r;
    open_with(&r, k < 3 ? k : 2, k > 1 ? "0.1" : "1e-10", /* 0.1: equal steps */
              BEARING, "'forces':[{'name':'f','type':'friction','joint':'axle','coefficient':0.2,'radius':0.1}]}", "");
    balance[k] = 0;
    while (r.t < 3 - 0.5 * h) {
      run_to(&r, r.t + h);
      balance[k] = fmax(balance[k], fabs(run_value(&r, "energy.balance")));
    }
    angle[k] = run_value(&r, "joint.axle.angle");
    ck_assert_double_gt(run_value(&r, "energy.dissipated"), 5);
    run_close(&r);
  }
  CLOSE(balance[0], 0, 1e-6);
  CLOSE(balance[1], 0, 1e-5);
  CLOSE(angle[1], angle[0], 1e-6);
  CLOSE(balance[2] / balance[3], 4, 0.2);
  CLOSE((angle[2] - angle[0]) / (angle[3] - angle[0]), 4, 0.2);
}
END_TEST

/* A parallelogram with friction in its four hinges, which turn at the same rate: the limits 1, 2, 3 and 4 N m add up,
 * however they are shared before, and the load may turn */
START_TEST(test_linkage) {
#define LINK(name, x, y, angle, half) \
  "{'name':'" name "','mass':1,'inertia':[0.01," half "," half "],'position':[" x "," y ",0],'orientation':" angle "}"
#define HINGE(name, a, b, x, y) \
  "{'name':'" name "','type':'revolute','bodies':['" a "','" b "'],'point':[" x "," y ",0],'axis':[0,0,1]}"
#define RUB(joint, limit) "{'name':'f" joint "','type':'friction','joint':'" joint "','limit':" limit "}"
  run r;
  const double loose = 2 / M_PI * asin(10 / 12.0);
  open_scene(&r, _i,
             "'gravity':[0,0,0],'bodies':[" LINK("c", "0", "0.5", "[1,0,0,1]", "0.1") "," LINK(
                 "k", "1", "1", "[1,0,0,0]",
                 "0.3") "," LINK("r", "2", "0.5", "[1,0,0,1]",
                                 "0.1") "],'joints':[" HINGE("A", "ground", "c", "0",
                                                             "0") "," HINGE("B", "c", "k", "0",
                                                                            "1") "," HINGE("C", "k", "r", "2",
                                                                                           "1") "," HINGE("D", "r",
                                                                                                          "ground", "2",
                                                                                                          "0") "],",
             "'forces':[" RUB("A", "1") "," RUB("B", "2") "," RUB("C", "3") "," RUB(
                 "D", "4") ",{'name':'w','type':'wrench','body':'c','moment':[0,0,1],'factor':{'type':'harmonic',"
                           "'amplitude':12,'frequency':0.25}}]}",
             "");
  double turned = 0;
  for (int k = 1; k <= 300; k++) {
    run_to(&r, 0.01 * k);
    double rate = run_value(&r, "joint.A.rate"), held = 0;
    held += run_value(&r, "force.fA.value") - run_value(&r, "force.fB.value");
    held += run_value(&r, "force.fC.value") - run_value(&r, "force.fD.value");
    if (r.t < loose) /* index 3 has velocities from positions: their rounding over a step */
      CLOSE(rate, 0, _i == 1 ? 1e-10 : 1e-12);
    else if (r.t > loose + 0.01 && r.t < 1.5)
      ck_assert_double_gt(rate, turned);
    if (rate == 0)
      CLOSE(held, 12 * sin(M_PI / 2 * r.t), 1e-8);
    else if (fabs(rate) > 1e-6)
      CLOSE(fabs(held), 10, 1e-9);
    turned = r.t < 1 ? rate : 0;
  }
  ck_assert_double_lt(run_value(&r, "joint.A.rate"), -0.1);
  CLOSE(run_value(&r, "energy.balance"), 0, _i == 2 ? 2e-4 : 1e-6);
  run_close(&r);
}
END_TEST

/* A motor that turns a rubbing shaft to and fro works against friction all the way */
START_TEST(test_motor) {
  run r;
  open_scene(&r, _i, "'gravity':[0,-9.81,0],'bodies':[" BODY("b", "4", "") "]," AXLE,
             "'drivers':[{'name':'d','type':'rotational_motor','joint':'axle','motion':{'type':'harmonic','amplitude':"
             "1,'frequency':1}}],'forces':[{'name':'f','type':'friction','joint':'axle','coefficient':0.2,'radius':"
             "0.03}]}",
             "");
  run_on(&r, 1, 0.005);
  CLOSE(run_value(&r, "energy.dissipated"), 4 * 0.2 * 0.03 * 4 * g, _i == 2 ? 1e-5 : 1e-6);
  CLOSE(run_value(&r, "driver.d.torque"), 0.2 * 0.03 * 4 * g, 1e-4); /* no acceleration here */
  run_close(&r);
}
END_TEST

/* Between rest and full speed the coefficient falls by exp(-(v/v_s)^2) */
START_TEST(test_stribeck) {
  run r;
  open_scene(&r, _i, "'bodies':[" BODY("b", "2", ",'velocity':[1,0,0]") "]," RAIL("[1,0,0]"),
             "'forces':[{'name':'f','type':'friction','joint':'rail','coefficient':{'static':0.6,'dynamic':0.2},"
             "'velocity_scale':0.3,'viscous':0.7}]}",
             "");
  for (int k = 1; k <= 8; k++) {
    run_on(&r, 0.04 * k, _i == 2 ? 1e-4 : 0.04);
    double v = run_value(&r, "joint.rail.speed");
    ck_assert_double_gt(v, 0.02);
    CLOSE(run_value(&r, "force.f.value"), 2 * g * (0.2 + 0.4 * exp(-v * v / 0.09)) + 0.7 * v, 1e-9);
  }
  run_on(&r, 0.6, _i == 2 ? 1e-4 : 0.04);
  CLOSE(run_value(&r, "joint.rail.speed"), 0, 1e-9);
  CLOSE(run_value(&r, "energy.balance"), 0, 1e-6);
  run_close(&r);
}
END_TEST

/* A coupled body under loads that jump from window to window: what they bring above the limit moves it, no more and no
 * less; a run that is saved, goes astray and is restored has the same bits */
START_TEST(test_windows) {
  static const double push[] = {4, -4, 9, 9, -9, 0, 4.9, -20, 0, 0, 5.1, 5.1, 0, 0, 0, 0};
  const double H = 0.02, limit = 5, m = 2;
  double x = 0, v = 0;
  run r;
  open_scene(&r, _i, "'gravity':[0,0,0],'bodies':[" BODY("b", "2", "") "]," RAIL("[1,0,0]"),
             "'forces':[{'name':'f','type':'friction','joint':'rail','limit':5}]}", "b");
  for (int k = 0; k < 16; k++) {
    const tdm_wrench load = {{push[k], 0, 0}, {0, 0, 0}}, astray = {{30 - 4 * push[k], 0, 0}, {0, 0, 0}};
    for (double left = H; left > 1e-15;) { /* Coulomb's law, by hand */
      double way = v != 0 ? copysign(1, v) : fabs(push[k]) > limit ? copysign(1, push[k]) : 0;
      double a = way == 0 ? 0 : (push[k] - way * limit) / m, stop = v != 0 && a * v < 0 ? -v / a : INFINITY;
      double h = fmin(left, stop);
      x += h * v + 0.5 * a * h * h;
      v = stop <= left ? 0 : v + a * h;
      left -= h;
    }
    ck_assert_int_eq(mbd_engine_save(r.self, 0, &r.err), TDM_OK);
    run_window(&r, H * (k + 1), &astray, 1, 0, NULL);
    tdm_state kept[2];
    for (int again = 0; again < 2; again++) {
      ck_assert_int_eq(mbd_engine_restore(r.self, 0, &r.err), TDM_OK);
      r.t = H * k;
      run_window(&r, H * (k + 1), &load, 1, 0, NULL);
      kept[again] = r.state[0];
    }
    ck_assert_mem_eq(&kept[0], &kept[1], sizeof kept[0]);
    CLOSE(r.state[0].twist.velocity.x, v, v == 0 ? 1e-9 : 2e-8);
    CLOSE(r.state[0].pose.position.x, x, _i == 1 ? 2e-8 : 2e-9);
  }
  run_close(&r);
}
END_TEST

/* Friction by a reaction that is not determined is refused; by one that redundant rows do not touch it is not */
START_TEST(test_undetermined) {
  run r;
  run_open(&r,
           "{'bodies':[" BODY("b", "1", "") "],'joints':[{'name':'low','type':'revolute','bodies':['ground','b'],"
                                            "'point':[0,0,0],'axis':[0,0,1]},{'name':'high','type':'revolute','bodies'"
                                            ":['ground','b'],'point':[0,0,1],'axis':[0,0,1]}],'forces':[{'name':'f',"
                                            "'type':'friction','joint':'low','coefficient':0.1,'radius':0.1}]}",
           "");
  ck_assert_int_eq(r.status, TDM_ERR_SCENE);
  ck_assert_str_eq(r.err.path, "mbd.forces[0].coefficient");
  ck_assert_msg(strstr(r.err.message, "not determined") != NULL, "%s", r.err.message);
  run_close(&r);
  run_open_good(
      &r,
      "{'gravity':[0,-9.81,0],'bodies':[" LINK("c", "0", "0.5", "[1,0,0,1]", "0.1") "," LINK(
          "k", "1", "1", "[1,0,0,0]",
          "0.3") "," LINK("r", "2", "0.5", "[1,0,0,1]",
                          "0.1") "],'joints':[" HINGE("A", "ground", "c", "0",
                                                      "0") "," HINGE("B", "c", "k", "0",
                                                                     "1") "," HINGE("C", "k", "r", "2",
                                                                                    "1") "," HINGE("D", "r", "ground",
                                                                                                   "2",
                                                                                                   "0") "],"
                                                                                                        "'forces':[{'"
                                                                                                        "name':'f','"
                                                                                                        "type':'"
                                                                                                        "friction','"
                                                                                                        "joint':'A','"
                                                                                                        "coefficient':"
                                                                                                        "0.1,'radius':"
                                                                                                        "0.1,'thrust_"
                                                                                                        "radius':0"
                                                                                                        "},{'name':'w',"
                                                                                                        "'type':'"
                                                                                                        "wrench','body'"
                                                                                                        ":'c','moment':"
                                                                                                        "[0,0,-2]}]}",
      "");
  /* half of the coupler, and the crank itself */
  run_on(&r, 0.1, 0.01);
  CLOSE(run_value(&r, "energy.balance"), 0, 1e-6);
  ck_assert_double_gt(run_value(&r, "force.f.value"), -0.1 * 0.1 * 2 * g);
  ck_assert_double_lt(run_value(&r, "force.f.value"), -0.1 * 0.1 * g);
  run_close(&r);
}
END_TEST

TEST_MAIN_ROWS("mbd friction", {test_slope, 3}, {test_breakaway, 3}, {test_stick_slip, 3}, {test_drawer, 3},
               {test_bearing, 3}, {test_linkage, 3}, {test_motor, 3}, {test_stribeck, 3}, {test_windows, 3},
               {test_pendulum, 1}, {test_undetermined, 1})
