/* What drivers prescribe, in long windows: every scheme goes the way of n = 1, or refuses the window. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/results/table.h"
#include "tests/command.h"
#include "tests/test_main.h"

#include <math.h>

/* A grain on a deck; ' stands for ". Half a period of the drivers is 625 steps. */
/* clang-format off */
#define SCENE(mbd, grain) \
  "{'time': {'end': 0.15, 'dt': 2e-5},\n" \
  " 'coupling': {'n': 625, 'transport': 'inproc', 'bodies': [{'mbd': 'deck', 'dem': 'deck'}]},\n" \
  " 'output': {'interval': 1e-3},\n" \
  " 'mbd': {" mbd "},\n" \
  " 'dem': {'materials': [{'name': 'grain', 'density': 2500, 'young_modulus': 1e7, 'poisson_ratio': 0.3}],\n" \
  "  'pairs': [{'materials': ['grain', 'grain'], 'restitution': 0.3, 'friction': 0.3}],\n" \
  "  'bodies': [{'name': 'deck', 'material': 'grain', 'shapes': [{'type': 'plane', 'normal': [0, 0, 1]}]}],\n" \
  "  'particles': [{'type': 'list', 'material': 'grain', " grain "}]}}\n"
#define DECK(mass) "{'name': 'deck', 'mass': " mass ", 'inertia': [1, 1, 1], 'position': [0, 0, 0]}"
#define RAIL(body) \
  "{'name': 'rail', 'type': 'prismatic', 'bodies': ['ground', '" body "'], 'point': [0, 0, 0], 'axis': [0, 0, 1]}"
#define PIVOT \
  "{'name': 'pivot', 'type': 'revolute', 'bodies': ['ground', 'deck'], 'point': [-0.2, 0, 0], 'axis': [0, 1, 0]}"
#define DRIVER(type, joint, law) \
  "'drivers': [{'name': 'shake', 'type': '" type "', 'joint': '" joint "', 'motion': {" law "}}]"
#define SMALL "'radius': 0.004, 'positions': [[0, 0, 0.0043]]"

static const char vibrating[] = SCENE("'bodies': [" DECK("20") "], 'joints': [" RAIL("deck") "],\n"
  DRIVER("linear_motor", "rail", "'type': 'harmonic', 'amplitude': 0.0015, 'frequency': 40"), SMALL);
static const char rocking[] = SCENE("'bodies': [" DECK("20") "], 'joints': [" PIVOT "],\n"
  DRIVER("rotational_motor", "pivot", "'type': 'harmonic', 'amplitude': 0.01, 'frequency': 40"), SMALL);
/* by a driver without a joint, about an axis through the deck */
static const char oriented[] = SCENE("'bodies': [" DECK("20") "], 'joints': [{'name': 'ball', 'type': 'revolute',\n"
  "  'bodies': ['ground', 'deck'], 'point': [-0.2, 0, 0], 'axis': [0, 1, 0]}],\n"
  " 'drivers': [{'name': 'tilt', 'type': 'orientation_motion', 'bodies': ['ground', 'deck'], 'axis': [0, 1, 0],\n"
  "  'motion': {'type': 'harmonic', 'amplitude': 0.01, 'frequency': 40}}]", SMALL);
/* a deck on a spring on a vibrating base, and a grain that it feels */
static const char excited[] = SCENE("'bodies': [" DECK("2") ",\n"
  "   {'name': 'base', 'mass': 5, 'inertia': [1, 1, 1], 'position': [0, 0, -0.2]}],\n"
  "  'joints': [" RAIL("base") ",\n"
  "   {'name': 'slide', 'type': 'prismatic', 'bodies': ['base', 'deck'], 'point': [0, 0, 0], 'axis': [0, 0, 1]}],\n"
  "  'forces': [{'name': 'spring', 'type': 'spring_damper', 'bodies': ['base', 'deck'],\n"
  "   'points': [[0, 0, -0.2], [0, 0, 0]], 'stiffness': 20000, 'damping': 20}],\n"
  DRIVER("linear_motor", "rail", "'type': 'harmonic', 'amplitude': 0.0015, 'frequency': 40"),
  "'radius': 0.02, 'positions': [[0, 0, 0.021]]");
