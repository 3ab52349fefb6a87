/* `tandem sweep`: see sweep.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE /* asprintf */
#include "coupler/sweep/sweep.h"

#include <stdlib.h>
#include <string.h>

/* ---- the grid ---- */

tdm_status cpl_sweep_axis(cpl_sweep_options *o, const char *path, const char *list, tdm_error *err) {
  if (o->naxis == CPL_AXES_MAX - 1 || strlen(path) >= TDM_PATH_MAX)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "sweep: at most %d axes", CPL_AXES_MAX - 1);
  for (int a = 0; a < o->naxis; a++)
    if (strcmp(o->axis[a].path, path) == 0)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "sweep: %s is given twice", path);
  return cpl_axis_read(&o->axis[o->naxis++], "sweep", path, list, err);
}

tdm_status cpl_sweep_repeat(cpl_sweep_options *o, const char *path, const char *list, tdm_error *err) {
  return cpl_axis_read(&o->repeat, "sweep", path, list, err);
}

tdm_status cpl_sweep_seeds(cpl_sweep_options *o, const char *list, tdm_error *err) {
  return cpl_axis_read(&o->seeds, "sweep", "--seeds", list, err);
}

void cpl_sweep_free(cpl_sweep_options *o) {
  for (int a = 0; a < o->naxis; a++)
    cpl_axis_free(&o->axis[a]);
  cpl_axis_free(&o->repeat);
  cpl_axis_free(&o->seeds);
  o->naxis = 0;
}

/* Cell number -> values of its axes; the first axis runs slowest. */
static tdm_status fill_cell(const cpl_sweep_options *o, const cpl_cells *cells, int index, tdm_error *err) {
  cpl_cell *cell = &cells->cell[index];
  int value[CPL_AXES_MAX];
  char *name = strdup("");
  if (!name)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  cell->scene = o->scene;
  for (int a = o->naxis - 1; a >= 0; a--) {
    value[a] = index % o->axis[a].nvalue;
    index /= o->axis[a].nvalue;
  }
  for (int a = 0; a < o->naxis && name; a++) {
    const cpl_axis *axis = &o->axis[a];
    const char *last = strrchr(axis->path, '.') ? strrchr(axis->path, '.') + 1 : axis->path;
    char *longer;
    if (asprintf(&longer, "%s%s%s=%s", name, a ? " " : "", last, axis->value[value[a]]) < 0)
      longer = NULL;
    if (!longer)
      tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    cpl_cell_set(cell, axis->path, axis->value[value[a]], err);
    free(name);
    name = longer;
  }
  cpl_cell_place(cells, cell, name ? name : "", o->naxis);
  free(name);
  return err->status;
}

/* ---- the sweep ---- */

/* The grid, into a directory that is open. */
static tdm_status sweep_cells(const cpl_sweep_options *o, long ncell, tdm_error *err) {
  cpl_cells cells = {.out = o->out, .jobs = o->jobs, .resume = o->resume, .scenarios = o->scenarios};
  memcpy(cells.solver, o->solver, sizeof cells.solver);
  cpl_cells_make(&cells, (int)ncell, err);
  for (int i = 0; i < cells.ncell; i++)
    fill_cell(o, &cells, i, err);
  if (err->status == TDM_OK)
    cpl_cells_run(&cells, err);
  if (err->status == TDM_OK || err->status == TDM_ERR_INTERRUPTED) {
    tdm_error report = {0};
    if (cpl_sweep_report(o, cells.cell, cells.ncell, &report) != TDM_OK)
      tdm_fail(err, report.status, NULL, "%s", report.message);
  }
  cpl_cells_free(&cells);
  return err->status;
}

tdm_status cpl_sweep(const cpl_sweep_options *o, tdm_error *err) {
  long ncell = 1;
  for (int a = 0; a < o->naxis; a++) {
    ncell *= o->axis[a].nvalue;
    if (ncell > 10000)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "sweep: more than 10000 cells");
  }
  tdm_results results;
  const tdm_results_def def = {
      .dir = o->out, .force = o->force, .beside = o->resume, .instead = "go on with it with --resume, "};
  if (tdm_results_open(&results, &def, err) != TDM_OK)
    return err->status;
  if (tdm_check_writable(o->json, err) == TDM_OK && tdm_results_start(&results, err) == TDM_OK)
    sweep_cells(o, ncell, err);
  tdm_results_close(&results);
  return err->status;
}
