/* Drivers: the motion law, a pendulum that a motor turns ([L18] Eq. 20-22 with the signs mended), rotors without a
 * fixed body, the motor's work, velocities at the start.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/motion/motion.h"
#include "tests/numerics/test_mbd_support.h"
#include "tests/test_main.h"

/* ---- the law by itself ---- */

static tdm_motion motion_of(const char *text) {
  tdm_motion motion = {0};
  tdm_error err = {0};
  json_t *json = scene_json("%s", text);
  tdm_object o = tdm_object_open(json, "", &err);
  tdm_motion_read(&motion, &o, "motion");
  ck_assert_msg(!err.status, "%s: %s", err.path, err.message);
  json_decref(json);
  return motion;
}

/* constant rate w, reached within `rise` [s]; 0: at once */
static tdm_motion rate_law(double w, double rise) {
  char text[160], smooth[48];
  snprintf(smooth, sizeof smooth, "'smooth','rise':%.17g", rise);
  snprintf(text, sizeof text, "{'motion':{'type':'constant_rate','rate':%.17g,'start':%s}}", w,
           rise > 0 ? smooth : "'step'");
  return motion_of(text);
}

/* value, rate and acceleration of every law at 0, and the rates against differences of the values over [-0.2, 2] */
START_TEST(test_laws) {
  static const struct {
    const char *text;
    double value, rate, acceleration;
  } laws[] = {
      {"{'motion':{'type':'constant','value':0.7}}", 0.7, 0, 0},
      {"{'motion':{'type':'polynomial','coefficients':[1,-2,3,0.5]}}", 1, -2, 6},
      {"{'motion':{'type':'harmonic','amplitude':2,'frequency':1.5,'phase':0.5,'mean':-1}}", -1 + 2 * 0.479425538604203,
       2 * 3 * M_PI * 0.8775825618903728, -2 * 9 * M_PI * M_PI * 0.479425538604203},
      {"{'motion':{'type':'harmonic','amplitude':2,'omega':3}}", 0, 6, 0},
      {"{'motion':{'type':'step','from':1,'to':3,'start':0.3,'rise':1}}", 1, 0, 0},
      /* x = t^3 - t, odd about 0, where a natural spline on symmetric points has no second derivative */
      {"{'motion':{'type':'table','times':[-1,-0.5,0,0.5,1],'values':[0,0.375,0,-0.375,0],"
       "'interpolation':'cspline'}}",
       0, NAN, 0},
      {"{'motion':{'type':'table','times':[-1,0,0.7,2],'values':[0,1,3,3],'interpolation':'steffen','after':'hold'}}",
       1, NAN, NAN},
      {"{'motion':{'type':'table','times':[0,0.25,0.5,0.75,1],'values':[0,1,0,-1,0],'interpolation':'periodic'}}", 0,
       NAN, 0},
      {"{'motion':{'type':'triangle','rate':-3,'period':1.5,'corner':0.5}}", 0, -3, 0},
      {"{'motion':{'type':'sum','laws':[{'type':'polynomial','coefficients':[1,-2]},"
       "{'type':'triangle','amplitude':0.6,'period':1.2,'corner':0.6},{'type':'sum','laws':["
       "{'type':'harmonic','amplitude':2,'omega':3}]}]}}",
       1, 5, 0},
  };
  for (size_t i = 0; i < sizeof laws / sizeof laws[0]; i++) {
    tdm_motion m = motion_of(laws[i].text);
    tdm_motion_value x = tdm_motion_at(&m, 0);
    CLOSE(x.value, laws[i].value, 1e-13);
    if (!isnan(laws[i].rate))
      CLOSE(x.rate, laws[i].rate, 1e-13);
    if (!isnan(laws[i].acceleration))
      CLOSE(x.acceleration, laws[i].acceleration, 1e-12);
    const double h = 1e-6;
    for (double t = -0.2013; t < 2; t += 0.0373) {
      tdm_motion_value lo = tdm_motion_at(&m, t - h), at = tdm_motion_at(&m, t), hi = tdm_motion_at(&m, t + h);
      CLOSE(at.rate, (hi.value - lo.value) / (2 * h), 1e-7);
      CLOSE(at.acceleration, (hi.rate - lo.rate) / (2 * h), 1e-5);
    }
    tdm_motion_clear(&m);
  }
}
END_TEST