/* clang-format on */

static const char *const schemes[] = {"proxy", "iterative", "dem-first", "lommen", "hold"};

enum { NTIME = 151 };
static const char *dir;
static double reference[2][NTIME]; /* of n = 1: z of the deck, kinetic energy of the grain */

static void setup(const char *scene) {
  dir = directory_with_scene(scene);
}

static void run(const char *options) {
  int status = command("tandem run %s/scene.json --force --out %s/out %s", dir, dir, options);
  ck_assert_msg(status == 0, "%s: %d: %s", options, status, command_output);
}

static void read_column(const char *name, const char *column, double *to) {
  char file[256];
  tdm_error err = {0};
  cpl_table t;
  snprintf(file, sizeof file, "%s/out/%s", dir, name);
  ck_assert_msg(cpl_table_read(&t, file, &err) == TDM_OK, "%s", err.message);
  ck_assert_int_eq(t.nrow, NTIME);
  memcpy(to, cpl_table_column(&t, column, &err), NTIME * sizeof *to);
  ck_assert_int_eq(err.status, TDM_OK);
  cpl_table_free(&t);
}

static void results(double out[2][NTIME]) {
  read_column("body_deck.csv", "z", out[0]);
  read_column("dem.csv", "particles.kinetic_energy", out[1]);
}

static double nse(const double *is, const double *should) {
  double mean = 0, off = 0, all = 0;
  for (int k = 0; k < NTIME; k++)
    mean += should[k] / NTIME;
  for (int k = 0; k < NTIME; k++) {
    off += pow(is[k] - should[k], 2);
    all += pow(should[k] - mean, 2);
  }
  return 1 - off / all;
}

/* Of n = 1 with `proxy`. */
static void solve(const char *scene) {
  setup(scene);
  run("--set coupling.n=1");
  results(reference);
}

/* A run agrees with n = 1 in the deck's place and the grain's energy, 1 - nse being at most this. */
static void expect_same(const char *options, double deck, double grain) {
  double out[2][NTIME];
  run(options);
  ck_assert_msg(strstr(command_output, "mechanism changed") == NULL, "%s: %s", options, command_output);
  results(out);
  ck_assert_msg(nse(out[0], reference[0]) > 1 - deck && nse(out[1], reference[1]) > 1 - grain, "%s: nse %.7f, %.7f",
                options, nse(out[0], reference[0]), nse(out[1], reference[1]));
}

/* Half a period and two whole ones a window, with every scheme. */
static void expect_all_schemes(const char *scene) {
  char line[256];
  solve(scene);
  for (int i = 0; i < 5; i++)
    for (int n = 625; n <= 2500; n += 1875) {
      snprintf(line, sizeof line, "--set coupling.scheme=%s --set coupling.n=%d", schemes[i], n);
      expect_same(line, 1e-9, 1e-3);
    }
  directory_remove(dir);
}

START_TEST(a_deck_that_vibrates) {
  expect_all_schemes(vibrating);
}
END_TEST

START_TEST(a_screen_that_rocks) {
  expect_all_schemes(rocking);
}
END_TEST

START_TEST(a_screen_with_a_prescribed_orientation) {
  solve(oriented);
  for (int i = 0; i < 5; i++) {
    char line[64];
    snprintf(line, sizeof line, "--set coupling.scheme=%s", schemes[i]);
    expect_same(line, 1e-9, 1e-3);
  }
  directory_remove(dir);
}
END_TEST

