/* The stability set: families and their cases, what a run is judged by, a small family from beginning to end. The set
 * itself takes minutes: `tandem verify stability`. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/stability/report.h"
#include "scenarios/table.h"
#include "tests/command.h"
#include "tests/test_main.h"

#include <math.h>
#include <sys/stat.h>

/* ---- judging ---- */

enum { ROWS = 41 };

/* A run's directory with y(t) = sin t + what it is off by, every 0.1 s, and its cell. */
static void make_run(cpl_cell *cell, const char *dir, const char *name, const char *ended, double off, double n,
                     const char *warnings) {
  char file[4352];
  snprintf(cell->dir, sizeof cell->dir, "%.200s/%s", dir, name);
  mkdir(cell->dir, 0777);
  snprintf(file, sizeof file, "%s/body.csv", cell->dir);
  FILE *f = fopen(file, "w");
  fputs("time [s],y [m]\n", f);
  for (int i = 0; i < ROWS; i++)
    fprintf(f, "%.17g,%.17g\n", 0.1 * i, sin(0.1 * i) + (i % 2 ? 100 * off : off));
  fclose(f);
  snprintf(file, sizeof file, "%s/summary.json", cell->dir);
  json_t *summary = json_pack("{s:{s:f, s:f}, s:o, s:{s:f}}", "settings", "coupling.n", n, "time.dt", 0.1, "warnings",
                              json_loads(warnings, 0, NULL), "ledger", "residual_share", 1e-4);
  json_dump_file(summary, file, 0);
  json_decref(summary);
  cell->row = json_pack("{s:s, s:s, s:f}", "ended", ended, "reason", "the reason", "wall_s", 1.0);
}

static const char *judged(const cpl_cell *run, const cpl_cell trio[SCN_TRIO], double *error) {
  static char outcome[32];
  const scn_family f = {.file = "body.csv", .column = "y", .floor = 1e-3};
  const scn_stability_case c = {.name = "a=1"};
  json_t *row = scn_judge(&f, &c, "proxy", run, trio);
  snprintf(outcome, sizeof outcome, "%s", json_string_value(json_object_get(row, "outcome")));
  *error = json_is_number(json_object_get(row, "error")) ? json_number_value(json_object_get(row, "error")) : NAN;
  ck_assert(scn_row_outcome(row) < SCN_OUTCOMES);
  ck_assert_double_eq_tol(json_number_value(json_object_get(row, "residual_share")), 1e-4, 1e-12);
  json_decref(row);
  return outcome;
}

static void forget(cpl_cell *cell, int n) {
  for (int i = 0; i < n; i++)
    json_decref(cell[i].row);
}

START_TEST(a_run_is_judged_by_what_it_did_and_said) {
  static const char said[] = "[{\"message\": \"look\"}]";
  static const struct {
    const char *ended, *warnings, *is;
    double off;
  } rows[] = {{"TDM_OK", "[]", "ok", 1e-4},
              {"TDM_OK", said, "warned", 1e-4},
              {"TDM_OK", said, "inexact", 0.5},
              {"TDM_OK", "[]", "SILENT", 0.5},
              {"TDM_ERR_NUMERIC", "[]", "stopped", 0},
              {"TDM_ERR_SCENE", "[]", "refused", 0},
              {"TDM_ERR_LOST", "[]", "BROKEN", 0},
              {"TDM_ERR_TIMEOUT", "[]", "BROKEN", 0}};
  const char *dir = directory_make();
  cpl_cell trio[SCN_TRIO] = {0};
  for (int k = 0; k < SCN_TRIO; k++)
    make_run(&trio[k], dir,
             k == 0   ? "reference"
             : k == 1 ? "twin"
                      : "neighbour",
             "TDM_OK", 1e-3 * scn_nudge[k], 1, "[]");
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    cpl_cell run = {0};
    double error;
    make_run(&run, dir, "run", rows[i].ended, rows[i].off, 2, rows[i].warnings);
    ck_assert_str_eq(judged(&run, trio, &error), rows[i].is);
    if (strcmp(rows[i].ended, "TDM_OK") == 0) /* every other row is no end of a window, and 100 times as far off */
      ck_assert(error > rows[i].off && error < 3 * rows[i].off);
    else
      ck_assert(isnan(error));
    forget(&run, 1);
  }
  forget(trio, SCN_TRIO);
  directory_remove(dir);
}
END_TEST

START_TEST(chaos_is_judged_by_mean_and_rms) {
  const char *dir = directory_make();
  cpl_cell trio[SCN_TRIO] = {0}, run = {0};
  double error;
  for (int k = 0; k < SCN_TRIO; k++)
    make_run(&trio[k], dir,
             k == 0   ? "reference"
             : k == 1 ? "twin"
                      : "neighbour",
             "TDM_OK", 1e3 * scn_nudge[k], 1, "[]");
  make_run(&run, dir, "run", "TDM_OK", 0.02, 2, "[]");
  ck_assert_str_eq(judged(&run, trio, &error), "ok");
  ck_assert_double_eq_tol(error, 0.02 / 0.7, 0.01);
  forget(&run, 1);
  forget(trio, SCN_TRIO);
  directory_remove(dir);
}
END_TEST

