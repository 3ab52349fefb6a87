/* tandem calibrate: known values found again, runs that fail, seeds, resuming, wrong input, curves that turn. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/calibrate/target.h"
#include "test_calibrate_support.h"
#include "tests/test_main.h"

#include <sys/stat.h>

/* One ball of radius 0.05 m that is thrown up and falls: z = v t - g t^2/2. */
static const char ball[] =
    "{'parameters': {'g': 9, 'v': 1}, 'time': {'end': 0.3, 'dt': 1e-4}, 'output': {'interval': 0.01},\n"
    " 'dem': {'gravity': [0, 0, '=-g'],\n"
    "  'materials': [{'name': 'm', 'density': 1000, 'young_modulus': 1e6, 'poisson_ratio': 0.2}],\n"
    "  'pairs': [{'materials': ['m', 'm'], 'restitution': 0.6, 'friction': 0.3}],\n"
    "  'particles': [{'type': 'list', 'material': 'm', 'radius': 0.05, 'positions': [[0, 0, 0]], 'velocity': [0, 0, "
    "'=v']}]}}\n";

/* It falls on a floor and bounces. */
static const char bouncing[] =
    "{'time': {'end': 0.3, 'dt': 1e-4}, 'output': {'interval': 0.01},\n"
    " 'dem': {'gravity': [0, 0, -10],\n"
    "  'materials': [{'name': 'm', 'density': 1000, 'young_modulus': 1e6, 'poisson_ratio': 0.2}],\n"
    "  'pairs': [{'materials': ['m', 'm'], 'restitution': 0.9, 'friction': 0.3}],\n"
    "  'bodies': [{'name': 'floor', 'material': 'm', 'shapes': [{'type': 'plane', 'normal': [0, 0, 1]}]}],\n"
    "  'particles': [{'type': 'list', 'material': 'm', 'radius': 0.05, 'positions': [[0, 0, 0.1]]}]}}\n";

/* The file of a curve with a row every 20 ms. */
static void write_curve(const char *name, const char *head, double (*value)(double t), double end) {
  char text[4096];
  size_t n = (size_t)snprintf(text, sizeof text, "%s\n", head);
  for (int i = 0; 0.02 * i < end + 1e-9; i++)
    n += (size_t)snprintf(text + n, sizeof text - n, "%g,%.15g\n", 0.02 * i, value(0.02 * i));
  text[n - 1] = 0; /* a last row without its line break counts */
  write_file(dir, name, text);
}

static double thrown(double t) {
  return 0.7 * t - 0.5 * 13.7 * t * t;
}

static double energy(double t) {
  return 0.5 * 1000 * 4 / 3.0 * M_PI * pow(0.05, 3) * pow(1 - 13.7 * t, 2);
}

