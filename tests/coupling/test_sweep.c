/* tandem sweep: the grid, its rows, resuming, cells that fail or are unstable. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/command.h"
#include "tests/test_main.h"

#include <jansson.h>
#include <math.h>

/* spring_damper with 20 particles and a short run: same reference, small fill. */
static const char scene[] =
    "{\"scenario\": \"spring_damper\", \"time\": {\"end\": 0.3, \"dt\": 2e-4},\n"
    " \"coupling\": {\"n\": 5, \"bodies\": [{\"mbd\": \"box\", \"dem\": \"box\"}]},\n"
    " \"mbd\": {\"bodies\": [{\"name\": \"box\", \"mass\": 10, \"inertia\": [1, 1, 1], \"position\": [0, 0, 0]}],\n"
    "  \"joints\": [{\"name\": \"guide\", \"type\": \"prismatic\", \"bodies\": [\"ground\", \"box\"], \"point\": [0, "
    "0, 0],\n"
    "   \"axis\": [0, 0, 1]}],\n"
    "  \"forces\": [{\"name\": \"spring\", \"type\": \"spring_damper\", \"bodies\": [\"ground\", \"box\"],\n"
    "   \"points\": [[0, 0, 3], [0, 0, 0]], \"stiffness\": 500, \"damping\": 50, \"preload\": 10}]},\n"
    " \"dem\": {\"materials\": [{\"name\": \"m\", \"density\": 1000, \"young_modulus\": 1e7, \"poisson_ratio\": "
    "0.2}],\n"
    "  \"pairs\": [{\"materials\": [\"m\", \"m\"], \"restitution\": 0.9, \"friction\": 0.5}],\n"
    "  \"bodies\": [{\"name\": \"box\", \"material\": \"m\", \"shapes\": [{\"type\": \"box\", \"size\": [0.3, 0.3, "
    "0.8],\n"
    "   \"side\": \"inside\"}]}],\n"
    "  \"particles\": [{\"type\": \"random\", \"material\": \"m\", \"count\": 20, \"radius\": 0.05, \"total_mass\": "
    "20,\n"
    "   \"region\": {\"min\": [-0.15, -0.15, -0.4], \"max\": [0.15, 0.15, 0.4]}}],\n"
    "  \"settle\": {\"speed\": 5e-3}}}\n";

static const char *dir;

static void setup(void) {
  dir = directory_with_scene(scene);
}

static json_t *rows_of(const char *name) {
  char file[256];
  snprintf(file, sizeof file, "%s/%s", dir, name);
  json_t *json = json_load_file(file, 0, NULL);
  ck_assert_ptr_nonnull(json);
  json_t *rows = json_incref(json_object_get(json, "rows"));
  json_decref(json);
  ck_assert(json_is_array(rows));
  return rows;
}

static const char *text(const json_t *row, const char *key) {
  return json_string_value(json_object_get(row, key));
}

