/* Redundant constraints, singular positions, and the balance of energies. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/numerics/test_mbd_support.h"
#include "tests/test_main.h"

#define BODY(name, x, y, rest) \
  "{'name':'" name "','mass':1,'inertia':[0.08,0.08,0.08],'position':[" x "," y ",0]" rest "}"
#define HINGE(name, a, b, x, y) \
  "{'name':'" name "','type':'revolute','bodies':['" a "','" b "'],'point':[" x "," y ",0],'axis':[0,0,1]}"

/* a planar four-bar whose last joint is given */
#define FOUR_BAR(last)                                                                                             \
  "{'gravity':[0,-9.81,0],'bodies':[" BODY("crank", "0", "0.5", "") "," BODY("coupler", "1", "1.25", "") "," BODY( \
      "rocker", "2", "0.75",                                                                                       \
      "") "],'joints':[" HINGE("A", "ground", "crank", "0",                                                        \
                               "0") "," HINGE("B", "crank", "coupler", "0",                                        \
                                              "1") "," HINGE("C", "coupler", "rocker", "2",                        \
                                                             "1.5") "," last                                       \
                                                                    "],'solver':{'relative_tolerance':1e-10}}"

/* number of redundant rows in the report, each of joint `name` */
static int redundant(const run *r, const char *name) {
  json_t *rows = json_object_get(r->ready.report, "redundant");
  for (size_t i = 0; i < json_array_size(rows); i++)
    ck_assert_str_eq(json_string_value(json_object_get(json_array_get(rows, i), "joint")), name);
  return (int)json_array_size(rows);
}

static int freedom(const run *r) {
  return (int)json_integer_value(json_object_get(r->ready.report, "degrees_of_freedom"));
}

START_TEST(test_four_bar) {
  run four, loose;
  run_open_good(&four, FOUR_BAR(HINGE("D", "rocker", "ground", "2", "0")), "crank");
  run_open_good(&loose,
                FOUR_BAR("{'name':'D','type':'point_on_line','bodies':['ground','rocker'],'point':[2,0,0],"
                         "'axis':[0,0,1]}"),
                "crank");
  ck_assert_int_eq(redundant(&four, "D"), 3);
  ck_assert_int_eq(redundant(&loose, ""), 0);
  ck_assert_int_eq(freedom(&four), 1);
  ck_assert_int_eq(freedom(&loose), 1);
  for (int i = 1; i <= 10; i++) {
    run_to(&four, 0.1 * i);
    run_to(&loose, 0.1 * i);
    CLOSE(four.state[0].twist.angular.z, loose.state[0].twist.angular.z, 1e-7);
    CLOSE(run_value(&four, "joint.D.fx"), -run_value(&loose, "joint.D.fx"), 1e-5);
    CLOSE(run_value(&four, "joint.D.fz"), 0, 1e-9); /* a planar mechanism has none across */
    CLOSE(run_value(&four, "joint.D.mx"), 0, 1e-9);
  }
  run_close(&four);
  run_close(&loose);
}
END_TEST

/* a door on two hinges, which share what their equations leave open */
START_TEST(test_door) {
  run r;
  run_open_good(&r,
                "{'gravity':[0,0,-10],'bodies':[{'name':'door','mass':30,'inertia':[3,3,3],'position':[0.5,0,1]}],"
                "'joints':[{'name':'low','type':'revolute','bodies':['ground','door'],'point':[0,0,0.5],'axis':[0,0,"
                "1]},{'name':'high','type':'revolute','bodies':['ground','door'],'point':[0,0,1.5],'axis':[0,0,1]}]}",
                "door");
  ck_assert_int_eq(redundant(&r, "high"), 5);
  run_to(&r, 0.1);
  CLOSE(run_value(&r, "joint.low.fz"), 150, 1e-6);
  CLOSE(run_value(&r, "joint.high.fz"), 150, 1e-6);
  CLOSE(run_value(&r, "joint.low.fx") + run_value(&r, "joint.high.fx"), 0, 1e-6);
  /* 300 N at 0.5 m: by the pair of forces at 1 m and the moments of both hinges */
  CLOSE(run_value(&r, "joint.low.fx") * -0.5 + run_value(&r, "joint.high.fx") * 0.5 + run_value(&r, "joint.low.my") +
            run_value(&r, "joint.high.my"),
        -150, 1e-6);
  run_close(&r);
}
END_TEST

