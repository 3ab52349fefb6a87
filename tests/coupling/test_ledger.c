/* The ledger: work in closed form, impulse, balance, and runs that gain energy. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/observe/ledger.h"
#include "coupler/observe/momentum.h"
#include "protocol/results/results.h"
#include "tests/command.h"
#include "tests/result_table.h"
#include "tests/test_main.h"

#include <math.h>

/* ---- work in closed form ---- */

static tdm_vec3 hermite_velocity(const tdm_state *a, const tdm_state *b, double h, double s) {
  tdm_vec3 way = tdm_scale(6 * s * (1 - s) / h, tdm_sub(b->pose.position, a->pose.position));
  way = tdm_axpy((1 - s) * (1 - 3 * s), a->twist.velocity, way);
  return tdm_axpy(s * (3 * s - 2), b->twist.velocity, way);
}

START_TEST(work_is_the_integral_along_the_path) {
  const double h = 0.25;
  tdm_quat q0 = tdm_quat_from_rotvec(tdm_v3(0.3, -0.2, 0.5));
  tdm_vec3 axis = tdm_v3(0, 0.6, 0.8);
  double angle = 0.4, rate0 = 1.1, rate1 = 2.3;
  tdm_state a = {{{1, 2, 3}, q0}, {{0.5, -1, 2}, tdm_scale(rate0, axis)}};
  tdm_state b = {{{1.2, 1.9, 3.3}, tdm_quat_mul(tdm_quat_from_rotvec(tdm_scale(angle, axis)), q0)},
                 {{-0.7, 0.4, 1}, tdm_scale(rate1, axis)}};
  tdm_wrench load[TDM_LOAD_MAX] = {{{10, -3, 2}, {1, 2, 3}}, {{-40, 7, 5}, {0.3, -2, 1}}, {{25, 1, -60}, {-4, 1, 0.5}}};
  for (int j = 3; j < TDM_LOAD_MAX; j++)
    load[j] = (tdm_wrench){{j, -30, 20 - j}, {3, 2 * j, -1}};
  for (int n = 1; n <= TDM_LOAD_MAX; n++) {
    const int cells = 2000;
    double sum = 0;
    for (int i = 0; i <= cells; i++) { /* Simpson */
      double s = (double)i / cells, weight = i == 0 || i == cells ? 1 : i % 2 ? 4 : 2;
      tdm_vec3 f = {0, 0, 0}, m = {0, 0, 0};
      for (int j = n - 1; j >= 0; j--) {
        f = tdm_add(tdm_scale(s, f), load[j].force);
        m = tdm_add(tdm_scale(s, m), load[j].moment);
      }
      double w = 6 * s * (1 - s) * angle / h + (1 - s) * (1 - 3 * s) * rate0 + s * (3 * s - 2) * rate1;
      sum += weight * (tdm_dot(f, hermite_velocity(&a, &b, h, s)) + w * tdm_dot(m, axis));
    }
    ck_assert_double_eq_tol(cpl_work_along(&a, &b, h, load, n), h * sum / (3 * cells), 1e-10);
  }
  /* a constant load: force times way, moment times turn, whatever the twists */
  double work = tdm_dot(load[0].force, tdm_v3(0.2, -0.1, 0.3)) + angle * tdm_dot(load[0].moment, axis);
  ck_assert_double_eq_tol(cpl_work_along(&a, &b, h, load, 1), work, 1e-13);
}
END_TEST

/* ---- runs ---- */

/* a cube that floats, hit by a particle; %s: restitution, further settings of dem and of the coupling */
static const char floating[] =
    "{\"time\": {\"end\": 0.02, \"dt\": 2e-5},\n"
    " \"coupling\": {\"n\": 10, \"bodies\": [{\"mbd\": \"cube\", \"dem\": \"cube\"}]},\n"
    " \"output\": {\"interval\": 2e-4},\n"
    " \"mbd\": {\"gravity\": [0, 0, -9.81], \"bodies\": [{\"name\": \"cube\", \"mass\": 0.05, \"inertia\": [1e-4, "
    "1e-4, "
    "1e-4], \"position\": [0.1, 0, 0], \"velocity\": [0.1, 0, 0.3]}]},\n"
    " \"dem\": {\"gravity\": [0, 0, -9.81], \"materials\": [{\"name\": \"m\", \"density\": 2500, \"young_modulus\": "
    "5e6, "
    "\"poisson_ratio\": 0.2}],\n"
    "  \"pairs\": [{\"materials\": [\"m\", \"m\"], \"restitution\": 1, \"friction\": 0}],\n"
    "  \"bodies\": [{\"name\": \"cube\", \"material\": \"m\", \"shapes\": [{\"type\": \"box\", \"size\": [0.2, 0.2, "
    "0.2], "
    "\"side\": \"outside\"}]}],\n"
    "  \"particles\": [{\"type\": \"list\", \"material\": \"m\", \"radius\": 0.01, \"mass\": 0.02, \"positions\": "
    "[[-0.011, 0.02, 0]], \"velocity\": [2, 0, 0]}]}}\n";

