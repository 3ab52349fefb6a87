/* The press of hydrogel.json as a mechanism (plate.json): a plate on a prismatic joint whose motor drives it down, or
 * that a force pushes until the bed bears it, coupled by `proxy`. The bed becomes many times as stiff meanwhile.
 * Windows of 10 and of 100 steps against windows of one step. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/support.h"
#include "scenarios/table.h"

#include <math.h>
#include <stdio.h>

enum { PUSHED, DRIVEN, WAYS, WINDOWS = 3 };
static const char *const way_name[WAYS] = {"pushed", "driven"};
static const int window[WINDOWS] = {1, 10, 100}; /* steps */

/* time histories of a run */
typedef struct {
  scn_result result;
  int n;
  const double *z, *speed, *load; /* (n) of the plate; the load of the balls [N] */
  const double *motor;            /* (n) driven: force of the motor on the plate along the joint [N]; else NULL */
} history;

static void prepare(cpl_verify_case run[WAYS][WINDOWS]) {
  for (int w = 0; w < WAYS; w++)
    for (int k = 0; k < WINDOWS; k++) {
      run[w][k] = (cpl_verify_case){.scene = "multicontact/plate.json"};
      snprintf(run[w][k].name, sizeof run[w][k].name, "%s n=%d", way_name[w], window[k]);
      cpl_verify_case_set(&run[w][k], "parameters.driven=%d", w);
      cpl_verify_case_set(&run[w][k], "parameters.n=%d", window[k]);
    }
}

static tdm_status read_history(const cpl_verify_case *run, int way, history *h, tdm_error *err) {
  if (run->err.status != TDM_OK)
    return tdm_fail(err, run->err.status, NULL, "%.100s: %.800s", run->name, run->err.message);
  if (scn_result_read(&h->result, run->dir, err) != TDM_OK)
    return err->status;
  const cpl_table *body = &h->result.body;
  h->n = body->nrow;
  h->z = cpl_table_column(body, "z", err);
  h->speed = cpl_table_column(body, "vz", err);
  h->load = cpl_table_column(body, "fz", err);
  h->motor = way == DRIVEN ? cpl_table_column(&h->result.mbd, "driver.ram.force", err) : NULL;
  if (err->status == TDM_OK && way == DRIVEN && h->result.mbd.nrow != h->n)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: mbd.csv and body_plate.csv have other numbers of rows", run->dir);
  return err->status;
}

/* by how much a differs from b at most, share of `scale` */
static double difference(const double *a, const double *b, int n, double scale) {
  double most = 0;
  for (int k = 0; k < n; k++)
    most = fmax(most, fabs(a[k] - b[k]) / scale);
  return most;
}

/* the load's slope over the plate's way, between two shares of the whole way [N/m] */
static double stiffness(const history *h, double from, double to) {
  const double start = h->z[0], whole = start - h->z[h->n - 1];
  int a = 0, b = 0;
  while (b + 1 < h->n && start - h->z[b] < to * whole) {
    b++;
    a = start - h->z[b] < from * whole ? b : a;
  }
  return (h->load[b] - h->load[a]) / (h->z[a] - h->z[b]);
}

/* A run beside that with windows of one step. */
static void measure(cpl_verify *v, const cpl_verify_case *run, int way, const history *h, const history *fine) {
  const int end = h->n - 1;
  const double force = scn_number_or(h->result.scene, "parameters.force", NAN), load = h->load[end];
  const bool gained = json_is_true(tdm_scene_value(h->result.summary, "ledger.gained"));
  cpl_verify_about(v, run);
  cpl_verify_measure(v, "load_at_end [N]", run->name, load, CPL_NO_LIMIT, 0);
  if (way == DRIVEN) {
    cpl_verify_measure(v, "motor_at_end [N]", run->name, h->motor[end], CPL_NO_LIMIT, 0);
    cpl_verify_measure(v, "motor_off_load", run->name, h->motor[end] / load + 1, CPL_AT_MOST, 1e-3);
    cpl_verify_measure(v, "motor_off_n=1", run->name, difference(h->motor, fine->motor, h->n, fine->load[end]),
                       CPL_AT_MOST, 0.01);
  } else {
    const double whole = fine->z[0] - fine->z[end];
    cpl_verify_measure(v, "height_at_end [m]", run->name, h->z[end], CPL_NO_LIMIT, 0);
    cpl_verify_measure(v, "load_off_force", run->name, load / force - 1, CPL_AT_MOST, 0.01);
    cpl_verify_measure(v, "height_off_n=1", run->name, difference(h->z, fine->z, h->n, whole), CPL_AT_MOST, 0.01);
    cpl_verify_measure(v, "speed_at_end [m/s]", run->name, h->speed[end], CPL_AT_MOST, 0.01 * whole);
  }
  cpl_verify_measure(v, "exchange_made_energy", run->name, gained, CPL_AT_MOST, 0);
}

static void plot(cpl_verify *v) {
  static const tdm_curve force[] = {{"driven_n=1/body_plate.csv", "(-$4+0.167)/0.167:17", "windows of 1 step", "lines"},
                                    {"driven_n=10/body_plate.csv", "(-$4+0.167)/0.167:17", "10 steps", "lines"},
                                    {"driven_n=100/body_plate.csv", "(-$4+0.167)/0.167:17", "100 steps", "lines"}};
  static const tdm_curve place[] = {{"pushed_n=1/body_plate.csv", "1:4", "windows of 1 step", "lines"},
                                    {"pushed_n=10/body_plate.csv", "1:4", "10 steps", "lines"},
                                    {"pushed_n=100/body_plate.csv", "1:4", "100 steps", "lines"}};
  const tdm_plot plots[] = {
      {.title = "driven", .xlabel = "strain", .ylabel = "load on the plate [N]", .ncurve = WINDOWS, .curve = force},
      {.title = "pushed", .xlabel = "t [s]", .ylabel = "height of the plate [m]", .ncurve = WINDOWS, .curve = place}};
  cpl_verify_plot(v, "plate", 2, plots);
}

tdm_status scn_multi_plate(cpl_verify *v, tdm_error *err) {
  cpl_verify_case run[WAYS][WINDOWS];
  history h[WAYS][WINDOWS] = {0};
  prepare(run);
  cpl_verify_run_many(v, WAYS * WINDOWS, run[0], 0, err);
  for (int w = 0; w < WAYS; w++)
    for (int k = 0; k < WINDOWS && err->status == TDM_OK; k++)
      if (read_history(&run[w][k], w, &h[w][k], err) == TDM_OK)
        measure(v, &run[w][k], w, &h[w][k], &h[w][0]);
  if (err->status == TDM_OK) {
    const history *driven = &h[DRIVEN][0];
    cpl_verify_about(v, &run[DRIVEN][0]);
    cpl_verify_measure(v, "stiffness_at_end/at_start", "driven n=1",
                       stiffness(driven, 0.9, 1) / stiffness(driven, 0, 0.1), CPL_AT_LEAST, 10);
    plot(v);
  }
  for (int w = 0; w < WAYS; w++)
    for (int k = 0; k < WINDOWS; k++)
      scn_result_free(&h[w][k].result);
  return err->status;
}