/* an axis that is not quite parallel locks the mechanism, and the user is told */
START_TEST(test_nearly_dependent) {
  static const char *const axis[] = {"[0,1e-8,1]", "[0,5e-5,1]", "[0,1e-12,1]"};
  char last[256], scene[2048];
  snprintf(last, sizeof last, "{'name':'D','type':'revolute','bodies':['rocker','ground'],'point':[2,0,0],'axis':%s}",
           axis[_i]);
  snprintf(scene, sizeof scene, FOUR_BAR("%s"), last);
  run r;
  run_open_good(&r, scene, "crank");
  if (_i < 2) {
    ck_assert_int_eq(freedom(&r), 0);
    ck_assert_int_eq(r.ready.nwarning, 2);
    ck_assert_str_eq(r.ready.warning[0].path, "mbd.joints[3]");
    ck_assert_ptr_nonnull(strstr(r.ready.warning[0].message, "exactly parallel"));
    ck_assert_ptr_nonnull(strstr(r.ready.warning[1].message, "nothing can move"));
  } else {
    ck_assert_int_eq(freedom(&r), 1);
    ck_assert_int_eq(r.ready.nwarning, 0);
  }
  run_close(&r);
}
END_TEST

static const struct {
  const char *scene, *words[3];
} bad[] = {
    /* a coupler that cannot reach */
    {FOUR_BAR("{'name':'D','type':'revolute','bodies':['rocker','ground'],'points':[[2,0,0],[9,0,0]],'axis':[0,0,1]}"),
     {"cannot be assembled", "contradict", "joint"}},
    /* one joint out of the plane: it comes first in the message */
    {FOUR_BAR(
         "{'name':'D','type':'revolute','bodies':['rocker','ground'],'points':[[2,0,0],[2,0,0.1]],'axis':[0,0,1]}"),
     {"cannot be assembled", "stay open: joint \"D\"", "point z"}},
    /* hinges of one door on different axes */
    {"{'bodies':[" BODY("door", "0", "0", "") "],'joints':[" HINGE(
         "low", "ground", "door", "0",
         "0") ",{'name':'high',"
              "'type':'revolute','bodies':['ground','door'],'points':[[0.5,0,1],[0.6,0,1]],'axis':[0,0,1]}]}",
     {"cannot be assembled", "low", "high"}},
    /* a four-bar that starts flat */
    {"{'bodies':[" BODY("crank", "0.5", "0", "") "," BODY("coupler", "1.5", "0", "") "," BODY(
         "rocker", "2.5", "0",
         "") "],'joints':[" HINGE("A", "ground", "crank", "0",
                                  "0") "," HINGE("B", "crank", "coupler", "1",
                                                 "0") "," HINGE("C", "coupler", "rocker", "2",
                                                                "0") "," HINGE("D", "rocker", "ground", "1", "0") "]}",
     {"singular position", "start elsewhere", "D"}},
};

START_TEST(test_refused) {
  run r;
  run_open(&r, bad[_i].scene, "");
  ck_assert_int_eq(r.status, TDM_ERR_SCENE);
  for (int i = 0; i < 3; i++)
    ck_assert_msg(strstr(r.err.message, bad[_i].words[i]) != NULL, "%s: %s", r.err.path, r.err.message);
  run_close(&r);
}
END_TEST

/* A parallelogram (IFToMM benchmark A02, N = 1) goes through the positions where another branch begins. */
START_TEST(test_singular) {
  run r;
  double row[5];
  run_open_good(
      &r,
      "{'gravity':[0,-9.81,0],'corrector':'modified','solver':{'relative_tolerance':1e-10,'absolute_tolerance':1e-10},"
      "'bodies':[{'name':'a','mass':1,'inertia':[0.0833333333333333,0.001,0.0833333333333333],'position':[0,0.5,0],"
      "'velocity':[0.5,0,0],'angular_velocity':[0,0,-1]},{'name':'b','mass':1,'inertia':[0.0833333333333333,0.001,"
      "0.0833333333333333],'position':[1,0.5,0],'velocity':[0.5,0,0],'angular_velocity':[0,0,-1]},{'name':'c','mass':"
      "1,'inertia':[0.001,0.0833333333333333,0.0833333333333333],'position':[0.5,1,0],'velocity':[1,0,0]}],'joints'"
      ":[" HINGE("A", "ground", "a", "0", "0") "," HINGE("B", "ground", "b", "1", "0") "," HINGE(
          "C", "a", "c", "0", "1") "," HINGE("D", "c", "b", "1", "1") "]}",
      "a b");
  for (int i = 1; i <= 10; i++) {
    run_to(&r, i);
    reference_row("fourbar_A02_N1_computed.csv", i, row, 5);
    for (int b = 0; b < 2; b++) {
      double angle = -tdm_quat_to_rotvec(r.state[b].pose.orientation).z;
      CLOSE(remainder(angle - row[1], 2 * M_PI), 0, 1e-4);
    }
    CLOSE(run_value(&r, "energy.balance"), 0, 1e-4);
  }
  run_close(&r);
}
END_TEST

