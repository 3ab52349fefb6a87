/* tandem-mbd run and check as a user calls them: the files of a run, bit-identity, wrong input. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/command.h"
#include "tests/result_table.h"
#include "tests/test_main.h"

#include <jansson.h>
#include <math.h>
#include <stdbool.h>

/* A pendulum whose centre of mass is 1 m from its pivot, released level; 0.1 m + inertia of a ball. */
static const char scene[] =
    "{\"time\": {\"end\": 0.5},\n"
    " \"output\": {\"interval\": 0.01},\n"
    " \"mbd\": {\"gravity\": [0, -9.81, 0],\n"
    "  \"bodies\": [{\"name\": \"bob\", \"mass\": 2, \"inertia\": [0.1, 0.1, 0.1], \"position\": [1, 0, 0]}],\n"
    "  \"joints\": [{\"name\": \"pivot\", \"type\": \"revolute\", \"bodies\": [\"ground\", \"bob\"], \"point\": [0, 0, "
    "0],\n"
    "   \"axis\": [0, 0, 1]}]}}\n";

static const char *dir;

static void setup(void) {
  dir = directory_with_scene(scene);
}

static void run(const char *out, const char *options) {
  int status = command("tandem-mbd run %s/scene.json --out %s/%s %s", dir, dir, out, options);
  ck_assert_msg(status == 0, "%d: %s", status, command_output);
}

static double number(const json_t *json, const char *a, const char *b) {
  const json_t *value = json_object_get(json, a);
  value = b ? json_object_get(value, b) : value;
  ck_assert_msg(json_is_number(value), "%s.%s is no number", a, b ? b : "");
  return json_number_value(value);
}

START_TEST(a_run_writes_its_files) {
  setup();
  run("out", "--set mbd.solver.relative_tolerance=1e-10");
  static const char *const files[] = {"channels.csv", "scene.json",   "summary.json",  "mbd.log",  "motion.png",
                                      "motion.gp",    "energies.png", "reactions.png", "drift.png"};
  for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
    ck_assert_msg(is_there(dir, "out", files[i]), "%s", files[i]);
  cpl_table t;
  read_table(&t, dir, "out/channels.csv");
  ck_assert_int_eq(t.nrow, 51);
  const double *time = column(&t, "time"), *x = column(&t, "body.bob.x"), *y = column(&t, "body.bob.y");
  const double *kinetic = column(&t, "energy.kinetic"), *potential = column(&t, "energy.potential");
  const double *fy = column(&t, "joint.pivot.fy"), *drift = column(&t, "constraint.drift");
  ck_assert_double_eq(time[0], 0);
  ck_assert_double_eq_tol(time[50], 0.5, 1e-15);
  for (int i = 0; i < t.nrow; i++) {
    ck_assert_double_eq_tol(x[i] * x[i] + y[i] * y[i], 1, 1e-8);
    ck_assert_double_eq_tol(kinetic[i] + potential[i], 0, 1e-7);
    ck_assert(drift[i] >= 0 && drift[i] < 1e-9);
  }
  /* at rest and level the pivot carries the weight less m g / (1 + I/(m l^2)) */
  ck_assert_double_eq_tol(fy[0], 2 * 9.81 * (1 - 1 / 1.05), 1e-9);
  cpl_table_free(&t);

  char path[512];
  snprintf(path, sizeof path, "%s/out/summary.json", dir);
  json_t *summary = json_load_file(path, 0, NULL);
  ck_assert_str_eq(json_string_value(json_object_get(summary, "status")), "TDM_OK");
  ck_assert_str_eq(json_string_value(json_object_get(json_object_get(summary, "solver"), "formulation")), "ggl");
  ck_assert_double_eq(number(summary, "simulated_s", NULL), 0.5);
  ck_assert(number(summary, "integrator", "steps") > 20 && number(summary, "integrator", "residuals") > 20);
  ck_assert(number(summary, "wall_s", "mbd") > 0);
  ck_assert(number(summary, "constraint_drift", NULL) < 1e-9);
  ck_assert_double_eq(number(summary, "report", "degrees_of_freedom"), 1);
  json_decref(summary);
  directory_remove(dir);
}
END_TEST

START_TEST(runs_are_bit_identical) {
  setup();
  run("one", "");
  run("two", "");
  ck_assert_msg(command("cmp %s/one/channels.csv %s/two/channels.csv", dir, dir) == 0, "%s", command_output);
  directory_remove(dir);
}
END_TEST