/* a table from a file, with a line of names, comments and several separators, is that of the scene */
START_TEST(test_law_file) {
  const char *file = TANDEM_TEST_DIR "/test_mbd_law.csv";
  FILE *f = fopen(file, "w");
  ck_assert_ptr_nonnull(f);
  fputs("time,angle\n# measured\n0, 0\n0.5;1e-1\n\n1 0.3\r\n2\t-0.2\n", f);
  fclose(f);
  tdm_motion a = motion_of("{'motion':{'type':'table','file':'" TANDEM_TEST_DIR "/test_mbd_law.csv'}}");
  tdm_motion b = motion_of("{'motion':{'type':'table','times':[0,0.5,1,2],'values':[0,0.1,0.3,-0.2]}}");
  for (double t = 0; t <= 2; t += 0.1)
    CLOSE(tdm_motion_at(&a, t).value, tdm_motion_at(&b, t).value, 0);
  CLOSE(tdm_motion_at(&a, 1).value, 0.3, 1e-15);
  tdm_motion_clear(&a);
  tdm_motion_clear(&b);

  f = fopen(file, "w");
  fputs("time,angle\n0,0\n0.5\n1,2\n", f);
  fclose(f);
  tdm_motion bad = {0};
  tdm_error err = {0};
  json_t *json = scene_json("{'motion':{'type':'table','file':'" TANDEM_TEST_DIR "/test_mbd_law.csv'}}");
  tdm_object o = tdm_object_open(json, "", &err);
  tdm_motion_read(&bad, &o, "motion");
  ck_assert_int_eq(err.status, TDM_ERR_FILE);
  ck_assert_msg(strstr(err.message, "line 3") != NULL, "%s", err.message);
  tdm_motion_clear(&bad);
  json_decref(json);
}
END_TEST

/* a table stays between its points unless the scene asks for a spline, which does not */
START_TEST(test_law_between) {
  static const char *const more[] = {"", ",'interpolation':'cspline'"};
  for (int k = 0; k < 2; k++) {
    char text[256];
    snprintf(text, sizeof text, "{'motion':{'type':'table','times':[0,1,2,3,4,5],'values':[0,0,0,1,1,1]%s}}", more[k]);
    tdm_motion m = motion_of(text);
    double least = 0, most = 1;
    for (double t = 0; t <= 5; t += 0.01) {
      least = fmin(least, tdm_motion_at(&m, t).value);
      most = fmax(most, tdm_motion_at(&m, t).value);
    }
    if (k == 0) {
      CLOSE(least, 0, 1e-15);
      CLOSE(most, 1, 1e-15);
    } else {
      ck_assert_double_gt(most, 1.1);
      ck_assert_double_lt(least, -0.1);
    }
    tdm_motion_clear(&m);
  }
}
END_TEST

/* the end of a smooth step, a table that repeats, one that holds */
START_TEST(test_law_ends) {
  tdm_motion m = motion_of("{'motion':{'type':'step','from':1,'to':3,'start':0.3,'rise':1}}");
  CLOSE(tdm_motion_at(&m, 0.8).value, 2, 1e-15);
  CLOSE(tdm_motion_at(&m, 5).value, 3, 0);
  CLOSE(tdm_motion_at(&m, 5).rate, 0, 0);
  tdm_error err = {0};
  tdm_motion_clear(&m);
  m = motion_of("{'motion':{'type':'table','times':[0,1,2,3],'values':[0,2,2,0],'interpolation':'periodic'}}");
  for (int k = -2; k <= 2; k++)
    CLOSE(tdm_motion_at(&m, 0.37 + 3 * k).value, tdm_motion_at(&m, 0.37).value, 1e-14);
  ck_assert_int_eq(tdm_motion_check(&m, -100, 100, "p", "m", &err), TDM_OK);
  tdm_motion_clear(&m);
  m = motion_of("{'motion':{'type':'table','times':[0,1,2,3],'values':[0,2,3,3],'interpolation':'steffen','after':"
                "'hold'}}");
  ck_assert_int_eq(tdm_motion_check(&m, 0, 100, "p", "m", &err), TDM_OK);
  CLOSE(tdm_motion_at(&m, 50).value, 3, 0);
  CLOSE(tdm_motion_at(&m, 50).rate, 0, 0);
  tdm_motion_clear(&m);
  m = motion_of("{'motion':{'type':'table','times':[0,2],'values':[1,5]}}");
  CLOSE(tdm_motion_at(&m, 0.5).value, 2, 1e-15);
  CLOSE(tdm_motion_at(&m, 0.5).rate, 2, 1e-15);
  CLOSE(tdm_motion_at(&m, 0.5).acceleration, 0, 0);
  tdm_motion_clear(&m);
  m = motion_of("{'motion':{'type':'table','times':[0,1,2],'values':[0,2,3]}}");
  ck_assert_int_eq(tdm_motion_check(&m, 0, 2, "p", "m", &err), TDM_OK);
  ck_assert_int_eq(tdm_motion_check(&m, 0, 2.001, "p", "m", &err), TDM_ERR_SCENE);
  ck_assert_ptr_nonnull(strstr(err.message, "ends at t = 2 s"));
  err.status = TDM_OK;
  ck_assert_int_eq(tdm_motion_check(&m, -1, 2, "p", "m", &err), TDM_ERR_SCENE);
  ck_assert_ptr_nonnull(strstr(err.message, "begins"));
  tdm_motion_clear(&m);
}
END_TEST

