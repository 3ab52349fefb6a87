/* Coupling schemes on model problems with an exact solution: the order of their error in the window H.
 *
 * A box on a spring and damper along x holds one sphere that is wider than the box, so that both faces press on it with
 * a linear law all the time: two masses on linear springs,
 *
 *   M x'' = -kb x - cb x' + 2 k (z - x),   m z'' = -2 k (z - x)
 *
 * whose exact solution is a matrix exponential. DEM's step is 1e-5 s, 1/5700 of the fastest period: its own error is
 * about 1e-7 of the amplitude, and windows of 0.5 to 4 ms are long against it. The error is the rms of x over 0.2 s.
 */
#include "coupler/table.h"
#include "tests/command.h"
#include "tests/test_main.h"

#include <gsl/gsl_linalg.h>
#include <math.h>

/* kg, N/m, N s/m, m/s */
static const double box_mass = 2, spring = 3000, damping = 10, contact = 2500, start_speed = 0.1;
static const double sphere_mass = 4.0 / 3 * M_PI * 0.05 * 0.05 * 0.05 * 1000;

static const char scene[] =
    "{\"time\": {\"end\": 0.2, \"dt\": 1e-5},\n"
    " \"coupling\": {\"n\": 100, \"transport\": \"inproc\", \"interpolation\": \"hermite\",\n"
    "  \"bodies\": [{\"mbd\": \"box\", \"dem\": \"box\"}]},\n"
    " \"mbd\": {\"gravity\": [0, 0, 0],\n"
    "  \"bodies\": [{\"name\": \"box\", \"mass\": 2, \"inertia\": [1, 1, 1], \"position\": [0, 0, 0],\n"
    "   \"velocity\": [0.1, 0, 0]}],\n"
    "  \"joints\": [{\"name\": \"guide\", \"type\": \"prismatic\", \"bodies\": [\"ground\", \"box\"],\n"
    "   \"point\": [0, 0, 0], \"axis\": [1, 0, 0]}],\n"
    "  \"forces\": [{\"name\": \"spring\", \"type\": \"spring_damper\", \"bodies\": [\"ground\", \"box\"],\n"
    "   \"points\": [[-1, 0, 0], [0, 0, 0]], \"stiffness\": 3000, \"damping\": 10}]},\n"
    " \"dem\": {\"gravity\": [0, 0, 0], \"contact\": {\"normal\": \"hooke\", \"tangential\": \"none\"},\n"
    "  \"materials\": [{\"name\": \"m\", \"density\": 1000}],\n"
    "  \"pairs\": [{\"materials\": [\"m\", \"m\"], \"stiffness\": 2500, \"restitution\": 1}],\n"
    "  \"bodies\": [{\"name\": \"box\", \"material\": \"m\", \"shapes\": [{\"type\": \"box\", \"size\": [0.092, 0.4, "
    "0.4],\n"
    "   \"side\": \"inside\"}]}],\n"
    "  \"particles\": [{\"type\": \"list\", \"material\": \"m\", \"radius\": 0.05, \"positions\": [[0, 0, 0]]}]}}\n";

static const char *dir;

static void run(const char *options) {
  int status = command("tandem run %s/scene.json --out %s/out %s", dir, dir, options);
  ck_assert_msg(status == 0, "%d: %s", status, command_output);
}

/* x of the box at the output times (ntime x 2: position, velocity) */
static void exact(int ntime, double interval, double *out) {
  double rate[16] = {0,
                     1,
                     0,
                     0,
                     -(spring + 2 * contact) / box_mass,
                     -damping / box_mass,
                     2 * contact / box_mass,
                     0,
                     0,
                     0,
                     0,
                     1,
                     2 * contact / sphere_mass,
                     0,
                     -2 * contact / sphere_mass,
                     0};
  double step[16], y[4] = {0, start_speed, 0, 0};
  gsl_matrix_view A = gsl_matrix_view_array(rate, 4, 4), E = gsl_matrix_view_array(step, 4, 4);
  gsl_matrix_scale(&A.matrix, interval);
  gsl_linalg_exponential_ss(&A.matrix, &E.matrix, GSL_PREC_DOUBLE);
  for (int k = 0; k < ntime; k++) {
    out[2 * k] = y[0];
    out[2 * k + 1] = y[1];
    double next[4] = {0};
    for (int i = 0; i < 4; i++)
      for (int j = 0; j < 4; j++)
        next[i] += step[4 * i + j] * y[j];
    memcpy(y, next, sizeof y);
  }
}

/* rms of the error of x, as a share of the rms of x */
static double error(const char *options) {
  char file[256];
  tdm_error err = {0};
  cpl_table t;
  static double reference[2 * 1000];
  run(options);
  snprintf(file, sizeof file, "%s/out/body_box.csv", dir);
  ck_assert_msg(cpl_table_read(&t, file, &err) == TDM_OK, "%s", err.message);
  const double *x = cpl_table_column(&t, "x", &err);
  double wrong = 0, all = 0;
  ck_assert_int_eq(t.nrow, 201);
  exact(t.nrow, 1e-3, reference);
  for (int k = 0; k < t.nrow; k++) {
    wrong += pow(x[k] - reference[2 * k], 2);
    all += pow(reference[2 * k], 2);
  }
  cpl_table_free(&t);
  return sqrt(wrong / all);
}

START_TEST(scan) {
  dir = directory_make();
  write_file(dir, "scene.json", scene);
  double last = 0;
  for (int n = atoi(getenv("FROM")); n <= atoi(getenv("TO")); n *= 2) {
    char options[2048];
    snprintf(options, sizeof options, "--set coupling.n=%d %s", n, getenv("SCAN"));
    double e = error(options);
    printf("%s n=%d error %.3e order %.2f\n", getenv("SCAN"), n, e, log2(e / last));
    last = e;
  }
  directory_remove(dir);
}
END_TEST

TEST_MAIN("schemes", 60, scan)
