/* Thin rods without inertia about their own axis: they move as rods where nothing turns them about it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/numerics/test_mbd_support.h"
#include "tests/test_main.h"

#include <math.h>

static const char *const formulation[] = {"ggl", "index3", "one_step"};

/* A rod on a ball at its upper end goes round in a cone: rate^2 = 3 g/(2 L cos(angle)). The given rate has a share
 * along the rod, which means nothing. */
START_TEST(a_rod_on_a_ball_goes_round_in_a_cone) {
  const double g = 9.81, L = 0.8, m = 2, angle = 0.7, rate = sqrt(1.5 * g / (L * cos(angle))), J = m * L * L / 12;
  const double radius = 0.5 * L * sin(angle), depth = 0.5 * L * cos(angle), tolerance = _i == 0 ? 1e-8 : 1e-4;
  char scene[1024];
  run r;
  snprintf(
      scene, sizeof scene,
      "{'formulation':'%s','solver':{'relative_tolerance':1e-10,'max_step':0.002},'bodies':[{'name':'rod','mass':%g"
      ",'inertia':[0,%.17g,%.17g],'position':[%.17g,0,%.17g],'orientation':[%.17g,0,%.17g,0],'velocity':[0,%.17g,0]"
      ",'angular_velocity':[0,0,%.17g]}],'joints':[{'name':'ball','type':'spherical','bodies':['ground','rod'],"
      "'point':[0,0,0]}]}",
      formulation[_i], m, J, J, radius, -depth, cos(0.5 * (M_PI / 2 - angle)), sin(0.5 * (M_PI / 2 - angle)),
      radius * rate, rate);
  run_open_good(&r, scene, "");
  for (int i = 1; i <= 20; i++) {
    run_to(&r, 0.1 * i);
    CLOSE(run_value(&r, "body.rod.x"), radius * cos(rate * r.t), tolerance);
    CLOSE(run_value(&r, "body.rod.y"), radius * sin(rate * r.t), tolerance);
    CLOSE(run_value(&r, "body.rod.z"), -depth, tolerance);
    CLOSE(run_value(&r, "joint.ball.fz"), m * g, 1e3 * tolerance); /* of the ball on the rod */
  }
  run_close(&r);
}
END_TEST

/* Held about its axis by hinges across it: the same motion as with any inertia there. */
START_TEST(a_hinged_rod_swings_as_any_other) {
  static const char *const along[] = {"0", "0.03"};
  double angle[2], energy[2], force[2];
  for (int k = 0; k < 2; k++) {
    char scene[1024];
    run r;
    snprintf(
        scene, sizeof scene,
        "{'formulation':'%s','solver':{'relative_tolerance':1e-10,'max_step':0.002},'bodies':[{'name':'a','mass':1,"
        "'inertia':[%s,0.08,0.08],'position':[0.5,0,0]},{'name':'b','mass':1,'inertia':[%s,0.08,0.08],'position':"
        "[1.5,0,0]}],'joints':[{'name':'p','type':'revolute','bodies':['ground','a'],'point':[0,0,0],'axis':"
        "[0,1,0]},{'name':'q','type':'revolute','bodies':['a','b'],'point':[1,0,0],'axis':[0,1,0]}]}",
        formulation[_i], along[k], along[k]);
    run_open_good(&r, scene, "");
    run_on(&r, 0.5, 0.05);
    angle[k] = run_value(&r, "joint.q.angle");
    energy[k] = run_value(&r, "energy.kinetic");
    force[k] = run_value(&r, "joint.p.fx");
    run_close(&r);
  }
  CLOSE(angle[0], angle[1], 1e-8);
  CLOSE(energy[0], energy[1], 1e-7);
  CLOSE(force[0], force[1], 1e-6);
}
END_TEST

#define ROD(name, x) "{'name':'" name "','mass':1,'inertia':[0,0.08,0.08],'position':[" x ",0,0]}"
#define BALL "{'name':'ball','type':'spherical','bodies':['ground','a'],'point':[0,0,0]}"
static const struct {
  const char *scene, *coupled, *path, *words;
  tdm_status status;
} bad[] = {
    /* a torque about the axis */
    {"{'bodies':[" ROD("a", "0.5") "],'joints':[" BALL
                                   "],'forces':[{'name':'w','type':'wrench','body':'a','moment':[1e-3,0,0]}]}",
     "", "mbd.bodies[0].inertia", "a torque of 0.001 N m", TDM_ERR_NUMERIC},
    /* particles beside it */
    {"{'bodies':[" ROD("a", "0.5") "],'joints':[" BALL "]}", "a", "coupling.bodies[0].mbd",
     "no inertia about its own axis", TDM_ERR_SCENE},
    /* two in a line, each of which the other holds */
    {"{'bodies':[" ROD("a", "0.5") "," ROD(
         "b", "1.5") "],'joints':[" BALL ",{'name':'f','type':'fixed','bodies':['a','b'],'point':[1,0,0]}]}",
     "", "mbd.bodies[1].inertia", "together with others", TDM_ERR_SCENE},
};

START_TEST(what_would_turn_it_is_refused) {
  run r;
  run_open(&r, bad[_i].scene, bad[_i].coupled);
  ck_assert_int_eq(r.status, bad[_i].status);
  ck_assert_str_eq(r.err.path, bad[_i].path);
  ck_assert_msg(strstr(r.err.message, bad[_i].words) != NULL, "%s", r.err.message);
  run_close(&r);
}
END_TEST

TEST_MAIN_ROWS("mbd_slim", {a_rod_on_a_ball_goes_round_in_a_cone, 3}, {a_hinged_rod_swings_as_any_other, 3},
               {what_would_turn_it_is_refused, sizeof bad / sizeof bad[0]})