/* [A07] Eq. (4.7) with its second branch mended */
static double printed_triangle(double w, double period, double t) {
  const double s = t - floor(t / period) * period;
  return s <= period / 2 ? w * s : w * (period - s);
}

/* off its corners the triangle is the printed one; at them it is smooth: the acceleration grows from either end with
 * the square of the distance, at most to 3.75 w/T, and turns the rate; the first one is sharp */
START_TEST(test_law_triangle) {
  const double w = 7, P = 0.02, T = 0.002;
  tdm_motion m = motion_of("{'motion':{'type':'triangle','rate':7,'period':0.02,'corner':0.002}}");
  tdm_motion same = motion_of("{'motion':{'type':'triangle','amplitude':0.07,'period':0.02,'corner':0.002}}");
  double most = 0;
  for (int i = 0; i < 40000; i++) {
    const double t = i * 0.9737e-5, nearest = round(2 * t / P) * P / 2;
    const tdm_motion_value x = tdm_motion_at(&m, t);
    CLOSE(tdm_motion_at(&same, t).value, x.value, 1e-16);
    most = fmax(most, fabs(x.acceleration));
    if (fabs(t - nearest) > T / 2 || nearest == 0) {
      CLOSE(x.value, printed_triangle(w, P, t), 1e-15);
      CLOSE(fabs(x.rate), w, 0);
      CLOSE(x.acceleration, 0, 0);
    } else {
      CLOSE(x.value, printed_triangle(w, P, t), 0.15626 * w * T);
    }
  }
  CLOSE(most, 3.75 * w / T, 1e-3 * w / T);
  for (int k = 1; k < 5; k++) {
    const double corner = k * P / 2, turn = k % 2 ? -1 : 1, near = 0.5 * T * (1 - 2e-4);
    CLOSE(tdm_motion_at(&m, corner).rate, 0, 1e-12);
    CLOSE(tdm_motion_at(&m, corner).value, (k % 2 ? w * P / 2 : 0) + turn * 0.15625 * w * T, 1e-15);
    for (int side = -1; side <= 1; side += 2)
      CLOSE(tdm_motion_at(&m, corner + side * near).acceleration, turn * 60 * w / T * 1e-8, 1e-9 * w / T);
  }
  CLOSE(tdm_motion_at(&m, -0.3).value, -0.3 * w, 0);
  tdm_motion_clear(&m);
  tdm_motion_clear(&same);
}
END_TEST

/* a sum has values where all its laws have them */
START_TEST(test_law_sum) {
  tdm_error err = {0};
  tdm_motion m = motion_of("{'motion':{'type':'sum','laws':[{'type':'table','times':[-1,2],'values':[0,1]},"
                           "{'type':'table','times':[0,3],'values':[0,1]},{'type':'constant','value':1}]}}");
  ck_assert_int_eq(tdm_motion_check(&m, 0, 2, "p", "m", &err), TDM_OK);
  CLOSE(tdm_motion_at(&m, 1.5).value, 2.5 / 3 + 0.5 + 1, 1e-15);
  CLOSE(tdm_motion_at(&m, 1.5).rate, 2.0 / 3, 1e-15);
  ck_assert_int_eq(tdm_motion_check(&m, 0, 2.1, "p", "m", &err), TDM_ERR_SCENE);
  err.status = TDM_OK;
  ck_assert_int_eq(tdm_motion_check(&m, -0.1, 2, "p", "m", &err), TDM_ERR_SCENE);
  tdm_motion_clear(&m);
}
END_TEST

