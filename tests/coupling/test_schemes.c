/* Coupling schemes on model problems with an exact solution: the order of their error in the window H.
 *
 * A box that is narrower than the sphere in it: both faces press on the sphere all the time, by a linear law. So box
 * and sphere are two masses on linear springs. The box slides along x on a spring and damper, alone or with a second
 * one, or hangs on a hinge. DEM's step of 1e-5 s is 1/5700 of the fastest period: its own error (1e-7; 1e-4 where
 * lommen and hold use plain means of n values) is small against that of windows of 0.5 to 8 ms. The error is the rms of
 * x over 0.2 s beside the rms of x.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/command.h"
#include "tests/result_table.h"
#include "tests/test_main.h"

#include <gsl/gsl_linalg.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>

enum { NTIME = 201 };
static const double interval = 1e-3;

/* kg, N/m, N s/m, m/s; of the scenes below */
static const double box_mass = 2, between = 1500, contact = 2500, start_speed = 0.1;
static double spring = 3000, damping = 10;
static const double sphere_mass = 4.0 / 3 * M_PI * 0.05 * 0.05 * 0.05 * 1000;

/* Scenes, with ' for ". */
/* clang-format off */
#define RUN(bodies) \
  "{'time': {'end': 0.2, 'dt': 1e-5},\n" \
  " 'coupling': {'n': 100, 'transport': 'inproc', 'interpolation': 'hermite', 'bodies': [" bodies "]},\n"
#define PARTICLES(gravity, bodies, spheres) \
  " 'dem': {'gravity': " gravity ", 'contact': {'normal': 'hooke', 'tangential': 'none'},\n" \
  "  'materials': [{'name': 'm', 'density': 1000}],\n" \
  "  'pairs': [{'materials': ['m', 'm'], 'stiffness': 2500, 'restitution': 1}],\n" \
  "  'bodies': [" bodies "],\n" \
  "  'particles': [{'type': 'list', 'material': 'm', 'radius': 0.05, " spheres "}]}}\n"
#define INSIDE(name, size) \
  "{'name': '" name "', 'material': 'm', 'shapes': [{'type': 'box', 'size': " size ", 'side': 'inside'}]}"
#define BOX(name, position) \
  "{'name': '" name "', 'mass': 2, 'inertia': [1, 1, 1], 'position': " position ", 'velocity': [0.1, 0, 0]}"
#define GUIDE(name, body) \
  "{'name': '" name "', 'type': 'prismatic', 'bodies': ['ground', '" body "'], 'point': [0, 0, 0], 'axis': [1, 0, 0]}"
#define SPRING(name, bodies, points, numbers) \
  "{'name': '" name "', 'type': 'spring_damper', 'bodies': " bodies ", 'points': " points ", " numbers "}"

#define ONE "{'mbd': 'box', 'dem': 'box'}"
#define TWO ONE ", {'mbd': 'next', 'dem': 'next'}"
#define TWO_BOXES BOX("box", "[0, 0, 0]") ", " BOX("next", "[1, 0, 0]")
#define TWO_FILLED \
  PARTICLES("[0, 0, 0]", INSIDE("box", "[0.092, 0.4, 0.4]") ", " INSIDE("next", "[0.092, 0.4, 0.4]"), \
            "'positions': [[0, 0, 0], [1, 0, 0]]")
#define GROUND_SPRING(numbers) SPRING("spring", "['ground', 'box']", "[[-1, 0, 0], [0, 0, 0]]", numbers)

/* a sliding box */
static const char slide[] =
  RUN(ONE)
  " 'mbd': {'gravity': [0, 0, 0], 'bodies': [" BOX("box", "[0, 0, 0]") "],\n"
  "  'joints': [" GUIDE("guide", "box") "],\n"
  "  'forces': [" GROUND_SPRING("'stiffness': 3000, 'damping': 10") "]},\n"
  PARTICLES("[0, 0, 0]", INSIDE("box", "[0.092, 0.4, 0.4]"), "'positions': [[0, 0, 0]]");

