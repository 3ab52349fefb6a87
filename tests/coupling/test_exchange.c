/* coupling.lommen: what MBD is given of the extrapolated load, and which velocity DEM's contacts feel. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/command.h"
#include "tests/result_table.h"
#include "tests/test_main.h"

#include <math.h>

/* clang-format off */
/* A particle of 1 kg hits a cube of 10 kg that slides, a window a step. */
static const char hit[] =
  "{'time': {'end': 0.012, 'dt': 1e-5},\n"
  " 'coupling': {'n': 1, 'scheme': 'lommen', 'transport': 'inproc', 'bodies': [{'mbd': 'cube', 'dem': 'cube'}]},\n"
  " 'output': {'interval': 1e-5},\n"
  " 'mbd': {'gravity': [0, 0, 0], 'formulation': 'ggl', 'solver': {'relative_tolerance': 1e-11},\n"
  "  'bodies': [{'name': 'cube', 'mass': 10, 'inertia': [1, 1, 1], 'position': [0.1, 0, 0]}],\n"
  "  'joints': [{'name': 'guide', 'type': 'prismatic', 'bodies': ['ground', 'cube'], 'point': [0, 0, 0],\n"
  "   'axis': [1, 0, 0]}]},\n"
  " 'dem': {'gravity': [0, 0, 0], 'contact': {'normal': 'hooke', 'tangential': 'none'},\n"
  "  'materials': [{'name': 'm', 'density': 1000}],\n"
  "  'pairs': [{'materials': ['m', 'm'], 'stiffness': 2e5, 'damping': 200}],\n"
  "  'bodies': [{'name': 'cube', 'material': 'm', 'shapes': [{'type': 'box', 'size': [0.2, 0.2, 0.2],\n"
  "   'side': 'outside'}]}],\n"
  "  'particles': [{'type': 'list', 'material': 'm', 'radius': 0.02, 'mass': 1, 'positions': [[-0.0205, 0, 0]],\n"
  "   'velocity': [1, 0, 0]}]}}\n";

/* A motor pushes the cube with 1 m/s2 into a particle that is too heavy to move: F = k delta + c v, c = 200 N s/m. */
static const char push[] =
  "{'time': {'end': 0.01, 'dt': 1e-5},\n"
  " 'coupling': {'n': 100, 'scheme': 'lommen', 'transport': 'inproc', 'bodies': [{'mbd': 'cube', 'dem': 'cube'}]},\n"
  " 'output': {'interval': 1e-3},\n"
  " 'mbd': {'gravity': [0, 0, 0],\n"
  "  'bodies': [{'name': 'cube', 'mass': 10, 'inertia': [1, 1, 1], 'position': [0.1, 0, 0]}],\n"
  "  'joints': [{'name': 'guide', 'type': 'prismatic', 'bodies': ['ground', 'cube'], 'point': [0, 0, 0],\n"
  "   'axis': [1, 0, 0]}],\n"
  "  'drivers': [{'name': 'motor', 'type': 'linear_motor', 'joint': 'guide',\n"
  "   'motion': {'type': 'polynomial', 'coefficients': [0, 0, -0.5]}}]},\n"
  " 'dem': {'gravity': [0, 0, 0], 'contact': {'normal': 'hooke', 'tangential': 'none'},\n"
  "  'materials': [{'name': 'm', 'density': 1000}],\n"
  "  'pairs': [{'materials': ['m', 'm'], 'stiffness': 2e5, 'damping': 200}],\n"
  "  'bodies': [{'name': 'cube', 'material': 'm', 'shapes': [{'type': 'box', 'size': [0.2, 0.2, 0.2],\n"
  "   'side': 'outside'}]}],\n"
  "  'particles': [{'type': 'list', 'material': 'm', 'radius': 0.02, 'mass': 1e9, 'positions': [[-0.0195, 0, 0]]}]}}\n";