/* rate and acceleration are the derivatives of the value; the acceleration and its derivative have no jump */
START_TEST(test_law) {
  const double T = 0.4, w = -3, h = 1e-6;
  tdm_motion m = motion_of("{'motion':{'type':'constant_rate','rate':-3,'start':'smooth','rise':0.4}}");
  double most = 0;
  for (double t = h; t < 0.6; t += 0.0037) {
    tdm_motion_value lo = tdm_motion_at(&m, t - h), x = tdm_motion_at(&m, t), hi = tdm_motion_at(&m, t + h);
    CLOSE(x.rate, (hi.value - lo.value) / (2 * h), 1e-8);
    CLOSE(x.acceleration, (hi.rate - lo.rate) / (2 * h), 1e-7);
    most = fmax(most, fabs(x.acceleration));
  }
  CLOSE(most, 1.875 * fabs(w) / T, 1e-3);
  CLOSE(tdm_motion_at(&m, 0).value, 0, 0);
  CLOSE(tdm_motion_at(&m, 0).rate, 0, 0);
  for (int end = 0; end < 2; end++) { /* |acceleration| grows with the square of the distance from either end */
    tdm_motion_value x = tdm_motion_at(&m, end ? T - 1e-4 * T : 1e-4 * T);
    CLOSE(x.acceleration, 30 * w / T * 1e-8, 1e-9);
  }
  CLOSE(tdm_motion_at(&m, T - 1e-12).value, w * T / 2, 1e-11);
  CLOSE(tdm_motion_at(&m, T).value, w * T / 2, 1e-15);
  CLOSE(tdm_motion_at(&m, 10).value, w * (10 - T / 2), 1e-13);
  CLOSE(tdm_motion_at(&m, 10).rate, w, 0);

  tdm_motion_clear(&m);
  m = motion_of("{'motion':{'type':'constant_rate','rate':2,'start':'step'}}");
  CLOSE(tdm_motion_at(&m, 0).rate, 2, 0);
  CLOSE(tdm_motion_at(&m, 1.5).value, 3, 0);
  CLOSE(tdm_motion_at(&m, 1.5).acceleration, 0, 0);
  tdm_motion_clear(&m);
}
END_TEST

/* ---- the pendulum of [L18] Section 3.2: 72 deg/s, r = 1.5 m, arm along +x at the start ---- */

#define RATE "1.2566370614359172"
#define PENDULUM(start)                                                                                                \
  "{'gravity':[0,-9.81,0],'bodies':[{'name':'box','mass':246.6,'inertia':[20,21,35],'position':[1.5,0,0]}],"           \
  "'joints':[{'name':'pivot','type':'revolute','bodies':['ground','box'],'point':[0,0,0],'axis':[0,0,1]}],"            \
  "'drivers':[{'name':'motor','type':'rotational_motor','joint':'pivot','motion':{'type':'constant_rate','rate':" RATE \
  "," start "}}]}"

static const double m = 246.6, r0 = 1.5, g = 9.81, w = 1.2566370614359172, I = 35 + 246.6 * 1.5 * 1.5;

/* Compare the last window's sample with the rigid solution at angle, rate, acceleration; return the largest of the
 * deviations of torque and forces relative to m g r and m g. */
static double deviation(const run *r, double angle, double rate, double acceleration) {
  double c = cos(angle), s = sin(angle), n2 = rate * rate, worst = 0;
  double torque = I * acceleration + m * g * r0 * c;
  double fx = m * r0 * (-n2 * c - acceleration * s), fy = m * r0 * (-n2 * s + acceleration * c) + m * g;
  worst = fmax(worst, fabs(run_value(r, "driver.motor.torque") - torque) / (m * g * r0));
  worst = fmax(worst, fabs(run_value(r, "joint.pivot.fx") - fx) / (m * g));
  worst = fmax(worst, fabs(run_value(r, "joint.pivot.fy") - fy) / (m * g));
  worst = fmax(worst, fabs(run_value(r, "joint.pivot.fz")) / (m * g));
  /* the motor's torque is not the joint's */
  worst = fmax(worst, fabs(run_value(r, "joint.pivot.mx")) / (m * g * r0));
  worst = fmax(worst, fabs(run_value(r, "joint.pivot.my")) / (m * g * r0));
  worst = fmax(worst, fabs(run_value(r, "joint.pivot.mz")) / (m * g * r0));
  return worst;
}

/* Windows of 5e-4 s to `end`; print and check what must hold for any start. */
static void turn(const char *scene, double end, double rise, double limit) {
  run r;
  const double H = 5e-4;
  const long n = lround(end / H);
  double worst = 0, angle = 0, rate = 0, place = 0, drift = 0;
  run_open_good(&r, scene, "box");
  tdm_motion law = rate_law(w, rise);
  for (long i = 1; i <= n; i++) {
    double t = (double)i * H;
    run_to(&r, t);
    tdm_motion_value x = tdm_motion_at(&law, t);
    worst = fmax(worst, deviation(&r, x.value, x.rate, x.acceleration));
    angle = fmax(angle, fabs(run_value(&r, "driver.motor.angle") - x.value));
    rate = fmax(rate, fabs(run_value(&r, "driver.motor.rate") - x.rate));
    place = fmax(place, fabs(r.state[0].pose.position.y - r0 * sin(x.value)));
    drift = fmax(drift, run_value(&r, "constraint.drift"));
  }
  long steps = run_close_steps(&r);
  tdm_motion_clear(&law);
  printf(
      "rise %g s: forces and torque %.2g, angle %.2g rad, rate %.2g rad/s, position %.2g m, drift %.2g, %ld steps in "
      "%ld windows\n",
      rise, worst, angle, rate, place, drift, steps, n);
  ck_assert_msg(worst < limit, "forces or torque %g", worst);
  ck_assert_msg(angle < 1e-8 && rate < 1e-8 && place < 1e-8 && drift < 1e-8, "angle %g, rate %g, place %g, drift %g",
                angle, rate, place, drift);
  ck_assert_msg(steps < n + n / 10, "%ld steps in %ld windows", steps, n);
}