/* 20 particles twice as heavy as the box that holds them on a spring */
static const char heavy[] =
    "{\"time\": {\"end\": 1.5, \"dt\": 2e-4},\n"
    " \"coupling\": {\"n\": 250, \"scheme\": \"lommen\", \"bodies\": [{\"mbd\": \"box\", \"dem\": \"box\"}]},\n"
    " \"mbd\": {\"bodies\": [{\"name\": \"box\", \"mass\": 10, \"inertia\": [1, 1, 1], \"position\": [0, 0, 0]}],\n"
    "  \"joints\": [{\"name\": \"guide\", \"type\": \"prismatic\", \"bodies\": [\"ground\", \"box\"], \"point\": [0, "
    "0, "
    "0], \"axis\": [0, 0, 1]}],\n"
    "  \"forces\": [{\"name\": \"spring\", \"type\": \"spring_damper\", \"bodies\": [\"ground\", \"box\"],\n"
    "   \"points\": [[0, 0, 3], [0, 0, 0]], \"stiffness\": 500, \"damping\": 50, \"preload\": 10}]},\n"
    " \"dem\": {\"materials\": [{\"name\": \"m\", \"density\": 1000, \"young_modulus\": 1e7, \"poisson_ratio\": "
    "0.2}],\n"
    "  \"pairs\": [{\"materials\": [\"m\", \"m\"], \"restitution\": 0.9, \"friction\": 0.5}],\n"
    "  \"bodies\": [{\"name\": \"box\", \"material\": \"m\", \"shapes\": [{\"type\": \"box\", \"size\": [0.3, 0.3, "
    "0.8], "
    "\"side\": \"inside\"}]}],\n"
    "  \"particles\": [{\"type\": \"random\", \"material\": \"m\", \"count\": 20, \"radius\": 0.05, \"total_mass\": "
    "20,\n"
    "   \"region\": {\"min\": [-0.15, -0.15, -0.4], \"max\": [0.15, 0.15, 0.4]}}],\n"
    "  \"settle\": {\"speed\": 5e-3}}}\n";

/* the summary's ledger (borrowed from *summary) */
static const json_t *ledger_of(const char *dir, json_t **summary) {
  char path[256];
  snprintf(path, sizeof path, "%s/out", dir);
  *summary = tdm_results_read(path, "summary.json", NULL);
  ck_assert_ptr_nonnull(*summary);
  const json_t *ledger = json_object_get(*summary, "ledger");
  ck_assert_ptr_nonnull(ledger);
  return ledger;
}

static double figure(const json_t *ledger, const char *key) {
  return json_number_value(json_object_get(ledger, key));
}