/* A box hangs on a spring and damper; a ball is pressed between its floor and its lid. */
static const char hang[] =
  "{'time': {'end': 0.05, 'dt': 1e-5},\n"
  " 'coupling': {'n': 1, 'scheme': 'lommen', 'bodies': [{'mbd': 'box', 'dem': 'box'}]},\n"
  " 'mbd': {'bodies': [{'name': 'box', 'mass': 2, 'inertia': [1, 1, 1], 'position': [0, 0, 0]}],\n"
  "  'joints': [{'name': 'guide', 'type': 'prismatic', 'bodies': ['ground', 'box'], 'point': [0, 0, 0],\n"
  "   'axis': [0, 0, 1]}],\n"
  "  'forces': [{'name': 'spring', 'type': 'spring_damper', 'bodies': ['ground', 'box'],\n"
  "   'points': [[0, 0, 1], [0, 0, 0]], 'stiffness': 3000, 'damping': 10}]},\n"
  " 'dem': {'contact': {'normal': 'hooke', 'tangential': 'none'}, 'materials': [{'name': 'm', 'density': 1000}],\n"
  "  'pairs': [{'materials': ['m', 'm'], 'stiffness': 2500, 'restitution': 1}],\n"
  "  'bodies': [{'name': 'box', 'material': 'm', 'shapes': [{'type': 'box', 'size': [0.4, 0.4, 0.092],\n"
  "   'side': 'inside'}]}],\n"
  "  'particles': [{'type': 'list', 'material': 'm', 'radius': 0.05, 'positions': [[0, 0, 0]]}]}}\n";
/* clang-format on */

static const char *dir;

static void run(const char *out, const char *options) {
  int status = command("tandem run %s/scene.json --out %s/%s --force %s", dir, dir, out, options);
  ck_assert_msg(status == 0, "%d: %s", status, command_output);
}

#define LOAD(shape) "--set coupling.lommen.load=" shape
#define VELOCITY(which) "--set coupling.lommen.wall_velocity=" which

START_TEST(defaults_are_the_bits_of_before) {
  dir = directory_with_scene(hit);
  run("none", "");
  run("named", LOAD("polynomial") " " VELOCITY("path"));
  run("other", "--set coupling.scheme=hold " LOAD("end-held")); /* settings of another scheme than the run's */
  run("hold", "--set coupling.scheme=hold");
  ck_assert_int_eq(command("cmp %s/none/body_cube.csv %s/named/body_cube.csv", dir, dir), 0);
  ck_assert_int_eq(command("cmp %s/hold/body_cube.csv %s/other/body_cube.csv", dir, dir), 0);
  static const char *const others[] = {LOAD("end-held"), LOAD("end-ramped"), VELOCITY("sent")};
  for (int i = 0; i < 3; i++) {
    run("other", others[i]);
    ck_assert_msg(command("cmp -s %s/none/body_cube.csv %s/other/body_cube.csv", dir, dir) == 1, "%s", others[i]);
  }
  directory_remove(dir);
}
END_TEST

/* What MBD was given is what the cube's velocity says: m dv = impulse of a window, with the means F of the windows
 * before and their weights. */
START_TEST(what_mbd_is_given) {
  static const struct {
    const char *options;
    double weight[4]; /* of F_k, F_k-1, F_k-2, F_k-3 in the mean load of window k + 1 */
  } cases[] = {
      {LOAD("polynomial"), {23.0 / 12, -16.0 / 12, 5.0 / 12, 0}}, /* the parabola's mean: Adams and Bashforth */
      {LOAD("end-held"), {3, -3, 1, 0}},
      {LOAD("end-ramped"), {1.5, 0, -1, 0.5}}, /* of (3, -3, 1, 0) and (0, 3, -3, 1) */
  };
  const double h = 1e-5, mass = 10;
  dir = directory_with_scene(hit);
  for (int i = 0; i < 3; i++) {
    cpl_table t;
    run("out", cases[i].options);
    read_table(&t, dir, "out/body_cube.csv");
    const double *v = column(&t, "vx"), *f = column(&t, "fx");
    double most = 0;
    for (int k = 5; k < t.nrow; k++) {
      double load = 0;
      for (int j = 0; j < 4; j++)
        load += cases[i].weight[j] * f[k - 1 - j];
      most = fmax(most, fabs(f[k]));
      ck_assert_msg(fabs(mass * (v[k] - v[k - 1]) / h - load) < 0.05, "%s, row %d: %g N, expected %g N",
                    cases[i].options, k, mass * (v[k] - v[k - 1]) / h, load);
    }
    ck_assert_double_gt(most, 100);
    cpl_table_free(&t);
  }
  directory_remove(dir);
}
END_TEST

/* The derivative of the straight path is the velocity in the window's middle, what is sent that at its end. */
START_TEST(what_contacts_feel) {
  const double damping = 200, acceleration = 1, h = 1e-3;
  cpl_table path, sent;
  dir = directory_with_scene(push);
  run("path", VELOCITY("path"));
  run("sent", VELOCITY("sent"));
  read_table(&path, dir, "path/body_cube.csv");
  read_table(&sent, dir, "sent/body_cube.csv");
  const double *x = column(&path, "x"), *fx = column(&path, "fx"), *gx = column(&sent, "fx");
  ck_assert_int_eq(path.nrow, 11);
  for (int k = 1; k < path.nrow; k++) {
    const double overlap = 5e-4 - 0.5 * (x[k - 1] + x[k] - 0.2); /* window average, but for half a step */
    ck_assert_double_eq_tol(fx[k], 2e5 * overlap + damping * acceleration * (k - 0.5) * h, 0.02);
    ck_assert_double_eq_tol(gx[k] - fx[k], damping * acceleration * 0.5 * h, 1e-6);
  }
  cpl_table_free(&path);
  cpl_table_free(&sent);
  directory_remove(dir);
}
END_TEST

