/* The verification of the multibody solver: the fast part of the group "mbd" meets its limits, its JSON is whole, and a
 * wrong scene is found out. The others run with `tandem verify mbd`. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/adams/adams.h"
#include "scenarios/mbd/mechanism.h"
#include "scenarios/table.h"
#include "tests/command.h"
#include "tests/test_main.h"

#include <math.h>

static json_t *verify(const char *name, const char *scenarios, tdm_status *status) {
  const char *dir = directory_make();
  const char *const names[] = {name, NULL};
  char file[256], plot[256];
  tdm_error err = {0};
  snprintf(file, sizeof file, "%s/verify.json", dir);
  snprintf(plot, sizeof plot, "%s/%s/work_ggl.csv", dir, name);
  cpl_verify_options options = {.scenario = scn_table, .name = names, .out = dir, .json = file, .scenarios = scenarios};
  *status = cpl_verify_all(&options, &err);
  json_t *json = json_load_file(file, JSON_REJECT_DUPLICATES, NULL);
  if (*status == TDM_OK)
    ck_assert_msg(access(plot, F_OK) == 0, "no %s", plot);
  directory_remove(dir);
  ck_assert_ptr_nonnull(json);
  return json;
}

static double measured(const json_t *json, const char *name) {
  const json_t *scenario = json_array_get(json_object_get(json, "scenarios"), 0), *measure;
  size_t i;
  json_array_foreach(json_object_get(scenario, "measures"), i, measure) {
    if (strcmp(json_string_value(json_object_get(measure, "name")), name) == 0)
      return json_number_value(json_object_get(measure, "value"));
  }
  ck_abort_msg("no measure %s", name);
  return NAN;
}

START_TEST(torque_free_meets_its_limits) {
  tdm_status status;
  json_t *json = verify("torque_free", NULL, &status);
  ck_assert_int_eq(status, TDM_OK);
  ck_assert(json_is_true(json_object_get(json, "pass")));
  ck_assert(measured(json, "digits") >= 8);
  ck_assert(measured(json, "momentum_drift") <= 1e-7);
  ck_assert(measured(json, "wall_s") > 0);
  const json_t *scenario = json_array_get(json_object_get(json, "scenarios"), 0);
  ck_assert(json_number_value(json_object_get(scenario, "time_mbd_s")) > 0);
  ck_assert_double_eq(json_number_value(json_object_get(scenario, "time_dem_s")), 0);
  json_decref(json);
}
END_TEST

START_TEST(a_wrong_scene_misses_its_limits) {
  /* an inertia that is off by 1e-6 */
  const char *dir = directory_make();
  char own[128];
  snprintf(own, sizeof own, "%s-scenes", dir);
  ck_assert_int_eq(command("mkdir -p %s/mbd", own), 0);
  ck_assert_int_eq(command("cp -r " TANDEM_SOURCE_DIR "/scenarios/mbd/torque_free %s/mbd/", own), 0);
  ck_assert_int_eq(command("sed -i 's/\"inertia\": .1, 2, 3./\"inertia\": [1, 2.000002, 3]/' "
                           "%s/mbd/torque_free/scene.json",
                           own),
                   0);
  directory_remove(dir);
  tdm_status status;
  json_t *json = verify("torque_free", own, &status);
  ck_assert_int_eq(status, TDM_ERR_LIMIT);
  ck_assert(json_is_false(json_object_get(json, "pass")));
  ck_assert(measured(json, "digits") < 8);
  json_decref(json);
  directory_remove(own);
}
END_TEST

START_TEST(angles_are_counted_over_turns) {
  tdm_channel channel[2] = {{.name = "body.a.qw", .unit = "1"}, {.name = "body.a.qz", .unit = "1"}};
  enum { N = 100 };
  double value[2 * N], angle[N];
  scn_motion m = {.nchannel = 2, .nsample = N, .channel = channel, .value = value};
  for (int i = 0; i < N; i++) {
    value[2 * i] = cos(0.5 * (0.3 - 0.4 * i));
    value[2 * i + 1] = sin(0.5 * (0.3 - 0.4 * i));
  }
  ck_assert(scn_motion_angle(&m, "a", angle));
  for (int i = 0; i < N; i++)
    ck_assert_double_eq_tol(angle[i], 0.3 - 0.4 * i, 1e-12);
  ck_assert(!scn_motion_angle(&m, "b", angle));
}
END_TEST

/* a joint, a link, a spring of zero length, an actuator */
START_TEST(adams_has_the_same_results) {
  static const char *const model[] = {"Revolute_Case02", "RevSpherical_Case02", "TranSpring_Case01",
                                      "LinActuator_Case02"};
  for (size_t i = 0; i < sizeof model / sizeof model[0]; i++) {
    char dir[512];
    scn_adams_difference d;
    tdm_error err = {0};
    snprintf(dir, sizeof dir, TANDEM_SOURCE_DIR "/scenarios/adams/%s", model[i]);
    ck_assert_msg(scn_adams_compare(&d, dir, 1e-10, &err) == TDM_OK, "%s: %s", model[i], err.message);
    ck_assert_msg(d.share <= 1.1, "%s: %s differs by %g times the table's error", model[i], d.quantity, d.share);
  }
}
END_TEST

START_TEST(adams_has_other_results_for_another_model) {
  const char *dir = directory_make();
  scn_adams_difference d;
  tdm_error err = {0};
  ck_assert_int_eq(command("cp " TANDEM_SOURCE_DIR "/scenarios/adams/Revolute_Case02/* %s", dir), 0);
  ck_assert_int_eq(command("sed -i 's/-9.80665/-9.8068/' %s/scene.json", dir), 0);
  ck_assert_int_eq(scn_adams_compare(&d, dir, 1e-10, &err), TDM_OK);
  ck_assert_msg(d.share > 2, "%s: %g", d.quantity, d.share);
  directory_remove(dir);
}
END_TEST

TEST_MAIN("verify mbd", adams_has_the_same_results, adams_has_other_results_for_another_model,
          torque_free_meets_its_limits, a_wrong_scene_misses_its_limits, angles_are_counted_over_turns)
