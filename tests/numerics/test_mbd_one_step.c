/* The one-step formulation: order, constraints, energy, loads that jump from window to window, samples inside a step.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/model/kin.h"
#include "test_mbd_support.h"
#include "tests/test_main.h"

#define HEAVY_TOP                                                                                              \
  "'bodies':[{'name':'top','mass':15,'inertia':[0.234375,0.46875,0.234375],'position':[0,1,0],"                \
  "'angular_velocity':[0,150,-4.61538],'velocity':[4.61538,0,0]}],'joints':[{'name':'tip','type':'spherical'," \
  "'bodies':['ground','top'],'point':[0,0,0]}]"
/* tilted axis, asymmetric body, spring and damper: nothing is zero by symmetry */
#define PENDULUM                                                                                             \
  "'bodies':[{'name':'bob','mass':2,'inertia':[0.3,0.2,0.4],'position':[1,0,0]}],'joints':[{'name':'hinge'," \
  "'type':'revolute','bodies':['ground','bob'],'point':[0,0,0],'axis':[0,1,0.3]}]"
#define DOUBLE                                                                                                   \
  "'bodies':[{'name':'a','mass':1,'inertia':[0.1,0.1,0.1],'position':[0.5,0,0]},{'name':'b','mass':1,'inertia':" \
  "[0.1,0.1,0.1],'position':[1.5,0,0]}],'joints':[{'name':'h1','type':'revolute','bodies':['ground','a'],"       \
  "'point':[0,0,0],'axis':[0,1,0]},{'name':'h2','type':'revolute','bodies':['a','b'],'point':[1,0,0],"           \
  "'axis':[0,1,0.2]}],'forces':[{'name':'s','type':'spring_damper','bodies':['ground','b'],'points':[[2,0,2],"   \
  "[1.5,0,0]],'stiffness':30,'damping':0.3}]"

/* steps as long as the window: the error test lets them be */
#define EQUAL_STEPS "'formulation':'one_step','solver':{'relative_tolerance':0.1}"

/* The state of `body` at `end` in windows of H; the largest constraint violation into *drift. */
static tdm_state state_at(const char *scene, const char *settings, const char *body, double end, double H,
                          double *drift) {
  char text[2048];
  snprintf(text, sizeof text, "{%s,%s}", scene, settings);
  run r;
  run_open_good(&r, text, body);
  long n = lround(end / H);
  double most = 0;
  for (long k = 1; k <= n; k++) {
    double t1 = end * (double)k / (double)n;
    if (k % 50 && k < n)
      run_window(&r, t1, NULL, 0, 0, NULL);
    else
      run_to(&r, t1);
    most = fmax(most, k % 50 && k < n ? 0 : run_value(&r, "constraint.drift"));
  }
  if (drift)
    *drift = most;
  tdm_state s = r.state[0];
  run_close(&r);
  return s;
}

START_TEST(test_order) {
  static const struct {
    const char *scene, *body;
    double end, H;
  } cases[] = {{PENDULUM, "bob", 1, 0.01}, {HEAVY_TOP, "top", 0.5, 1e-3}, {DOUBLE, "b", 1, 0.005}};
  const char *scene = cases[_i].scene, *body = cases[_i].body;
  tdm_state exact = state_at(scene, "'solver':{'relative_tolerance':1e-10,'max_step':1e-3}", body, cases[_i].end,
                             cases[_i].end, NULL);
  for (int radius = 0; radius < 3; radius++) {
    char settings[100];
    double error[3], drift;
    snprintf(settings, sizeof settings,
             "'formulation':'one_step','solver':{'spectral_radius':%g,'relative_tolerance':0.1}", 0.4 * radius);
    for (int k = 0; k < 3; k++) {
      error[k] = apart(exact, state_at(scene, settings, body, cases[_i].end, cases[_i].H / (1 << k), &drift));
      ck_assert_msg(drift < 1e-10, "drift %g", drift);
    }
    for (int k = 0; k < 2; k++) {
      double order = log2(error[k] / error[k + 1]);
      ck_assert_msg(order > 1.9 && order < 2.15, "case %d, radius %g: order %g", _i, 0.4 * radius, order);
    }
  }
}
END_TEST

