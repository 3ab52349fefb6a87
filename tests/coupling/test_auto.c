/* Windows that choose their length: what is taken back and solved again, what stays, and the defaults of a scene that
 * says nothing of windows and formulation. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/command.h"
#include "tests/result_table.h"
#include "tests/test_main.h"

#include <jansson.h>
#include <math.h>

enum { NTIME = 201 };

/* A box on a spring that slides along x, and a sphere that both of its faces press on: all linear. ' for ". */
static const char slide[] =
    "{'time': {'end': 0.2, 'dt': 1e-5},\n"
    " 'coupling': {'transport': 'inproc', 'bodies': [{'mbd': 'box', 'dem': 'box'}]},\n"
    " 'mbd': {'gravity': [0, 0, 0],\n"
    "  'bodies': [{'name': 'box', 'mass': 2, 'inertia': [1, 1, 1], 'position': [0, 0, 0], 'velocity': [0.1, 0, 0]}],\n"
    "  'joints': [{'name': 'guide', 'type': 'prismatic', 'bodies': ['ground', 'box'], 'point': [0, 0, 0],\n"
    "   'axis': [1, 0, 0]}],\n"
    "  'forces': [{'name': 'spring', 'type': 'spring_damper', 'bodies': ['ground', 'box'],\n"
    "   'points': [[-1, 0, 0], [0, 0, 0]], 'stiffness': 3000, 'damping': 10}]},\n"
    " 'dem': {'gravity': [0, 0, 0], 'contact': {'normal': 'hooke', 'tangential': 'none'},\n"
    "  'materials': [{'name': 'm', 'density': 1000}],\n"
    "  'pairs': [{'materials': ['m', 'm'], 'stiffness': 2500, 'restitution': 1}],\n"
    "  'bodies': [{'name': 'box', 'material': 'm',\n"
    "   'shapes': [{'type': 'box', 'size': [0.092, 0.4, 0.4], 'side': 'inside'}]}],\n"
    "  'particles': [{'type': 'list', 'material': 'm', 'radius': 0.05, 'positions': [[0, 0, 0]]}]}}\n";

/* Forces beside the spring that change the mechanism inside a long window. */
#define FORCE(name, rest) "--set 'mbd.forces[1]={\"name\": \"" name "\", " rest "}' "
#define BETWEEN "\"bodies\": [\"ground\", \"box\"], \"points\": [[-1, 0, 0], [0, 0, 0]]"
static const char *const changes[] = {
    FORCE("end", "\"type\": \"stop\", \"joint\": \"guide\", \"upper\": 1.5e-3, \"stiffness\": 1e5"),
    FORCE("rope", "\"type\": \"cable\", " BETWEEN ", \"stiffness\": 1e5, \"free_length\": 1.001, \"smoothing\": 1e-4"),
    FORCE("rub", "\"type\": \"friction\", \"joint\": \"guide\", \"limit\": 2"),
    "--set 'mbd.forces[0]={\"name\": \"kink\", \"type\": \"spring_damper\", " BETWEEN
    ", \"interpolation\": \"steffen\", \"stiffness_table\": [[0.9, 1, 1.002, 1.1], [-100, 0, 2, 9802]]}'"};
enum { NCHANGE = sizeof changes / sizeof changes[0] };

static const char *dir;

static void run(const char *first, const char *second) {
  int status = command("tandem run %s/scene.json --out %s/out --force --set coupling.guard.action=warn %s %s", dir, dir,
                       first, second);
  ck_assert_msg(status == 0, "%d: %s", status, command_output);
}

static void read_x(double x[NTIME]) {
  cpl_table t;
  read_table(&t, dir, "out/body_box.csv");
  ck_assert_int_eq(t.nrow, NTIME);
  memcpy(x, column(&t, "x"), NTIME * sizeof *x);
  cpl_table_free(&t);
}

/* Largest difference beside the largest value. */
static double off(const double *a, const double *b) {
  double most = 0, size = 0;
  for (int k = 0; k < NTIME; k++) {
    most = fmax(most, fabs(a[k] - b[k]));
    size = fmax(size, fabs(b[k]));
  }
  return most / size;
}

