/* Light parts beside heavy ones: reactions and driver forces to 1e-6 for mass ratios up to 1e10, whichever holds the
 * other, with redundant rows and without, in every formulation. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/assembly/assemble.h"
#include "mbd/assembly/balance.h"
#include "mbd/scene/scene.h"
#include "tests/numerics/test_mbd_support.h"
#include "tests/test_main.h"

#include <math.h>

static const char *const formulation[] = {"ggl", "index3", "one_step"};
static const double ratio[] = {1, 1e4, 1e8, 1e10};
enum { RATIOS = sizeof ratio / sizeof ratio[0], WAYS = 2, LAYOUTS = 2, CASES = 3 * RATIOS * WAYS * LAYOUTS };

/* what a case is, from its number */
typedef struct {
  const char *formulation;
  double mass[2]; /* of the holder and of what it holds [kg] */
  bool redundant;
} light_case;

static light_case case_of(int i) {
  double r = ratio[i / 3 % RATIOS], heavy = 5e4;
  bool light_holds = i / (3 * RATIOS) % WAYS == 0;
  return (light_case){formulation[i % 3],
                      {light_holds ? heavy / r : heavy, light_holds ? heavy : heavy / r},
                      i / (3 * RATIOS * WAYS) % LAYOUTS == 1};
}

static int body_json(char *out, size_t size, const char *name, double mass, double x, double z, const char *rest) {
  return snprintf(out, size, "{'name':'%s','mass':%.17g,'inertia':[%.17g,%.17g,%.17g],'position':[%.17g,0,%.17g]%s}",
                  name, mass, 0.5 * mass, 0.4 * mass, 0.3 * mass, x, z, rest);
}

#define RELATIVE(x, y) CLOSE(x, y, 1e-6 * fabs(y))

/* A ram lifts a holder with what is flanged to it, up and down by a law; a second guide makes rows redundant. `off` is
 * how far the start is from fitting [m]. */
static void ram(light_case c, double off) {
  const double g = 9.81, amplitude = 0.05, w = 10;
  char scene[4096], holder[512], held[512], guide[256] = "";
  if (c.redundant)
    snprintf(guide, sizeof guide,
             ",{'name':'guide','type':'prismatic','bodies':['ground','held'],'points':[[1.2,0,1.5],[%.17g,0,%.17g]],"
             "'axis':[0,0,1]}",
             1.2 + off, 1.5 - off);
  body_json(holder, sizeof holder, "holder", c.mass[0], 0, 0.2, "");
  body_json(held, sizeof held, "held", c.mass[1], 0.3 + off, 1.5 - off, "");
  snprintf(scene, sizeof scene,
           "{'gravity':[0,0,-%g],'formulation':'%s','bodies':[%s,%s],'joints':[{'name':'ram','type':'prismatic',"
           "'bodies':['ground','holder'],'point':[0,0,0.2],'axis':[0,0,1]},{'name':'flange','type':'fixed','bodies':["
           "'holder','held'],'points':[[0,0,0.8],[%.17g,0,%.17g]]}%s],'drivers':[{'name':'lift','type':'linear_motor',"
           "'joint':'ram','motion':{'type':'harmonic','amplitude':%g,'omega':%g}}]}",
           g, c.formulation, holder, held, off, 0.8 - off, guide, amplitude, w);
  run r;
  run_open_good(&r, scene, "");
  for (int i = 0; i <= 4; i++) {
    double t = 0.01 * i, up = g - amplitude * w * w * sin(w * t);
    if (i > 0)
      run_to(&r, t);
    double lift = i > 0 ? run_value(&r, "driver.lift.force") : first(&r, "driver.lift.force");
    double flange = i > 0 ? run_value(&r, "joint.flange.fz") : first(&r, "joint.flange.fz");
    RELATIVE(lift, (c.mass[0] + c.mass[1]) * up);
    RELATIVE(flange, c.mass[1] * up);
    if (c.redundant)
      continue;
    double moment = i > 0 ? run_value(&r, "joint.flange.my") : first(&r, "joint.flange.my");
    RELATIVE(moment, -c.mass[1] * up * 0.3);
  }
  run_close(&r);
}