/* two of them with a spring between, so that each moves under the other's load */
static const char train[] =
  RUN(TWO)
  " 'mbd': {'gravity': [0, 0, 0], 'bodies': [" TWO_BOXES "],\n"
  "  'joints': [" GUIDE("guide", "box") ", " GUIDE("other", "next") "],\n"
  "  'forces': [" GROUND_SPRING("'stiffness': 3000, 'damping': 10") ",\n"
  "   " SPRING("between", "['box', 'next']", "[[0, 0, 0], [1, 0, 0]]", "'stiffness': 1500, 'damping': 0") "]},\n"
  TWO_FILLED;

/* two boxes in one piece, on twice the spring and damper: the motion of one */
static const char twin[] =
  RUN(TWO)
  " 'mbd': {'gravity': [0, 0, 0], 'bodies': [" TWO_BOXES "],\n"
  "  'joints': [" GUIDE("guide", "box") ",\n"
  "   {'name': 'weld', 'type': 'fixed', 'bodies': ['box', 'next'], 'point': [0.5, 0, 0]}],\n"
  "  'forces': [" GROUND_SPRING("'stiffness': 6000, 'damping': 20") "]},\n"
  TWO_FILLED;

/* a box that swings half a metre below a hinge along y with a torsional spring */
static const char swing[] =
  RUN(ONE)
  " 'mbd': {'gravity': [0, 0, -9.81], 'bodies': [{'name': 'box', 'mass': 2, 'inertia': [1, 0.05, 1],\n"
  "   'position': [0, 0, -0.5], 'velocity': [-1, 0, 0], 'angular_velocity': [0, 2, 0]}],\n"
  "  'joints': [{'name': 'hinge', 'type': 'revolute', 'bodies': ['ground', 'box'], 'point': [0, 0, 0],\n"
  "   'axis': [0, 1, 0]}],\n"
  "  'forces': [{'name': 'spring', 'type': 'torsional_spring_damper', 'joint': 'hinge', 'stiffness': 60,\n"
  "   'damping': 0.5}]},\n"
  PARTICLES("[0, 0, -9.81]", INSIDE("box", "[0.092, 0.4, 0.092]"),
            "'positions': [[0, 0, -0.5]], 'velocity': [-0.85, 0, 0]");
/* clang-format on */

static const char *dir;
static double reference[NTIME]; /* x of the (first) box */

/* ---- exact solutions ---- */

/* n states under y' = A y; x = y[0] */
static void solve_linear(int n, double *A, double *y) {
  double step[64], next[8];
  gsl_matrix_view a = gsl_matrix_view_array(A, (size_t)n, (size_t)n),
                  e = gsl_matrix_view_array(step, (size_t)n, (size_t)n);
  gsl_matrix_scale(&a.matrix, interval);
  gsl_linalg_exponential_ss(&a.matrix, &e.matrix, GSL_PREC_DOUBLE);
  for (int k = 0; k < NTIME; k++) {
    reference[k] = y[0];
    memset(next, 0, sizeof next);
    for (int i = 0; i < n; i++)
      for (int j = 0; j < n; j++)
        next[i] += step[n * i + j] * y[j];
    memcpy(y, next, (size_t)n * sizeof *y);
  }
}

/* boxes in a row, on sphere and spring; (x, v, z, w) of each: M x'' = 2 k (z - x) - ..., m z'' = -2 k (z - x) */
static void solve_sliders(int nbox) {
  const int n = 4 * nbox;
  double A[64] = {0}, y[8] = {0};
  for (int i = 0; i < nbox; i++) {
    const int x = 4 * i, v = x + 1, z = x + 2, w = x + 3;
    y[v] = start_speed;
    A[n * x + v] = A[n * z + w] = 1;
    A[n * v + x] = -2 * contact / box_mass;
    A[n * v + z] = 2 * contact / box_mass;
    A[n * w + x] = 2 * contact / sphere_mass;
    A[n * w + z] = -2 * contact / sphere_mass;
  }
  A[n * 1 + 0] -= spring / box_mass;
  A[n * 1 + 1] -= damping / box_mass;
  if (nbox == 2) {
    A[n * 1 + 0] -= between / box_mass;
    A[n * 1 + 4] += between / box_mass;
    A[n * 5 + 0] += between / box_mass;
    A[n * 5 + 4] -= between / box_mass;
  }
  solve_linear(n, A, y);
}