/* Angle at time t of a bar that falls about its hinge from the horizontal, theta'' = k cos theta, by Runge and Kutta.
 */
static double falling_bar(double k, double t) {
  enum { STEPS = 20000 };
  double x = 0, v = 0, h = t / STEPS;
  for (int i = 0; i < STEPS; i++) {
    double v1 = v + h / 2 * k * cos(x), v2 = v + h / 2 * k * cos(x + h / 2 * v);
    double v3 = v + h * k * cos(x + h / 2 * v1), a1 = k * cos(x), a2 = k * cos(x + h / 2 * v);
    double a3 = k * cos(x + h / 2 * v1), a4 = k * cos(x + h * v2);
    x += h / 6 * (v + 2 * v1 + 2 * v2 + v3);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return x;
}

/* What Newton's iteration and rounding leave of positions must not come back divided by the step: second order down to
 * steps of 1e-6 s, for IDA no loss of digits. */
START_TEST(test_tiny_steps) {
  static const char bar[] =
      "{'gravity':[0,0,-981],%s,'bodies':[{'name':'bar','mass':2,'inertia':[0.03,0.03,0.03],'position':[0.2,0,0]}],"
      "'joints':[{'name':'pin','type':'revolute','bodies':['ground','bar'],'point':[0,0,0],'axis':[0,1,0]}]}";
  const double end = 0.05, exact = falling_bar(2 * 981 * 0.2 / (0.03 + 2 * 0.04), end);
  double error[2];
  for (int fine = 0; fine < 2; fine++) {
    run r;
    char scene[512];
    snprintf(scene, sizeof scene, bar, _i ? "'formulation':'ggl'" : EQUAL_STEPS);
    run_open_good(&r, scene, "bar");
    int n = fine ? 50000 : 5000;
    for (int k = 1; k < n; k++)
      run_window(&r, end * k / n, NULL, 0, 0, NULL);
    run_to(&r, end);
    error[fine] = fabs(run_value(&r, "joint.pin.angle") - exact);
    run_close(&r);
  }
  double order = log10(error[0] / error[1]);
  if (_i)
    ck_assert_msg(error[0] < 1e-8 && error[1] < 1e-9, "ggl: errors %g, %g", error[0], error[1]);
  else
    ck_assert_msg(error[0] < 3e-7 && order > 1.9 && order < 2.1, "errors %g, %g", error[0], error[1]);
}
END_TEST

/* the trajectory that two formulations agree on to 1e-11 */
START_TEST(test_heavy_top) {
  const tdm_vec3 exact = {-0.702468297057, -0.021165184701, -0.711400257652};
  double drift;
  tdm_state s = state_at(HEAVY_TOP, "'formulation':'one_step'", "top", 0.5, 2e-5, &drift);
  ck_assert_double_lt(tdm_norm(tdm_sub(s.pose.position, exact)), 2e-6);
  ck_assert_double_lt(drift, 1e-10);
}
END_TEST

/* no damping but the method's own: the energy of a swing stays */
START_TEST(test_energy) {
  run r;
  run_open_good(&r, "{" PENDULUM ",'formulation':'one_step'}", "bob");
  run_to(&r, 1e-3);
  double first = run_value(&r, "energy.kinetic") + run_value(&r, "energy.potential"), most = 0, kinetic = 0;
  for (int k = 2; k <= 50000; k++)
    if (k % 100)
      run_window(&r, 1e-3 * k, NULL, 0, 0, NULL);
    else {
      run_to(&r, 1e-3 * k);
      kinetic = fmax(kinetic, run_value(&r, "energy.kinetic"));
      most = fmax(most, fabs(run_value(&r, "energy.kinetic") + run_value(&r, "energy.potential") - first));
    }
  ck_assert_msg(most < 2e-5 * kinetic, "energy: %g of %g", most, kinetic);
  run_close(&r);
}
END_TEST

#define GUIDE(k, c)                                                                                          \
  "{'gravity':[0,0,0]," EQUAL_STEPS ",'bodies':[{'name':'box','mass':2,'inertia':[1,1,1],'position':"        \
  "[0,0,0]}],'joints':[{'name':'guide','type':'prismatic','bodies':['ground','box'],'point':[0,0,0],'axis':" \
  "[0,0,1]}],'forces':[{'name':'spring','type':'spring_damper','bodies':['ground','box'],'points':[[0,0,1]," \
  "[0,0,0]],'stiffness':" k ",'damping':" c "}]}"

/* A load that is another polynomial in each window: impulse and way are exact, whatever the window. */
START_TEST(test_impulse) {
  static const double windows[] = {1e-2, 1e-5, 1e-7};
  run r;
  uint64_t draw = 7;
  double v = 0, x = 0, H = windows[_i];
  run_open_good(&r, GUIDE("0", "0"), "box");
  for (int k = 0; k < 300; k++) {
    tdm_wrench load[4] = {{{0, 0, 0}, {0, 0, 0}}};
    double c[4];
    for (int j = 0; j < 4; j++) {
      c[j] = 100 * noise(&draw);
      load[j].force = tdm_v3(noise(&draw), noise(&draw), c[j]);
    }
    int n = 1 + k / 75; /* constants first, up to cubics */
    run_window(&r, H * (k + 1), load, n, 0, NULL);
    x += H * v;
    for (int j = 0; j < n; j++) {
      v += H * c[j] / 2 / (j + 1);
      x += H * H * c[j] / 2 / (j + 1) / (j + 2);
    }
    CLOSE(r.state[0].twist.velocity.z, v, 1e-12);
    CLOSE(r.state[0].pose.position.z, x, 1e-12);
  }
  run_close(&r);
}
END_TEST

/* Damping far too stiff for the step, from a start out of its equilibrium, with a start in each window and without. */
START_TEST(test_stiff_start) {
  static const double radius[] = {0.8, 1, 0};
  for (int i = 0; i < 6; i++) {
    run r;
    char scene[1024];
    snprintf(
        scene, sizeof scene,
        "{'formulation':'one_step','restart_each_window':%s,'bodies':[{'name':'box','mass':1,'inertia':[1,1,1],"
        "'position':[0,0,-1]}],'joints':[{'name':'guide','type':'prismatic','bodies':['ground','box'],'point':[0,0,"
        "0],'axis':[0,0,1]}],'forces':[{'name':'s','type':'spring_damper','bodies':['ground','box'],'points':[[0,0,0],"
        "[0,0,-1]],'stiffness':1,'damping':1e7}],'solver':{'spectral_radius':%g}}",
        i % 2 ? "true" : "false", radius[i / 2]);
    run_open_good(&r, scene, "box");
    for (int k = 0; k < 100; k++) {
      run_window(&r, 1e-3 * (k + 1), NULL, 0, 0, NULL);
      double v = r.state[0].twist.velocity.z;
      ck_assert_msg(fabs(v / -9.81e-7 - 1) < 1e-3, "case %d, window %d: %g m/s", i, k, v);
    }
    run_close(&r);
  }
}
END_TEST

/* a start in each window costs no order */
START_TEST(test_restarts) {
  tdm_state exact = state_at(DOUBLE, "'solver':{'relative_tolerance':1e-10,'max_step':1e-3}", "b", 1, 1, NULL);
  double error[2];
  for (int k = 0; k < 2; k++)
    error[k] = apart(exact, state_at(DOUBLE, EQUAL_STEPS ",'restart_each_window':true", "b", 1, 0.005 / (1 + k), NULL));
  ck_assert_msg(error[0] > 3.7 * error[1], "errors %g, %g", error[0], error[1]);
}
END_TEST

/* White noise on an oscillator, constant in each window, against the exact solution: second order, and no ringing. */
START_TEST(test_white_noise) {
  double error[2];
  for (int fine = 0; fine < 2; fine++) {
    /* m = 2, k = 5000, c = 20: w = 50, decay 5 */
    const double d = 5, w = sqrt(2500 - 25), H = 2e-3 / (1 + fine);
    double C = exp(-d * H) * cos(w * H), S = exp(-d * H) * sin(w * H) / w, x = 0, v = 0, sum = 0, worst = 0, force = 0;
    run r;
    uint64_t draw = 3;
    run_open_good(&r, GUIDE("5000", "20"), "box");
    for (int k = 0; k < 2000 * (1 + fine); k++) {
      force = fine && k % 2 ? force : 100 * noise(&draw);
      tdm_wrench load = {{0, 0, force}, {0, 0, 0}};
      run_window(&r, H * (k + 1), &load, 1, 0, NULL);
      double rest = force / 5000, y = x - rest, u = v;
      x = rest + C * y + S * (u + d * y);
      v = C * u - S * (2500 * y + d * u);
      sum += v * v;
      worst = fmax(worst, fabs(v - r.state[0].twist.velocity.z));
    }
    error[fine] = worst / sqrt(sum / (2000 * (1 + fine)));
    run_close(&r);
  }
  ck_assert_msg(error[0] < 0.02 && error[0] > 3.7 * error[1], "errors %g, %g", error[0], error[1]);
}
END_TEST

/* Samples inside a long step against the same by IDA. */
START_TEST(test_samples) {
  double error[2];
  for (int fine = 0; fine < 2; fine++) {
    run a, b;
    double H = 0.02 / (1 + fine), worst = 0;
    run_open_good(&a, "{" DOUBLE ",'formulation':'one_step','solver':{'max_step':1,'relative_tolerance':0.1}}", "b");
    run_open_good(&b, "{" DOUBLE ",'solver':{'relative_tolerance':1e-10}}", "b");
    for (int k = 0; k < 20 * (1 + fine); k++) {
      double time[4] = {H * (k + 0.2), H * (k + 0.5), H * (k + 0.9), H * (k + 1)};
      run_window(&a, H * (k + 1), NULL, 0, 4, time);
      run_window(&b, H * (k + 1), NULL, 0, 4, time);
      for (int i = 0; i < 4; i++)
        worst = fmax(worst, apart(a.sample[i], b.sample[i]));
      ck_assert_mem_eq(&a.sample[3], &a.state[0], sizeof a.state[0]);
    }
    error[fine] = worst;
    run_close(&a);
    run_close(&b);
  }
  ck_assert_msg(error[0] < 4e-3 && error[0] > 3.7 * error[1], "errors %g, %g", error[0], error[1]);
}
END_TEST

/* the work of a motor that runs up a pendulum, in the balance of energies: second order */
START_TEST(test_work) {
  double worst[2] = {0, 0};
  for (int fine = 0; fine < 2; fine++) {
    run r;
    double H = 0.01 / (1 + fine);
    run_open_good(&r,
                  "{'bodies':[{'name':'bob','mass':1,'inertia':[0.1,0.1,0.1],'position':[1,0,0]}],'joints':[{'name':"
                  "'hinge','type':'revolute','bodies':['ground','bob'],'point':[0,0,0],'axis':[0,1,0]}],'drivers':[{"
                  "'name':'motor','type':'rotational_motor','joint':'hinge','motion':{'type':'constant_rate','rate':"
                  "10,'start':'smooth','rise':0.5}}],'formulation':'one_step'}",
                  "bob");
    for (int k = 0; k < 100 * (1 + fine); k++) {
      run_to(&r, H * (k + 1));
      worst[fine] = fmax(worst[fine], fabs(run_value(&r, "energy.balance")));
    }
    run_close(&r);
  }
  ck_assert_msg(worst[0] < 0.05 && worst[0] > 3.7 * worst[1], "balance %g, %g J of 65 J", worst[0], worst[1]);
}
END_TEST

/* windows that max_step divides are as many short windows */
START_TEST(test_max_step) {
  tdm_state a = state_at(DOUBLE, "'formulation':'one_step','solver':{'max_step':0.0025,'relative_tolerance':0.1}", "b",
                         0.5, 0.01, NULL);
  tdm_state b = state_at(DOUBLE, EQUAL_STEPS, "b", 0.5, 0.0025, NULL);
  ck_assert_double_lt(apart(a, b), 1e-9);
  run r;
  run_open(&r, "{" DOUBLE ",'solver':{'spectral_radius':1.1}}", "b");
  ck_assert_int_eq(r.status, TDM_ERR_SCENE);
  ck_assert_str_eq(r.err.path, "mbd.solver.spectral_radius");
  run_close(&r);
}
END_TEST

/* a planar four-bar of revolute joints: three of its rows follow from the others */
#define FOUR_BAR                                                                                                    \
  "'gravity':[0,-9.81,0],'bodies':[{'name':'a','mass':1,'inertia':[0.01,0.08,0.08],'position':[0,0.5,0],'velocity'" \
  ":[0.5,0,0],'angular_velocity':[0,0,-1]},{'name':'b','mass':1,'inertia':[0.01,0.08,0.08],'position':[0.5,1,0],"   \
  "'velocity':[1,0,0]},{'name':'c','mass':1,'inertia':[0.01,0.08,0.08],'position':[1,0.4,0]}],'joints':[{'name':"   \
  "'p','type':'revolute','bodies':['ground','a'],'point':[0,0,0],'axis':[0,0,1]},{'name':'q','type':'revolute',"    \
  "'bodies':['a','b'],'point':[0,1,0],'axis':[0,0,1]},{'name':'r','type':'revolute','bodies':['b','c'],'point':"    \
  "[1,1,0],'axis':[0,0,1]},{'name':'s','type':'revolute','bodies':['c','ground'],'point':[1.2,-0.2,0],'axis':"      \
  "[0,0,1]}]"

START_TEST(test_redundant) {
  double drift;
  tdm_state exact = state_at(FOUR_BAR, "'solver':{'relative_tolerance':1e-10}", "b", 1, 0.1, NULL), one[2];
  for (int k = 0; k < 2; k++) {
    one[k] = state_at(FOUR_BAR, EQUAL_STEPS, "b", 1, 1e-3 / (1 + k), &drift);
    ck_assert_double_lt(drift, 1e-10);
  }
  double coarse = apart(exact, one[0]), fine = apart(exact, one[1]);
  ck_assert_msg(coarse < 1e-3 && coarse > 3.5 * fine, "errors %g, %g", coarse, fine);
}
END_TEST

/* 1e4 rpm, a hundredth of a radian and a radian a window: the second is too coarse to be right, but holds together */
START_TEST(test_fast) {
  for (int coarse = 0; coarse < 2; coarse++) {
    run r;
    double H = coarse ? 1e-3 : 1e-5, most = 0;
    run_open_good(&r,
                  "{'bodies':[{'name':'rotor','mass':2,'inertia':[0.3,0.2,0.4],'position':[0.1,0,0],'velocity':[0,0,"
                  "-104.71975511965977],'angular_velocity':[0,1047.1975511965977,0]}],'joints':[{'name':'hinge','type':"
                  "'revolute','bodies':['ground','rotor'],'point':[0,0,0],'axis':[0,1,0]}],'formulation':'one_step'}",
                  "rotor");
    for (int k = 0; k < 500; k++) {
      run_to(&r, H * (k + 1));
      most = fmax(most, run_value(&r, "constraint.drift"));
    }
    ck_assert_double_lt(most, 1e-10);
    if (!coarse)
      CLOSE(r.state[0].twist.angular.y, 1047.1975511965977, 0.01);
    long steps = run_close_steps(&r);
    if (!coarse)
      ck_assert_int_eq(steps, 500);
  }
}
END_TEST

#define WHEEL(name, x, w) \
  "{'name':'" name "','mass':1,'inertia':[0.1,0.1,0.1],'position':[" x ",0,0],'angular_velocity':[0,0," w "]}"
#define SHAFT(name, wheel, x) \
  "{'name':'" name "','type':'revolute','bodies':['ground','" wheel "'],'point':[" x ",0,0],'axis':[0,0,1]}"
#define GEARS(w1, w2, ratio)                                                                               \
  "{'formulation':'one_step','bodies':[" WHEEL("a", "0", w1) "," WHEEL("b", "3", w2) "],'joints':[" SHAFT( \
      "s", "a", "0") "," SHAFT("t", "b", "3") ",{'name':'g','type':'gear','joints':['s','t'],'ratio':" ratio "}]}"

/* many turns leave rounding errors in proportion to the angle */
START_TEST(test_many_turns) {
  run r;
  run_open_good(&r, GEARS("100", "-270.27027027027026", "0.37"), "a");
  for (int k = 0; k < 5000; k++)
    run_to(&r, 1e-2 * (k + 1));
  CLOSE(run_value(&r, "joint.s.angle"), 5000, 1e-9);
  ck_assert_double_lt(run_value(&r, "constraint.drift"), 5e-12);
  run_close(&r);
}
END_TEST

/* Many radians in a window: steps of a radian or less, so that angles are counted right. */
START_TEST(test_turns_in_a_window) {
  static const char *const scenes[] = {
      GEARS("100", "-10000", "0.01"),
      "{'gravity':[0,0,0],'formulation':'one_step','bodies':[{'name':'a','mass':1,'inertia':[0.1,0.1,0.1],"
      "'position':[0,0,0],'velocity':[0,0,0.15915494309189535],'angular_velocity':[0,0,100]}],'joints':[{'name':'s',"
      "'type':'screw','bodies':['ground','a'],'point':[0,0,0],'axis':[0,0,1],'pitch':0.01}]}",
      /* from rest: 1 rad/s by the load in the first window, 100 at the end */
      "{'gravity':[0,0,0],'formulation':'one_step','bodies':[{'name':'a','mass':1,'inertia':[0.1,0.1,0.1],"
      "'position':[0,0,0]}],'joints':[{'name':'s','type':'revolute','bodies':['ground','a'],'point':[0,0,0],'axis':"
      "[0,0,1]}],'forces':[{'name':'t','type':'torsional_spring_damper','joint':'s','stiffness':0}]}"};
  run r;
  const tdm_wrench load = {{0, 0, 0}, {0, 0, 0.1 * 200}};
  run_open_good(&r, scenes[_i], "a");
  for (int k = 0; k < 10; k++) {
    double t1 = 0.1 * (k + 1);
    run_window(&r, t1, &load, _i == 2, 1, &t1);
  }
  CLOSE(run_value(&r, "joint.s.angle"), 100, 1e-9);
  if (_i == 1)
    CLOSE(run_value(&r, "joint.s.translation"), 0.15915494309189535, 1e-12);
  if (_i == 2)
    CLOSE(run_value(&r, "force.t.angle"), 100, 1e-9);
  run_close(&r);
}
END_TEST

/* the interval of outputs is the step in a window of many, unless max_step says otherwise */
START_TEST(test_steps_of_samples) {
  double time[20];
  for (int coarse = 0; coarse < 2; coarse++) {
    run r;
    run_open_good(&r,
                  coarse ? "{" DOUBLE ",'formulation':'one_step','solver':{'max_step':0.05,'relative_tolerance':0.1}}"
                         : "{" DOUBLE "," EQUAL_STEPS "}",
                  "b");
    for (int k = 0; k < 20; k++)
      time[k] = 0.005 * (k + 1);
    run_window(&r, time[19], NULL, 0, 20, time);
    ck_assert_int_eq(run_close_steps(&r), coarse ? 2 : 20);
  }
}
END_TEST

/* a four-bar of a millimetre, a metre away: rounding of positions turns its links */
START_TEST(test_small_and_far) {
  run r;
  double most = 0;
  run_open_good(
      &r,
      "{'gravity':[0,-9.81,0]," EQUAL_STEPS ",'bodies':[{'name':'a','mass':1,'inertia':[1e-7,1e-7,1e-7],"
      "'position':[1,0.0005,0]},{'name':'b','mass':1,'inertia':[1e-7,1e-7,1e-7],'position':[1.0005,0.00115,0]},"
      "{'name':'c','mass':1,'inertia':[2e-7,2e-7,2e-7],'position':[1.0011,0.00055,0]}],'joints':[{'name':'p','type':"
      "'revolute','bodies':['ground','a'],'point':[1,0,0],'axis':[0,0,1]},{'name':'q','type':'revolute','bodies':['a',"
      "'b'],'point':[1,0.001,0],'axis':[0,0,1]},{'name':'r','type':'revolute','bodies':['b','c'],'point':[1.001,0.0013,"
      "0],'axis':[0,0,1]},{'name':'s','type':'revolute','bodies':['c','ground'],'point':[1.0012,-0.0002,0],'axis':[0,0,"
      "1]}]}",
      "a");
  for (int k = 0; k < 5000; k++) {
    run_to(&r, 1e-5 * (k + 1));
    most = fmax(most, run_value(&r, "constraint.drift"));
  }
  ck_assert_msg(most < 1e-14, "drift %g", most);
  CLOSE(run_value(&r, "energy.balance"), 0, 1e-6);
  ck_assert_int_eq(run_close_steps(&r), 5000); /* none was halved */
}
END_TEST

/* ---- the error test ---- */

/* a body on a rail that meets a stop at z = 0 from `height`; settings, mass 2 kg */
#define FALL(gravity, height, speed, exponent, damping)                                                           \
  "{'gravity':[0,0," gravity "],%s,'bodies':[{'name':'b','mass':2,'inertia':[1,1,1],'position':[0,0," height      \
  "],'velocity':[0,0," speed "]}],'joints':[{'name':'rail','type':'prismatic','bodies':['ground','b'],'point':[0" \
  ",0," height "],'axis':[0,0,1]}],'forces':[{'name':'floor','type':'stop','joint':'rail','lower':-" height       \
  ",'stiffness':2e7,'exponent':" exponent ",'damping':" damping "}]}"

/* A fall onto an elastic stop in windows of many contacts' length: what the energy is off by, of 118 J, after six
 * impacts goes with the tolerance to the power of 2/3. */
START_TEST(test_bouncing) {
  static const double tolerance[] = {1e-5, 1e-7, 1e-9};
  double off[3];
  for (int k = 0; k < 3; k++) {
    run r;
    char scene[1024], settings[128];
    snprintf(settings, sizeof settings, "'formulation':'one_step','solver':{'relative_tolerance':%g}", tolerance[k]);
    snprintf(scene, sizeof scene, FALL("-9.81", "6", "0", "1.5", "0"), settings);
    run_open_good(&r, scene, "b");
    double most = 0;
    for (int i = 1; i <= 65; i++) { /* windows of 0.2 s, contacts of 3 ms */
      run_to(&r, 0.2 * i);
      if (run_value(&r, "force.floor.value") == 0)
        most = fmax(most, fabs(energy(&r) - first_energy(&r)));
    }
    off[k] = most;
    run_close(&r);
  }
  ck_assert_msg(off[0] < 0.2 && off[1] < off[0] && 200 * off[2] < off[0], "energy off by %g, %g, %g J", off[0], off[1],
                off[2]);
}
END_TEST

/* Restitution of k d^n (1 + c d'): v1 = e v0 with X = c v0 and X - ln(1 + X) = -e X - ln(1 - e X), whatever n and k
 * (Hunt & Crossley 1975, integrated). In one window that holds the whole impact. */
START_TEST(test_restitution) {
#define IMPACT(exponent, damping) FALL("0", "0.01", "-2", exponent, damping)
  static const double X[] = {0.37315, 1.43275, 4.9192}; /* e = 0.8, 0.5, 0.2 */
  static const char *const scenes[] = {IMPACT("1", "0.186575"),   IMPACT("1", "0.716375"),   IMPACT("1", "2.4596"),
                                       IMPACT("1.5", "0.186575"), IMPACT("1.5", "0.716375"), IMPACT("1.5", "2.4596")};
  static const char *const formulation[] = {"ggl", "one_step"};
  for (int i = 0; i < 12; i++) {
    run r;
    char scene[1024], settings[128];
    const double x = X[i % 3];
    double e = 0, above = 1 / x; /* by halves: the right side grows with e */
    for (int k = 0; k < 60; k++) {
      double middle = 0.5 * (e + above);
      *(-middle * x - log(1 - middle * x) < x - log(1 + x) ? &e : &above) = middle;
    }
    snprintf(settings, sizeof settings, "'formulation':'%s','solver':{'relative_tolerance':1e-10}", formulation[i / 6]);
    snprintf(scene, sizeof scene, scenes[i % 6], settings);
    run_open_good(&r, scene, "b");
    run_to(&r, 0.1);
    CLOSE(r.state[0].twist.velocity.z / 2, e, 1e-6);
    run_close(&r);
  }
}
END_TEST

/* A force that grows evenly in one long window: the way is right to tolerance^(2/3) of itself. */
START_TEST(test_long_window) {
  run r;
  double t1 = 1;
  run_open_good(
      &r,
      "{'gravity':[0,0,0],'formulation':'one_step','bodies':[{'name':'b','mass':2,'inertia':[1,1,1],'position':"
      "[0,0,0]}],'forces':[{'name':'f','type':'wrench','body':'b','force':[6,0,0],'factor':{'type':"
      "'polynomial','coefficients':[0,1]}}]}",
      "b");
  run_window(&r, t1, NULL, 0, 0, NULL);
  CLOSE(r.state[0].twist.velocity.x, 1.5, 1e-9);
  CLOSE(r.state[0].pose.position.x, 0.5, 0.5 * 5e-6);
  run_close(&r);
}
END_TEST

/* a load without bounds ends the run with time and advice */
START_TEST(test_bad_load) {
  run r;
  tdm_wrench load = {{0, 0, 1e300}, {0, 0, 0}};
  run_open_good(&r, "{" PENDULUM ",'formulation':'one_step'}", "bob");
  run_to(&r, 1e-3);
  ck_assert_int_eq(run_step(&r, 2e-3, &load, 1, 0, NULL), TDM_ERR_NUMERIC);
  ck_assert_ptr_nonnull(strstr(r.err.message, "t = 0.001 s"));
  run_close(&r);
}
END_TEST

TEST_MAIN_ROWS("mbd_one_step", {test_order, 3}, {test_heavy_top, 1}, {test_energy, 1}, {test_impulse, 3},
               {test_stiff_start, 1}, {test_restarts, 1}, {test_white_noise, 1}, {test_samples, 1}, {test_work, 1},
               {test_max_step, 1}, {test_redundant, 1}, {test_fast, 1}, {test_many_turns, 1},
               {test_turns_in_a_window, 3}, {test_steps_of_samples, 1}, {test_small_and_far, 1}, {test_bad_load, 1},
               {test_tiny_steps, 2}, {test_bouncing, 1}, {test_restitution, 1}, {test_long_window, 1})