START_TEST(what_is_refused) {
  static const struct {
    const char *options, *path, *says;
  } cases[] = {
      {LOAD("held"), "coupling.lommen.load", "end-held"},
      {VELOCITY("body"), "coupling.lommen.wall_velocity", "sent"},
      {"--set coupling.lommen.wall_mass=1e8", "coupling.lommen.wall_mass", "unknown"},
      {"--set dem.contact.wall_mass=heavy", "dem.contact.wall_mass", "edem"},
      /* a solver without any capability */
      {VELOCITY("sent") " --set coupling.transport=ipc --set coupling.solvers.dem=dummy_solver", "coupling.lommen",
       "the scheme lommen needs the capability \"sent_velocity\" for its settings, which"},
  };
  dir = directory_with_scene(hit);
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    ck_assert_int_eq(command("tandem run %s/scene.json --out %s/out --force %s", dir, dir, cases[i].options), 1);
    expect_output(cases[i].path);
    expect_output(cases[i].says);
  }
  directory_remove(dir);
}
END_TEST

/* rms of what two runs differ by in a column of the box */
static double apart(const char *a, const char *b, const char *name) {
  cpl_table s, t;
  char file[64];
  snprintf(file, sizeof file, "%s/body_box.csv", a);
  read_table(&s, dir, file);
  snprintf(file, sizeof file, "%s/body_box.csv", b);
  read_table(&t, dir, file);
  const double *x = column(&s, name), *y = column(&t, name);
  double sum = 0;
  ck_assert_int_eq(s.nrow, t.nrow);
  for (int k = 0; k < s.nrow; k++)
    sum += pow(x[k] - y[k], 2);
  const double rms = sqrt(sum / s.nrow);
  cpl_table_free(&s);
  cpl_table_free(&t);
  return rms;
}

/* Pinging: a multibody solver whose positions have a scatter has velocities that scatter by that over the window, so
 * that short windows make it worse; positions stay where they are. tandem-mbd has none. */
START_TEST(what_pings) {
  static const char scattered[] = LOAD("end-held") " " VELOCITY("sent") " --set coupling.solvers.mbd=scattered_mbd";
  const double scatter = 1e-6, dt = 1e-5;
  char options[512];
  dir = directory_with_scene(hang);
  for (int n = 1; n <= 5; n += 4) {
    snprintf(options, sizeof options, "%s --set coupling.n=%d", scattered, n);
    setenv("SCATTER", "0", 1);
    run("still", options);
    setenv("SCATTER", "1e-6", 1);
    run("scattered", options);
    ck_assert_double_eq_tol(apart("still", "scattered", "vz") * n * dt / (scatter * sqrt(2.0 / 3)), 1, 0.25);
    ck_assert_double_lt(apart("still", "scattered", "z"), 3 * scatter);
  }
  directory_remove(dir);
}
END_TEST

#define HERTZ(mass)                                                                                                 \
  "--set 'dem.contact={\"normal\": \"hertz\", \"wall_mass\": " mass "}' --set 'dem.materials=[{\"name\": \"m\", "   \
  "\"density\": 1000, \"young_modulus\": 1e7, \"poisson_ratio\": 0.2}]' --set 'dem.pairs=[{\"materials\": [\"m\", " \
  "\"m\"], \"restitution\": 0.5, \"friction\": 0}]'"

/* "edem" is 1e8 kg: a wall mass that damping takes, and no coupling */
START_TEST(the_wall_mass_of_the_paper_s_code) {
  dir = directory_with_scene(hit);
  run("0", HERTZ("\"edem\""));
  run("1", HERTZ("1e8"));
  run("2", HERTZ("\"body\""));
  ck_assert_int_eq(command("cmp %s/0/body_cube.csv %s/1/body_cube.csv", dir, dir), 0);
  ck_assert_int_eq(command("cmp -s %s/0/body_cube.csv %s/2/body_cube.csv", dir, dir), 1);
  directory_remove(dir);
}
END_TEST

TEST_MAIN("exchange", defaults_are_the_bits_of_before, what_mbd_is_given, what_contacts_feel, what_pings,
          what_is_refused, the_wall_mass_of_the_paper_s_code)