/* (angle, rate, X, Z, X', Z'): the faces act on the sphere as an isotropic spring to the middle of the box */
static int swinging(double t, const double *y, double *rate, void *unused) {
  (void)t, (void)unused;
  double cx = -0.5 * sin(y[0]), cz = -0.5 * cos(y[0]);
  double fx = 2 * contact * (y[2] - cx), fz = 2 * contact * (y[3] - cz); /* on the box, through the sphere's middle */
  double moment = y[3] * fx - y[2] * fz + 9.81 * box_mass * cx - 60 * y[0] - 0.5 * y[1];
  const double out[6] = {
      y[1], moment / (0.05 + box_mass * 0.25), y[4], y[5], -fx / sphere_mass, -fz / sphere_mass - 9.81};
  memcpy(rate, out, sizeof out);
  return GSL_SUCCESS;
}

static void solve_swing(void) {
  gsl_odeiv2_system system = {swinging, NULL, 6, NULL};
  gsl_odeiv2_driver *driver = gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, 1e-5, 1e-13, 1e-13);
  double t = 0, y[6] = {0, 2, 0, -0.5, -0.85, 0};
  for (int k = 0; k < NTIME; k++) {
    ck_assert_int_eq(gsl_odeiv2_driver_apply(driver, &t, k * interval, y), GSL_SUCCESS);
    reference[k] = -0.5 * sin(y[0]);
  }
  gsl_odeiv2_driver_free(driver);
}

/* ---- runs ---- */

static void setup(const char *scene) {
  dir = directory_with_scene(scene);
}

static void run(const char *options) {
  /* explicit schemes gain energy here, which is what is measured */
  int status =
      command("tandem run %s/scene.json --out %s/out --force --set coupling.guard.action=warn %s", dir, dir, options);
  ck_assert_msg(status == 0, "%d: %s", status, command_output);
}

/* rms of the error of x, as a share of the rms of x */
static double error(int n, const char *options) {
  char line[2048];
  tdm_error err = {0};
  cpl_table t;
  snprintf(line, sizeof line, "--set coupling.n=%d %s", n, options);
  run(line);
  read_table(&t, dir, "out/body_box.csv");
  const double *x = cpl_table_column(&t, "x", &err);
  double wrong = 0, all = 0;
  ck_assert_int_eq(t.nrow, NTIME);
  for (int k = 0; k < t.nrow; k++) {
    wrong += pow(x[k] - reference[k], 2);
    all += pow(reference[k], 2);
  }
  cpl_table_free(&t);
  return sqrt(wrong / all);
}

/* the summary's number behind "name" that stands behind "section" */
static double summary(const char *section, const char *name) {
  char file[256], text[16384];
  snprintf(file, sizeof file, "%s/out/summary.json", dir);
  FILE *f = fopen(file, "r");
  ck_assert_ptr_nonnull(f);
  text[fread(text, 1, sizeof text - 1, f)] = 0;
  fclose(f);
  const char *at = strstr(text, section);
  at = at ? strstr(at, name) : NULL;
  ck_assert_msg(at != NULL, "no %s in %s of summary.json", name, section);
  return atof(strchr(at, ':') + 1);
}

/* The error's order over a doubling of the window is as expected, within 0.3. */
static void expect_order(double order, int n, const char *options) {
  double coarse = error(2 * n, options), fine = error(n, options), is = log2(coarse / fine);
  ck_assert_msg(fabs(is - order) < 0.3, "order %.2f, expected %g, n = %d with %s (errors %.3g, %.3g)", is, order, n,
                options, coarse, fine);
}

/* so that IDA's error is none of the coupling's */
/* so that IDA's error is none of the coupling's; one_step, the default, has another error */
#define EXACT " --set mbd.formulation=ggl --set mbd.solver.relative_tolerance=1e-11"
#define STEPS " --set mbd.solver.max_step=1e-4" /* the same of generalised-alpha */

/* an mbd solver that takes no more of a load than a parabola */
#define PARABOLA " --set coupling.transport=ipc --set coupling.solvers.mbd=lacking_mbd"

/* Means of the past are late by H (hold) or, at the end of their window, by H/2: first order. A path predicted with
 * a constant acceleration and the mean of the same window: second. The proxy is exact for a linear mechanism; of a
 * parabola's load the cubic and higher parts are left out: H^3 inside a window, H^5 in the place. */