START_TEST(windows_and_grid_change_little) {
  setup();
  run("one", "--set mbd.solver.relative_tolerance=1e-10");
  run("two", "--set mbd.solver.relative_tolerance=1e-10 --set time.dt=0.013 --set output.interval=0.1");
  cpl_table a, b;
  read_table(&a, dir, "one/channels.csv");
  read_table(&b, dir, "two/channels.csv");
  ck_assert_int_eq(b.nrow, 6);
  for (int i = 0; i < b.nrow; i++)
    ck_assert_double_eq_tol(column(&b, "body.bob.y")[i], column(&a, "body.bob.y")[10 * i], 1e-7);
  cpl_table_free(&a);
  /* a grid that does not end with the run */
  run("three", "--set output.interval=0.03");
  read_table(&a, dir, "three/channels.csv");
  ck_assert_int_eq(a.nrow, 18);
  ck_assert_double_eq_tol(column(&a, "time")[16], 0.48, 1e-15);
  ck_assert_double_eq(column(&a, "time")[17], 0.5);
  ck_assert_double_eq_tol(column(&a, "body.bob.y")[17], column(&b, "body.bob.y")[5], 1e-5);
  cpl_table_free(&a);
  run("four", "--set output.interval=0.7");
  expect_output("output.interval: is 0.7 s but the run ends at 0.5 s");
  read_table(&a, dir, "four/channels.csv");
  ck_assert_int_eq(a.nrow, 2);
  ck_assert_double_eq(column(&a, "time")[1], 0.5);
  cpl_table_free(&a);
  cpl_table_free(&b);
  directory_remove(dir);
}
END_TEST

START_TEST(results_are_kept) {
  setup();
  run("out", "");
  ck_assert_int_eq(command("tandem-mbd run %s/scene.json --out %s/out", dir, dir), 1);
  expect_output("--force");
  run("out", "--force --set time.end=0.1");
  cpl_table t;
  read_table(&t, dir, "out/channels.csv");
  ck_assert_int_eq(t.nrow, 11);
  cpl_table_free(&t);
  directory_remove(dir);
}
END_TEST

/* --no-plots leaves these out, and nothing else; tandem report makes its own */
START_TEST(plots_can_be_left_out) {
  setup();
  run("out", "--no-plots");
  ck_assert(is_there(dir, "out", "channels.csv") && is_there(dir, "out", "summary.json"));
  ck_assert(!is_there(dir, "out", "motion.gp") && !is_there(dir, "out", "motion.png") &&
            !is_there(dir, "out", "drift.png"));
  ck_assert_int_eq(command("tandem report %s/out", dir), 0);
  ck_assert(is_there(dir, "out", "index.html"));
  directory_remove(dir);
}
END_TEST

START_TEST(without_gnuplot_runs_work) {
  setup();
  int status = command("env PATH=/nowhere " TANDEM_BIN_DIR "/tandem-mbd run %s/scene.json --out %s/out", dir, dir);
  ck_assert_msg(status == 0, "%d: %s", status, command_output);
  expect_output("gnuplot is not installed");
  ck_assert(is_there(dir, "out", "channels.csv") && is_there(dir, "out", "summary.json"));
  directory_remove(dir);
}
END_TEST

START_TEST(check_says_what_would_run) {
  setup();
  ck_assert_int_eq(command("tandem-mbd check %s/scene.json --set mbd.formulation=index3", dir), 0);
  expect_output("index3");
  expect_output("degrees_of_freedom           1");
  expect_output("51 rows");
  ck_assert_int_eq(command("tandem-mbd check %s/scene.json --out x", dir), 2);
  expect_output("--out does not go with");
  ck_assert_int_eq(command("tandem-mbd check heavy_top --scenarios " TANDEM_SOURCE_DIR "/scenarios"), 0);
  directory_remove(dir);
}
END_TEST

static const struct {
  const char *options, *path, *words;
} cases[] = {
    {"--set time.end=0", "time.end", "greater than 0"},
    {"--set time.dt=0", "time.dt", "greater than 0"},
    {"--set time.dt=2", "time.dt", "longer than the whole run"},
    {"--set time.edn=1", "time.edn", "did you mean \"end\""},
    {"--set output.interval=0", "output.interval", "greater than 0"},
    {"--set output.interval=1e-12", "output.interval", "take longer ones"},
    {"--set output.intervall=1", "output.intervall", "did you mean \"interval\""},
    {"--set coupling.n=3", "coupling", "tandem run"},
    {"--set dem.bodies=[]", "dem", "tandem run"},
    {"--set mbdd.gravity=1", "mbdd", "did you mean \"mbd\""},
    {"--set mbd.joints[0].bodies[1]=\"bobb\"", "mbd.joints[0].bodies[1]", "did you mean \"bob\""},
    {"--set mbd.bodies[0].mass=0", "mbd.bodies[0].mass", "greater than 0"},
    {"--set mbd.bodies[0].velocity=[1,0,0] --strict", "mbd.bodies[0].velocity", "strict"},
};