START_TEST(a_ram_feels_all_it_lifts) {
  ram(case_of(_i), 0);
}
END_TEST

/* the start is put right first, by Newton's iteration on all rows */
START_TEST(a_start_that_does_not_fit_is_put_right) {
  ram(case_of(_i), 1e-3);
}
END_TEST

/* A motor turns an arm about y; what it holds at its end hangs on a flange, and a hinge of its own on the same axis
 * makes rows redundant. */
START_TEST(a_motor_feels_all_it_turns) {
  const light_case c = case_of(_i);
  const double g = 9.81, rate = 3, arm = 2;
  char scene[4096], holder[512], held[512];
  body_json(holder, sizeof holder, "holder", c.mass[0], 0, 0, "");
  body_json(held, sizeof held, "held", c.mass[1], arm, 0, "");
  snprintf(scene, sizeof scene,
           "{'gravity':[0,0,-%g],'formulation':'%s','bodies':[%s,%s],'joints':[{'name':'hinge','type':'revolute',"
           "'bodies':['ground','holder'],'point':[0,0,0],'axis':[0,1,0]},{'name':'flange','type':'fixed','bodies':["
           "'holder','held'],'point':[%g,0,0]}%s],'drivers':[{'name':'motor','type':'rotational_motor','joint':"
           "'hinge','motion':{'type':'constant_rate','start':'step','rate':-%g}}]}",
           g, c.formulation, holder, held, arm,
           c.redundant ? ",{'name':'second','type':'revolute','bodies':['ground','held'],'point':[0,1,0],'axis':"
                         "[0,1,0]}"
                       : "",
           rate);
  run r;
  run_open_good(&r, scene, "");
  for (int i = 1; i <= 4; i++) {
    run_to(&r, 0.01 * i);
    double angle = rate * 0.01 * i, inward = c.mass[1] * arm * rate * rate;
    RELATIVE(run_value(&r, "driver.motor.torque"), -c.mass[1] * g * arm * cos(angle));
    if (c.redundant)
      continue;
    CLOSE(run_value(&r, "joint.flange.fx"), -inward * cos(angle), 1e-6 * c.mass[1] * g);
    CLOSE(run_value(&r, "joint.flange.fz"), c.mass[1] * g - inward * sin(angle), 1e-6 * c.mass[1] * g);
    RELATIVE(run_value(&r, "joint.hinge.fz"), (c.mass[0] + c.mass[1]) * g - inward * sin(angle));
  }
  run_close(&r);
}
END_TEST

/* A driven parallelogram of four hinges (three redundant rows) and the same with joints that leave none: forces in the
 * plane are the same. The bodies are heavy and light in turn. */