static void expect_orders(void) {
  expect_order(1, 100, "--set coupling.scheme=hold");
  expect_order(1, 200, "--set coupling.scheme=lommen");
  expect_order(2, 200, "--set coupling.scheme=dem-first");
  expect_order(5, 1600, "--set coupling.scheme=proxy" EXACT PARABOLA);
}

START_TEST(orders_of_a_slider) {
  setup(slide);
  solve_sliders(1);
  expect_orders();
  expect_order(5, 1600, "--set coupling.scheme=iterative" STEPS PARABOLA);
  directory_remove(dir);
}
END_TEST

/* What a run expects of itself, beside what it is off. */
static void expect_estimate(const char *scheme, int n) {
  char options[128];
  double size = 0;
  snprintf(options, sizeof options, "--set coupling.scheme=%s" EXACT, scheme);
  const double is = error(n, options), estimated = summary("\"error_estimate\"", "\"rms\"");
  for (int k = 0; k < NTIME; k++)
    size += reference[k] * reference[k] / NTIME;
  const double ratio = estimated / (is * sqrt(size));
  ck_assert_msg(ratio > 1. / 3 && ratio < 3, "%s, n = %d: %g of the error", scheme, n, ratio);
}

START_TEST(estimates_are_near_the_error) {
  static const char *const schemes[] = {"hold", "lommen", "dem-first"};
  setup(slide);
  solve_sliders(1);
  for (int i = 0; i < 3; i++)
    for (int n = 100; n <= 800; n *= 2)
      expect_estimate(schemes[i], n);
  /* of the proxy, which is exact here, it is no more than what a parabola leaves of the load, as jitter */
  error(100, "--set coupling.scheme=proxy" EXACT);
  const double proxy = summary("\"error_estimate\"", "\"share\"");
  ck_assert_msg(proxy < 1e-4, "%g", proxy);
  directory_remove(dir);
}
END_TEST

START_TEST(orders_of_two_sliders) {
  setup(train);
  solve_sliders(2);
  expect_orders();
  directory_remove(dir);
}
END_TEST

START_TEST(orders_of_a_swing) {
  setup(swing);
  solve_swing();
  expect_order(2, 200, "--set coupling.scheme=dem-first");
  expect_order(5, 1600, "--set coupling.scheme=proxy" EXACT PARABOLA);
  ck_assert_double_lt(error(200, "--set coupling.scheme=proxy" EXACT), 1e-8);
  directory_remove(dir);
}
END_TEST

START_TEST(proxy_at_long_windows) {
  /* H = 8 ms, 0.9 rad of the fastest motion */
  setup(slide);
  solve_sliders(1);
  double lommen = error(800, "--set coupling.scheme=lommen"), proxy = error(800, "--set coupling.scheme=proxy" EXACT);
  ck_assert_double_gt(lommen, 0.1);
  ck_assert_double_lt(proxy, 1e-4 * lommen);
  ck_assert_double_lt(error(100, "--set coupling.scheme=proxy" EXACT), 1.5e-7); /* what DEM's step leaves */
  directory_remove(dir);
}
END_TEST

/* A mechanism that swings within the window, without damping: the load ends where DEM ended. */
START_TEST(stiff_supports) {
  /* omega H of the box alone; two of them zeros of j_3 and j_4(omega H / 2), where P_3 and P_4 do not reach both the
   * place and the velocity at the end */
  static const double swings[] = {4, 8, 13.9758643, 16, 16.3651231};
  const double H = 0.02;
  char line[512];
  setup(slide);
  damping = 0;
  for (int i = 0; i < 5; i++) {
    spring = box_mass * pow(swings[i] / H, 2);
    solve_sliders(1);
    snprintf(line, sizeof line, "--set mbd.forces[0].stiffness=%.17g --set mbd.forces[0].damping=0" EXACT, spring);
    double e = error(2000, line);
    ck_assert_msg(e < 2e-3, "omega H = %g: %g", swings[i], e);
    ck_assert_msg(strstr(command_output, "vibrates") == NULL, "omega H = %g: %s", swings[i], command_output);
    strcat(line, PARABOLA);
    double before = error(2000, line);
    ck_assert_msg(before > 0.02, "omega H = %g: a parabola comes to %g", swings[i], before);
  }
  /* 50 rad, and a sphere that bounces between the faces: more than the polynomials follow, which is told */
  snprintf(line, sizeof line,
           "--set mbd.forces[0].stiffness=%.17g --set mbd.forces[0].damping=0 --set mbd.bodies[0].velocity=[0,0,0] "
           "--set dem.particles[0].velocity=[0.5,0,0] --set dem.pairs[0].stiffness=1e6 --set "
           "dem.bodies[0].shapes[0].size=[0.102,0.4,0.4]",
           box_mass * pow(50 / H, 2));
  run(line);
  ck_assert_ptr_null(strstr(command_output, "vibrates")); /* n = 100 */
  strcat(line, " --set coupling.n=2000");
  run(line);
  expect_output("the mechanism of \"box\" vibrates too fast for the window");
  directory_remove(dir);
}
END_TEST