START_TEST(one_parameter) {
  dir = directory_with_scene(ball);
  write_curve("energy.csv", "time [s],dem:particles.kinetic_energy [J]", energy, 0.3);
  int status = command("tandem calibrate %s/scene.json --parameter parameters.g --range 2 20 --target %s/energy.csv "
                       "--jobs 2 --out %s/c --write %s/found.json --json %s/copy.json",
                       dir, dir, dir, dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  expect_output("converged");
  json_t *c = load("c/calibration.json"), *found = load("found.json"), *copy = load("copy.json");
  expect_status(c, "converged");
  ck_assert(json_equal(c, copy));
  ck_assert_str_eq(text(c, "method"), "brent");
  ck_assert_double_eq_tol(number(parameter(c, 0), "value"), 13.7, 0.01);
  ck_assert_double_eq(number(parameter(c, 0), "start"), 9);
  ck_assert_str_eq(text(parameter(c, 0), "determined"), "well");
  ck_assert_double_lt(number(c, "misfit"), 1e-3);
  /* rows change by 0.01 of their scale when g changes by so much: dE/dg by the formula */
  double sum = 0;
  for (int i = 0; i <= 15; i++)
    sum +=
        pow(1000 * 4 / 3.0 * M_PI * pow(0.05, 3) * 0.02 * i * (1 - 13.7 * 0.02 * i) / (energy(0.3) - energy(0.08)), 2) /
        16;
  ck_assert_double_eq_tol(number(parameter(c, 0), "for_1_percent"), 0.01 / sqrt(sum), 0.05 * 0.01 / sqrt(sum));
  ck_assert_double_eq(number(c, "ntries"), (double)json_array_size(json_object_get(c, "tries")));
  ck_assert_double_lt(number(c, "ntries"), 20);
  ck_assert_double_eq(number(c, "valleys"), 1);
  ck_assert_double_eq(json_number_value(json_object_get(json_object_get(found, "parameters"), "g")),
                      number(parameter(c, 0), "value"));
  static const char *const files[] = {"c/path.png", "c/fit.png", "c/sensitivity.png", "c/calibration.csv"};
  for (int k = 0; k < 4; k++)
    ck_assert_msg(has(files[k]), "no %s", files[k]);
  json_decref(c);
  json_decref(found);
  json_decref(copy);
  directory_remove(dir);
}
END_TEST

START_TEST(two_parameters) {
  dir = directory_with_scene(ball);
  write_curve("z.csv", "time [s],dem:particles.com.z [m]", thrown, 0.3);
  const char *const options = "--parameter parameters.g --range 2 50 --log parameters.g --parameter parameters.v "
                              "--range -2 2 --tolerance 1e-3";
  int status = command("tandem calibrate %s/scene.json %s --target %s/z.csv --out %s/c", dir, options, dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  json_t *c = load("c/calibration.json");
  expect_status(c, "converged");
  ck_assert_str_eq(text(c, "method"), "simplex");
  ck_assert_double_eq_tol(number(parameter(c, 0), "value"), 13.7, 0.1);
  ck_assert_double_eq_tol(number(parameter(c, 1), "value"), 0.7, 0.02);
  /* dz/dg = -t^2/2, dz/dv = t: the correlation of both estimates */
  double gg = 0, gv = 0, vv = 0;
  for (int i = 0; i <= 15; i++) {
    const double t = 0.02 * i;
    gg += pow(t, 4) / 4;
    gv -= pow(t, 3) / 2;
    vv += t * t;
  }
  const json_t *correlation = json_object_get(parameter(c, 0), "correlation");
  ck_assert_double_eq_tol(json_number_value(json_array_get(correlation, 1)), -gv / sqrt(gg * vv), 0.01);
  json_decref(c);
  directory_remove(dir);
}
END_TEST

/* Restitution above 1 is refused: those tries are bad, and the search goes on. */
START_TEST(runs_that_fail) {
  dir = directory_with_scene(bouncing);
  int status =
      command("sh -c 'tandem-dem run %s/scene.json --no-plots --set dem.pairs[0].restitution=0.55 --out %s/truth "
              "&& cut -d, -f1,9 %s/truth/channels.csv | sed \"1s/,/,dem:/\" >%s/target.csv'",
              dir, dir, dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  status = command("tandem calibrate %s/scene.json --parameter dem.pairs[0].restitution --range 0.1 1.7 --target "
                   "%s/target.csv --out %s/c",
                   dir, dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  expect_output("no misfit: ");
  json_t *c = load("c/calibration.json");
  expect_status(c, "converged");
  ck_assert_double_eq_tol(number(parameter(c, 0), "value"), 0.55, 0.01);
  ck_assert_double_ge(number(c, "failed"), 2);
  json_decref(c);
  /* the start among them, with two parameters */
  status = command("tandem calibrate %s/scene.json --set dem.pairs[0].restitution=1.5 --parameter "
                   "dem.pairs[0].restitution --range 0.1 1.7 --parameter dem.gravity[2] --range -15 -5 --target "
                   "%s/target.csv --out %s/d",
                   dir, dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  c = load("d/calibration.json");
  ck_assert_double_eq_tol(number(parameter(c, 0), "value"), 0.55, 0.03);
  ck_assert_double_eq_tol(number(parameter(c, 1), "value"), -10, 0.2);
  json_decref(c);
  /* all of them */
  status = command("tandem calibrate %s/scene.json --parameter dem.pairs[0].restitution --range 1.1 1.7 --target "
                   "%s/target.csv --out %s/e",
                   dir, dir, dir);
  ck_assert_int_eq(status, 1);
  expect_output("no run could be compared with the targets; the last: ");
  c = load("e/calibration.json");
  expect_status(c, "failed");
  ck_assert(json_is_null(json_object_get(parameter(c, 0), "value")));
  json_decref(c);
  directory_remove(dir);
}
END_TEST

/* Numbers as targets, with seeds: two, so that two parameters are determined. */
START_TEST(numbers_and_seeds) {
  dir = directory_with_scene(ball);
  int status = command("tandem calibrate %s/scene.json --parameter parameters.g --range 2 20 --measure "
                       "dem:particles.com.z@min --target -0.3 --out %s/c --repeat parameters.v=0.5,0.6,0.7",
                       dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  json_t *c = load("c/calibration.json");
  expect_status(c, "converged");
  /* the mean of v t - g t^2/2 at 0.3 s; standard deviation of the mean: 0.3*0.1/sqrt(3) */
  const double g = (0.6 * 0.3 + 0.3) / (0.5 * 0.09);
  ck_assert_double_eq_tol(number(parameter(c, 0), "value"), g, 0.02);
  ck_assert_double_eq_tol(number(parameter(c, 0), "standard_error"), 0.03 / sqrt(3) / 0.045, 0.01);
  ck_assert_double_eq_tol(number(c, "noise"), 0.03 / sqrt(3) / 0.3, 1e-6);
  ck_assert_double_eq(number(c, "runs"), 3 * number(c, "ntries"));
  json_decref(c);
  status = command("tandem calibrate %s/scene.json --parameter parameters.g --range 2 20 --parameter parameters.v "
                   "--range 0 2 --measure dem:particles.com.z --target -0.3 --measure dem:particles.velocity.z "
                   "--target -2.5 --out %s/d --tolerance 1e-3",
                   dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  c = load("d/calibration.json");
  /* v*0.3 - g*0.045 = -0.3, v - 0.3 g = -2.5 */
  ck_assert_double_eq_tol(number(parameter(c, 0), "value"), 10, 0.1);
  ck_assert_double_eq_tol(number(parameter(c, 1), "value"), 0.5, 0.03);
  ck_assert(json_is_null(json_object_get(parameter(c, 0), "standard_error"))); /* as many numbers as parameters */
  json_decref(c);
  directory_remove(dir);
}
END_TEST

static long modified(const char *name) {
  char file[512];
  struct stat at;
  snprintf(file, sizeof file, "%s/%s", dir, name);
  ck_assert_msg(stat(file, &at) == 0, "no %s", file);
  return (long)at.st_mtim.tv_sec * 1000000 + at.st_mtim.tv_nsec / 1000;
}

START_TEST(killed_and_resumed) {
  char scene[128], target[128], out[128];
  dir = directory_with_scene(ball);
  write_curve("energy.csv", "time,dem:particles.kinetic_energy", energy, 0.3);
  snprintf(scene, sizeof scene, "%s/scene.json", dir);
  snprintf(target, sizeof target, "%s/energy.csv", dir);
  snprintf(out, sizeof out, "%s/c", dir);
  const char *const arguments[] = {"calibrate", scene,      "--parameter",  "parameters.g", "--range", "2",
                                   "20",        "--target", target,         "--out",        out,       "--jobs",
                                   "1",         "--set",    "time.dt=2e-6", "--resume",     NULL};
  pid_t pid = background(dir, arguments);
  WAIT_FOR(has("c/cells/g=6.5/row.json"));
  kill(pid, SIGKILL);
  background_end(pid);
  json_t *c = load("c/calibration.json");
  expect_status(c, "running");
  json_decref(c);
  const long before = modified("c/cells/g=9/channels.csv");
  pid = background(dir, arguments);
  WAIT_FOR(background_said(dir, "try 3: g=6.5"));
  kill(pid, SIGTERM);
  ck_assert_int_eq(background_end(pid), 130);
  ck_assert(background_said(dir, "interrupted; --resume goes on"));
  c = load("c/calibration.json");
  expect_status(c, "interrupted");
  json_decref(c);
  pid = background(dir, arguments);
  ck_assert_int_eq(background_end(pid), 0);
  ck_assert_int_eq(modified("c/cells/g=9/channels.csv"), before);
  c = load("c/calibration.json");
  expect_status(c, "converged");
  ck_assert_double_eq_tol(number(parameter(c, 0), "value"), 13.7, 0.01);
  /* the same without an interruption; results that are there are not overwritten */
  ck_assert_int_eq(command("tandem calibrate %s --parameter parameters.g --range 2 20 --target %s --set time.dt=2e-6 "
                           "--out %s/d",
                           scene, target, dir),
                   0);
  json_t *d = load("d/calibration.json");
  ck_assert(json_equal(json_object_get(c, "parameters"), json_object_get(d, "parameters")));
  ck_assert_double_eq(number(c, "ntries"), number(d, "ntries"));
  ck_assert_int_eq(
      command("tandem calibrate %s --parameter parameters.g --range 2 20 --target %s --out %s", scene, target, out), 1);
  expect_output("go on with it with --resume");
  json_decref(c);
  json_decref(d);
  directory_remove(dir);
}
END_TEST

/* How else a search ends. */
START_TEST(other_ends) {
  dir = directory_with_scene(ball);
  write_curve("z.csv", "time,dem:particles.com.z", thrown, 0.3);
  char target[160];
  snprintf(target, sizeof target, "--target %s/z.csv", dir);
  ck_assert_int_eq(
      command("tandem calibrate %s/scene.json --set parameters.v=0.7 --parameter parameters.g --range 2 12 "
              "%s --out %s/a",
              dir, target, dir),
      0);
  json_t *c = load("a/calibration.json");
  expect_status(c, "at_end");
  ck_assert(json_is_true(json_object_get(parameter(c, 0), "at_end")));
  ck_assert_double_eq_tol(number(parameter(c, 0), "value"), 12, 0.05);
  json_decref(c);
  ck_assert_int_eq(command("tandem calibrate %s/scene.json --parameter dem.pairs[0].friction --range 0.1 0.9 %s --out "
                           "%s/b",
                           dir, target, dir),
                   0);
  expect_output("nothing that is compared depends on the parameters");
  c = load("b/calibration.json");
  expect_status(c, "flat");
  json_decref(c);
  ck_assert_int_eq(command("tandem calibrate %s/scene.json --parameter parameters.g --range 2 20 %s --out %s/d --tries "
                           "7",
                           dir, target, dir),
                   0);
  c = load("d/calibration.json");
  expect_status(c, "spent");
  ck_assert_double_eq(number(c, "ntries"), 9); /* with those beside the best */
  json_decref(c);
  directory_remove(dir);
}
END_TEST

/* Each is refused with its place and a cure, before anything is made. */
START_TEST(wrong_input) {
  static const struct {
    const char *arguments, *message;
    int status;
  } wrong[] = {
      {"--target z.csv", "0 --parameter; give one to 4", 2},
      {"--parameter parameters.g --target z.csv", "give each parameter a range FROM TO", 2},
      {"--parameter parameters.g --range 2 --target z.csv", "--range needs 2 values", 2},
      {"--parameter parameters.g --range 20 2 --target z.csv", "20 is not below 2; give the lower end first", 2},
      {"--parameter parameters.g --range 2 x --target z.csv", "\"x\" is no number", 2},
      {"--parameter parameters.g --range 0 2 --log parameters.g --target z.csv", "give one above 0", 2},
      {"--parameter parameters.g --range 2 9 --log parameters.v --target z.csv", "is no --parameter", 2},
      {"--parameter dem.pairs[0].frictoin --range 0 1 --target z.csv",
       "scene.json: --parameter dem.pairs[0].frictoin: the scene has no value there; did you mean "
       "dem.pairs[0].friction?",
       2},
      {"--parameter dem.pairs[1].friction --range 0 1 --target z.csv", "add --set dem.pairs[1].friction=VALUE", 2},
      {"--parameter dem.gravity[3] --range 0 1 --target z.csv", "the scene has no value there", 2},
      {"--parameter parameters.w --range 0 1 --target z.csv", "the scene has no value there", 2},
      {"--parameter dem.materials[0].name --range 0 1 --target z.csv", "is \"m\" there; name the path of a number", 2},
      {"--parameter dem.gravity[2] --range -9 -1 --target z.csv", "is the expression \"=-g\" there", 2},
      {"--parameter parameters.g --range 2 9 --parameter parameters.g --range 2 9 --target z.csv", "is given twice", 2},
      {"--parameter parameters.g --range 2 9", "0 --target; give 1 to 16", 2},
      {"--parameter parameters.g --range 2 9 --target nothing.csv", "nothing.csv: cannot be opened", 1},
      {"--parameter parameters.g --range 2 9 --target one.csv", "one.csv:1: has 1 column; give it 2, with commas", 1},
      {"--parameter parameters.g --range 2 9 --target text.csv", "text.csv:3: not a row of numbers", 1},
      {"--parameter parameters.g --range 2 9 --target names.csv", "names.csv:1: column \"z\" is no channel of a run",
       1},
      {"--parameter parameters.g --range 2 9 --target turns.csv", "turns.csv: row 4: the abscissa turns at 0.2", 1},
      {"--parameter parameters.g --range 2 9 --target 3", "a number needs its --measure", 2},
      {"--parameter parameters.g --range 2 9 --target z.csv --measure steps", "--measure steps has no number", 2},
      {"--parameter parameters.g --range 2 9 --target 3 --measure dem:a@ned", "did you mean \"end\"?", 1},
      {"--parameter parameters.g --range 2 9 --target z.csv --repeat parameters.w=3,4",
       "\"parameters.w\" is no place in the scene", 1},
      {"--parameter parameters.g --range 2 9 --target z.csv --tolerance 2", "give a share above 0", 2},
      {"--parameter parameters.g --range 2 9 --target z.csv --repeat parameters.g=3,4", "is a --parameter, too", 2},
      {"--parameter parameters.g --range 2 9 --target z.csv --tries 0", "give a number from 1", 2},
      {"--parameter parameters.g --range 2 9 --target z.csv --n 10", "--n does not go with this command", 2},
  };
  dir = directory_with_scene(ball);
  write_curve("z.csv", "time,dem:particles.com.z", thrown, 0.3);
  write_file(dir, "one.csv", "time;dem:particles.com.z\n0;1\n1;2\n");
  write_file(dir, "text.csv", "time,dem:a\n0,1\n1,two\n");
  write_file(dir, "names.csv", "time,z\n0,1\n1,2\n");
  write_file(dir, "turns.csv", "time,dem:a\n0,1\n0.3,2\n0.1,2\n0.2,1\n");
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    const int status = command("sh -c 'cd %s && tandem calibrate scene.json %s --out c'", dir, wrong[k].arguments);
    ck_assert_msg(status == wrong[k].status, "%s: %d %s", wrong[k].arguments, status, command_output);
    expect_output(wrong[k].message);
    ck_assert(!has("c"));
  }
  /* what only a run shows: after the first, with what there is */
  ck_assert_int_eq(command("tandem calibrate %s/scene.json --parameter parameters.g --range 2 9 --measure "
                           "dem:particles.con.z --target 1 --out %s/d",
                           dir, dir),
                   2);
  expect_output("--measure \"dem:particles.con.z\" is not in the results of a run; did you mean dem:particles.com.z?");
  expect_output("dem:particles.kinetic_energy");
  ck_assert_int_eq(command("tandem calibrate %s/scene.json --parameter parameters.g --range 2 9 --measure "
                           "repose.mean_deg --target 30 --out %s/e",
                           dir, dir),
                   2);
  expect_output("wall_s.all");
  /* keys that the scene does not have: unknown ones, and one that no law of the scene reads, after the first run */
  ck_assert_int_eq(command("tandem calibrate %s/scene.json --parameter dem.pairs[0].spin --range 0 1 --target %s/z.csv "
                           "--out %s/f",
                           dir, dir, dir),
                   2);
  expect_output("--parameter dem.pairs[0].spin, which the scene does not have, was tried with 0.5");
  expect_output("unknown key \"spin\"");
  ck_assert_int_eq(
      command("tandem calibrate %s/scene.json --parameter dem.pairs[0].rolling_friction --range 0 1 --target "
              "%s/z.csv --out %s/g",
              dir, dir, dir),
      2);
  expect_output("is read by none of the scene's laws");
  ck_assert_int_eq(command("tandem run %s/scene.json --range 1 2", dir), 2);
  directory_remove(dir);
}
END_TEST

/* Both solvers: a block that nothing touches moves, over its own way. */
START_TEST(both_solvers) {
  dir = directory_with_scene(
      "{'time': {'end': 0.02, 'dt': 1e-4}, 'coupling': {'n': 10, 'bodies': [{'mbd': 'box', 'dem': 'box'}]},\n"
      " 'mbd': {'gravity': [0, 0, 0], 'bodies': [{'name': 'box', 'mass': 1, 'inertia': [1, 1, 1],\n"
      "  'position': [0, 0, -5], 'velocity': [1, 0, 0]}]},\n"
      " 'dem': {'gravity': [0, 0, -10],\n"
      "  'materials': [{'name': 'm', 'density': 1000, 'young_modulus': 1e6, 'poisson_ratio': 0.2}],\n"
      "  'pairs': [{'materials': ['m', 'm'], 'restitution': 0.6, 'friction': 0.3}],\n"
      "  'bodies': [{'name': 'box', 'material': 'm', 'shapes': [{'type': 'box', 'size': [1, 1, 1], 'side': "
      "'outside'}]}],\n"
      "  'particles': [{'type': 'list', 'material': 'm', 'radius': 0.05, 'positions': [[0, 0, 0]]}]}}\n");
  /* x = v t, speed of the ball = 10 t */
  write_file(dir, "speed.csv", "-body_box:x [m],dem:particles.velocity.z [m/s]\n0,0\n-0.01,-0.05\n-0.02,-0.1\n");
  int status = command("tandem calibrate %s/scene.json --parameter mbd.bodies[0].velocity[0] --range 0.5 3 --target "
                       "%s/speed.csv --out %s/c",
                       dir, dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  json_t *c = load("c/calibration.json");
  ck_assert_double_eq_tol(number(parameter(c, 0), "value"), 2, 0.02);
  json_decref(c);
  directory_remove(dir);
}
END_TEST

/* A plate that `motion` presses on a ball: its force over its way by Hertz, whose modulus is found, and half of the way
 * back. Times far longer than the ball's oscillation, damped. */
START_TEST(force_over_the_way_of_a_wall) {
  char curve[2048] = "-dem:body.plate.uz [m],dem:body.plate.fz [N]\n";
  dir = directory_with_scene(
      "{'time': {'end': 0.4, 'dt': 2e-5}, 'output': {'interval': 2e-3},\n"
      " 'dem': {'gravity': [0, 0, 0],\n"
      "  'materials': [{'name': 'm', 'density': 10, 'young_modulus': 1e5, 'poisson_ratio': 0.2}],\n"
      "  'pairs': [{'materials': ['m', 'm'], 'restitution': 0.1, 'friction': 0.3}],\n"
      "  'bodies': [{'name': 'floor', 'material': 'm', 'shapes': [{'type': 'plane', 'normal': [0, 0, 1]}]},\n"
      "   {'name': 'plate', 'material': 'm', 'position': [0, 0, 0.1], 'shapes': [{'type': 'plane', 'normal': [0, 0, "
      "-1]}],\n"
      "    'motion': {'oscillation': {'amplitude': [0, 0, -0.002], 'frequency': 1.25}}}],\n"
      "  'particles': [{'type': 'list', 'material': 'm', 'radius': 0.05, 'positions': [[0, 0, 0.05]]}]}}\n");
  /* both walls take half of the way; F = 4/3 E* sqrt(R) d^1.5, E* = E/(2(1 - nu^2)) */
  for (int i = 0; i <= 12; i++) {
    const double u = 0.002 * (i <= 8 ? i / 8.0 : 1 - (i - 8) / 8.0);
    const double force = 4 / 3.0 * 4e5 / (2 * (1 - 0.04)) * sqrt(0.05) * pow(u / 2, 1.5);
    snprintf(curve + strlen(curve), sizeof curve - strlen(curve), "%g,%.9g\n", u, force);
  }
  write_file(dir, "press.csv", curve);
  int status = command("tandem calibrate %s/scene.json --parameter dem.materials[0].young_modulus --range 3e4 3e6 "
                       "--log dem.materials[0].young_modulus --target %s/press.csv --tolerance 1e-3 --out %s/c",
                       dir, dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  json_t *c = load("c/calibration.json");
  expect_status(c, "converged");
  ck_assert_double_eq_tol(number(parameter(c, 0), "value"), 4e5, 0.02 * 4e5);
  ck_assert_double_lt(number(c, "misfit"), 0.02);
  json_decref(c);
  directory_remove(dir);
}
END_TEST

/* Two solutions: the way of a plate after half a period is -2 A sin(phase). */
START_TEST(two_valleys) {
  dir = directory_with_scene(
      "{'time': {'end': 0.4, 'dt': 1e-3}, 'output': {'interval': 0.01},\n"
      " 'dem': {'gravity': [0, 0, 0],\n"
      "  'materials': [{'name': 'm', 'density': 10, 'young_modulus': 1e5, 'poisson_ratio': 0.2}],\n"
      "  'pairs': [{'materials': ['m', 'm'], 'restitution': 0.1, 'friction': 0.3}],\n"
      "  'bodies': [{'name': 'plate', 'material': 'm', 'shapes': [{'type': 'plane', 'normal': [0, 0, 1]}],\n"
      "    'motion': {'oscillation': {'amplitude': [0, 0, 0.002], 'frequency': 1.25, 'phase': 1}}}],\n"
      "  'particles': [{'type': 'list', 'material': 'm', 'radius': 0.05, 'positions': [[0, 0, 0.5]]}]}}\n");
  int status = command("tandem calibrate %s/scene.json --parameter dem.bodies[0].motion.oscillation.phase --range 0 "
                       "3.14159 --measure dem:body.plate.uz --target -0.002 --out %s/c",
                       dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  expect_output("the misfit has 2 valleys over the parameter");
  json_t *c = load("c/calibration.json");
  ck_assert_double_eq(number(c, "valleys"), 2);
  ck_assert_double_eq_tol(sin(number(parameter(c, 0), "value")), 0.5, 0.02);
  json_decref(c);
  directory_remove(dir);
}
END_TEST

/* ---- curves ---- */

/* The values of a run's CSV file at the rows of a target's; the share that is reached. */
static tdm_status compare(const char *target, const char *channels, double *value, double *covered, tdm_error *err) {
  char file[256];
  cpl_target t;
  cpl_study study;
  cpl_cell run = {.program = "tandem-dem"};
  write_file(dir, "target.csv", target);
  write_file(dir, "channels.csv", channels);
  snprintf(file, sizeof file, "%s/target.csv", dir);
  snprintf(run.dir, sizeof run.dir, "%s", dir);
  if (cpl_target_read(&t, file, NULL, err) == TDM_OK) {
    json_t *measures = json_array(), *curves = json_array();
    snprintf(file, sizeof file, "%s/scene.json", dir);
    cpl_target_enter(&t, 0, measures, curves);
    json_t *json = json_pack("{s:s, s:o}", "scene", file, "curves", curves);
    ck_assert_msg(cpl_study_read_json(&study, json, err) == TDM_OK, "%s", err->message);
    cpl_target_values(&t, 0, &study, &run, NAN, value, covered, err);
    cpl_study_free(&study);
    json_decref(json);
    json_decref(measures);
  }
  cpl_target_free(&t);
  return err->status;
}

START_TEST(out_and_back) {
  double v[8], covered;
  tdm_error err = {0};
  dir = directory_with_scene(ball);
  /* straight lines between rows whose abscissa goes beyond all before; 9 is not one of them */
  const char *run = "time [s],x [m],f [N]\n0,0,0\n1,1,10\n2,0.5,9\n3,2,20\n4,1.5,16\n5,nan,3\n6,0.5,4\n7,0,2\n";
  ck_assert_int_eq(compare("dem:x,dem:f\n0,0\n0.5,0\n1.5,0\n2,0\n1,0\n0,0\n", run, v, &covered, &err), TDM_OK);
  const double right[] = {0, 5, 15, 20, 10, 2};
  for (int i = 0; i < 6; i++)
    ck_assert_double_eq_tol(v[i], right[i], 1e-12);
  ck_assert_double_eq(covered, 1);
  /* beyond the ends: their values */
  ck_assert_int_eq(compare("dem:x,dem:f\n-1,0\n1,0\n2,0\n4,0\n", run, v, &covered, &err), TDM_OK);
  ck_assert_double_eq(v[0], 0);
  ck_assert_double_eq(v[3], 20);
  ck_assert_double_eq(covered, 0.5);
  /* negatives of both */
  ck_assert_int_eq(compare("-dem:x,-dem:f\n0,0\n-1.5,0\n", run, v, &covered, &err), TDM_OK);
  ck_assert_double_eq_tol(v[1], -15, 1e-12);
  /* nothing in common */
  ck_assert_int_eq(compare("dem:x,dem:f\n3,0\n4,0\n", run, v, &covered, &err), TDM_ERR_NUMERIC);
  ck_assert_ptr_nonnull(strstr(err.message, "goes from 0 to 2, the target's from 3 to 4"));
  directory_remove(dir);
}
END_TEST

TEST_MAIN("calibrate", one_parameter, two_parameters, runs_that_fail, numbers_and_seeds, killed_and_resumed, other_ends,
          wrong_input, both_solvers, force_over_the_way_of_a_wall, two_valleys, out_and_back)