START_TEST(impulse_and_balance_of_a_floating_cube) {
  const char *dir = directory_make();
  write_file(dir, "scene.json", floating);
  ck_assert_msg(command("tandem run %s/scene.json --out %s/out --force", dir, dir) == 0, "%s", command_output);
  cpl_table ledger = {0}, body = {0};
  read_table(&ledger, dir, "out/ledger.csv");
  read_table(&body, dir, "out/body_cube.csv");
  ck_assert_int_eq(ledger.nrow, body.nrow);
  const double *t = column(&body, "time"), *vx = column(&body, "vx"), *vz = column(&body, "vz");
  const double *px = column(&ledger, "cube.impulse.x"), *pz = column(&ledger, "cube.impulse.z");
  const double *balance = column(&ledger, "balance"), *dem = column(&ledger, "cube.work.dem"),
               *mbd = column(&ledger, "cube.work.mbd");
  for (int i = 0; i < ledger.nrow; i++) { /* windows end on output times; the tolerance is MBD's */
    ck_assert_double_eq_tol(px[i], 0.05 * (vx[i] - 0.1), 1e-7);
    ck_assert_double_eq_tol(pz[i], 0.05 * (vz[i] - 0.3 + 9.81 * t[i]), 1e-7);
  }
  int last = ledger.nrow - 1;
  ck_assert_double_gt(px[last], 0.04); /* it was hit */
  ck_assert_double_gt(dem[last], 0.02);
  ck_assert_double_eq_tol(mbd[last], dem[last], 1e-5 * dem[last]);
  ck_assert_double_eq(balance[0], 0);
  json_t *summary;
  const json_t *figures = ledger_of(dir, &summary);
  double most = figure(figures, "largest_energy_J");
  ck_assert_double_gt(most, 0.02);
  ck_assert_double_eq_tol(balance[last], 0, 1e-3 * most); /* e = 1: nothing is lost, nothing comes */
  ck_assert_double_lt(figure(figures, "energy_rise"), 5e-3);
  ck_assert_double_lt(figure(figures, "energy_residual"), 1e-5);
  json_decref(summary);
  cpl_table_free(&ledger);
  cpl_table_free(&body);
  ck_assert_int_eq(command("sh -c 'cp %s/out/ledger.csv %s/first.csv'", dir, dir), 0);
  ck_assert_int_eq(command("tandem run %s/scene.json --out %s/out --force", dir, dir), 0);
  ck_assert_int_eq(command("cmp %s/out/ledger.csv %s/first.csv", dir, dir), 0);
  ck_assert_msg(command("tandem report %s/out", dir) == 0, "%s", command_output);
  ck_assert_int_eq(command("sh -c 'ls %s/out/report_*ledger.png'", dir), 0);
  directory_remove(dir);
}
END_TEST

/* Nothing holds the cube, and there is no gravity: whatever the scheme and the formulation, the momentum of cube and
 * particle after the impact is that before it. Schemes that extrapolate owe a window's impulse meanwhile. */
START_TEST(momentum_of_an_isolated_system) {
  static const char *const scheme[] = {"proxy", "iterative", "dem-first", "lommen", "hold"};
  static const char *const formulation[] = {"ggl", "index3", "one_step"};
  const double before[3] = {0.05 * 0.1 + 0.02 * 2, 0, 0.05 * 0.3};
  const char *dir = directory_make();
  write_file(dir, "scene.json", floating);
  for (int k = 0; k < 15; k++) {
    json_t *summary;
    cpl_table body = {0}, dem = {0};
    ck_assert_msg(command("tandem run %s/scene.json --out %s/out --force --set mbd.gravity=[0,0,0] "
                          "--set dem.gravity=[0,0,0] --set coupling.n=%d --set coupling.scheme=%s --set "
                          "mbd.formulation=%s --set coupling.transport=inproc --set output.interval=2e-3",
                          dir, dir, k % 2 ? 1 : 7, scheme[k / 3], formulation[k % 3]) == 0,
                  "%s", command_output);
    read_table(&body, dir, "out/body_cube.csv");
    read_table(&dem, dir, "out/dem.csv");
    for (int c = 0; c < 3; c++) {
      static const char *const v[] = {"vx", "vy", "vz"};
      static const char *const w[] = {"particles.velocity.x", "particles.velocity.y", "particles.velocity.z"};
      double now = 0.05 * column(&body, v[c])[body.nrow - 1] + 0.02 * column(&dem, w[c])[dem.nrow - 1];
      ck_assert_msg(fabs(now - before[c]) < 1e-10 * 0.045, "%s, %s: %.15g N s, was %.15g", scheme[k / 3],
                    formulation[k % 3], now, before[c]);
    }
    ck_assert_double_gt(column(&body, "vx")[body.nrow - 1], 1); /* it was hit */
    const json_t *cube = json_object_get(json_object_get(ledger_of(dir, &summary), "bodies"), "cube");
    ck_assert_double_lt(figure(cube, "momentum_off"), 1e-10);
    json_decref(summary);
    cpl_table_free(&body);
    cpl_table_free(&dem);
  }
  directory_remove(dir);
}
END_TEST