START_TEST(half_the_run_in_a_window) {
  /* H = 0.1 s, 11 rad of the fastest motion; a parabola: 0.25, and 0.0041 of the swing */
  setup(slide);
  solve_sliders(1);
  ck_assert_double_lt(error(10000, EXACT), 1e-3);
  directory_remove(dir);
  setup(train);
  solve_sliders(2);
  ck_assert_double_lt(error(10000, EXACT), 1e-3);
  directory_remove(dir);
  setup(swing);
  solve_swing();
  ck_assert_double_lt(error(10000, EXACT), 1e-3);
  directory_remove(dir);
}
END_TEST

START_TEST(two_bodies_in_one_piece) {
  /* the loads of both go through one mechanism: the motion of one box on half the spring */
  setup(twin);
  solve_sliders(1);
  ck_assert_double_lt(error(200, "--set coupling.scheme=proxy" EXACT), 1.5e-7);
  ck_assert_double_lt(error(800, "--set coupling.scheme=proxy" EXACT), 4e-6);
  directory_remove(dir);
}
END_TEST

START_TEST(iterations_make_up_for_a_proxy_of_masses_alone) {
  /* With six bodies on springs too soft to be felt, more than a reduced model has room for: DEM gets the mobility
   * without springs and dampers. */
  char crowd[3000] = "--set coupling.scheme=proxy" EXACT STEPS, iterate[3200];
  for (int i = 1; i <= 6; i++)
    snprintf(crowd + strlen(crowd), sizeof crowd - strlen(crowd),
             " --set 'mbd.bodies[%d]={\"name\":\"x%d\",\"mass\":1,\"inertia\":[1,1,1],\"position\":[0,%d,0]}'"
             " --set 'mbd.forces[%d]={\"name\":\"s%d\",\"type\":\"spring_damper\",\"bodies\":[\"box\",\"x%d\"],"
             "\"points\":[[0,0,0],[0,%d,0]],\"stiffness\":1e-9}'",
             i, i, i, i, i, i, i);
  setup(slide);
  solve_sliders(1);
  double once = error(800, crowd);
  ck_assert_double_gt(once, 2e-3);
  static const char *const accelerators[] = {"iqn-ils", "aitken"};
  for (int i = 0; i < 2; i++) {
    snprintf(iterate, sizeof iterate,
             "%s --set coupling.scheme=iterative --set coupling.iterative.accelerator=%s "
             "--set coupling.iterative.tolerance=1e-6",
             crowd, accelerators[i]);
    double again = error(800, iterate);
    ck_assert_msg(again < 0.005 * once, "%g after %g", again, once);
    ck_assert_double_gt(summary("iterations", "mean"), 1.5);
    ck_assert_double_le(summary("iterations", "largest"), 5);
    ck_assert_double_eq(summary("iterations", "windows_not_converged"), 0);
  }
  directory_remove(dir);
}
END_TEST

/* Two plates on rails squeeze 144 grains in windows of 100 steps. Under `iterative` MBD goes with one_step, and one of
 * its steps a window must put the plates where the parabola of the load does: it was worse than `proxy`. */