START_TEST(test_step_start) {
  run r;
  run_open_good(&r, PENDULUM("'start':'step'"), "box");
  ck_assert_int_eq(r.ready.nwarning, 0);
  ck_assert_int_eq((int)json_integer_value(json_object_get(r.ready.report, "degrees_of_freedom")), 0);
  CLOSE(r.ready.body[0].state.twist.angular.z, w, 1e-14);
  CLOSE(r.ready.body[0].state.twist.velocity.y, w * r0, 1e-13);
  CLOSE(r.ready.initial[run_channel(&r, "driver.motor.rate")], w, 1e-14);
  CLOSE(r.ready.initial[run_channel(&r, "driver.motor.torque")], m * g * r0, 1e-9);
  CLOSE(r.ready.initial[run_channel(&r, "joint.pivot.fx")], -m * w * w * r0, 1e-10);
  ck_assert_str_eq(r.ready.channel[run_channel(&r, "driver.motor.torque")].unit, "N m");
  ck_assert_str_eq(r.ready.channel[run_channel(&r, "driver.motor.angle")].unit, "rad");
  ck_assert_str_eq(r.ready.channel[run_channel(&r, "driver.motor.rate")].unit, "rad/s");
  run_close(&r);
  turn(PENDULUM("'start':'step'"), 12, 0, 1e-6); /* 2.4 turns */
}
END_TEST

START_TEST(test_smooth_start) {
  run r;
  run_open_good(&r, PENDULUM("'start':'smooth','rise':0.25"), "box");
  ck_assert_int_eq(r.ready.nwarning, 0);
  CLOSE(r.ready.body[0].state.twist.angular.z, 0, 0);
  CLOSE(r.ready.initial[run_channel(&r, "driver.motor.torque")], m * g * r0, 1e-9);
  run_close(&r);
  turn(PENDULUM("'start':'smooth','rise':0.25"), 12, 0.25, 1e-6);
}
END_TEST

/* Long windows without loss: IDA chooses its own steps and does not step over a start, samples come from dense output.
 */
START_TEST(test_long_windows) {
  static const char *const scenes[2] = {PENDULUM("'start':'step'"), PENDULUM("'start':'smooth','rise':0.25")};
  for (int i = 0; i < 2; i++) {
    run r;
    double worst = 0, at[40];
    tdm_motion law = rate_law(w, 0.25 * i);
    run_open_good(&r, scenes[i], "box");
    for (int k = 0; k < 10; k++) {
      for (int s = 0; s < 40; s++)
        at[s] = 2 * k + 0.05 * (s + 1);
      run_window(&r, at[39], NULL, 0, 40, at);
      for (int s = 0; s < 40; s++) {
        const double *c = r.channel + s * r.ready.nchannel;
        tdm_motion_value x = tdm_motion_at(&law, at[s]);
        double torque = (I * x.acceleration + m * g * r0 * cos(x.value)) / (m * g * r0);
        worst = fmax(worst, fabs(c[run_channel(&r, "driver.motor.torque")] / (m * g * r0) - torque));
        worst = fmax(worst, fabs(c[run_channel(&r, "driver.motor.angle")] - x.value));
      }
    }
    long steps = run_close_steps(&r);
    tdm_motion_clear(&law);
    printf("long windows: %.2g, %ld steps over 20 s\n", worst, steps);
    ck_assert_msg(worst < 1e-6 && steps < 2000, "%g, %ld steps", worst, steps);
  }
}
END_TEST