/* A solver that takes the mean of two windows' loads: what it has of the momentum is half a window late. */
START_TEST(momentum_that_no_load_gave_is_noticed) {
  cpl_settings settings = {.nbody = 1};
  tdm_assigned_body body = {.mass = 2, .state.twist.velocity = {1, 0, 0}, .nfree = 1, .free = {{1, 0, 0}}};
  cpl_session session = {.settings = &settings, .body = &body};
  tdm_wrench load[TDM_LOAD_MAX] = {{{0, 0, 0}, {0, 0, 0}}};
  tdm_state end = body.state;
  cpl_loop loop = {.settings = &settings, .session = &session, .nload = 2, .load = load, .state_end = &end};
  for (int late = 0; late < 2; late++) {
    cpl_momentum momentum = {{0, 0, 0}, 0, 0, 0};
    double mean = 0, v = 1;
    for (int k = 0; k < 100; k++) {
      loop.t0 = 0.01 * k, loop.t1 = 0.01 * (k + 1);
      load[0].force = tdm_v3(k < 50 ? k : 0, 3, 0);
      load[1].force = tdm_v3(k < 50 ? 1 : 0, 0, 0);
      double before = mean;
      mean = load[0].force.x + 0.5 * load[1].force.x;
      v += 0.01 / 2 * (late ? 0.5 * (mean + before) : mean);
      end.twist.velocity.x = v;
      cpl_momentum_window(&momentum, &loop, 0);
    }
    double share = cpl_momentum_share(&momentum, &body);
    ck_assert_msg(late ? share > 0.01 : share < 1e-13, "%g", share);
  }
  body.nfree = 0;
  ck_assert(isnan(cpl_momentum_share(&(cpl_momentum){{0, 0, 0}, 0, 0, 0}, &body)));
}
END_TEST

START_TEST(a_run_that_gains_energy_stops) {
  const char *dir = directory_make();
  json_t *summary;
  write_file(dir, "scene.json", heavy);
  ck_assert_int_eq(
      command("tandem run %s/scene.json --out %s/out --force --set dem.settle.store=%s/bed", dir, dir, dir), 1);
  expect_output("coupling.n: energy without a source");
  expect_output("at body \"box\"");
  expect_output("take a smaller coupling.n");
  const json_t *figures = ledger_of(dir, &summary);
  ck_assert_double_gt(figure(figures, "gained_at_s"), 0);
  ck_assert_double_lt(figure(summary, "simulated_s"), 1.5);
  ck_assert_str_eq(json_string_value(json_object_get(summary, "status")), "TDM_ERR_NUMERIC");
  json_decref(summary);
  /* only told */
  command(
      "tandem run %s/scene.json --out %s/out --force --set dem.settle.store=%s/bed --set coupling.guard.action=warn",
      dir, dir, dir);
  expect_output("tandem: warning: server: ");
  expect_output("energy without a source");
  figures = ledger_of(dir, &summary);
  ck_assert_double_gt(figure(figures, "gained_at_s"), 0);
  json_decref(summary);
  ck_assert_int_eq(command("grep -q 'event=guard.*energy without a source' %s/out/server.log", dir), 0);
  /* short windows: nothing rises, and what both sides worked agrees */
  ck_assert_int_eq(
      command("tandem run %s/scene.json --out %s/out --force --set dem.settle.store=%s/bed --set coupling.n=5 "
              "--set coupling.scheme=proxy",
              dir, dir, dir),
      0);
  figures = ledger_of(dir, &summary);
  ck_assert_double_lt(figure(figures, "energy_rise"), 0.01);
  ck_assert_double_lt(figure(figures, "energy_residual"), 1e-5);
  json_decref(summary);
  directory_remove(dir);
}
END_TEST

START_TEST(a_run_that_ends_with_energy_gained_has_failed) {
  const char *dir = directory_make();
  write_file(dir, "scene.json", heavy);
  /* three windows: too few for three looks in a row */
  ck_assert_int_eq(
      command("tandem run %s/scene.json --out %s/out --force --set coupling.n=1000 --set time.end=0.6", dir, dir), 1);
  expect_output("energy without a source");
  directory_remove(dir);
}
END_TEST

/* A sticking elastic sphere keeps more than a tenth of its energy in its tangential spring for a while, which is not
 * counted: no reason to stop. Both accounts of the exchange agree, also under iterations. */
