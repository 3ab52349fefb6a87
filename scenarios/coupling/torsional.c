/* The grid on a box that turns (e = 0.5, 4 s): angle and rate against the run with n = 1 of the same Δt and scheme.
 *
 * Particle motion is chaotic: two runs with n = 1 that differ by round-off (the box's mass by 1e-14 of itself) say how
 * close any two runs can come. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/coupling/cell.h"
#include "scenarios/table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double least_nse = 0.999;
static const char *const state[] = {"theta", "omega"};

/* Which n a grid has: all with --full, else those that show most. */
static bool wanted(const cpl_verify *v, int n) {
  return cpl_verify_full(v) || n == 5 || n == 50 || n == 100 || n == 1000;
}

/* Nash-Sutcliffe of a cell's curve against that of the run with n = 1. */
static double agreement(const cpl_comparison *c, const cpl_comparison *reference, int curve) {
  if (c->nrow != reference->nrow || c->ncurve <= curve)
    return NAN;
  return cpl_nse(c->curve[curve].simulation, reference->curve[curve].simulation, c->nrow);
}

static void measure(cpl_verify *v, scn_cell *cell, const cpl_verify_case *run, const cpl_comparison *reference,
                    tdm_error *err) {
  cpl_comparison c = {0};
  tdm_error own = {0};
  scn_cell_judge(cell, run, scn_torsional_compare, &own);
  if (own.status == TDM_OK && run->err.status == TDM_OK)
    scn_torsional_compare(run->dir, &c, &own);
  for (int i = 0; i < 2; i++)
    cell->nse[i] = agreement(&c, reference, i);
  cpl_comparison_free(&c);
  if (own.status == TDM_OK)
    scn_cell_measure(v, cell, run, state, "M");
  else
    tdm_fail(err, own.status, NULL, "%.100s: %.800s", run->name, own.message);
}

/* n = 1 first, then the ceiling, then the others. */
static int prepare(const cpl_verify *v, const char *dt, scn_cell *cell, cpl_verify_case *run) {
  int n = 2;
  cell[0] = (scn_cell){.scheme = "proxy", .dt = dt, .n = 1};
  cell[1] = cell[0];
  for (int i = 1; i < SCN_STEPS; i++)
    if (wanted(v, scn_steps[i]))
      cell[n++] = (scn_cell){.scheme = "proxy", .dt = dt, .n = scn_steps[i]};
  for (int i = 0; i < n; i++) {
    if (i > 1)
      cell[i].least_nse = least_nse;
    scn_cell_prepare(&cell[i], "torsional", &run[i]);
  }
  snprintf(run[1].name, sizeof run[1].name, "ceiling dt=%s", dt);
  cpl_verify_case_set(&run[1], "mbd.bodies[0].mass=%.17g", 50 * (1 + 1e-14)); /* 50 kg in the scene */
  return n;
}

static tdm_status one_step(cpl_verify *v, const char *dt, scn_cell *cell, cpl_verify_case *run, int *n,
                           tdm_error *err) {
  cpl_comparison reference = {0};
  tdm_error first = {0};
  *n = prepare(v, dt, cell, run);
  if (cpl_verify_run_many(v, *n, run, 0, err) != TDM_OK)
    return err->status;
  *err = run[0].err;
  if (err->status == TDM_OK && scn_torsional_compare(run[0].dir, &reference, err) == TDM_OK)
    for (int i = 1; i < *n; i++)
      measure(v, &cell[i], &run[i], &reference, &first);
  cpl_comparison_free(&reference);
  if (err->status == TDM_OK)
    *err = first;
  return err->status;
}

static void plot(cpl_verify *v, bool full) {
  static const char setup[] = "set logscale\nset format '%g'\nset key bottom right\n";
  static const tdm_curve curves[] = {{"proxy_1e-4.csv", "1:2", "angle, dt = 1e-4 s", "linespoints pt 7"},
                                     {"proxy_1e-4.csv", "1:3", "rate, dt = 1e-4 s", "linespoints pt 6"},
                                     {"ceiling_1e-4.csv", "1:3", "rate, runs that differ by round-off", "points pt 3"},
                                     {"proxy_1e-5.csv", "1:2", "angle, dt = 1e-5 s", "linespoints pt 9"},
                                     {"proxy_1e-5.csv", "1:3", "rate, dt = 1e-5 s", "linespoints pt 8"}};
  const tdm_plot plots[] = {
      {
          .title = "1 - nse against n = 1",
          .xlabel = "H = n dt [s]",
          .ylabel = "1 - nse",
          .setup = setup,
          .ncurve = full ? 5 : 3,
          .curve = curves,
      },
  };
  cpl_verify_plot(v, "grid", 1, plots);
}

tdm_status scn_coupling_torsional(cpl_verify *v, tdm_error *err) {
  static const char *const dts[] = {"1e-4", "1e-5"};
  scn_cell *cell = calloc(SCN_CELLS_MAX, sizeof *cell);
  cpl_verify_case *run = calloc(SCN_CELLS_MAX, sizeof *run);
  if (!cell || !run)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int d = 0; err->status == TDM_OK && d < (cpl_verify_full(v) ? 2 : 1); d++) {
    int n = 0;
    char name[32];
    one_step(v, dts[d], cell, run, &n, err);
    snprintf(name, sizeof name, "ceiling_%s", dts[d]);
    scn_cell_write(v, 1, cell + 1, "proxy", dts[d], NULL, name);
    snprintf(name, sizeof name, "proxy_%s", dts[d]);
    scn_cell_write(v, n - 2, cell + 2, "proxy", dts[d], NULL, name);
  }
  plot(v, cpl_verify_full(v));
  free(cell);
  free(run);
  return err->status;
}