/* a load from outside goes to the motor and the joint: torque and force of a wrench about the centre of mass */
START_TEST(test_load) {
  run r;
  tdm_wrench load[2] = {{{30, -40, 5}, {1, 2, 3}}, {{0, 10, 0}, {0, 0, -1}}};
  run_open_good(&r, PENDULUM("'start':'step'"), "box");
  double at = 0.1;
  run_window(&r, at, load, 2, 1, &at); /* load at the end of the window: the sum of the coefficients */
  double c = cos(w * at), s = sin(w * at);
  CLOSE(run_value(&r, "driver.motor.torque"), m * g * r0 * c - (r0 * (c * -30 - s * 30) + 2), 1e-4);
  CLOSE(run_value(&r, "joint.pivot.fx"), -m * w * w * r0 * c - 30, 1e-4);
  CLOSE(run_value(&r, "joint.pivot.fy"), -m * w * w * r0 * s + m * g + 30, 1e-4);
  CLOSE(run_value(&r, "joint.pivot.fz"), -5, 1e-6);
  /* loads that jump by several times the weight at every window leave the motion alone */
  for (int i = 1; i <= 2000; i++) {
    double F = 1e4 * sin(i * i), M = 1e4 * cos(i * i);
    tdm_wrench jump = {{0, F, 0}, {0, 0, M}};
    at += 5e-4;
    run_window(&r, at, &jump, 1, 1, &at);
    CLOSE(run_value(&r, "driver.motor.torque"), (m * g - F) * r0 * cos(w * at) - M, 1e-3);
    CLOSE(run_value(&r, "joint.pivot.fy"), -m * w * w * r0 * sin(w * at) + m * g - F, 1e-3);
    CLOSE(run_value(&r, "driver.motor.angle"), w * at, 1e-8);
  }
  long steps = run_close_steps(&r);
  ck_assert_msg(steps < 2500, "%ld steps in 2001 windows", steps);
}
END_TEST

/* ---- two free bodies ---- */

/* Coaxial rotors without a fixed body and with a torsional spring between them: angular momentum stays zero, and the
 * torque is J thetaddot + k theta with J = J1 J2/(J1 + J2). The spring counts its angle by itself. */
START_TEST(test_rotors) {
  const double J1 = 2, J2 = 3, J = J1 * J2 / (J1 + J2), k = 0.7, rise = 0.5, rate = -9;
  run r;
  run_open_good(&r,
                "{'gravity':[0,0,0],'bodies':[{'name':'a','mass':5,'inertia':[2,1.5,1.5],'position':[0,1,0]},"
                "{'name':'b','mass':6,'inertia':[3,2,2],'position':[0,1,0]}],"
                "'joints':[{'name':'shaft','type':'revolute','bodies':['a','b'],'point':[0,1,0],'axis':[1,0,0]}],"
                "'drivers':[{'name':'motor','type':'rotational_motor','joint':'shaft','motion':{'type':'constant_rate',"
                "'rate':-9,'start':'smooth','rise':0.5}}],"
                "'forces':[{'name':'spring','type':'torsional_spring_damper','joint':'shaft','stiffness':0.7}]}",
                "a b");
  ck_assert_int_eq((int)json_integer_value(json_object_get(r.ready.report, "degrees_of_freedom")), 6);
  tdm_motion law = rate_law(rate, rise);
  for (int i = 1; i <= 400; i++) {
    double t = 0.01 * i;
    run_to(&r, t);
    tdm_motion_value x = tdm_motion_at(&law, t);
    CLOSE(r.state[0].twist.angular.x, -J2 / (J1 + J2) * x.rate, 1e-6);
    CLOSE(r.state[1].twist.angular.x, J1 / (J1 + J2) * x.rate, 1e-6);
    CLOSE(run_value(&r, "driver.motor.torque"), J * x.acceleration + k * x.value, 1e-5);
    CLOSE(run_value(&r, "force.spring.angle"), x.value, 1e-7);
    CLOSE(run_value(&r, "driver.motor.angle"), x.value, 1e-8);
  }
  ck_assert_double_lt(run_value(&r, "driver.motor.angle"), -10 * M_PI / 2); /* over several turns */
  run_close(&r);
  tdm_motion_clear(&law);
}
END_TEST

/* A motor with an oblique axis on a base that swings on a ball: the work of its torque is the change of energy.
 * Simpson's rule over the samples is exact to about 1e-8 here. */