START_TEST(values_of_the_scene) {
  setup();
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    int status = command("tandem-mbd run %s/scene.json --out %s/out --force %s", dir, dir, cases[i].options);
    ck_assert_msg(status == 1, "%s: exit status %d: %s", cases[i].options, status, command_output);
    char path[256];
    snprintf(path, sizeof path, ": %s: ", cases[i].path);
    ck_assert_msg(
        strstr(command_output, path) && strstr(command_output, cases[i].words) && strstr(command_output, "scene.json:"),
        "%s: expected place, \"%s\" and \"%s\" in: %s", cases[i].options, path, cases[i].words, command_output);
  }
  directory_remove(dir);
}
END_TEST

static const struct {
  const char *line, *words;
} lines[] = {
    {"tandem-mbd rnu x", "did you mean run"},    {"tandem-mbd run", "name one scene"},
    {"tandem-mbd run a b", "name one scene"},    {"tandem-mbd run x --frce", "did you mean --force"},
    {"tandem-mbd run x --out", "needs a value"}, {"tandem-mbd check x --no-plots", "--no-plots does not go"},
};

/* A fall onto a stiff stop in steps that hop over the impact: without an error test it makes energy. */
START_TEST(energy_is_judged) {
  char path[512];
  dir = directory_make();
  write_file(dir, "scene.json",
             "{\"time\": {\"end\": 4}, \"output\": {\"interval\": 0.01},\n"
             " \"mbd\": {\"formulation\": \"one_step\", \"solver\": {\"absolute_tolerance\": 1e6},\n"
             "  \"bodies\": [{\"name\": \"b\", \"mass\": 2, \"inertia\": [1, 1, 1], \"position\": [0, 0, 6]}],\n"
             "  \"joints\": [{\"name\": \"rail\", \"type\": \"prismatic\", \"bodies\": [\"ground\", \"b\"], \"point\": "
             "[0, 0, 6], \"axis\": [0, 0, 1]}],\n"
             "  \"forces\": [{\"name\": \"floor\", \"type\": \"stop\", \"joint\": \"rail\", \"lower\": -6, "
             "\"stiffness\": 2e7, \"exponent\": 1.5}]}}");
  ck_assert_int_eq(command("tandem-mbd run %s/scene.json --out %s/stop", dir, dir), 1);
  expect_output("the bodies have gained");
  expect_output("smaller tolerances");
  snprintf(path, sizeof path, "%s/stop/summary.json", dir);
  json_t *summary = json_load_file(path, 0, NULL);
  ck_assert_str_eq(json_string_value(json_object_get(summary, "status")), "TDM_ERR_NUMERIC");
  ck_assert_double_lt(number(summary, "simulated_s", NULL), 2);
  ck_assert_double_gt(number(summary, "energy_off", "share"), 0.1);
  json_decref(summary);
  ck_assert_int_eq(command("tandem-mbd run %s/scene.json --out %s/warn --set mbd.guard.action=warn", dir, dir), 0);
  expect_output("warning");
  expect_output("the bodies have gained");
  snprintf(path, sizeof path, "%s/warn/summary.json", dir);
  summary = json_load_file(path, 0, NULL);
  ck_assert_int_eq((int)json_array_size(json_object_get(summary, "warnings")), 1);
  json_decref(summary);
  ck_assert_int_eq(command("tandem-mbd run %s/scene.json --out %s/off --set mbd.guard.action=off", dir, dir), 0);
  ck_assert_ptr_null(strstr(command_output, "gained"));
  /* with its error test */
  ck_assert_int_eq(
      command("tandem-mbd run %s/scene.json --out %s/good --set mbd.solver.absolute_tolerance=1e-10", dir, dir), 0);
  ck_assert_ptr_null(strstr(command_output, "gained"));
  snprintf(path, sizeof path, "%s/good/summary.json", dir);
  summary = json_load_file(path, 0, NULL);
  ck_assert_double_lt(number(summary, "energy_off", "share"), 1e-4);
  json_decref(summary);
  directory_remove(dir);
}
END_TEST

START_TEST(command_lines) {
  for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
    int status = command("%s", lines[i].line);
    ck_assert_msg(status == 2 && strstr(command_output, lines[i].words), "%s: %d, %s", lines[i].line, status,
                  command_output);
  }
  ck_assert_int_eq(command("tandem-mbd run nothing_of_that_name"), 1);
  expect_output("neither a scene file nor a scenario");
  ck_assert_int_eq(command("tandem-mbd run hopper"), 1);
  expect_output("run it with: tandem-dem run hopper");
  ck_assert_int_eq(command("tandem-mbd --help"), 0);
  expect_output("tandem-mbd run SCENE");
}
END_TEST

TEST_MAIN("mbd_run", a_run_writes_its_files, runs_are_bit_identical, windows_and_grid_change_little, results_are_kept,
          plots_can_be_left_out, without_gnuplot_runs_work, check_says_what_would_run, values_of_the_scene,
          command_lines, energy_is_judged)
