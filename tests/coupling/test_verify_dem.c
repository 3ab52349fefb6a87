/* The verification of the DEM engine: the fast part of the group "dem" meets its limits, and its JSON is whole. The
 * others (conservation, discharge) run with `tandem verify dem`. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/dem_physics/impact.h"
#include "scenarios/table.h"
#include "tests/command.h"
#include "tests/test_main.h"

#include <math.h>

static json_t *verify(const char *name) {
  const char *dir = directory_make();
  const char *const names[] = {name, NULL};
  char file[256];
  tdm_error err = {0};
  snprintf(file, sizeof file, "%s/verify.json", dir);
  cpl_verify_options options = {.scenario = scn_table, .name = names, .out = dir, .json = file};
  tdm_status status = cpl_verify_all(&options, &err);
  json_t *json = json_load_file(file, JSON_REJECT_DUPLICATES, NULL);
  directory_remove(dir);
  ck_assert_msg(status == TDM_OK, "%s: %s", name, err.message);
  ck_assert_ptr_nonnull(json);
  return json;
}

/* at least `least` measures, all numbers, at least one with a limit in every case; the time of the runs is told */
static void check(const char *name, size_t least) {
  json_t *json = verify(name), *scenarios = json_object_get(json, "scenarios"), *measure;
  ck_assert(json_is_true(json_object_get(json, "pass")));
  ck_assert_uint_eq(json_array_size(scenarios), 1);
  json_t *scenario = json_array_get(scenarios, 0), *measures = json_object_get(scenario, "measures");
  ck_assert_str_eq(json_string_value(json_object_get(scenario, "name")), name);
  ck_assert(json_is_true(json_object_get(scenario, "pass")));
  ck_assert(json_number_value(json_object_get(scenario, "simulated_s")) > 0);
  ck_assert(json_number_value(json_object_get(scenario, "time_dem_s")) > 0);
  ck_assert_uint_ge(json_array_size(measures), least);
  size_t i, limited = 0;
  json_array_foreach(measures, i, measure) {
    const char *of = json_string_value(json_object_get(measure, "case"));
    ck_assert_msg(json_is_number(json_object_get(measure, "value")), "%s, %s: no number", name, of);
    ck_assert(json_is_string(json_object_get(measure, "name")));
    ck_assert(json_is_true(json_object_get(measure, "pass")));
    limited += json_is_number(json_object_get(measure, "limit"));
  }
  ck_assert_uint_ge(limited, least);
  json_decref(json);
}

START_TEST(normal_laws) {
  check("normal_laws", 50);
}
END_TEST

START_TEST(chung_ooi) {
  check("chung_ooi", 30);
}
END_TEST

START_TEST(rolling) {
  check("rolling", 15);
}
END_TEST

START_TEST(lammps) {
  check("lammps", 40);
}
END_TEST

START_TEST(convergence) {
  check("convergence", 12);
}
END_TEST

/* ---- the reference of the impacts ---- */

START_TEST(the_reference_keeps_what_theory_says) {
  /* Hertz without damping: overlap, time; Tsuji's damping: e whatever the size; sliding: V_t' = V_t - 2 mu V_n */
  scn_law law = scn_law_hertz(0.3, 0.02, 4e7, 1e7, 0, 0.1);
  double overlap = pow(15 * 0.3 * 0.25 / (16 * 4e7 * sqrt(0.02)), 0.4);
  scn_outcome o = scn_solve_impact(&law, 0.5, 0.6, 0);
  ck_assert_double_eq_tol(o.overlap / overlap, 1, 1e-6);
  ck_assert_double_eq_tol(o.time / (2.9432751843 * overlap / 0.5), 1, 1e-6);
  ck_assert_double_eq_tol(o.normal, 0.5, 1e-9);
  ck_assert_double_eq_tol(o.v, 0.6 - 2 * 0.1 * 0.5, 1e-8);
  for (int e = 2; e < 10; e += 2) {
    law = scn_law_hertz(0.3, 0.02, 4e7, 1e7, scn_beta(0.1 * e), 0);
    /* the damping begins like delta^1/4, which costs Runge and Kutta some of their order */
    ck_assert_double_eq_tol(scn_solve_impact(&law, 0.5, 0, 0).normal / 0.5, 0.1 * e, 5e-6);
  }
}
END_TEST

START_TEST(the_reference_clips) {
  /* cut at 0, the damping of e = 0.5, 0.4, 0.3 gives these; integrated by another program */
  static const double in[] = {0.5, 0.4, 0.3}, out[] = {0.5502831697, 0.4720139802, 0.3971405155};
  for (int k = 0; k < 3; k++) {
    scn_law law = scn_law_hertz(0.3, 0.02, 4e7, 1e7, scn_beta(in[k]), 0);
    law.clip = true;
    ck_assert_double_eq_tol(scn_solve_impact(&law, 0.5, 0, 0).normal / 0.5, out[k], 1e-6);
    ck_assert_double_eq_tol(scn_beta_clipped(out[k]), scn_beta(in[k]), 1e-5);
  }
}
END_TEST

TEST_MAIN("verify dem", normal_laws, chung_ooi, rolling, lammps, convergence, the_reference_keeps_what_theory_says,
          the_reference_clips)
