/* The error that a run estimates: in its summary, at its end, in its report; and `tandem run --estimate`. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/trial/trial.h"
#include "tests/coupling/seam_run.h"
#include "tests/test_main.h"

#include "protocol/scene/scene.h"

#include <jansson.h>
#include <math.h>

static const char *dir;

static void setup(void) {
  dir = directory_with_scene(seam_scene);
}

static double number(const json_t *summary, const char *path) {
  const json_t *value = tdm_scene_value(summary, path);
  ck_assert_msg(json_is_number(value), "no number %s", path);
  return json_number_value(value);
}

START_TEST(summary_terminal_and_report) {
  setup();
  ck_assert_msg(command("tandem run %s/scene.json --out %s/out", dir, dir) == 0, "%s", command_output);
  expect_output("error, estimated, of body \"box\":");
  json_t *summary = seam_summary(dir, "out");
  ck_assert_str_eq(json_string_value(tdm_scene_value(summary, "error_estimate.worst_body")), "box");
  const double worst = number(summary, "error_estimate.worst");
  const double share = number(summary, "error_estimate.bodies.box.velocity.share");
  ck_assert(worst >= share && share > 1e-3 && worst < 1); /* the load of `hold` is late */
  ck_assert(json_is_false(tdm_scene_value(summary, "error_estimate.large")));
  ck_assert_ptr_null(strstr(command_output, "that is large:"));
  ck_assert_double_eq_tol(number(summary, "error_estimate.bodies.box.velocity.rms") /
                              number(summary, "error_estimate.bodies.box.velocity.spread"),
                          share, 1e-9);
  ck_assert(json_is_null(tdm_scene_value(summary, "error_estimate.bodies.box.angle.share"))); /* unknown is not 0 */
  json_decref(summary);
  ck_assert_int_eq(command("tandem report %s/out", dir), 0);
  ck_assert_int_eq(command("grep -c 'The error, estimated' %s/out/index.html", dir), 0);
  ck_assert_int_eq(command("grep -c 'velocity .m/s.' %s/out/index.html", dir), 0);
  directory_remove(dir);
}
END_TEST

/* Twice the window: twice the error, above 5 %. */
START_TEST(an_error_that_is_large) {
  setup();
  ck_assert_msg(command("tandem run %s/scene.json --out %s/out --set coupling.n=200", dir, dir) == 0, "%s",
                command_output);
  expect_output("that is large: take shorter windows");
  json_t *summary = seam_summary(dir, "out");
  ck_assert(json_is_true(tdm_scene_value(summary, "error_estimate.large")));
  json_decref(summary);
  ck_assert_int_eq(command("tandem report %s/out", dir), 0);
  ck_assert_int_eq(command("grep -c 'This is large' %s/out/index.html", dir), 0);
  directory_remove(dir);
}
END_TEST

START_TEST(what_is_not_known_is_not_zero) {
  setup();
  ck_assert_int_eq(
      command("tandem run %s/scene.json --out %s/out --set time.end=2e-3 --set output.interval=1e-3", dir, dir), 0);
  expect_output("error, estimated: unknown (too few windows");
  json_t *summary = seam_summary(dir, "out");
  ck_assert(json_is_null(tdm_scene_value(summary, "error_estimate.worst")));
  json_decref(summary);
  ck_assert_int_eq(command("tandem report %s/out", dir), 0);
  ck_assert_int_eq(command("grep -c 'unknown: too few' %s/out/index.html", dir), 0);
  directory_remove(dir);
}
END_TEST

/* Half the window halves the error of `hold`: the repetition finds what the run is off until then. */
START_TEST(a_share_is_repeated) {
  setup();
  ck_assert_msg(command("tandem run %s/scene.json --out %s/out --estimate 0.5", dir, dir) == 0, "%s", command_output);
  expect_output("repeated until 0.05 s (50 % of the run");
  json_t *summary = seam_summary(dir, "out");
  const char *const of = "error_estimate.repetition.bodies.box.velocity";
  char path[128];
  double e[3];
  static const char *const keys[] = {"coupling", "dem_step", "round_off"};
  for (int k = 0; k < 3; k++) {
    snprintf(path, sizeof path, "%s.%s", of, keys[k]);
    e[k] = number(summary, path);
  }
  ck_assert_double_eq_tol(number(summary, "error_estimate.repetition.until_s"), 0.05, 1e-12);
  ck_assert_double_gt(e[0], 100 * e[1]);
  /* beside a run that has no error of the exchange */
  cpl_apart_runs apart;
  char run[128], exact[128];
  snprintf(run, sizeof run, "%s/out", dir);
  snprintf(exact, sizeof exact, "%s/exact", dir);
  ck_assert_int_eq(command("tandem run %s/scene.json --out %s --set coupling.scheme=proxy", dir, exact), 0);
  ck_assert_int_eq(cpl_trial_compare(run, exact, "box", 0.05, &apart, &(tdm_error){0}), TDM_OK);
  ck_assert_int_eq(apart.nrow, 51);
  ck_assert_msg(fabs(e[0] / apart.rms[CPL_VELOCITY] - 1) < 0.2, "%g, it is %g", e[0], apart.rms[CPL_VELOCITY]);
  ck_assert_double_lt(e[2], 1e-9);
  json_decref(summary);
  ck_assert_int_eq(command("tandem report %s/out", dir), 0);
  ck_assert_int_eq(command("grep -c 'Repeated until 0.05 s' %s/out/index.html", dir), 0);
  ck_assert_int_eq(command("test -d %s/out/estimate/half_window", dir), 0);
  directory_remove(dir);
}
END_TEST