/* what the motor, the wrench and gravity bring in, the damper and the friction turn into heat, or it is stored */
START_TEST(test_balance) {
  static const char *const formulation[] = {"'ggl'", "'index3'", "'one_step'"};
  const double tolerance[] = {1e-6, 1e-4, 1e-4};
  char scene[2048];
  snprintf(scene, sizeof scene,
           "{'gravity':[0,-9.81,0],'formulation':%s,'solver':{'relative_tolerance':1e-9,'max_step':0.0005},'bodies':["
           "%s,%s],'joints':[%s,%s],'drivers':[{'name':'motor','type':'rotational_motor','joint':'A','motion':{'type'"
           ":'constant_rate','rate':4,'start':'smooth','rise':0.3}}],'forces':[{'name':'coil','type':"
           "'torsional_spring_damper','joint':'B','stiffness':3,'damping':0.2},{'name':'rub','type':'friction','joint':"
           "'B','coordinate':'angle','limit':0.1,'velocity_scale':0.5},{'name':'push','type':'wrench','body':'b',"
           "'force':[2,1,0]}]}",
           formulation[_i], BODY("a", "0.5", "0", ""), BODY("b", "1.5", "0", ""), HINGE("A", "ground", "a", "0", "0"),
           HINGE("B", "a", "b", "1", "0"));
  run r;
  run_open_good(&r, scene, "");
  CLOSE(r.ready.initial[run_channel(&r, "energy.balance")], 0, 0);
  for (int i = 1; i <= 20; i++)
    run_to(&r, 0.1 * i);
  double supplied = run_value(&r, "energy.supplied"), heat = run_value(&r, "energy.dissipated");
  ck_assert_double_gt(fabs(supplied), 1);
  ck_assert_double_gt(heat, 0.1);
  CLOSE(run_value(&r, "energy.balance"), 0, tolerance[_i] * fmax(1, fabs(supplied)));
  run_close(&r);
}
END_TEST

/* Steps that are too short to get anywhere: an error with advice, not an endless run. */
START_TEST(test_standstill) {
  run r;
  run_open_good(&r,
                "{'solver':{'max_step':1e-10},'bodies':[{'name':'a','mass':1,'inertia':[0.1,0.1,0.1],'position':[1,0,0]"
                "}],'joints':[{'name':'h','type':'revolute','bodies':['ground','a'],'point':[0,0,0],'axis':[0,1,0]}]}",
                "a");
  ck_assert_int_eq(run_step(&r, 1, NULL, 0, 0, NULL), TDM_ERR_NUMERIC);
  ck_assert_msg(strstr(r.err.message, "stands still") != NULL, "%s", r.err.message);
  ck_assert_msg(strstr(r.err.message, "larger mbd.solver.max_step") != NULL, "%s", r.err.message);
  run_close(&r);
}
END_TEST

/* a shaft that turns with two arms hinged to it, as they swing out */
#define ARM(name, x, v)                                                                            \
  "{'name':'" name "','mass':1,'inertia':[0.1,0.1,0.1],'position':[" x ",0,-0.3],'velocity':[0," v \
  ",0],'angular_velocity':[0,0,5]}"