/* What summary.json says of the windows' lengths. */
static long said(const char *key) {
  char path[256];
  snprintf(path, sizeof path, "%s/out/summary.json", dir);
  json_t *summary = json_load_file(path, 0, NULL);
  const json_t *value = json_object_get(json_object_get(summary, "n"), key);
  ck_assert_msg(json_is_integer(value), "no n.%s in summary.json", key);
  long is = (long)json_integer_value(value);
  json_decref(summary);
  return is;
}

START_TEST(windows_are_taken_back) {
  double shortest[NTIME], longest[NTIME], x[NTIME], again[NTIME];
  dir = directory_with_scene(slide);
  run(changes[_i], "--set coupling.n=4");
  read_x(shortest);
  run(changes[_i], "--set coupling.n=1000");
  expect_output("the mechanism changed inside");
  read_x(longest);
  run(changes[_i], "");
  expect_output("were taken back and solved again, shorter");
  ck_assert_ptr_null(strstr(command_output, "mechanism changed"));
  ck_assert_int_ge(said("taken_back"), 1);
  ck_assert_int_eq(said("kept"), 0);
  ck_assert_int_gt(said("most"), 100);
  read_x(x);
  ck_assert_msg(off(x, shortest) < 3e-3 && off(x, shortest) < 0.25 * off(longest, shortest),
                "off by %g, windows of 1000 steps by %g", off(x, shortest), off(longest, shortest));
  run(changes[_i], ""); /* the same again, bit for bit */
  read_x(again);
  ck_assert(memcmp(x, again, sizeof x) == 0);
  directory_remove(dir);
}
END_TEST

/* Until n_min; and what stays is told. */
START_TEST(windows_are_not_shortened_below_n_min) {
  dir = directory_with_scene(slide);
  run(changes[0], "--set coupling.auto.n_min=700");
  expect_output("stayed with a mismatch that was far too large");
  ck_assert_int_ge(said("kept"), 1);
  ck_assert_int_eq(said("least"), 700);
  directory_remove(dir);
}
END_TEST

START_TEST(windows_stay_where_a_solver_cannot_go_back) {
  dir = directory_with_scene(slide);
  setenv("LACKS", "restore", 1);
  run(changes[0], "--set coupling.transport=ipc --set coupling.solvers.mbd=lacking_mbd");
  unsetenv("LACKS");
  expect_output("stayed with a mismatch that was far too large");
  ck_assert_int_eq(said("taken_back"), 0);
  ck_assert_int_ge(said("kept"), 1);
  directory_remove(dir);
}
END_TEST

/* Cases of the stability set: a stiff stop, whose windows made 1.5e-3 of the work before less was allowed where they
 * make much; a light plate hit by a ball, whose load of degree 8 MBD's account of the work missed (1.6e-3). */
static const struct {
  const char *scene, *set;
} stiff[] = {{"box", "omega=20 --set parameters.stop=1e6 --set parameters.H=1e-3"},
             {"light", "inertia=1e-9 --set parameters.H=1e-4"}};

START_TEST(the_exchange_makes_no_more_energy_than_its_tolerance) {
  char path[256];
  dir = directory_make();
  int status = command("tandem run %s/%s.json --out %s/out --set coupling.n=auto "
                       "--set 'coupling.auto.n_max==max(1, rint(H/dt))' --set parameters.%s",
                       TANDEM_SOURCE_DIR "/scenarios/stability", stiff[_i].scene, dir, stiff[_i].set);
  ck_assert_msg(status == 0, "%s", command_output);
  snprintf(path, sizeof path, "%s/out/summary.json", dir);
  json_t *summary = json_load_file(path, 0, NULL);
  const json_t *share = json_object_get(json_object_get(summary, "ledger"), "residual_share");
  ck_assert(json_is_number(share));
  ck_assert_double_gt(json_number_value(share), 0);
  ck_assert_double_le(json_number_value(share), 1e-3);
  json_decref(summary);
  directory_remove(dir);
}
END_TEST

/* A formulation whose history cannot be copied starts again at each window: it comes to the same. */
START_TEST(any_formulation_goes_back) {
  double x[NTIME], by_ida[NTIME];
  dir = directory_with_scene(slide);
  run(changes[0], "");
  read_x(x);
  run(changes[0], "--set mbd.formulation=ggl");
  ck_assert_int_ge(said("taken_back"), 1);
  read_x(by_ida);
  ck_assert_msg(off(by_ida, x) < 1e-3, "%g", off(by_ida, x));
  directory_remove(dir);
}
END_TEST