static const char squeeze[] =
    "{\"time\": {\"end\": 0.2, \"dt\": 2e-05}, \"coupling\": {\"n\": 100, \"scheme\": \"iterative\", "
    "\"bodies\": [{\"mbd\": \"lower\", \"dem\": \"lower\"}, {\"mbd\": \"upper\", \"dem\": \"upper\"}]}, "
    "\"mbd\": {\"gravity\": [0, 0, 0], \"bodies\": [{\"name\": \"lower\", \"mass\": 6, \"inertia\": [0.1, "
    "0.1, 0.1], \"position\": [0, 0, -0.02], \"velocity\": [0, 0, 0.6]}, {\"name\": \"upper\", \"mass\": 9, "
    "\"inertia\": [0.1, 0.1, 0.1], \"position\": [0, 0, 0.15], \"velocity\": [0, 0, -0.9]}], \"joints\": "
    "[{\"name\": \"gl\", \"type\": \"prismatic\", \"bodies\": [\"ground\", \"lower\"], \"point\": [0, 0, 0], "
    "\"axis\": [0, 0, 1]}, {\"name\": \"gu\", \"type\": \"prismatic\", \"bodies\": [\"ground\", \"upper\"], "
    "\"point\": [0, 0, 0.2], \"axis\": [0, 0, 1]}]}, \"dem\": {\"gravity\": [0, 0, 0], \"materials\": "
    "[{\"name\": \"g\", \"density\": 2500, \"young_modulus\": 20000000.0, \"poisson_ratio\": 0.25}, "
    "{\"name\": \"w\", \"density\": 2500, \"young_modulus\": 20000000.0, \"poisson_ratio\": 0.25}], "
    "\"pairs\": [{\"materials\": [\"g\", \"g\"], \"restitution\": 0.7, \"friction\": 0.4}, {\"materials\": "
    "[\"g\", \"w\"], \"restitution\": 0.7, \"friction\": 0}], \"bodies\": [{\"name\": \"sides\", "
    "\"material\": \"w\", \"shapes\": [{\"type\": \"box\", \"side\": \"inside\", \"size\": [0.2, 0.2, 1], "
    "\"open\": [\"+z\", \"-z\"]}]}, {\"name\": \"lower\", \"material\": \"g\", \"shapes\": [{\"type\": "
    "\"box\", \"side\": \"outside\", \"size\": [0.5, 0.5, 0.04]}]}, {\"name\": \"upper\", \"material\": "
    "\"g\", \"shapes\": [{\"type\": \"box\", \"side\": \"outside\", \"size\": [0.5, 0.5, 0.04]}]}], "
    "\"particles\": [{\"type\": \"block\", \"material\": \"g\", \"count\": [6, 6, 4], \"corner\": [-0.075, "
    "-0.075, 0.0201], \"spacing\": 0.03, \"radius\": 0.01}]}}";

START_TEST(iterations_at_long_windows) {
  static const char *const body[] = {"lower", "upper"};
  dir = directory_make();
  double v[2][2];
  write_file(dir, "scene.json", squeeze);
  for (int k = 0; k < 2; k++) {
    ck_assert_msg(
        command("tandem run %s/scene.json --out %s/out --force --set coupling.n=%d", dir, dir, k ? 20 : 100) == 0, "%s",
        command_output);
    for (int b = 0; b < 2; b++) {
      char path[256];
      cpl_table table = {0};
      snprintf(path, sizeof path, "%s/out/body_%s.csv", dir, body[b]);
      ck_assert_int_eq(cpl_table_read(&table, path, NULL), TDM_OK);
      v[k][b] = cpl_table_column(&table, "vz", NULL)[table.nrow - 1];
      cpl_table_free(&table);
    }
  }
  for (int b = 0; b < 2; b++)
    ck_assert_msg(fabs(v[0][b] - v[1][b]) < 1e-7, "%s: %.10g m/s, %.10g in short windows", body[b], v[0][b], v[1][b]);
  directory_remove(dir);
}
END_TEST

