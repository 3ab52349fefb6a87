/* `tandem sweep`: a grid of runs of one scene, as [L18] Table II.
 *
 *   out/bed_<hash>        the settled bed that cells share (one for each combination of other settings)
 *   out/cells/<name>/     result directory of a cell, its comparison, and row.json, which --resume reads
 *   out/sweep.json, sweep.csv, table.html, heat_<state>.png, heat_energy.png, cost.png,
 *                         price.png
 *
 * A cell that fails or is unstable is a result, not a failure of the sweep.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_SWEEP_SWEEP_H
#define CPL_SWEEP_SWEEP_H

#include "coupler/verify/jobs.h"
#include "coupler/verify/verify.h"

enum { CPL_AXES_MAX = 16, CPL_VALUES_MAX = 64 };

/* One axis of the grid: a path of the scene and the values that it takes. */
typedef struct {
  char path[TDM_PATH_MAX];
  int nvalue;
  char *value[CPL_VALUES_MAX]; /* owned, as --set takes them */
} cpl_axis;

typedef struct {
  const char *scene; /* file */
  int naxis;
  cpl_axis axis[CPL_AXES_MAX];
  int jobs;    /* cells at a time */
  bool force;  /* replace the results of an earlier sweep there */
  bool resume; /* keep the rows that are there */
  const char *out;
  const char *json; /* further copy of sweep.json, NULL: none */
  const cpl_scenario *scenarios;
  cpl_solver solver[CPL_NROLE];
} cpl_sweep_options;

/* Cut "1e-5,1e-4" (commas inside brackets, braces and quotes do not count) into an axis, added to the options. */
tdm_status cpl_sweep_axis(cpl_sweep_options *options, const char *path, const char *list, tdm_error *err);
void cpl_sweep_free(cpl_sweep_options *options);

/* Run the grid. TDM_OK when every cell was tried, whatever became of it. */
tdm_status cpl_sweep(const cpl_sweep_options *options, tdm_error *err);

/* ---- one cell (sweep_cell.c) ---- */

typedef struct {
  char name[512];                     /* "dt=1e-5 n=10 scheme=lommen" */
  char dir[4096];                     /* its result directory */
  char *assignment[CPL_AXES_MAX + 1]; /* "path=value" for each axis, then the stored bed's; owned */
  const char *set[CPL_AXES_MAX + 2];  /* the same, NULL-terminated */
  json_t *row;                        /* NULL until it was tried */
} cpl_cell;

/* Run a cell and judge it: a row as the JSON contract of the sweep has it (new reference). */
json_t *cpl_cell_run(const cpl_sweep_options *options, const cpl_cell *cell);

/* The row of a cell that has no numbers. */
json_t *cpl_cell_row(const cpl_sweep_options *options, const cpl_cell *cell, const char *status, const char *reason);

/* ---- results (sweep_report.c) ---- */

/* Table on standard output, sweep.json, sweep.csv, table.html, plots. */
tdm_status cpl_sweep_report(const cpl_sweep_options *options, const cpl_cell *cell, int ncell, tdm_error *err);

#endif
