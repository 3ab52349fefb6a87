/* tandem sweep by measures: study files, seeds, cases, published values, cells that fail, resuming, options, and
 * studies that verify runs. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/verify/verify.h"
#include "tests/command.h"
#include "tests/test_main.h"

#include <math.h>

/* One ball of radius 0.05 m and density 1000 kg/m^3 that falls freely: its kinetic energy is m (g t)^2/2. */
static const char ball[] =
    "{'time': {'end': 0.1, 'dt': 1e-4}, 'output': {'interval': 0.01},\n"
    " 'dem': {'gravity': [0, 0, -10],\n"
    "  'materials': [{'name': 'm', 'density': 1000, 'young_modulus': 1e6, 'poisson_ratio': 0.2}],\n"
    "  'pairs': [{'materials': ['m', 'm'], 'restitution': 0.6, 'friction': 0.3}],\n"
    "  'particles': [{'type': 'list', 'material': 'm', 'radius': 0.05, 'positions': [[0, 0, 0]]}]}}\n";

static double energy(double density, double gravity, double time) {
  const double mass = density * 4 / 3 * M_PI * pow(0.05, 3);
  return 0.5 * mass * pow(gravity * time, 2);
}

static const char *dir;

/* A directory with scene.json (the ball) and study.json, whose single quotes become double ones. */
static void setup(const char *study) {
  char text[4096];
  dir = directory_with_scene(ball);
  ck_assert_uint_lt(strlen(study), sizeof text);
  strcpy(text, study);
  double_quotes(text);
  write_file(dir, "study.json", text);
}

static json_t *load(const char *name) {
  char file[256];
  snprintf(file, sizeof file, "%s/%s", dir, name);
  json_t *json = json_load_file(file, 0, NULL);
  ck_assert_msg(json != NULL, "no %s; output:\n%s", file, command_output);
  return json;
}

static const json_t *cell_named(const json_t *study, const char *name) {
  size_t i;
  json_t *cell;
  json_array_foreach(json_object_get(study, "cells"), i, cell) {
    if (strcmp(json_string_value(json_object_get(cell, "name")), name) == 0)
      return cell;
  }
  ck_abort_msg("no cell %s", name);
}

/* mean, min, max, sd or n of a measure in a cell; NaN for null */
static double number(const json_t *study, const char *cell, const char *measure, const char *what) {
  const json_t *measures = json_object_get(cell_named(study, cell), "measures");
  const json_t *value = json_object_get(json_object_get(measures, measure), what);
  ck_assert_msg(value != NULL, "no %s of %s in %s", what, measure, cell);
  return json_is_number(value) ? json_number_value(value) : NAN;
}

static bool has(const char *name) {
  char file[512];
  snprintf(file, sizeof file, "%s/%s", dir, name);
  return access(file, R_OK) == 0;
}

/* A text stands in a file. */
static bool says(const char *name, const char *text) {
  return command("grep -qF -e '%s' %s/%s", text, dir, name) == 0;
}

#define near(a, b) ck_assert_double_eq_tol(a, b, 1e-9 * fabs(b))

static const char grid[] =
    "{'title': 'A ball', 'scene': 'scene.json', 'set': {'output.interval': 0.005},\n"
    " 'axes': [{'path': 'dem.gravity[2]', 'values': [-10, -20], 'title': 'gravity', 'unit': 'm/s2'},\n"
    "  {'path': 'dem.materials[0].density', 'values': [1000, 2000]}],\n"
    " 'seeds': {'path': 'time.end', 'values': [0.1, 0.2, 0.3]},\n"
    " 'measures': [{'channel': 'dem:particles.kinetic_energy', 'name': 'energy', 'unit': 'mJ', 'factor': 1000,\n"
    "   'published': {'source': '[X00] Fig. 1', 'points': [[-10, 260], [-15, 700]]}},\n"
    "  {'channel': 'dem:particles.kinetic_energy', 'at': [0.02, 0.08], 'name': 'span'},\n"
    "  {'channel': 'dem:particles.velocity.z', 'at': 'min'},\n"
    "  {'path': 'summary.particles', 'title': 'particles'}],\n"
    " 'curves': [{'channel': 'dem:particles.kinetic_energy', 'name': 'energy', 'unit': 'J'}]}\n";