START_TEST(a_window_that_does_not_converge_is_told) {
  setup(slide);
  solve_sliders(1);
  double e = error(1000, "--set coupling.scheme=iterative --set coupling.iterative.max=2 "
                         "--set coupling.iterative.tolerance=1e-15 --set coupling.iterative.absolute=0");
  expect_output("the 2 iterations of the window from 0 s on did not converge");
  expect_output("server: not_converged: 20 times, from t = 0 s to ");
  expect_output("of the first 10 windows did not converge, more than a tenth"); /* then it is a warning */
  expect_output("iterations a window: 2.00 in the mean, 2 at most");
  ck_assert_double_lt(e, 1e-3);
  ck_assert_double_eq(summary("iterations", "windows_not_converged"), 20);
  ck_assert_double_eq(summary("iterations", "largest"), 2);
  ck_assert_int_eq(command("grep -c 'event=not_converged' %s/out/server.log", dir), 0);
  expect_output("10"); /* the summary counts the rest */
  directory_remove(dir);
}
END_TEST

#define AUTO "--set coupling.n=auto"

START_TEST(windows_find_their_length) {
  setup(slide);
  solve_sliders(1);
  char line[512];
  double e[3], windows[3];
  for (int i = 0; i < 3; i++) { /* a mismatch of order 3 in H, 2 beside the motion: half the window for a quarter */
    snprintf(line, sizeof line,
             AUTO " --set coupling.scheme=dem-first --set 'coupling.auto={\"tolerance\": %g, \"absolute\": 0}'",
             1.6e-2 * pow(0.25, i));
    e[i] = error(1, line);
    windows[i] = summary("{", "\"windows\"");
    ck_assert_double_eq(summary("\"n\"", "least"), 1);
    ck_assert_double_gt(summary("\"n\"", "most"), 2e4 / windows[i]);
  }
  ck_assert_double_lt(windows[0], 120); /* of about 1 / (110 / s) x sqrt(0.016) */
  for (int i = 0; i < 2; i++) {
    ck_assert_msg(fabs(windows[i + 1] / windows[i] - 2) < 0.2, "%g and %g windows", windows[i], windows[i + 1]);
    ck_assert_msg(e[i + 1] < 0.5 * e[i], "error %g after %g", e[i + 1], e[i]);
  }
  /* limits hold, and the run ends where it should */
  run(AUTO " --set 'coupling.auto={\"n_min\": 7, \"n_max\": 600}'");
  expect_output("0.2 s simulated in");
  ck_assert_double_eq(summary("\"n\"", "least"), 7);
  ck_assert_double_eq(summary("\"n\"", "most"), 600);
  directory_remove(dir);
}
END_TEST

START_TEST(a_fast_turn_shortens_windows) {
  /* 40 rad/s: 1000 steps of 1e-4 s would be 4 rad */
  setup(swing);
  static const char spin[] = " --set mbd.forces=[] --set mbd.bodies[0].angular_velocity=[0,40,0] --set "
                             "mbd.bodies[0].velocity=[-20,0,0] --set dem.particles=[] --set time.dt=1e-4 --set "
                             "time.end=1";
  char line[512];
  snprintf(line, sizeof line, AUTO "%s", spin);
  run(line);
  ck_assert_double_gt(summary("\"n\"", "most"), 50);
  ck_assert_double_lt(summary("\"n\"", "most"), 250);
  ck_assert_int_eq(command("tandem run %s/scene.json --out %s/out --force --set coupling.n=1000 %s", dir, dir, spin),
                   1);
  expect_output("take a smaller n");
  directory_remove(dir);
}
END_TEST

START_TEST(nothing_coupled) {
  setup(slide);
  static const char *const schemes[] = {"proxy", "iterative", "dem-first", "lommen"};
  char line[256];
  for (int i = 0; i < 4; i++) {
    snprintf(line, sizeof line, "--set coupling.bodies=[] --set coupling.n=%s --set coupling.scheme=%s",
             i < 3 ? "auto" : "100", schemes[i]);
    run(line);
    expect_output("0.2 s simulated");
  }
  directory_remove(dir);
}
END_TEST

