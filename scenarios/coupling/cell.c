/* Cells of a grid over Δt and n, one scheme each: see cell.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/coupling/cell.h"

#include "protocol/results/results.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const int scn_steps[SCN_STEPS] = {1, 5, 10, 25, 50, 100, 1000};

static const double load_span = 0.02; /* [s] */

double scn_cell_window(const scn_cell *cell) {
  return cell->n * strtod(cell->dt, NULL);
}

void scn_cell_prepare(const scn_cell *cell, const char *scene, cpl_verify_case *run) {
  *run = (cpl_verify_case){.scene = scene, .shares_bed = true};
  snprintf(run->name, sizeof run->name, "scheme=%s dt=%s n=%d%s%s", cell->scheme, cell->dt, cell->n,
           cell->more ? " " : "", cell->more ? cell->more : "");
  cpl_verify_case_set(run, "coupling.scheme=%s", cell->scheme);
  cpl_verify_case_set(run, "time.dt=%s", cell->dt);
  cpl_verify_case_set(run, "coupling.n=%d", cell->n);
  cpl_verify_case_set(run, "coupling.guard.action=warn"); /* to see what comes of it */
}

/* A run may also get to its end without its particles. */
static bool lost_particles(const char *dir) {
  char file[4352];
  cpl_table dem = {0};
  snprintf(file, sizeof file, "%s/dem.csv", dir);
  cpl_table_read(&dem, file, NULL);
  const double *lost = cpl_table_column(&dem, "particles.lost", NULL);
  bool any = lost && dem.nrow > 0 && lost[dem.nrow - 1] > 0;
  cpl_table_free(&dem);
  return any;
}

tdm_status scn_cell_judge(scn_cell *cell, const cpl_verify_case *run, scn_compare *compare, tdm_error *err) {
  cpl_comparison c = {0};
  cell->nse[0] = cell->nse[1] = cell->r2_load = cell->r2_load_20ms = NAN;
  json_t *summary = tdm_results_read(run->dir, "summary.json", NULL);
  cell->iterations = scn_number_or(summary, "iterations.mean", NAN);
  cell->stable = run->err.status == TDM_OK && !lost_particles(run->dir) &&
                 !json_is_true(tdm_scene_value(summary, "ledger.gained"));
  json_decref(summary);
  if (run->err.status == TDM_ERR_NUMERIC)
    return TDM_OK;
  *err = run->err;
  if (err->status == TDM_OK && compare(run->dir, &c, err) == TDM_OK &&
      cpl_comparison_write(&c, run->dir, err) == TDM_OK) {
    for (int i = 0; i < 2; i++)
      cell->nse[i] = cpl_comparison_nse(&c, &c.curve[i]);
    cell->r2_load = cpl_comparison_r2(&c, &c.curve[2]);
    cell->r2_load_20ms = cpl_comparison_r2_mean(&c, &c.curve[2], load_span);
  }
  cpl_comparison_free(&c);
  return err->status;
}

void scn_cell_measure(cpl_verify *v, const scn_cell *cell, const cpl_verify_case *run, const char *const state[2],
                      const char *load) {
  char name[64];
  cpl_verify_about(v, run);
  for (int i = 0; i < 2; i++) {
    snprintf(name, sizeof name, "nse_%s", state[i]);
    cpl_verify_measure(v, name, run->name, cell->nse[i], cell->least_nse > 0 ? CPL_AT_LEAST : CPL_NO_LIMIT,
                       cell->least_nse);
  }
  snprintf(name, sizeof name, "r2_%s", load);
  cpl_verify_measure(v, name, run->name, cell->r2_load, CPL_NO_LIMIT, 0);
  snprintf(name, sizeof name, "r2_%s_20ms", load);
  cpl_verify_measure(v, name, run->name, cell->r2_load_20ms, cell->least_load > 0 ? CPL_AT_LEAST : CPL_NO_LIMIT,
                     cell->least_load);
  cpl_verify_measure(v, "stable", run->name, cell->stable, CPL_NO_LIMIT, 0);
  if (!isnan(cell->iterations))
    cpl_verify_measure(v, "iterations_per_window", run->name, cell->iterations, CPL_NO_LIMIT, 0);
}

static bool same(const char *a, const char *b) {
  return a == b || (a && b && strcmp(a, b) == 0);
}

void scn_cell_write(cpl_verify *v, int ncell, const scn_cell *cell, const char *scheme, const char *dt,
                    const char *more, const char *name) {
  char file[4352];
  snprintf(file, sizeof file, "%s/%s.csv", cpl_verify_dir(v), name);
  FILE *f = fopen(file, "w");
  if (!f)
    return; /* the plot says what is missing */
  fputs("H [s],1 - nse of the position [-],1 - nse of the velocity [-],r2 of the load [-],r2 of its means over 20 ms\n",
        f);
  for (int k = 0; k < SCN_STEPS; k++) /* in order of H, whatever order they ran in */
    for (int i = 0; i < ncell; i++)
      if (cell[i].n == scn_steps[k] && same(cell[i].scheme, scheme) && same(cell[i].dt, dt) && same(cell[i].more, more))
        fprintf(f, "%g,%.6g,%.6g,%.6g,%.6g\n", scn_cell_window(&cell[i]), 1 - cell[i].nse[0], 1 - cell[i].nse[1],
                cell[i].r2_load, cell[i].r2_load_20ms);
  fclose(f);
}