START_TEST(test_work) {
  run r;
  enum { N = 2000 };
  const double H = 1e-3;
  double work = 0, power[3] = {0}, worst = 0, scale = 0;
  run_open_good(&r,
                "{'bodies':[{'name':'base','mass':4,'inertia':[0.3,0.4,0.5,0.02,0.01,-0.03],'position':[0.1,0,-0.5]},"
                "{'name':'arm','mass':2,'inertia':[0.05,0.2,0.18,0.01,0,0.02],'position':[0.5,0.2,-0.7]}],"
                "'joints':[{'name':'ball','type':'spherical','bodies':['ground','base'],'point':[0,0,0]},"
                "{'name':'hip','type':'revolute','bodies':['base','arm'],'point':[0.2,0,-0.6],'axis':[1,2,-1]}],"
                "'drivers':[{'name':'motor','type':'rotational_motor','joint':'hip','motion':{'type':'constant_rate',"
                "'rate':8,'start':'step'}}],'solver':{'relative_tolerance':1e-9}}",
                "");
  ck_assert_int_eq((int)json_integer_value(json_object_get(r.ready.report, "degrees_of_freedom")), 3);
  ck_assert_int_eq(r.ready.nwarning, 0);
  const double *start = r.ready.initial;
  double energy = start[run_channel(&r, "energy.kinetic")] + start[run_channel(&r, "energy.potential")];
  power[0] = start[run_channel(&r, "driver.motor.torque")] * start[run_channel(&r, "driver.motor.rate")];
  for (int i = 1; i <= N; i++) {
    run_to(&r, H * i);
    power[2 - i % 2] = run_value(&r, "driver.motor.torque") * run_value(&r, "driver.motor.rate");
    if (i % 2)
      continue;
    work += H / 3 * (power[0] + 4 * power[1] + power[2]);
    power[0] = power[2];
    double now = run_value(&r, "energy.kinetic") + run_value(&r, "energy.potential");
    worst = fmax(worst, fabs(now - energy - work));
    scale = fmax(scale, fabs(work));
  }
  printf("work: %.3g J of up to %.3g J unaccounted for\n", worst, scale);
  ck_assert_msg(scale > 5 && worst < 1e-6 * scale, "%g J of %g J", worst, scale);
  run_close(&r);
}
END_TEST

/* power, the sizes of a reaction, and a marker's motion, of a wheel with an unbalance whose marker is turned against
 * it; the wheel is coupled, or not */
START_TEST(test_load_channels) {
  run r;
  const double mass = 2, radius = 0.4, arm = 0.9, J = 0.7;
  run_open_good(
      &r,
      "{'gravity':[0,-9.81,0],'bodies':[{'name':'wheel','mass':2,'inertia':[0.5,0.6,0.7],'position':[0.4,0,0],"
      "'markers':[{'name':'rim','point':[0.5,0,0],'orientation':[0.6,0,0,0.8],'output':true},{'name':'quiet'}"
      "]}],'joints':[{'name':'axle','type':'revolute','bodies':['ground','wheel'],'point':[0,0,0],'axis':"
      "[0,0,1]}],'drivers':[{'name':'motor','type':'rotational_motor','joint':'axle','motion':{'type':"
      "'polynomial','coefficients':[0,3,5]}}]}",
      _i ? "wheel" : "");
  for (int i = 1; i <= 5; i++) {
    const double t = 0.1 * i, angle = 3 * t + 5 * t * t, rate = 3 + 10 * t, c = cos(angle), s = sin(angle);
    run_to(&r, t);
    const double torque = (J + mass * radius * radius) * 10 + mass * g * radius * c;
    CLOSE(run_value(&r, "driver.motor.torque"), torque, 1e-5);
    CLOSE(run_value(&r, "driver.motor.power"), torque * rate, 1e-4);
    const double fx = mass * radius * (-rate * rate * c - 10 * s),
                 fy = mass * (radius * (-rate * rate * s + 10 * c) + g);
    CLOSE(run_value(&r, "joint.axle.f"), hypot(fx, fy), 1e-5);
    CLOSE(run_value(&r, "joint.axle.m"), 0, 1e-9);
    CLOSE(run_value(&r, "marker.wheel.rim.x"), arm * c, 1e-7);
    CLOSE(run_value(&r, "marker.wheel.rim.vy"), arm * rate * c, 1e-6);
    CLOSE(run_value(&r, "marker.wheel.rim.ay"), arm * (-rate * rate * s + 10 * c), 1e-5);
    CLOSE(run_value(&r, "marker.wheel.rim.alphaz"), 10, 1e-6);
    CLOSE(run_value(&r, "marker.wheel.rim.wz"), rate, 1e-6);
    const double half = 0.5 * angle + atan2(0.8, 0.6); /* the quaternion's sign is free */
    CLOSE(fabs(run_value(&r, "marker.wheel.rim.qw")), fabs(cos(half)), 1e-7);
    CLOSE(fabs(run_value(&r, "marker.wheel.rim.qz")), fabs(sin(half)), 1e-7);
  }
  for (int i = 0; i < r.ready.nchannel; i++)
    ck_assert(!strstr(r.ready.channel[i].name, "quiet"));
  run_close(&r);
}
END_TEST