/* A stop that is met inside a window is not in the mechanism that DEM carries: the run says so. */
START_TEST(a_mechanism_that_changes_is_told) {
  setup(slide);
  static const char stop[] = "--set 'mbd.forces[0]={\"name\": \"end\", \"type\": \"stop\", \"joint\": \"guide\", "
                             "\"upper\": 5e-3, \"stiffness\": 1e6}' --set coupling.n=1000";
  char line[512];
  run(stop);
  expect_output("the mechanism changed inside");
  snprintf(line, sizeof line, "%s --set coupling.scheme=iterative", stop);
  run(line);
  ck_assert_ptr_null(strstr(command_output, "mechanism changed"));
  expect_output("acted inside the window");
  run("--set coupling.n=1000"); /* the spring is in it */
  ck_assert_ptr_null(strstr(command_output, "mechanism changed"));
  /* a spring that gets 100 times as stiff; a motion that sets in and ends inside a window, which DEM is told of */
  run("--set coupling.n=1000 --set 'mbd.forces[0]={\"name\": \"s\", \"type\": \"spring_damper\", \"bodies\": "
      "[\"ground\", \"box\"], \"points\": [[-1,0,0],[0,0,0]], \"interpolation\": \"steffen\", \"stiffness_table\": "
      "[[0.9, 1, 1.002, 1.1], [-100, 0, 2, 9802]]}'");
  expect_output("the mechanism changed inside");
  expect_output("the kink of a table");
  run("--set coupling.n=90 --set mbd.bodies[0].velocity=[0,0,0] --set 'mbd.drivers=[{\"name\": \"d\", \"type\": "
      "\"linear_motor\", \"joint\": \"guide\", \"motion\": {\"type\": \"table\", \"interpolation\": \"steffen\", "
      "\"times\": [0, 0.055, 0.116, 0.3], \"values\": [0, 0, 5e-3, 5e-3]}}]'");
  ck_assert_ptr_null(strstr(command_output, "mechanism changed"));
  directory_remove(dir);
}
END_TEST

START_TEST(what_cannot_adapt_is_refused) {
  setup(slide);
  static const struct {
    const char *options, *what;
  } cases[] = {
      {AUTO " --set coupling.scheme=lommen", "no estimate of its error"},
      {AUTO " --set coupling.fallback=hold", "no estimate of its error"},
      {"--set coupling.n=often", "neither a whole number"},
      {"--set coupling.auto.n_max=5", "goes with \"n\": \"auto\""},
      {AUTO " --set coupling.auto.n_max=5 --set coupling.auto.n_min=6", "less than n_min"},
      {"--set coupling.scheme=iterative --set coupling.iterative.accelerator=anderson", "iqn-ils"},
      {"--set coupling.iterative.max=4294967297", "take at most 1000"},
      {"--set coupling.iterative.reuse=101", "take at most 100"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    ck_assert_int_eq(command("tandem run %s/scene.json --out %s/out --force %s", dir, dir, cases[i].options), 1);
    expect_output(cases[i].what);
    expect_output("coupling.");
  }
  ck_assert_int_eq(command("tandem check %s/scene.json %s", dir, AUTO), 0);
  expect_output("n from 1 to 1000");
  directory_remove(dir);
}
END_TEST

/* Refused when it is checked, not at the first window. */
START_TEST(multi_step_cannot_carry_a_mechanism) {
  setup(slide);
  static const char multi[] = "--set dem.integrator=multi-step --set 'dem.multi_step={\"substeps\": 2, \"mass\": 1}'";
  static const char *const schemes[] = {"proxy", "iterative", "dem-first", "lommen"};
  for (int i = 0; i < 4; i++) {
    int status = command("tandem check %s/scene.json %s --set coupling.scheme=%s", dir, multi, schemes[i]);
    ck_assert_msg(status == (i < 2), "%s: %d: %s", schemes[i], status, command_output);
    if (i < 2)
      expect_output("\"multi-step\" cannot carry the mechanism");
  }
  directory_remove(dir);
}
END_TEST

TEST_MAIN("schemes", orders_of_a_slider, estimates_are_near_the_error, orders_of_two_sliders, orders_of_a_swing,
          proxy_at_long_windows, stiff_supports, half_the_run_in_a_window, two_bodies_in_one_piece,
          iterations_make_up_for_a_proxy_of_masses_alone, a_window_that_does_not_converge_is_told,
          iterations_at_long_windows, windows_find_their_length, a_fast_turn_shortens_windows, nothing_coupled,
          a_mechanism_that_changes_is_told, what_cannot_adapt_is_refused, multi_step_cannot_carry_a_mechanism)