START_TEST(no_false_alarm) {
  static const char *const more[] = {"", "--set coupling.scheme=iterative"};
  const char *dir = directory_make();
  json_t *summary;
  write_file(
      dir, "scene.json",
      "{\"time\": {\"end\": 0.12, \"dt\": 5e-6}, \"coupling\": {\"n\": 100, \"bodies\": [{\"mbd\": \"box\", "
      "\"dem\": \"box\"}]},\n"
      " \"mbd\": {\"gravity\": [0, 0, 0], \"bodies\": [{\"name\": \"box\", \"mass\": 10, \"inertia\": [2, 2, 2], "
      "\"position\": [0, 0, 0], \"angular_velocity\": [0, 1, 0]}]},\n"
      " \"dem\": {\"gravity\": [0, 0, 0], \"materials\": [{\"name\": \"g\", \"density\": 1000, \"young_modulus\": "
      "1e6, \"poisson_ratio\": 0.2}], \"pairs\": [{\"materials\": [\"g\", \"g\"], \"restitution\": 1, "
      "\"friction\": 5}],\n"
      "  \"bodies\": [{\"name\": \"box\", \"material\": \"g\", \"shapes\": [{\"type\": \"box\", \"size\": [0.8, "
      "0.8, 1.4], \"side\": \"inside\"}]}],\n"
      "  \"particles\": [{\"type\": \"list\", \"material\": \"g\", \"radius\": 0.05, \"positions\": [[-0.2, 0, "
      "-0.6]], \"velocity\": [1.5, 0, -1]}]}}");
  for (int i = 0; i < 2; i++) {
    ck_assert_msg(command("tandem run %s/scene.json --out %s/out --force %s", dir, dir, more[i]) == 0, "%s",
                  command_output);
    const json_t *figures = ledger_of(dir, &summary);
    const json_t *body = json_object_get(json_object_get(figures, "bodies"), "box");
    ck_assert(json_is_null(json_object_get(figures, "gained_at_s")));
    ck_assert_double_gt(fabs(figure(body, "work_dem_J")), 0.1);
    ck_assert_double_lt(figure(figures, "energy_residual"), i ? 1e-4 : 1e-6); /* one_step of 5e-4 s; IDA */
    ck_assert_double_lt(fabs(figure(body, "blending_J")), 1e-4);
    json_decref(summary);
  }
  directory_remove(dir);
}
END_TEST

/* A particle of 10 g hits a cube of 20 g: at 40 steps a window the extrapolated load leaves the velocity 7 % off,
 * within what the guard lets pass. What both sides' works differ by tells. */
START_TEST(an_inexact_exchange_is_told) {
  static const struct {
    const char *more;
    bool inexact;
  } runs[] = {
      {"--set coupling.n=40 --set coupling.scheme=lommen", true},
      {"--set coupling.n=40 --set coupling.scheme=lommen --set coupling.guard.residual=2", false},
      {"--set coupling.n=40 --set coupling.scheme=lommen --set mbd.bodies[0].mass=10", false}, /* hardly moves */
      {"--set coupling.n=1 --set coupling.scheme=lommen", false},
      {"--set coupling.n=40", false}};
  const char *dir = directory_make();
  for (int i = 0; i < 5; i++) {
    json_t *summary;
    ck_assert_msg(command("tandem run %s/scenarios/collision/scene.json --out %s/out --force --set "
                          "mbd.bodies[0].mass=0.02 --set output.interval=1e-4 %s",
                          TANDEM_SOURCE_DIR, dir, runs[i].more) == 0,
                  "%s", command_output);
    ck_assert_msg((strstr(command_output, "coupling.n: inexact: ") != NULL) == runs[i].inexact, "%s: %s", runs[i].more,
                  command_output);
    const json_t *figures = ledger_of(dir, &summary);
    ck_assert(json_is_true(json_object_get(figures, "inexact")) == runs[i].inexact);
    if (i < 2)
      ck_assert_double_gt(figure(figures, "residual_share"), 0.3);
    else if (i > 2)
      ck_assert_double_lt(figure(figures, "residual_share"), 1e-3);
    json_decref(summary);
    if (i > 0)
      continue;
    ck_assert_int_eq(command("tandem report %s/out", dir), 0);
    expect_output("coupling.n: inexact: ");
    ck_assert_int_eq(command("grep -q 'inexact: ' %s/out/index.html", dir), 0);
  }
  directory_remove(dir);
}
END_TEST

/* A plate stands still over a bed whose last motion goes into rolling springs and comes back: that is no energy without
 * a source, and energy as small as that of a bed at rest is not judged. */