/* A force that a law of time scales is no part of the reduced model: DEM is told the path. */
START_TEST(forces_over_time_are_told_ahead) {
  static const char *const laws[] = {
      FORCE("push", "\"type\": \"wrench\", \"body\": \"box\", \"force\": [10, 0, 0], \"factor\": {\"type\": \"step\", "
                    "\"to\": 1, \"rise\": 0.1}"),
      FORCE("push", "\"type\": \"wrench\", \"body\": \"box\", \"force\": [10, 0, 0], \"factor\": {\"type\": "
                    "\"harmonic\", \"amplitude\": 1, \"frequency\": 30}")};
  double shortest[NTIME], x[NTIME];
  dir = directory_with_scene(slide);
  for (int k = 0; k < 2; k++) {
    run(laws[k], "--set coupling.n=10");
    read_x(shortest);
    run(laws[k], "--set coupling.n=2000");
    read_x(x);
    ck_assert_msg(off(x, shortest) < 1e-4, "%s: %g", laws[k], off(x, shortest));
  }
  directory_remove(dir);
}
END_TEST

/* A path that turns too little in a short window for MBD to tell nodes: it is asked for more, and windows grow on it.
 * (By the parabola of each window's start alone they stay below 50 steps.) */
START_TEST(windows_grow_on_what_drivers_prescribe) {
  dir = directory_make();
  ck_assert_int_eq(command("tandem run tumbler/two_deck.json --scenarios " TANDEM_SOURCE_DIR
                           "/scenarios --out %s/out --set coupling.n=auto --set parameters.end=0.15 --set "
                           "output.pictures.interval=0.1",
                           dir),
                   0);
  ck_assert_int_gt(said("most"), 500);
  directory_remove(dir);
}
END_TEST

START_TEST(n_is_auto_by_default) {
  dir = directory_with_scene(slide);
  run("", "");
  expect_output("windows of 1 to 1000 steps");
  ck_assert_int_eq(said("taken_back"), 0);
  ck_assert_int_eq(command("tandem check %s/scene.json", dir), 0);
  expect_output("n from 1 to 1000");
  for (int k = 0; k < 2; k++) {
    ck_assert_int_eq(
        command("tandem check %s/scene.json --set coupling.%s", dir, k ? "fallback=hold" : "scheme=lommen"), 1);
    expect_output("is \"auto\" where it is not given, for which the scheme");
    expect_output("has no estimate of its error; give a number, or take proxy, iterative or dem-first");
  }
  /* frames are not left out */
  run("--set output.particles_interval=2e-3", "");
  ck_assert_int_eq(said("most"), 200);
  directory_remove(dir);
}
END_TEST

START_TEST(coupled_bodies_go_by_one_step_by_default) {
  static const struct {
    const char *set, *formulation;
  } cases[] = {{"", "one_step"},
               {"--set coupling.n=10", "one_step"},
               {"--set mbd.formulation=ggl", "ggl"},
               {"--set mbd.corrector=modified", "ggl"},
               {"--set mbd.solver.max_order=2", "ggl"}};
  dir = directory_with_scene(slide);
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
    ck_assert_int_eq(command("tandem check %s/scene.json %s", dir, cases[k].set), 0);
    expect_output(cases[k].formulation);
  }
  /* bodies alone do not */
  ck_assert_int_eq(command("tandem-mbd check slider_crank --scenarios " TANDEM_SOURCE_DIR "/scenarios"), 0);
  expect_output("ggl");
  directory_remove(dir);
}
END_TEST

TEST_MAIN_ROWS("auto", {windows_are_taken_back, NCHANGE}, {windows_are_not_shortened_below_n_min, 1},
               {windows_stay_where_a_solver_cannot_go_back, 1},
               {the_exchange_makes_no_more_energy_than_its_tolerance, 2}, {any_formulation_goes_back, 1},
               {forces_over_time_are_told_ahead, 1}, {windows_grow_on_what_drivers_prescribe, 1},
               {n_is_auto_by_default, 1}, {coupled_bodies_go_by_one_step_by_default, 1})
