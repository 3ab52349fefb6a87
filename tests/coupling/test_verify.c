/* The verification runner: limits, NaN, failures, the JSON contract. Its scenarios here only pretend to measure. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/verify/verify.h"
#include "tests/command.h"
#include "tests/test_main.h"

#include <math.h>

static tdm_status good(cpl_verify *v, tdm_error *err) {
  (void)err;
  cpl_verify_measure(v, "nse_x", "", 0.9995, CPL_AT_LEAST, 0.999);
  cpl_verify_measure(v, "error", "m=1", -0.1, CPL_AT_MOST, 0.2);
  cpl_verify_measure(v, "free", "", NAN, CPL_NO_LIMIT, 0);
  return TDM_OK;
}

static tdm_status missed(cpl_verify *v, tdm_error *err) {
  (void)err;
  cpl_verify_measure(v, "error", "a", -0.3, CPL_AT_MOST, 0.2); /* signed: its size counts */
  cpl_verify_measure(v, "nse", "b", NAN, CPL_AT_LEAST, 0.9);
  cpl_verify_measure(v, "small", "c", NAN, CPL_AT_MOST, 0.9);
  return TDM_OK;
}

static tdm_status failing(cpl_verify *v, tdm_error *err) {
  cpl_verify_measure(v, "before", "", 1, CPL_NO_LIMIT, 0);
  return tdm_fail(err, TDM_ERR_NUMERIC, NULL, "it went wrong");
}

static const cpl_scenario table[] = {
    {.name = "good", .group = "scenarios", .verify = good},
    {.name = "missed", .group = "others", .verify = missed},
    {.name = "failing", .group = "others", .verify = failing},
    {0},
};

static json_t *verify(const char *const *names, tdm_status expected) {
  const char *dir = directory_make();
  char file[256];
  tdm_error err = {0};
  snprintf(file, sizeof file, "%s/verify.json", dir);
  cpl_verify_options options = {.scenario = table, .name = names, .out = dir, .json = file};
  ck_assert_int_eq(cpl_verify_all(&options, &err), expected);
  json_t *json = json_load_file(file, 0, NULL);
  directory_remove(dir);
  return json;
}

START_TEST(the_default_is_the_group_scenarios) {
  const char *const names[] = {NULL};
  json_t *json = verify(names, TDM_OK);
  ck_assert(json_is_true(json_object_get(json, "pass")));
  ck_assert_str_eq(json_string_value(json_object_get(json, "tandem")), TDM_VERSION);
  ck_assert(json_is_number(json_object_get(json, "wall_s")));
  json_t *scenarios = json_object_get(json, "scenarios");
  ck_assert_uint_eq(json_array_size(scenarios), 1);
  json_t *scenario = json_array_get(scenarios, 0);
  static const char *const keys[] = {"name",       "pass",       "wall_s",          "simulated_s", "windows",
                                     "time_dem_s", "time_mbd_s", "time_coupling_s", "measures"};
  for (int i = 0; i < 9; i++)
    ck_assert_msg(json_object_get(scenario, keys[i]) != NULL, "no %s", keys[i]);
  json_t *measures = json_object_get(scenario, "measures"), *unlimited = json_array_get(measures, 2);
  ck_assert_uint_eq(json_array_size(measures), 3);
  ck_assert(json_is_null(json_object_get(unlimited, "limit")));
  ck_assert(json_is_null(json_object_get(unlimited, "value"))); /* NaN */
  ck_assert(json_is_true(json_object_get(unlimited, "pass")));
  ck_assert_str_eq(json_string_value(json_object_get(unlimited, "case")), "");
  ck_assert_double_eq(json_real_value(json_object_get(json_array_get(measures, 1), "limit")), 0.2);
  json_decref(json);
}
END_TEST

START_TEST(missed_limits_fail) {
  const char *const names[] = {"missed", NULL};
  json_t *json = verify(names, TDM_ERR_LIMIT);
  ck_assert(json_is_false(json_object_get(json, "pass")));
  json_t *measures = json_object_get(json_array_get(json_object_get(json, "scenarios"), 0), "measures");
  for (size_t i = 0; i < 3; i++)
    ck_assert(json_is_false(json_object_get(json_array_get(measures, i), "pass")));
  json_decref(json);
}
END_TEST

START_TEST(a_failing_scenario_does_not_stop_the_others) {
  const char *const names[] = {"all", NULL};
  json_t *json = verify(names, TDM_ERR_LIMIT);
  json_t *scenarios = json_object_get(json, "scenarios");
  ck_assert_uint_eq(json_array_size(scenarios), 3);
  json_t *failed = json_array_get(scenarios, 2);
  ck_assert_str_eq(json_string_value(json_object_get(failed, "error")), "it went wrong");
  ck_assert(json_is_false(json_object_get(failed, "pass")));
  ck_assert_uint_eq(json_array_size(json_object_get(failed, "measures")), 1);
  ck_assert_ptr_null(json_object_get(json_array_get(scenarios, 0), "error"));
  json_decref(json);
}
END_TEST

START_TEST(unknown_names_are_refused) {
  const char *const names[] = {"mised", NULL};
  cpl_verify_options options = {.scenario = table, .name = names, .out = "/tmp"};
  tdm_error err = {0};
  ck_assert_int_eq(cpl_verify_all(&options, &err), TDM_ERR_ARGUMENT);
  ck_assert_ptr_nonnull(strstr(err.message, "did you mean \"missed\""));
}
END_TEST

TEST_MAIN("verify", the_default_is_the_group_scenarios, missed_limits_fail, a_failing_scenario_does_not_stop_the_others,
          unknown_names_are_refused)