START_TEST(springs_of_a_bed_raise_no_alarm) {
  const char *dir = directory_make();
  json_t *summary;
  write_file(
      dir, "scene.json",
      "{\"time\": {\"end\": 0.2, \"dt\": 1e-4}, \"coupling\": {\"n\": 10, \"bodies\": [{\"mbd\": \"plate\", \"dem\": "
      "\"plate\"}]}, \"mbd\": {\"formulation\": \"one_step\", \"bodies\": [{\"name\": \"plate\", \"mass\": 10, "
      "\"inertia\": [1, 1, 1], \"position\": [0, 0, 0.8]}], \"joints\": [{\"name\": \"rail\", \"type\": \"fixed\", "
      "\"bodies\": [\"ground\", \"plate\"], \"point\": [0, 0, 0.8]}]}, \"dem\": {\"contact\": {\"rolling\": "
      "\"spring-dashpot\"}, \"materials\": [{\"name\": \"grain\", \"density\": 2600, \"young_modulus\": 1e7, "
      "\"poisson_ratio\": 0.25}], \"pairs\": [{\"materials\": [\"grain\", \"grain\"], \"restitution\": 0.3, "
      "\"friction\": 0.6, \"rolling_friction\": 0.2}], \"bodies\": [{\"name\": \"plate\", \"material\": \"grain\", "
      "\"shapes\": [{\"type\": \"box\", \"side\": \"outside\", \"size\": [0.2, 0.2, 0.02]}]}, {\"name\": \"bin\", "
      "\"material\": \"grain\", \"shapes\": [{\"type\": \"box\", \"side\": \"inside\", \"size\": [0.4, 0.4, 1.0], "
      "\"open\": [\"+z\"]}]}], \"particles\": [{\"type\": \"random\", \"material\": \"grain\", \"count\": 400, "
      "\"radius\": [0.014, 0.02], \"region\": {\"min\": [-0.2, -0.2, -0.5], \"max\": [0.2, 0.2, -0.1]}}], \"settle\": "
      "{}}}");
  ck_assert_msg(command("tandem run %s/scene.json --out %s/out", dir, dir) == 0, "%s", command_output);
  const json_t *figures = ledger_of(dir, &summary);
  ck_assert(json_is_null(json_object_get(figures, "gained_at_s")));
  ck_assert(json_is_false(json_object_get(figures, "gained")));
  ck_assert_double_lt(figure(figures, "energy_rise"), 0.01);
  ck_assert_double_gt(figure(figures, "largest_energy_J"), 1e-6); /* 20 kg at 1e-3 m/s */
  json_decref(summary);
  directory_remove(dir);
}
END_TEST

START_TEST(without_energies_there_is_no_verdict) {
  const char *dir = directory_make();
  json_t *summary;
  write_file(dir, "scene.json",
             "{\"time\": {\"end\": 0.1, \"dt\": 1e-3}, \"coupling\": {\"n\": 5, \"scheme\": \"lommen\", \"bodies\": "
             "[{\"mbd\": \"b\", \"dem\": \"b\"}], \"solvers\": {\"dem\": \"dummy_solver\"}},\n"
             " \"mbd\": {\"bodies\": [{\"name\": \"b\", \"mass\": 1, \"inertia\": [1, 1, 1], \"position\": [0, 0, 0], "
             "\"velocity\": [1, 0, 0]}], \"gravity\": [0, 0, 0]},\n"
             " \"dem\": {\"stiffness\": 100}}");
  ck_assert_msg(command("tandem run %s/scene.json --out %s/out --force", dir, dir) == 0, "%s", command_output);
  const json_t *figures = ledger_of(dir, &summary);
  ck_assert(json_is_null(json_object_get(figures, "energy_residual")));
  ck_assert(json_is_false(json_object_get(figures, "inexact")));
  ck_assert(json_is_null(json_object_get(figures, "gained_at_s")));
  const json_t *body = json_object_get(json_object_get(figures, "bodies"), "b");
  ck_assert_double_lt(figure(body, "work_dem_J"), -0.1); /* the spring slows the body down */
  ck_assert_double_eq_tol(figure(body, "work_mbd_J"), figure(body, "work_dem_J"), 0.05);
  json_decref(summary);
  cpl_table t = {0};
  read_table(&t, dir, "out/ledger.csv");
  ck_assert(cpl_table_column(&t, "energy.mbd", NULL) && !cpl_table_column(&t, "energy.dem", NULL) &&
            !cpl_table_column(&t, "balance", NULL));
  cpl_table_free(&t);
  directory_remove(dir);
}
END_TEST

TEST_MAIN("ledger", work_is_the_integral_along_the_path, impulse_and_balance_of_a_floating_cube,
          momentum_of_an_isolated_system, momentum_that_no_load_gave_is_noticed, a_run_that_gains_energy_stops,
          a_run_that_ends_with_energy_gained_has_failed, no_false_alarm, an_inexact_exchange_is_told,
          springs_of_a_bed_raise_no_alarm, without_energies_there_is_no_verdict)