/* The base shakes the deck through the spring, and the grain hits it: the schemes that carry the mechanism. */
START_TEST(a_deck_on_a_shaken_base) {
  solve(excited);
  expect_same("--set coupling.scheme=proxy", 1e-5, 1e-3);
  expect_same("--set coupling.scheme=iterative", 1e-4, 1e-2);
  expect_same("--set coupling.scheme=proxy --set coupling.n=300", 1e-6, 1e-4);
  expect_same("--set coupling.n=auto", 1e-4, 1e-3);
  /* nobody on it: the path ahead is all there is, whatever the scheme */
  static const char empty[] = " --set 'dem.particles[0].positions=[[0,0,0.3]]' --set dem.gravity=[0,0,0]";
  char line[256];
  snprintf(line, sizeof line, "--set coupling.n=1%s", empty);
  run(line);
  results(reference);
  for (int i = 0; i < 5; i++) {
    double out[2][NTIME];
    snprintf(line, sizeof line, "--set coupling.scheme=%s%s", schemes[i], empty);
    run(line);
    results(out);
    ck_assert_double_gt(nse(out[0], reference[0]), i == 1 ? 1 - 1e-4 : 1 - 1e-8); /* iterative: MBD's own steps */
  }
  directory_remove(dir);
}
END_TEST

/* A deck that a polynomial lifts: a constant acceleration needs no nodes, one that grows does. */
START_TEST(a_deck_that_accelerates) {
  static const char *const laws[] = {"[0,0.05,2]", "[0,0.05,2,40]"};
  for (int k = 0; k < 2; k++) {
    char line[512], law[256];
    snprintf(law, sizeof law, "--set 'mbd.drivers[0].motion={\"type\":\"polynomial\",\"coefficients\":%s}'", laws[k]);
    setup(vibrating);
    snprintf(line, sizeof line, "%s --set coupling.n=1", law);
    run(line);
    results(reference);
    for (int i = 0; i < 3; i++) { /* those that go before MBD does */
      snprintf(line, sizeof line, "%s --set coupling.n=2500 --set coupling.scheme=%s", law, schemes[i]);
      expect_same(line, 1e-9, 1e-3);
    }
    directory_remove(dir);
  }
}
END_TEST

/* Windows of more than a radian: nodes tell how the body turns in them. */
START_TEST(a_drum_that_turns_on) {
  static const char drum[] =
      "--set 'mbd.drivers[0].motion={\"type\":\"constant_rate\",\"rate\":30,\"start\":\"step\"}' "
      "--set 'dem.bodies[0].shapes=[{\"type\":\"box\",\"size\":[0.1,0.1,0.1],\"side\":\"inside\"}]' "
      "--set mbd.joints[0].point=[0,0,0]";
  char line[512];
  setup(rocking);
  snprintf(line, sizeof line, "%s --set coupling.n=1", drum);
  run(line);
  double still[NTIME], once[2][NTIME];
  results(once);
  memcpy(reference, once, sizeof once);
  for (int i = 0; i < 5; i++) { /* 1.5 rad */
    double out[2][NTIME];
    snprintf(line, sizeof line, "%s --set coupling.n=2500 --set coupling.scheme=%s", drum, schemes[i]);
    run(line);
    results(out);
    read_column("body_deck.csv", "qy", still);
    ck_assert_double_eq_tol(fabs(still[100]), fabs(sin(0.5 * 30 * 0.1)), 1e-9);
    ck_assert_double_gt(nse(out[1], reference[1]), 0.999);
  }
  directory_remove(dir);
}
END_TEST

/* Windows find their length, and stay within what nodes tell. */
START_TEST(windows_that_adapt) {
  solve(vibrating);
  expect_same("--set coupling.n=auto", 1e-9, 1e-3);
  expect_same("--set coupling.n=auto --set coupling.scheme=dem-first", 1e-9, 1e-2);
  directory_remove(dir);
}
END_TEST