/* A shaft that oscillates by a triangle: whatever the windows and the integrator, the state is the law's to rounding
 * after a thousand corners, and the motor's work is the kinetic energy; windows need not know of the corners. */
START_TEST(test_corners) {
  static const struct {
    const char *formulation;
    double window;
  } cases[] = {{"ggl", 0.004}, {"one_step", 0.0007}, {"one_step", 0.004}, {"one_step", 0.013}, {"one_step", 0.253}};
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
    run r;
    char scene[512];
    snprintf(scene, sizeof scene,
             "{'formulation':'%s','bodies':[{'name':'shaft','mass':2,'inertia':[1,1,0.7],'position':[0,0,0]}],"
             "'joints':[{'name':'bearing','type':'revolute','bodies':['ground','shaft'],'point':[0,0,0],'axis':[0,0,1]"
             "}],'drivers':[{'name':'motor','type':'rotational_motor','joint':'bearing','motion':{'type':'triangle',"
             "'rate':11,'period':0.02,'corner':0.002}}]}",
             cases[k].formulation);
    run_open_good(&r, scene, "");
    double off = 0, most = 0, angle = 0, rate = 0;
    while (r.t < 10) {
      run_to(&r, r.t + cases[k].window);
      const double s = r.t - floor(r.t / 0.02) * 0.02, nearest = fabs(r.t - round(r.t / 0.01) * 0.01);
      off = fmax(off, fabs(run_value(&r, "energy.balance")));
      most = fmax(most, run_value(&r, "energy.kinetic"));
      if (nearest <= 0.001)
        continue;
      angle = fmax(angle, fabs(run_value(&r, "driver.motor.angle") - 11 * (s < 0.01 ? s : 0.02 - s)));
      rate = fmax(rate, fabs(run_value(&r, "driver.motor.rate") - (s < 0.01 ? 11 : -11)));
    }
    const long steps = run_close_steps(&r);
    printf("corners, %s, windows of %g s: %.3g rad, %.3g rad/s, %.3g of %.3g J, %.1f steps a corner\n",
           cases[k].formulation, cases[k].window, angle, rate, off, most, (double)steps / 1000);
    ck_assert_msg(angle < 1e-11 && rate < 1e-9, "%g rad, %g rad/s", angle, rate);
    ck_assert_msg(off < 1e-3 * most, "%g J of %g J", off, most);
  }
}
END_TEST

/* ---- velocities at the start ---- */

#define WHEEL(velocity)                                                                                            \
  "{'bodies':[{'name':'wheel','mass':1,'inertia':[1,1,1],'position':[0.5,0,0]," velocity "}],"                     \
  "'joints':[{'name':'axle','type':'revolute','bodies':['ground','wheel'],'point':[0,0,0],'axis':[0,0,1]}],"       \
  "'drivers':[{'name':'motor','type':'rotational_motor','joint':'axle','motion':{'type':'constant_rate','rate':4," \
  "'start':'step'}}]}"

START_TEST(test_start_velocities) {
  static const struct {
    const char *scene, *path; /* of the warning, NULL: none */
  } cases[] = {
      {WHEEL("'velocity':[0,0,0]"), NULL},                                        /* nothing given */
      {WHEEL("'velocity':[0,2,0],'angular_velocity':[0,0,4]"), NULL},             /* what the driver wants */
      {WHEEL("'velocity':[0,1,0],'angular_velocity':[0,0,2]"), "mbd.drivers[0]"}, /* joints hold, the driver does not */
      {WHEEL("'velocity':[0,0,1],'angular_velocity':[0,0,0]"), "mbd.bodies[0].velocity"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    run r;
    run_open_good(&r, cases[i].scene, "wheel");
    ck_assert_int_eq(r.ready.nwarning, cases[i].path != NULL);
    if (cases[i].path) {
      ck_assert_str_eq(r.ready.warning[0].path, cases[i].path);
    }
    CLOSE(r.ready.body[0].state.twist.angular.z, 4, 1e-14);
    CLOSE(r.ready.body[0].state.twist.velocity.y, 2, 1e-14);
    CLOSE(r.ready.body[0].state.twist.velocity.z, 0, 1e-14);
    run_close(&r);
  }
}
END_TEST

TEST_MAIN_ROWS("mbd driver", {test_law, 1}, {test_laws, 1}, {test_law_between, 1}, {test_law_ends, 1},
               {test_law_triangle, 1}, {test_law_sum, 1}, {test_law_file, 1}, {test_step_start, 1},
               {test_smooth_start, 1}, {test_long_windows, 1}, {test_load, 1}, {test_rotors, 1}, {test_work, 1},
               {test_load_channels, 2}, {test_corners, 1}, {test_start_velocities, 1})