/* ---- a family from beginning to end ---- */

START_TEST(a_small_family) {
  const char *dir = directory_make();
  ck_assert_int_eq(command("mkdir -p %s/stability/families && cp %s/stability/box.json %s/stability", dir,
                           TANDEM_SOURCE_DIR "/scenarios", dir),
                   0);
  char file[512];
  snprintf(file, sizeof file, "%s/stability/families/stop.json", dir);
  FILE *f = fopen(file, "w");
  fputs(
      "{\"title\": \"small\", \"scene\": \"box.json\", \"file\": \"body_box.csv\", \"column\": \"vz\", \"floor\": 1e-3,"
      " \"cases\": [{\"ratio\": [1, 2], \"end\": 0.01, \"H\": 1e-3}, {\"stop\": 1e4, \"end\": 0.01, \"H\": 5e-3}],"
      " \"full\": [{\"end\": 0.01, \"H\": 2e-3}]}",
      f);
  fclose(f);
  ck_assert_int_eq(
      command("tandem verify stability_stop stability_map --scenarios %s --out %s/out --json %s/v.json", dir, dir, dir),
      0);
  expect_output("small: outcome and error");
  expect_output("ratio=2 H=0.001");
  expect_output("beyond");
  snprintf(file, sizeof file, "%s/v.json", dir);
  json_t *json = json_load_file(file, 0, NULL), *first = json_array_get(json_object_get(json, "scenarios"), 0);
  json_t *cells = json_object_get(json_object_get(first, "detail"), "cells");
  ck_assert_int_eq(json_array_size(cells), 3 * 6);
  for (int k = 0; k < 2; k++) {
    json_t *row = json_array_get(cells, (size_t)k);
    ck_assert_str_eq(json_string_value(json_object_get(row, "case")), "ratio=1 H=0.001");
    ck_assert_str_eq(json_string_value(json_object_get(row, "scheme")), k ? "proxy" : "auto");
    ck_assert_str_eq(json_string_value(json_object_get(row, "outcome")), "ok");
    ck_assert(json_number_value(json_object_get(row, "error")) < 1e-2);
    ck_assert(json_number_value(json_object_get(row, "ceiling")) < 1e-6);
    ck_assert_double_eq_tol(json_number_value(json_object_get(row, "H")), 1e-3, 1e-12);
    ck_assert(json_is_false(json_object_get(row, "beyond")));
  }
  for (size_t i = 12; i < 18; i++) /* the box meets a stop, half a swing of which is half the window: by the numbers */
    ck_assert(json_is_true(json_object_get(json_array_get(cells, i), "beyond")));
  json_decref(json);
  directory_remove(dir);
}
END_TEST

/* Newton ends at steps of the rounding of t here: the integration of the parallelogram did not end. */
START_TEST(no_steps_without_end) {
  const char *dir = directory_make();
  const int status = command("tandem run %s/stability/fourbar.json --out %s/out --set parameters.ratio=10 "
                             "--set parameters.dt=1e-4 --set parameters.H=1e-3 --set coupling.scheme=iterative",
                             TANDEM_SOURCE_DIR "/scenarios", dir);
  ck_assert_msg(status == 0 || status == 1, "%d", status);
  if (status == 1)
    expect_output("singular position");
  directory_remove(dir);
}
END_TEST

/* each family's file is there, and so is its scene */
START_TEST(every_family_is_there) {
  int n = 0;
  for (const cpl_scenario *s = scn_table; s->name; s++) {
    char file[512];
    if (strcmp(s->group, "stability") != 0 || strcmp(s->name, "stability_map") == 0)
      continue;
    snprintf(file, sizeof file, TANDEM_SOURCE_DIR "/scenarios/stability/families/%s.json", s->name + 10);
    json_t *json = json_load_file(file, 0, NULL);
    ck_assert_msg(json != NULL, "%s", file);
    snprintf(file, sizeof file, TANDEM_SOURCE_DIR "/scenarios/stability/%s",
             json_string_value(json_object_get(json, "scene")));
    ck_assert_msg(access(file, R_OK) == 0, "%s", file);
    ck_assert_int_gt(json_array_size(json_object_get(json, "cases")), 0);
    json_decref(json);
    n++;
  }
  ck_assert_int_eq(n, 19);
}
END_TEST

TEST_MAIN("verify stability", a_run_is_judged_by_what_it_did_and_said, chaos_is_judged_by_mean_and_rms, a_small_family,
          no_steps_without_end, every_family_is_there)