START_TEST(what_cannot_be_repeated) {
  setup();
  /* one step a window */
  ck_assert_int_eq(
      command("tandem run %s/scene.json --out %s/out --set coupling.n=1 --set time.end=0.01 --estimate 1", dir, dir),
      0);
  expect_output("a window of one DEM step cannot be halved");
  static const struct {
    const char *options, *what;
    int status;
  } cases[] = {
      {"--estimate 0", "above 0, at most 1", 2},
      {"--estimate 2", "above 0, at most 1", 2},
      {"--estimate --set coupling.transport=tcp --set coupling.address=tcp://127.0.0.1:* --set "
       "coupling.solvers.dem=null",
       "dem is started by hand", 1},
      {"--estimate --set coupling.bodies=[]", "no body is coupled", 1},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    const int status = command("tandem run %s/scene.json --out %s/refused %s", dir, dir, cases[i].options);
    ck_assert_msg(status == cases[i].status, "%s: %d: %s", cases[i].options, status, command_output);
    expect_output(cases[i].what);
    ck_assert_int_ne(command("test -e %s/refused", dir), 0); /* before anything runs */
  }
  ck_assert_int_eq(command("tandem check %s/scene.json --estimate", dir), 2);
  directory_remove(dir);
}
END_TEST

/* Trials of one scene: the first settles the bed and keeps it. */
START_TEST(trials) {
  setup();
  char scene[128], results[128];
  snprintf(scene, sizeof scene, "%s/scene.json", dir);
  snprintf(results, sizeof results, "%s/trial", dir);
  tdm_error err = {0};
  tdm_gsl_return_errors();
  double error[2];
  for (int k = 0; k < 2; k++) {
    const char *const set[] = {k ? "coupling.n=50" : "coupling.n=100", NULL};
    cpl_trial t;
    const cpl_trial_options options = {
        .scene = scene,
        .set = set,
        .dir = results,
        .end = 0.05,
        .solver = {[CPL_MBD] = {.ops = &mbd_solver_ops}, [CPL_DEM] = {.ops = &dem_solver_ops}}};
    ck_assert_msg(cpl_trial_run(&options, &t, &err) == TDM_OK && t.status == TDM_OK, "%s%s", err.message, t.reason);
    ck_assert_double_eq_tol(t.run.simulated, 0.05, 1e-12);
    ck_assert_double_gt(t.run.loop, 0);
    ck_assert_ptr_nonnull(t.summary);
    error[k] = t.run.error_coupling;
    cpl_trial_free(&t);
  }
  ck_assert_msg(fabs(error[0] / error[1] - 2) < 0.3, "%g and %g", error[0], error[1]); /* `hold` is of first order */
  /* a scene that is wrong, and a run that ends badly: the first is an error, the second a result */
  cpl_trial t;
  const char *const wrong[] = {"coupling.n=-3", NULL};
  cpl_trial_options options = {.scene = scene, .set = wrong, .dir = results, .end = 0.05};
  ck_assert_int_eq(cpl_trial_run(&options, &t, &err), TDM_OK);
  ck_assert_int_ne(t.status, TDM_OK);
  ck_assert_int_gt((int)strlen(t.reason), 0);
  cpl_trial_free(&t);
  options.scene = "nowhere.json";
  ck_assert_int_ne(cpl_trial_run(&options, &t, &err), TDM_OK);
  cpl_trial_free(&t);
  directory_remove(dir);
}
END_TEST

TEST_MAIN("estimate", summary_terminal_and_report, an_error_that_is_large, what_is_not_known_is_not_zero,
          a_share_is_repeated, what_cannot_be_repeated, trials)