START_TEST(a_grid_and_its_rows) {
  setup();
  int status = command("tandem sweep %s/scene.json --dt 2e-4,1e-4 --n 1,1000 --scheme lommen,hold --jobs 2 --out %s/s "
                       "--json %s/rows.json",
                       dir, dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  expect_output("[8/8]");
  expect_output("all nse >= 0.999"); /* named, or that there is none */
  expect_output("price of a window, hold");
  json_t *rows = rows_of("rows.json");
  ck_assert_uint_eq(json_array_size(rows), 8);
  size_t i;
  json_t *row;
  int good = 0;
  json_array_foreach(rows, i, row) {
    static const char *const keys[] = {
        "dt",          "n",  "scheme", "settings",        "status",   "reason",   "wall_s",
        "simulated_s", "r2", "nse",    "energy_residual", "window_s", "estimate", "estimate_numeric"};
    for (int k = 0; k < 14; k++)
      ck_assert_msg(json_object_get(row, keys[k]) != NULL, "no %s", keys[k]);
    double residual = json_number_value(json_object_get(row, "energy_residual"));
    ck_assert(json_number_value(json_object_get(row, "window_s")) > 0);
    json_t *r2 = json_object_get(row, "r2"), *nse = json_object_get(row, "nse");
    ck_assert(json_object_get(r2, "x") && json_object_get(r2, "v") && json_object_get(r2, "F") &&
              json_object_get(r2, "F_20ms"));
    ck_assert_uint_eq(json_object_size(nse), 2);
    ck_assert_double_eq(json_number_value(json_object_get(json_object_get(row, "settings"), "time.dt")),
                        json_number_value(json_object_get(row, "dt")));
    if (json_integer_value(json_object_get(row, "n")) == 1) {
      ck_assert_msg(strcmp(text(row, "status"), "ok") == 0, "%s: %s", text(row, "status"), text(row, "reason"));
      ck_assert_double_gt(json_number_value(json_object_get(nse, "x")), 0.99);
      ck_assert(residual > 0 && residual < 0.01);
      const double estimate = json_number_value(json_object_get(row, "estimate"));
      const double numeric = json_number_value(json_object_get(row, "estimate_numeric"));
      const double error =
          1 - fmin(json_number_value(json_object_get(nse, "x")), json_number_value(json_object_get(nse, "v")));
      ck_assert_msg(estimate > error / 9 && estimate < 9 * error, "%g expected, it is %g", estimate, error);
      ck_assert(numeric > 0 && numeric < estimate); /* the reference's fill is rigid, that of the run is not */
      good++;
    } else { /* windows of 0.1 s with a fill twice as heavy as the box */
      ck_assert_str_eq(text(row, "status"), "unstable");
      ck_assert_double_gt(residual, 0.1);
      ck_assert_ptr_nonnull(strstr(text(row, "reason"), "without a source"));
    }
  }
  ck_assert_int_eq(good, 4);
  json_decref(rows);
  static const char *const files[] = {"sweep.json", "sweep.csv",  "table.html",
                                      "cost.png",   "price.png",  "heat_energy.png",
                                      "heat_x.png", "heat_v.png", "cells/dt=2e-4_n=1_scheme=lommen/comparison.png"};
  for (int k = 0; k < 9; k++)
    ck_assert_msg(command("test -s %s/s/%s", dir, files[k]) == 0, "no %s", files[k]);
  ck_assert_int_eq(command("sh -c 'test $(ls -d %s/s/bed_* | wc -l) = 1'", dir), 0); /* one bed for all cells */
  directory_remove(dir);
}
END_TEST

START_TEST(resuming_keeps_what_is_there) {
  setup();
  ck_assert_int_eq(command("tandem sweep %s/scene.json --n 5,10 --out %s/s", dir, dir), 0);
  ck_assert_int_eq(command("rm %s/s/cells/n=10/row.json", dir), 0);
  ck_assert_int_eq(command("tandem sweep %s/scene.json --n 5,10,20 --out %s/s --resume", dir, dir), 0);
  expect_output("1 of 3 cells are there already");
  expect_output("[3/3]");
  json_t *rows = rows_of("s/sweep.json");
  ck_assert_uint_eq(json_array_size(rows), 3);
  json_decref(rows);
  /* who shares the work changes no result */
  ck_assert_int_eq(
      command("sed -i.before 's/\"dem\": {/&\"threads\": 2, \"ranks\": 2, \"decomposition\": {\"balance\": "
              "{}}, /' %s/scene.json",
              dir),
      0);
  ck_assert_int_eq(command("grep -q ranks %s/scene.json", dir), 0);
  ck_assert_int_eq(command("timeout 60 tandem sweep %s/scene.json --n 5,10,20 --out %s/s --resume", dir, dir), 0);
  expect_output("3 of 3 cells are there already");
  ck_assert_int_eq(command("mv %s/scene.json.before %s/scene.json", dir, dir), 0);
  /* another scene: nothing is kept */
  ck_assert_int_eq(command("tandem sweep %s/scene.json --n 5 --set time.end=0.2 --out %s/s --resume", dir, dir), 0);
  ck_assert_ptr_null(strstr(command_output, "there already"));
  directory_remove(dir);
}
END_TEST

START_TEST(another_scene_in_the_same_directory) {
  /* other particles are another bed, a refused scene leaves nothing behind that would be taken for a result */
  setup();
  ck_assert_int_eq(command("tandem sweep %s/scene.json --n 5 --out %s/s", dir, dir), 0);
  ck_assert_int_eq(
      command("tandem sweep %s/scene.json --n 5 --set 'dem.particles[0].seed=7' --out %s/s --force", dir, dir), 0);
  expect_output(": ok");
  ck_assert_int_eq(command("sh -c 'sed s/0.9,/1.9,/ %s/scene.json >%s/wrong.json'", dir, dir), 0);
  ck_assert_int_eq(command("tandem sweep %s/wrong.json --n 5 --out %s/s --force", dir, dir), 0);
  expect_output(": failed");
  ck_assert_int_eq(command("tandem sweep %s/scene.json --n 5 --out %s/s", dir, dir), 1);
  expect_output("holds the results of an earlier run");
  expect_output("--resume");
  ck_assert_int_eq(command("tandem sweep %s/scene.json --n 5 --out %s/s --resume", dir, dir), 0);
  expect_output(": ok");
  directory_remove(dir);
}
END_TEST

START_TEST(failing_cells_are_results) {
  setup();
  ck_assert_int_eq(
      command("tandem sweep %s/scene.json --n 5,0 --set 'dem.pairs[0].friction=0.5,-1' --out %s/s", dir, dir), 0);
  json_t *rows = rows_of("s/sweep.json");
  ck_assert_uint_eq(json_array_size(rows), 4);
  int failed = 0;
  for (size_t i = 0; i < 4; i++) {
    json_t *row = json_array_get(rows, i);
    if (strcmp(text(row, "status"), "failed") != 0)
      continue;
    failed++;
    ck_assert(json_is_null(json_object_get(json_object_get(row, "nse"), "x")));
    ck_assert(json_is_null(json_object_get(json_object_get(row, "r2"), "F_20ms")));
    ck_assert(strstr(text(row, "reason"), "at least 1") || strstr(text(row, "reason"), "0 or greater"));
  }
  ck_assert_int_eq(failed, 3);
  json_decref(rows);
  directory_remove(dir);
}
END_TEST

/* A solver without capabilities: the row has the scheme that ran, not the scene's. */
START_TEST(a_row_names_the_fallback) {
  dir = directory_make();
  write_file(
      dir, "scene.json",
      "{\"time\": {\"end\": 0.02, \"dt\": 1e-4},\n"
      " \"coupling\": {\"n\": 10, \"fallback\": \"lommen\", \"bodies\": [{\"mbd\": \"box\", \"dem\": \"box\"}]},\n"
      " \"mbd\": {\"gravity\": [0, 0, 0], \"bodies\": [{\"name\": \"box\", \"mass\": 1,\n"
      "  \"inertia\": [1, 1, 1], \"position\": [0, 0, 0], \"velocity\": [1, 0, 0]}]},\n"
      " \"dem\": {\"stiffness\": 100}}\n");
  int status = command("tandem sweep %s/scene.json --scheme proxy,hold --set coupling.solvers.dem=dummy_solver "
                       "--out %s/s --json %s/rows.json",
                       dir, dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  json_t *rows = rows_of("rows.json");
  ck_assert_str_eq(text(json_array_get(rows, 0), "scheme"), "lommen");
  ck_assert_str_eq(text(json_array_get(rows, 1), "scheme"), "hold");
  json_decref(rows);
  directory_remove(dir);
}
END_TEST

START_TEST(an_inexact_cell_is_not_ok) {
  dir = directory_make();
  int status = command("tandem sweep %s/scenarios/collision/scene.json --n 1,40 --scheme lommen --set "
                       "mbd.bodies[0].mass=0.02 --out %s/s --json %s/rows.json",
                       TANDEM_SOURCE_DIR, dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  json_t *rows = rows_of("rows.json");
  ck_assert_str_eq(text(json_array_get(rows, 0), "status"), "ok");
  ck_assert_str_eq(text(json_array_get(rows, 1), "status"), "inexact");
  ck_assert_ptr_nonnull(strstr(text(json_array_get(rows, 1), "reason"), "through the interface"));
  json_decref(rows);
  directory_remove(dir);
}
END_TEST

START_TEST(interrupted_and_resumed) {
  setup();
  char file[128], out[128];
  snprintf(file, sizeof file, "%s/scene.json", dir);
  snprintf(out, sizeof out, "%s/s", dir);
  const char *const arguments[] = {"sweep",  file, "--n",   "5,1", "--set", "time.end=0.3,1e5",
                                   "--jobs", "2",  "--out", out,   NULL};
  pid_t pid = background(dir, arguments);
  WAIT_FOR(command("test -s %s/cells/n=5_end=0.3/row.json", out) == 0);
  kill(pid, SIGTERM);
  ck_assert_int_eq(background_end(pid), 130);
  background_output(dir);
  expect_output("--resume continues the sweep");
  expect_nothing_left(dir);
  json_t *rows = rows_of("s/sweep.json");
  ck_assert_uint_ge(json_array_size(rows), 1); /* what was done is there; the endless cells are not */
  ck_assert_uint_le(json_array_size(rows), 2);
  json_decref(rows);
  directory_remove(dir);
}
END_TEST

START_TEST(wrong_command_lines) {
  setup();
  ck_assert_int_eq(command("tandem sweep %s/scene.json --n 5,,10", dir), 2);
  expect_output("an empty value");
  ck_assert_int_eq(command("tandem sweep %s/scene.json --jobs none", dir), 2);
  ck_assert_int_eq(command("tandem sweep %s/scene.json --n 5 --set coupling.n=3", dir), 2);
  expect_output("given twice");
  ck_assert_int_eq(command("tandem sweep %s/scene.json --n 5,5", dir), 2);
  expect_output("has the value 5 twice");
  ck_assert_int_eq(command("tandem sweep %s/scene.json --n 5 --out %s/s --json /nonexistent/x.json", dir, dir), 1);
  expect_output("/nonexistent/x.json: cannot be written");
  ck_assert_int_eq(command("tandem run %s/scene.json --dt 1e-4", dir), 2);
  expect_output("--dt does not go with this command");
  ck_assert_int_eq(command("tandem sweep %s/nothing.json --n 5 --out %s/s", dir, dir), 1);
  directory_remove(dir);
}
END_TEST

TEST_MAIN("sweep", a_grid_and_its_rows, resuming_keeps_what_is_there, another_scene_in_the_same_directory,
          failing_cells_are_results, a_row_names_the_fallback, an_inexact_cell_is_not_ok, interrupted_and_resumed,
          wrong_command_lines)