START_TEST(windows_that_bend_too_much_are_refused) {
  setup(vibrating);
  for (int i = 0; i < 5; i++) {
    int status = command("tandem run %s/scene.json --force --out %s/out --set coupling.n=7500 --set coupling.scheme=%s",
                         dir, dir, schemes[i]);
    ck_assert_msg(status == 1, "%s: %d: %s", schemes[i], status, command_output);
    expect_output(
        "coupling.n: what drivers prescribe for body \"deck\" bends too much in the window from 0 s to 0.15 s");
    expect_output("take an n of ");
  }
  directory_remove(dir);
}
END_TEST

/* A DEM solver that takes no nodes goes as before, and is refused windows that it cannot follow. */
START_TEST(a_solver_that_takes_no_nodes) {
  static const char foreign[] = "--set coupling.transport=ipc --set coupling.solvers.dem=dummy_solver --set "
                                "'dem={\"stiffness\":100}' --set coupling.guard.action=off";
  setup(vibrating);
  static const char *const explicit[] = {"lommen", "hold", "dem-first"};
  for (int i = 0; i < 3; i++) {
    int status = command("tandem run %s/scene.json --force --out %s/out %s --set coupling.scheme=%s", dir, dir, foreign,
                         explicit[i]);
    ck_assert_msg(status == 1, "%s: %d: %s", explicit[i], status, command_output);
    expect_output("coupling.n: what drivers prescribe for body \"deck\" bends by ");
    expect_output("it lacks the capability \"path\"; take a smaller n");
    status = command("tandem run %s/scene.json --force --out %s/out %s --set coupling.scheme=%s --set coupling.n=25",
                     dir, dir, foreign, explicit[i]);
    ck_assert_msg(status == 0, "%s: %d: %s", explicit[i], status, command_output);
  }
  directory_remove(dir);
}
END_TEST

/* A multibody solver that does not tell the path ahead goes as before, and is doubted where the window shows it. */
START_TEST(a_solver_that_tells_no_path) {
  static const char foreign[] = "--set coupling.transport=ipc --set coupling.solvers.mbd=lacking_mbd";
  setup(vibrating);
  for (int i = 0; i < 5; i++)
    for (int n = 25; n <= 625; n += 600) {
      int status = command("env LACKS=ahead tandem run %s/scene.json --force --out %s/out %s --set coupling.scheme=%s "
                           "--set coupling.n=%d --set coupling.guard.action=off",
                           dir, dir, foreign, schemes[i], n);
      ck_assert_msg(status == 0, "%s: %d: %s", schemes[i], status, command_output);
      int told = strstr(command_output, "the solver does not tell ahead what they prescribe") != NULL;
      ck_assert_msg(told == (n == 625), "%s, n = %d: %s", schemes[i], n, command_output);
    }
  directory_remove(dir);
}
END_TEST

/* The ledger keeps the drivers' account apart: the balance is that of n = 1, whatever the window. */
START_TEST(the_balance_of_a_driven_deck) {
  double once[NTIME], out[NTIME];
  setup(vibrating);
  run("--set coupling.n=1");
  read_column("ledger.csv", "balance", once);
  ck_assert_double_lt(once[NTIME - 1], -1e-5);
  for (int i = 0; i < 5; i++) {
    char line[64];
    snprintf(line, sizeof line, "--set coupling.scheme=%s", schemes[i]);
    run(line);
    read_column("ledger.csv", "balance", out);
    ck_assert_double_eq_tol(out[NTIME - 1], once[NTIME - 1], 0.01 * fabs(once[NTIME - 1]));
    read_column("ledger.csv", "exchange", out);
    ck_assert_double_eq_tol(out[NTIME - 1], 0, 1e-12);
  }
  directory_remove(dir);
}
END_TEST

TEST_MAIN("prescribed", a_deck_that_vibrates, a_screen_that_rocks, a_screen_with_a_prescribed_orientation,
          a_deck_on_a_shaken_base, a_deck_that_accelerates, a_drum_that_turns_on, windows_that_adapt,
          windows_that_bend_too_much_are_refused, a_solver_that_takes_no_nodes, a_solver_that_tells_no_path,
          the_balance_of_a_driven_deck)