#define GOVERNOR(rest)                                                                                                 \
  "{" rest ",'bodies':[{'name':'shaft','mass':1,'inertia':[0.1,0.1,0.1],'position':[0,0,0],'angular_velocity':[0,0,5]" \
  "}," ARM("a", "0.4", "2") "," ARM("b", "-0.4", "-2") "],'joints':[" HINGE(                                           \
      "spin", "ground", "shaft", "0", "0") ",{'name':'ha','type':'revolute','bodies':['shaft','a'],'point':[0.05,0,0]" \
                                           ",'axis':[0,1,0]},{'name':'hb','type'"                                      \
                                           ":'revolute','bodies':['shaft','b'],'point':[-0.05,0,0],'axis':[0,1,0]}]}"

/* All formulations on IDA start at every tolerance there is, and get ever nearer to the one solution, in steps that do
 * not shrink with the square root of the tolerance, as those of order 1 would. */
START_TEST(test_tolerances) {
  static const char *const method[] = {"'formulation':'ggl'", "'formulation':'ggl','corrector':'modified'",
                                       "'formulation':'index3'"};
  double exact = 0;
  for (int k = 0; k <= 7; k++) { /* the first is what the others compare with */
    const double tolerance = pow(10, k == 0 ? -13 : -6 - k);
    char scene[2048];
    snprintf(scene, sizeof scene, GOVERNOR("%s,'solver':{'relative_tolerance':%g}"), k == 0 ? method[0] : method[_i],
             tolerance);
    run r;
    run_open_good(&r, scene, "");
    run_to(&r, 0.5);
    double angle = run_value(&r, "joint.ha.angle");
    exact = k == 0 ? angle : exact;
    CLOSE(angle, exact, 300 * tolerance);
    CLOSE(run_value(&r, "joint.hb.angle"), -angle, 300 * tolerance);
    CLOSE(run_value(&r, "constraint.drift"), 0, 1e-9);
    CLOSE(run_value(&r, "energy.balance"), 0, 1e4 * tolerance);
    ck_assert_int_lt(run_close_steps(&r), 2000);
  }
}
END_TEST

/* what is advised when it fails helps, and is not so already */
START_TEST(test_advice) {
  static const char *const rest[] = {"", "'corrector':'modified',"};
  for (int k = 0; k < 2; k++) {
    char scene[2048];
    snprintf(scene, sizeof scene, GOVERNOR("%s'solver':{'relative_tolerance':1e-13,'absolute_tolerance':1e-18}"),
             rest[k]);
    run r;
    run_open_good(&r, scene, "");
    ck_assert_int_eq(run_step(&r, 5, NULL, 0, 0, NULL), TDM_ERR_NUMERIC);
    ck_assert_msg(strstr(r.err.message, "larger mbd.solver.absolute_tolerance") != NULL, "%s", r.err.message);
    ck_assert_msg((strstr(r.err.message, "\"modified\"") == NULL) == (k == 1), "%s", r.err.message);
    ck_assert_msg(strstr(r.err.message, "windows") == NULL, "%s", r.err.message); /* nothing is coupled */
    run_close(&r);
  }
}
END_TEST

/* IDA that forgets its history at each window takes more steps to the same motion. */
START_TEST(test_restart) {
  static const char *const restart[] = {"false", "true"};
  long steps[2];
  double angle[2];
  for (int k = 0; k < 2; k++) {
    char scene[1024];
    snprintf(
        scene, sizeof scene,
        "{'gravity':[0,-9.81,0],'restart_each_window':%s,'bodies':[" BODY("a", "0.5", "0", "") "],'joints':[" HINGE(
            "A", "ground", "a", "0", "0") "],'solver':{'relative_tolerance':1e-9}}",
        restart[k]);
    run r;
    run_open_good(&r, scene, "a");
    for (int i = 1; i <= 50; i++)
      run_to(&r, 0.02 * i);
    angle[k] = tdm_quat_to_rotvec(r.state[0].pose.orientation).z;
    steps[k] = run_close_steps(&r);
  }
  CLOSE(angle[1], angle[0], 1e-6);
  ck_assert_int_gt(steps[1], 2 * steps[0]);
}
END_TEST

TEST_MAIN_ROWS("mbd_redundant", {test_four_bar, 1}, {test_door, 1}, {test_nearly_dependent, 3},
               {test_refused, sizeof bad / sizeof bad[0]}, {test_singular, 1}, {test_standstill, 1},
               {test_tolerances, 3}, {test_advice, 1}, {test_restart, 1}, {test_balance, 3})
