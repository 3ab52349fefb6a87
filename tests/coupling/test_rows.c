/* A row holds the state of its time, also where that lies inside a DEM step, and the last state is always written. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/command.h"
#include "tests/result_table.h"
#include "tests/test_main.h"

#include <math.h>

static const char *dir;

/* Steps of 1e-4 s, rows every 2.7 of them. A ball falls; another one bounces on a plate. */
#define DEM                                                                                                          \
  "{\"materials\": [{\"name\": \"m\", \"density\": 2600}], \"contact\": {\"normal\": \"hooke\", \"tangential\": "    \
  "\"none\"}, \"pairs\": [{\"materials\": [\"m\", \"m\"], \"restitution\": 0.5, \"stiffness\": 5000}], \"bodies\": " \
  "[{\"name\": \"plate\", \"material\": \"m\", \"shapes\": [{\"type\": \"plane\", \"normal\": [0, 0, 1]}]}], "       \
  "\"particles\": [{\"type\": \"list\", \"material\": \"m\", \"radius\": 0.01, \"positions\": [[0, 0, %s]]}]"
#define TIME "{\"time\": {\"end\": 0.05, \"dt\": 1e-4}, \"output\": {\"interval\": 2.7e-4}, "

static void setup(void) {
  char text[4096];
  dir = directory_make();
  snprintf(text, sizeof text, TIME "\"dem\": " DEM "}}", "5");
  write_file(dir, "falls.json", text);
  snprintf(text, sizeof text, TIME "\"dem\": " DEM "}}", "0.0105");
  write_file(dir, "bounces.json", text);
  snprintf(text, sizeof text,
           TIME "\"coupling\": {\"n\": 7, \"bodies\": [{\"mbd\": \"plate\", \"dem\": \"plate\"}]}, \"mbd\": "
                "{\"gravity\": [0, 0, -4], \"bodies\": [{\"name\": \"plate\", \"mass\": 1, \"inertia\": [1, 1, 1], "
                "\"position\": [0, 0, 0], \"velocity\": [0, 0, -3]}]}, \"dem\": " DEM ", \"gravity\": [0, 0, -9.81]}}",
           "5");
  write_file(dir, "coupled.json", text);
}

/* rows on the grid and one of the end */
static void expect_grid(const cpl_table *t) {
  const double *time = column(t, "time");
  ck_assert_int_eq(t->nrow, 187);
  for (int k = 0; k < 186; k++)
    ck_assert_double_lt(fabs(time[k] - k * 2.7e-4), 1e-15);
  ck_assert_double_lt(fabs(time[186] - 0.05), 1e-15);
}

/* free fall: places and velocities exactly, the energy to the order of the steps */
static void expect_fall(const cpl_table *t, double start) {
  const double *time = column(t, "time"), *z = column(t, "particles.com.z"), *v = column(t, "particles.velocity.z");
  const double *e = column(t, "particles.kinetic_energy"), *m = column(t, "particles.mass");
  expect_grid(t);
  for (int k = 0; k < t->nrow; k++) {
    double speed = 9.81 * time[k];
    ck_assert_msg(fabs(z[k] - start + 4.905 * time[k] * time[k]) < 1e-13, "z at %g s", time[k]);
    ck_assert_msg(fabs(v[k] + speed) < 1e-13, "v at %g s", time[k]);
    ck_assert_msg(fabs(e[k] - 0.5 * m[k] * speed * speed) < 0.13 * m[k] * 9.81 * 9.81 * 1e-8, "e at %g s", time[k]);
  }
}

START_TEST(alone) {
  setup();
  cpl_table t;
  ck_assert_msg(command("tandem-dem run %s/falls.json --out %s/out", dir, dir) == 0, "%s", command_output);
  read_table(&t, dir, "out/channels.csv");
  expect_fall(&t, 5);
  ck_assert_double_eq(column(&t, "particles.count")[100], 1);
  cpl_table_free(&t);
  directory_remove(dir);
}
END_TEST

START_TEST(coupled) {
  setup();
  for (int i = 0; i < 2; i++) { /* 7 does not divide 500 */
    cpl_table t;
    ck_assert_msg(command("tandem run %s/coupled.json --force --out %s/out --set coupling.scheme=%s", dir, dir,
                          i ? "lommen" : "proxy") == 0,
                  "%s", command_output);
    read_table(&t, dir, "out/dem.csv");
    expect_fall(&t, 5);
    cpl_table_free(&t);
    read_table(&t, dir, "out/body_plate.csv");
    expect_grid(&t);
    const double *time = column(&t, "time"), *v = column(&t, "vz"), *z = column(&t, "z");
    for (int k = 0; k < t.nrow; k++) {
      ck_assert_double_lt(fabs(v[k] + 3 + 4 * time[k]), 1e-7);
      ck_assert_double_lt(fabs(z[k] + 3 * time[k] + 2 * time[k] * time[k]), 1e-7);
    }
    cpl_table_free(&t);
    read_table(&t, dir, "out/ledger.csv");
    expect_grid(&t);
    cpl_table_free(&t);
  }
  ck_assert_int_eq(command("tandem check %s/coupled.json", dir), 0);
  expect_output("every 0.00027 s: 187 rows");
  directory_remove(dir);
}
END_TEST

/* impulse of a load that is given as means between rows */
static double impulse(const char *options, const char *channel) {
  cpl_table t;
  ck_assert_msg(command("tandem-dem run %s/bounces.json --force --out %s/out %s", dir, dir, options) == 0, "%s",
                command_output);
  read_table(&t, dir, "out/channels.csv");
  const double *time = column(&t, "time"), *f = column(&t, channel);
  double sum = 0;
  for (int k = 1; k < t.nrow; k++)
    sum += f[k] * (time[k] - time[k - 1]);
  cpl_table_free(&t);
  return sum;
}

/* Means over parts of steps add up to the same impulse as those over whole steps. */
START_TEST(loads_are_shared_out) {
  setup();
  double whole = impulse("--set output.interval=1e-3", "body.plate.fz");
  ck_assert_double_lt(whole, -1e-4);
  for (int i = 0; i < 3; i++) {
    static const char *const intervals[] = {"--set output.interval=2.7e-4", "--set output.interval=1.0001e-4",
                                            "--set output.interval=0.0333"};
    double parts = impulse(intervals[i], "body.plate.fz");
    ck_assert_msg(fabs(parts - whole) < 1e-12, "%s: %.17g N s, by whole steps %.17g", intervals[i], parts, whole);
  }
  directory_remove(dir);
}
END_TEST

/* Files for ParaView and pictures have the time of the step that they show, and the last state is among them. */
START_TEST(frames_and_pictures) {
  setup();
  ck_assert_msg(command("tandem-dem run %s/falls.json --out %s/out --set output.particles_interval=0.02003 --set "
                        "'output.pictures.times=[0.01003]'",
                        dir, dir) == 0,
                "%s", command_output);
  ck_assert_int_eq(command("cat %s/out/scene.pvd", dir), 0);
  expect_output("timestep=\"0\"");
  expect_output("timestep=\"0.0201\"");
  expect_output("timestep=\"0.0401\"");
  expect_output("timestep=\"0.05\"");
  ck_assert(is_there(dir, "out", "picture_000.png"));
  ck_assert_int_eq(command("tandem draw %s/out --times 0.0201,0.0401", dir), 0);
  expect_output("t = 0.0401 s");
  directory_remove(dir);
}
END_TEST

TEST_MAIN("rows", alone, coupled, loads_are_shared_out, frames_and_pictures)