START_TEST(a_parallelogram_has_the_same_forces_with_looser_joints) {
  static const char *const last[] = {
      "{'name':'D','type':'revolute','bodies':['b','coupler'],'point':[2,0,1],'axis':[0,1,0]}",
      "{'name':'D','type':'point_on_line','bodies':['b','coupler'],'point':[2,0,1],'axis':[0,1,0]}"};
  const double r = ratio[_i / 3 % RATIOS], heavy = 5e4;
  const int light = _i / (3 * RATIOS);
  double mass[3] = {heavy, heavy, heavy};
  mass[light] /= r;
  run of[2];
  for (int k = 0; k < 2; k++) {
    char scene[4096], a[512], b[512], coupler[512];
    body_json(a, sizeof a, "a", mass[0], 0, 0.5, "");
    body_json(b, sizeof b, "b", mass[1], 2, 0.5, "");
    body_json(coupler, sizeof coupler, "coupler", mass[2], 1.2, 1, "");
    snprintf(scene, sizeof scene,
             "{'formulation':'%s','bodies':[%s,%s,%s],'joints':[{'name':'A','type':'revolute','bodies':['ground','a'],"
             "'point':[0,0,0],'axis':[0,1,0]},{'name':'B','type':'revolute','bodies':['ground','b'],'point':[2,0,0],"
             "'axis':[0,1,0]},{'name':'C','type':'revolute','bodies':['a','coupler'],'point':[0,0,1],'axis':[0,1,0]},"
             "%s],'drivers':[{'name':'motor','type':'rotational_motor','joint':'A','motion':{'type':'constant_rate',"
             "'start':'step','rate':2}}]}",
             formulation[_i % 3], a, b, coupler, last[k]);
    run_open_good(&of[k], scene, "");
    run_on(&of[k], 0.04, 0.01);
  }
  static const char *const joint[] = {"A", "B", "C", "D"};
  for (int i = 0; i < 4; i++) {
    double force[2][2];
    for (int k = 0; k < 2; k++)
      for (int c = 0; c < 2; c++) {
        char channel[32];
        snprintf(channel, sizeof channel, "joint.%s.f%c", joint[i], "xz"[c]);
        force[k][c] = run_value(&of[k], channel);
      }
    CLOSE(hypot(force[0][0] - force[1][0], force[0][1] - force[1][1]), 0, 1e-6 * hypot(force[1][0], force[1][1]));
  }
  RELATIVE(run_value(&of[0], "driver.motor.torque"), run_value(&of[1], "driver.motor.torque"));
  for (int k = 0; k < 2; k++)
    run_close(&of[k]);
}
END_TEST

/* A door whose two hinges share its weight does so whatever else is light or heavy, and the check finds the body whose
 * forces do not add up. */
START_TEST(forces_that_do_not_add_up_are_found) {
  json_t *json = scene_json("{'bodies':[{'name':'post','mass':1e-3,'inertia':[1e-4,1e-4,1e-4],'position':[0,0,0]},"
                            "{'name':'door','mass':1e4,'inertia':[1e3,1e3,1e3],'position':[1,0,0]}],'joints':[{'name':"
                            "'foot','type':'fixed','bodies':['ground','post'],'point':[0,0,-1]},{'name':'hinge','type'"
                            ":'revolute','bodies':['post','door'],'point':[0,0,0],'axis':[0,0,1]}]}");
  mbd_model *model = NULL;
  tdm_error err = {0};
  mbd_assembly assembly;
  ck_assert_int_eq(mbd_model_read(&model, json, false, &err), TDM_OK);
  mbd_data *data = mbd_data_create(model);
  mbd_kkt *kkt = mbd_kkt_create(model);
  ck_assert_int_eq(mbd_assemble(model, data, kkt, &assembly, &err), TDM_OK);
  ck_assert(mbd_accelerations(model, data, kkt, 0, data->y));
  ck_assert_int_eq(mbd_check_balance(model, data, &err), TDM_OK);
  data->lambda[2] *= 1 + 5e-7; /* the foot's force upwards, which acts on the post alone */
  ck_assert_int_eq(mbd_check_balance(model, data, &err), TDM_OK);
  data->lambda[2] *= 1 + 5e-6;
  ck_assert_int_eq(mbd_check_balance(model, data, &err), TDM_ERR_NUMERIC);
  ck_assert_str_eq(err.path, "mbd.bodies[0]");
  ck_assert_ptr_nonnull(strstr(err.message, "forces on body \"post\" do not add up"));
  mbd_kkt_destroy(&kkt);
  mbd_data_destroy(&data);
  mbd_model_destroy(&model);
  json_decref(json);
}
END_TEST

TEST_MAIN_ROWS("mbd_light", {a_ram_feels_all_it_lifts, CASES}, {a_start_that_does_not_fit_is_put_right, CASES},
               {a_motor_feels_all_it_turns, CASES},
               {a_parallelogram_has_the_same_forces_with_looser_joints, 3 * RATIOS * 3},
               {forces_that_do_not_add_up_are_found, 1})