START_TEST(a_grid_with_seeds) {
  setup(grid);
  int status = command("tandem sweep %s/study.json --jobs 2 --out %s/s --json %s/copy.json", dir, dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  expect_output("[12/12]");
  json_t *study = load("copy.json");
  ck_assert_uint_eq(json_array_size(json_object_get(study, "cells")), 4);
  for (int g = 1; g <= 2; g++)
    for (int d = 1; d <= 2; d++) {
      char name[64];
      double e[3], mean = 0, squares = 0;
      snprintf(name, sizeof name, "gravity[2]=-%d density=%d", 10 * g, 1000 * d);
      for (int s = 0; s < 3; s++) {
        e[s] = 1e3 * energy(1000 * d, 10 * g, 0.1 * (s + 1));
        mean += e[s] / 3;
      }
      for (int s = 0; s < 3; s++)
        squares += (e[s] - mean) * (e[s] - mean);
      ck_assert_double_eq(number(study, name, "energy", "n"), 3);
      near(number(study, name, "energy", "mean"), mean);
      near(number(study, name, "energy", "min"), e[0]);
      near(number(study, name, "energy", "max"), e[2]);
      near(number(study, name, "energy", "sd"), sqrt(squares / 2));
      near(number(study, name, "particles.velocity.z_min", "min"), -10 * g * 0.3);
      ck_assert_double_eq(number(study, name, "particles", "mean"), 1);
      ck_assert_double_gt(number(study, name, "run_time", "mean"), 0);
      /* the mean of t^2 over [0.02, 0.08] by straight lines through rows 5 ms apart: h^2/6 more than the integral */
      const double square = (pow(0.08, 3) - pow(0.02, 3)) / 3 / 0.06 + pow(0.005, 2) / 6;
      near(number(study, name, "span", "mean"), energy(1000 * d, 10 * g, sqrt(square)));
    }
  ck_assert_str_eq(json_string_value(json_object_get(cell_named(study, "gravity[2]=-10 density=1000"), "status")),
                   "ok");
  json_decref(study);
  static const char *const files[] = {"s/study.json",       "s/study.csv",
                                      "s/table.html",       "s/measure_energy.png",
                                      "s/measure_span.png", "s/measure_run_time.png",
                                      "s/curve_energy.png", "s/cells/gravity_2_=-10_density=1000_end=0.1_"};
  for (int k = 0; k < 7; k++)
    ck_assert_msg(has(files[k]), "no %s", files[k]);
  ck_assert(says("s/table.html", "[X00] Fig. 1") && says("s/table.html", "within the spread"));
  ck_assert(says("s/measure_energy.gp", "[X00] Fig. 1") && says("s/measure_energy.gp", "-15,nan"));
  ck_assert(says("s/study.csv", "energy.sd [mJ]"));
  directory_remove(dir);
}
END_TEST

/* A part of the seeds: pages and plots tell of the runs that were, and the others come later. */
START_TEST(some_of_the_seeds) {
  setup("{'scene': 'scene.json', 'axes': [{'path': 'dem.gravity[2]', 'values': [-10, -20]}],\n"
        " 'seeds': {'path': 'time.end', 'values': [0.1, 0.2, 0.3]},\n"
        " 'measures': [{'channel': 'dem:particles.kinetic_energy', 'name': 'energy'}],\n"
        " 'curves': [{'channel': 'dem:particles.kinetic_energy', 'name': 'energy'}]}\n");
  ck_assert_int_eq(command("tandem sweep %s/study.json --out %s/s --seeds 0.2", dir, dir), 0);
  expect_output("[2/2]");
  json_t *study = load("s/study.json");
  ck_assert_double_eq(number(study, "gravity[2]=-20", "energy", "n"), 1);
  near(number(study, "gravity[2]=-20", "energy", "mean"), energy(1000, 20, 0.2));
  ck_assert_uint_eq(json_array_size(json_object_get(cell_named(study, "gravity[2]=-20"), "runs")), 1);
  json_decref(study);
  ck_assert(!says("s/measure_energy.gp", "runs") && !says("s/curve_energy.gp", "mean of"));
  ck_assert(says("s/table.html", "time.end = 0.2 (of 3 in the study)") && !says("s/table.html", "3 runs"));
  ck_assert_int_eq(command("tandem sweep %s/study.json --out %s/s --seeds 0.1,0.2 --resume", dir, dir), 0);
  expect_output("2 of 4 cells are there already");
  study = load("s/study.json");
  near(number(study, "gravity[2]=-20", "energy", "max"), energy(1000, 20, 0.2));
  near(number(study, "gravity[2]=-20", "energy", "min"), energy(1000, 20, 0.1));
  json_decref(study);
  ck_assert(says("s/measure_energy.gp", "least to greatest of 2 runs") && says("s/curve_energy.gp", "mean of"));
  ck_assert(says("s/table.html", "time.end = 0.1, 0.2 (of 3 in the study)") && says("s/table.html", "2 runs"));
  ck_assert_int_eq(command("tandem sweep %s/study.json --out %s/s --resume", dir, dir), 0);
  expect_output("4 of 6 cells are there already");
  ck_assert(says("s/measure_energy.gp", "least to greatest of 3 runs"));
  ck_assert(says("s/table.html", "time.end = 0.1, 0.2, 0.3.</p>"));
  /* one that is not there; no list; a study without seeds; a command without studies */
  ck_assert_int_eq(command("tandem sweep %s/study.json --out %s/t --seeds 0.2,0.4", dir, dir), 2);
  expect_output("the study has no seed \"0.4\"; its seeds are 0.1, 0.2, 0.3");
  ck_assert_int_eq(command("tandem sweep %s/study.json --out %s/u --seeds 0.2,", dir, dir), 2);
  expect_output("an empty value");
  ck_assert_int_eq(command("tandem sweep %s/scene.json --out %s/v --seeds 1", dir, dir), 2);
  expect_output("it repeats nothing");
  ck_assert_int_eq(command("tandem run %s/scene.json --out %s/w --seeds 1", dir, dir), 2);
  directory_remove(dir);
}
END_TEST

/* Neighbours along the first axis: differences against the spread of the seeds, known from the formula. */
START_TEST(neighbours_and_the_spread) {
  setup("{'scene': 'scene.json', 'axes': [{'path': 'dem.gravity[2]', 'values': [-10, -10.1, -20]}],\n"
        " 'seeds': {'path': 'time.end', 'values': [0.1, 0.11]},\n"
        " 'measures': [{'channel': 'dem:particles.kinetic_energy', 'name': 'energy'}]}\n");
  ck_assert_int_eq(command("tandem sweep %s/study.json --out %s/s", dir, dir), 0);
  json_t *study = load("s/study.json"), *pair;
  size_t i;
  int seen = 0;
  json_array_foreach(json_object_get(study, "neighbours"), i, pair) {
    if (strcmp(json_string_value(json_object_get(pair, "measure")), "energy") != 0)
      continue;
    const bool small = strcmp(json_string_value(json_object_get(pair, "to")), "gravity[2]=-10.1") == 0;
    const double a = small ? 10 : 10.1, b = small ? 10.1 : 20;
    const double mean_a = energy(1000, a, sqrt((0.1 * 0.1 + 0.11 * 0.11) / 2));
    const double mean_b = energy(1000, b, sqrt((0.1 * 0.1 + 0.11 * 0.11) / 2));
    near(json_number_value(json_object_get(pair, "difference")), mean_b - mean_a);
    near(json_number_value(json_object_get(pair, "spread")), energy(1000, b, 0.11) - energy(1000, b, 0.1));
    ck_assert(json_is_true(json_object_get(pair, "larger")) == !small);
    seen++;
  }
  ck_assert_int_eq(seen, 2);
  json_decref(study);
  directory_remove(dir);
}
END_TEST

static const char cases[] =
    "{'scene': 'scene.json',\n"
    " 'cells': [{'label': 'light', 'set': {'dem.materials[0].density': 500}},\n"
    "  {'label': 'a wrong one', 'set': {'dem.pairs[0].friction': -1}},\n"
    "  {'label': 'other', 'scene': 'other.json', 'set': {'time.end': 0.05}}],\n"
    " 'measures': [{'channel': 'dem:particles.kinetic_energy', 'name': 'energy', 'unit': 'J',\n"
    "  'published': [{'points': [['light', 0.2], ['other', 0.3]]}]}, {'channel': 'dem:nothing'}]}\n";

START_TEST(cases_with_labels_and_one_that_fails) {
  setup(cases);
  ck_assert_int_eq(command("sh -c 'sed s/1000/3000/ %s/scene.json >%s/other.json'", dir, dir), 0);
  ck_assert_int_eq(command("tandem sweep %s/study.json --out %s/s", dir, dir), 0);
  expect_output("is -1 but must be 0 or greater");
  expect_output("measure nothing has no number: light: no column");
  json_t *study = load("s/study.json");
  near(number(study, "light", "energy", "mean"), energy(500, 10, 0.1));
  near(number(study, "other", "energy", "mean"), energy(3000, 10, 0.05));
  ck_assert(isnan(number(study, "a wrong one", "energy", "mean")));
  ck_assert_double_eq(number(study, "a wrong one", "energy", "n"), 0);
  const json_t *wrong = cell_named(study, "a wrong one");
  ck_assert_str_eq(json_string_value(json_object_get(wrong, "status")), "failed");
  const json_t *run = json_array_get(json_object_get(wrong, "runs"), 0);
  ck_assert_ptr_nonnull(strstr(json_string_value(json_object_get(run, "reason")), "dem.pairs[0].friction"));
  json_decref(study);
  ck_assert(says("s/measure_energy.gp", "\"a wrong one\" 1"));
  ck_assert(says("s/table.html", "0.3 <span"));
  /* other measures of the same runs; what failed is tried again */
  ck_assert_int_eq(command("sh -c 'sed -i s/nothing/particles.count/ %s/study.json'", dir), 0);
  ck_assert_int_eq(command("tandem sweep %s/study.json --out %s/s --resume", dir, dir), 0);
  expect_output("2 of 3 cells are there already");
  study = load("s/study.json");
  ck_assert_double_eq(number(study, "light", "particles.count", "mean"), 1);
  json_decref(study);
  /* one of the cells, with another end */
  ck_assert_int_eq(command("tandem sweep %s/study.json --out %s/t --cell light --set time.end=0.2", dir, dir), 0);
  expect_output("[1/1] light: ok");
  study = load("t/study.json");
  near(number(study, "light", "energy", "mean"), energy(500, 10, 0.2));
  ck_assert_uint_eq(json_array_size(json_object_get(study, "cells")), 1);
  json_decref(study);
  ck_assert_int_eq(command("tandem sweep %s/study.json --out %s/u --cell lihgt", dir, dir), 2);
  expect_output("did you mean light");
  ck_assert(!has("u"));
  directory_remove(dir);
}
END_TEST

/* Killed while a long run goes: nothing is left that runs, and --resume goes on with what was not done. */
START_TEST(killed_and_resumed) {
  setup("{'scene': 'scene.json', 'axes': [{'path': 'time.end', 'values': [0.1, 1e6]}],\n"
        " 'measures': [{'channel': 'dem:particles.kinetic_energy', 'name': 'energy'}]}\n");
  char file[128], out[128];
  snprintf(file, sizeof file, "%s/study.json", dir);
  snprintf(out, sizeof out, "%s/s", dir);
  const char *const arguments[] = {"sweep", file, "--jobs", "2", "--out", out, NULL};
  pid_t pid = background(dir, arguments);
  WAIT_FOR(has("s/cells/end=0.1/row.json") && has("s/cells/end=1000000/channels.csv"));
  kill(pid, SIGKILL);
  background_end(pid);
  expect_nothing_left(dir);
  ck_assert(!has("s/study.json"));
  /* a signal to this process: the results so far are written */
  const char *const again[] = {"sweep", file, "--jobs", "2", "--out", out, "--resume", NULL};
  pid = background(dir, again);
  WAIT_FOR(background_said(dir, "1 of 2 cells are there already"));
  kill(pid, SIGTERM);
  ck_assert_int_eq(background_end(pid), 130);
  ck_assert(background_said(dir, "--resume continues the sweep"));
  expect_nothing_left(dir);
  json_t *half = load("s/study.json");
  ck_assert_uint_eq(json_array_size(json_object_get(half, "cells")), 1);
  json_decref(half);
  ck_assert_int_eq(command("sh -c 'sed -i s/1e6/0.2/ %s/study.json'", dir), 0);
  ck_assert_int_eq(command("tandem sweep %s/study.json --out %s/s --resume", dir, dir), 0);
  expect_output("1 of 2 cells are there already");
  json_t *study = load("s/study.json");
  near(number(study, "end=0.1", "energy", "mean"), energy(1000, 10, 0.1));
  near(number(study, "end=0.2", "energy", "mean"), energy(1000, 10, 0.2));
  json_decref(study);
  directory_remove(dir);
}
END_TEST

START_TEST(from_options) {
  setup("{}");
  int status = command("tandem sweep %s/scene.json --set dem.gravity[2]=-10,-20 --repeat time.end=0.1,0.2 --measure "
                       "dem:particles.kinetic_energy --measure dem:particles.velocity.z@[0.02,0.04] --measure steps "
                       "--out %s/s",
                       dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  json_t *study = load("s/study.json");
  near(number(study, "gravity[2]=-20", "particles.kinetic_energy", "max"), energy(1000, 20, 0.2));
  near(number(study, "gravity[2]=-20", "particles.velocity.z_span", "mean"), -20 * 0.03);
  ck_assert_double_eq(number(study, "gravity[2]=-10", "steps", "mean"), 1500);
  json_decref(study);
  /* particles alone without a measure: the run time */
  ck_assert_int_eq(command("tandem sweep %s/scene.json --set dem.gravity[2]=-10,-20 --out %s/t", dir, dir), 0);
  study = load("t/study.json");
  ck_assert_double_gt(number(study, "gravity[2]=-10", "run_time", "mean"), 0);
  json_decref(study);
  directory_remove(dir);
}
END_TEST

/* A study varies names of the scene's numbers; an expression of them as a value. */
START_TEST(parameters_of_the_scene) {
  setup("{'scene': 'named.json', 'set': {'parameters.end': '=0.05*k'},\n"
        " 'axes': [{'path': 'parameters.k', 'values': [2, 4]}],\n"
        " 'measures': [{'channel': 'dem:particles.kinetic_energy', 'name': 'energy'}, {'path': "
        "'summary.parameters.end'}]}\n");
  ck_assert_int_eq(command("sh -c 'sed \"s/.time.: {.end.: 0.1,/\\\"parameters\\\": {\\\"k\\\": 1, \\\"end\\\": 0.1}, "
                           "\\\"time\\\": {\\\"end\\\": \\\"=end\\\",/\" %s/scene.json >%s/named.json'",
                           dir, dir),
                   0);
  ck_assert_msg(command("tandem sweep %s/study.json --out %s/s", dir, dir) == 0, "%s", command_output);
  json_t *study = load("s/study.json");
  near(number(study, "k=4", "energy", "mean"), energy(1000, 10, 0.2));
  near(number(study, "k=2", "parameters.end", "mean"), 0.1);
  json_decref(study);
  ck_assert_int_eq(command("tandem sweep %s/study.json --out %s/s --resume", dir, dir), 0);
  expect_output("2 of 2 cells are there already");
  ck_assert_int_eq(command("sh -c 'sed -i s/parameters.k/parameters.kk/ %s/study.json'", dir), 0);
  ck_assert_int_eq(command("tandem sweep %s/study.json --out %s/t", dir, dir), 1);
  expect_output("study.json:2:");
  expect_output("axes[0].path: \"parameters.kk\" is no place in the scene");
  directory_remove(dir);
}
END_TEST

/* A scene for both solvers: a block that nothing touches, with a velocity; particles that fall. */
START_TEST(both_solvers) {
  dir = directory_with_scene(
      "{'time': {'end': 0.02, 'dt': 1e-4}, 'coupling': {'n': 10, 'bodies': [{'mbd': 'box', 'dem': 'box'}]},\n"
      " 'mbd': {'gravity': [0, 0, 0], 'bodies': [{'name': 'box', 'mass': 1, 'inertia': [1, 1, 1],\n"
      "  'position': [0, 0, -5], 'velocity': [1, 0, 0]}]},\n"
      " 'dem': {'gravity': [0, 0, -10], 'threads': 2,\n"
      "  'materials': [{'name': 'm', 'density': 1000, 'young_modulus': 1e6, 'poisson_ratio': 0.2}],\n"
      "  'pairs': [{'materials': ['m', 'm'], 'restitution': 0.6, 'friction': 0.3}],\n"
      "  'bodies': [{'name': 'box', 'material': 'm', 'shapes': [{'type': 'box', 'size': [1, 1, 1], 'side': "
      "'outside'}]}],\n"
      "  'particles': [{'type': 'list', 'material': 'm', 'radius': 0.05, 'positions': [[0, 0, 0]]}]}}\n");
  char text[] = "{'scene': 'scene.json', 'axes': [{'path': 'mbd.bodies[0].velocity[0]', 'values': [1, 2]}],\n"
                " 'measures': [{'channel': 'body_box:x'}, {'channel': 'dem:particles.kinetic_energy'},\n"
                "  {'path': 'summary.windows'}]}\n";
  double_quotes(text);
  write_file(dir, "study.json", text);
  int status = command("tandem sweep %s/study.json --jobs 2 --out %s/s", dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  json_t *study = load("s/study.json");
  near(number(study, "velocity[0]=2", "x", "mean"), 0.04);
  near(number(study, "velocity[0]=2", "particles.kinetic_energy", "mean"), energy(1000, 10, 0.02));
  ck_assert_double_eq(number(study, "velocity[0]=1", "windows", "mean"), 20);
  json_decref(study);
  /* side by side with one thread; alone with the scene's, and both are the same scene for --resume */
  ck_assert(says("s/cells/velocity_0_=1_*/scene.json", "\"threads\": 1"));
  ck_assert_int_eq(command("tandem sweep %s/study.json --jobs 1 --out %s/s --resume", dir, dir), 0);
  expect_output("2 of 2 cells are there already");
  directory_remove(dir);
}
END_TEST

/* Each is refused with its place and a cure. */
START_TEST(wrong_studies) {
  static const struct {
    const char *study, *message;
  } wrong[] = {
      {"{'scene': 'scene.json', 'axis': []}", "study.json:1:25: axis: unknown key \"axis\"; did you mean \"axes\"?"},
      {"{'axes': []}", "scene: missing"},
      {"{'scene': 'nothing.json'}", "scene: cannot be read"},
      {"{'scene': 'scene.json', 'axes': [{'path': 'time.end', 'values': []}]}", "axes[0].values: has 0 entries"},
      {"{'scene': 'scene.json', 'axes': [{'path': 'time.end', 'values': [1, 1.0]}]}", "axes[0].values"},
      {"{'scene': 'scene.json',\n 'axes': [{'path': 'dem.pairs[7].friction', 'values': [1]}]}",
       "study.json:2:12: axes[0].path: \"dem.pairs[7].friction\" is no place in the scene"},
      {"{'scene': 'scene.json', 'set': {'dem.pairs[7].friction': 1}}", "set: \"dem.pairs[7].friction\" is no place"},
      {"{'scene': 'scene.json', 'axes': [{'path': 'time.end', 'values': [1, 'a'], 'log': true}]}", "axes[0].log"},
      {"{'scene': 'scene.json', 'cells': [{'label': 'a'}, {'label': 'a'}]}", "cells[1].label: has \"a\" twice"},
      {"{'scene': 'scene.json', 'cells': [{'set': {}}]}", "cells[0].label: missing"},
      {"{'scene': 'scene.json', 'measures': [{'path': 'particles'}]}",
       "measures[0].path: is \"particles\"; write summary."},
      {"{'scene': 'scene.json', 'measures': [{'channel': 'particles'}]}", "measures[0].channel"},
      {"{'scene': 'scene.json', 'measures': [{'path': 'summary.a', 'channel': 'dem:a'}]}", "give one of"},
      {"{'scene': 'scene.json', 'measures': [{'title': 'a'}]}", "measures[0]: give one of"},
      {"{'scene': 'scene.json', 'measures': [{'channel': 'dem:a', 'at': 'ned'}]}",
       "measures[0].at: \"ned\" is not known; did you mean \"end\"?"},
      {"{'scene': 'scene.json', 'measures': [{'channel': 'dem:a', 'at': [2, 1]}]}",
       "measures[0].at: is from 2 s to 1 s"},
      {"{'scene': 'scene.json', 'measures': [{'path': 'summary.a', 'at': 'end'}]}", "measures[0].at: unknown key"},
      {"{'scene': 'scene.json', 'measures': [{'path': 'summary.a'}, {'path': 'summary.a'}]}", "measures[1].name"},
      {"{'scene': 'scene.json', 'measures': [{'path': 'summary.a', 'name': '../a'}]}", "measures[0].name"},
      {"{'scene': 'scene.json', 'cells': [{'label': 'one'}], 'measures': [{'path': 'summary.a', 'published': "
       "{'points': [['oen', 1]]}}]}",
       "measures[0].published.points: \"oen\" has no cell; did you mean \"one\"?"},
      {"{'scene': 'scene.json', 'measures': [{'path': 'summary.a', 'published': [{'points': [1]}]}]}",
       "measures[0].published[0].points: entry 0 is not [x, y]"},
      {"{'scene': 'scene.json', 'curves': [{'path': 'summary.a'}]}", "curves[0].channel: missing"},
      {"{'scene': 'scene.json', 'seeds': {'path': 'time.end'}}", "seeds.values: missing"},
  };
  setup("{}");
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    char text[1024];
    strcpy(text, wrong[k].study);
    double_quotes(text);
    write_file(dir, "study.json", text);
    ck_assert_msg(command("tandem sweep %s/study.json --out %s/s", dir, dir) == 1, "%s: %s", text, command_output);
    expect_output(wrong[k].message);
    ck_assert(!has("s"));
  }
  ck_assert_int_eq(command("tandem sweep %s/study.json --dt 1e-4", dir), 2);
  expect_output("write them into the study");
  ck_assert_int_eq(command("tandem run %s/scene.json --measure steps", dir), 2);
  ck_assert_int_eq(command("tandem sweep %s/scene.json --measure dem:a@ned", dir), 1);
  expect_output("did you mean \"end\"?");
  directory_remove(dir);
}
END_TEST

/* Gaps of a channel count neither in means nor as extremes; means are over time, not over rows. */
START_TEST(gaps_and_uneven_rows) {
  setup("{}");
  write_file(dir, "channels.csv", "time [s],a [1]\n0,nan\n1,4\n2,8\n4,2\n5,nan\n6,9\n");
  write_file(dir, "summary.json", "{\"status\": \"TDM_OK\", \"b\": {\"c\": [1, 7]}, \"none\": null}");
  char file[128];
  snprintf(file, sizeof file, "%s/scene.json", dir);
  json_t *json =
      json_pack("{s:s, s:[{s:s, s:s}, {s:s, s:s}, {s:s, s:s}, {s:s, s:s}, {s:s, s:[f, f], s:f}, {s:s}, {s:s}, "
                "{s:s, s:s, s:[f, f]}, {s:s, s:s, s:[f, f]}]}",
                "scene", file, "measures", "channel", "dem:a", "at", "end", "channel", "dem:a", "at", "mean", "channel",
                "dem:a", "at", "max", "channel", "dem:a", "at", "min", "channel", "dem:a", "at", 1.5, 3.0, "factor",
                10.0, "path", "summary.b.c[1]", "path", "summary.none", "channel", "dem:a", "at", "amplitude", "over",
                2.0, 6.0, "channel", "dem:a", "at", "end", "over", 0.0, 4.5);
  cpl_study study;
  tdm_error err = {0};
  ck_assert_msg(cpl_study_read_json(&study, json, &err) == TDM_OK, "%s", err.message);
  ck_assert_int_eq(cpl_cells_make(&study.cells, 1, &err), TDM_OK);
  snprintf(study.cells.cell[0].dir, sizeof study.cells.cell[0].dir, "%s", dir);
  study.cells.cell[0].program = "tandem-dem";
  study.cells.cell[0].row = json_object();
  study.run = calloc(1, sizeof *study.run);
  ck_assert_int_eq(cpl_study_collect(&study, &err), TDM_OK);
  /* lines 4-8 over one second, 8-2 over two; between 1.5 and 3 s 6-8, then 8-5 */
  const double right[] = {9, (6 + 2 * 5) / 3.0, 9, 2, 10 * (0.5 * 7 + 1 * 6.5) / 1.5, 7, NAN, 3.5, 2};
  for (int m = 0; m < 9; m++)
    if (isnan(right[m]))
      ck_assert_int_eq(cpl_study_value(&study, 0, m).n, 0);
    else
      near(cpl_study_value(&study, 0, m).mean, right[m]);
  ck_assert_ptr_nonnull(strstr(study.measure[6].lack, "none is no number"));
  cpl_study_free(&study);
  json_decref(json);
  directory_remove(dir);
}
END_TEST

/* ---- a study of verify ---- */

static tdm_status falling(cpl_verify *v, tdm_error *err) {
  static const char *const only[] = {"density=1000", NULL}, *const set[] = {"time.end=0.3", NULL};
  static const char *const seeds[] = {"-20", NULL};
  cpl_study study;
  if (cpl_verify_study(v, "studies/density.json", &(cpl_verify_part){0}, &study, err) == TDM_OK) {
    cpl_verify_measure(v, "energy", "density=2000", cpl_study_mean(&study, "density=2000", "energy"), CPL_NO_LIMIT, 0);
    ck_assert(isnan(cpl_study_mean(&study, "density=2001", "energy")));
  }
  cpl_study_free(&study);
  if (err->status == TDM_OK &&
      cpl_verify_study(v, "studies/density.json", &(cpl_verify_part){.only = only, .set = set, .seeds = seeds}, &study,
                       err) == TDM_OK) {
    const cpl_value value = cpl_study_value(&study, cpl_study_find_cell(&study, "density=1000", err), 0);
    ck_assert_int_eq(value.n, 1);
    ck_assert_int_eq(study.cells.ncell, 1);
    cpl_verify_measure(v, "energy", "density=1000", value.mean, CPL_NO_LIMIT, 0);
  }
  cpl_study_free(&study);
  return err->status;
}

START_TEST(verify_runs_studies) {
  static const cpl_scenario table[] = {{.name = "falling", .group = "scenarios", .verify = falling}, {0}};
  static const char *const none[] = {NULL};
  char text[] = "{'scene': '../scene.json', 'axes': [{'path': 'dem.materials[0].density', 'values': [1000, 2000]}],\n"
                " 'seeds': {'path': 'dem.gravity[2]', 'values': [-10, -20]},\n"
                " 'measures': [{'channel': 'dem:particles.kinetic_energy', 'name': 'energy'}]}\n";
  char out[128], json[128], path[4096];
  setup("{}");
  double_quotes(text);
  ck_assert_int_eq(command("sh -c 'mkdir -p %s/falling/studies && cp %s/scene.json %s/falling'", dir, dir, dir), 0);
  write_file(dir, "falling/studies/density.json", text);
  snprintf(out, sizeof out, "%s/out", dir);
  snprintf(json, sizeof json, "%s/verify.json", dir);
  snprintf(path, sizeof path, "%s:%s", TANDEM_BIN_DIR, getenv("PATH"));
  setenv("PATH", path, 1);
  tdm_error err = {0};
  cpl_verify_options options = {.scenario = table, .name = none, .out = out, .json = json, .scenarios = dir, .jobs = 2};
  options.solver[CPL_DEM].executable = "tandem-dem";
  ck_assert_msg(cpl_verify_all(&options, &err) == TDM_OK, "%s", err.message);
  json_t *verified = load("verify.json");
  const json_t *scenario = json_array_get(json_object_get(verified, "scenarios"), 0);
  const json_t *measures = json_object_get(scenario, "measures");
  near(json_number_value(json_object_get(json_array_get(measures, 0), "value")),
       0.5 * (energy(2000, 10, 0.1) + energy(2000, 20, 0.1)));
  near(json_number_value(json_object_get(json_array_get(measures, 1), "value")), energy(1000, 20, 0.3));
  near(json_number_value(json_object_get(scenario, "simulated_s")), 4 * 0.1 + 0.3);
  json_decref(verified);
  ck_assert(has("out/falling/density/table.html") && has("out/falling/density/measure_energy.png"));
  directory_remove(dir);
}
END_TEST

TEST_MAIN("study", a_grid_with_seeds, some_of_the_seeds, neighbours_and_the_spread,
          cases_with_labels_and_one_that_fails, killed_and_resumed, from_options, parameters_of_the_scene, both_solvers,
          wrong_studies, gaps_and_uneven_rows, verify_runs_studies)
