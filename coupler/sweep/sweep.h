/* `tandem sweep`: a grid of runs of one scene by error and run time, as [L18] Table II; or a study (study/study.h),
 * from its file or from options.
 *
 *   out/cells/<name>/     result directory of a cell (cells/cells.h)
 *   out/sweep.json, sweep.csv, table.html, heat_<state>.png, heat_energy.png, cost.png,
 *                         price.png
 *
 * A cell that fails or is unstable is a result, not a failure of the sweep.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_SWEEP_SWEEP_H
#define CPL_SWEEP_SWEEP_H

#include "coupler/study/words.h"
#include "coupler/sweep/sweep_rows.h"

enum { CPL_AXES_MAX = 16 };

typedef struct {
  const char *scene; /* file */
  int naxis;
  cpl_axis axis[CPL_AXES_MAX];
  /* of a study */
  const char *study;          /* its file, NULL: options instead */
  const char *const *set;     /* "path=value" for all cells of the file's study; NULL-terminated, may be NULL */
  const char *const *only;    /* names of its cells that are wanted; NULL-terminated, NULL: all */
  cpl_axis seeds;             /* those of its seeds that are wanted; without values: all */
  cpl_axis repeat;            /* seeds; without values: none */
  const char *const *measure; /* (nmeasure) paths of summary.json, or channels */
  int nmeasure;
  /* of both */
  int jobs;    /* cells at a time */
  bool force;  /* replace the results of an earlier sweep there */
  bool resume; /* keep the rows that are there */
  const char *out;
  const char *json; /* further copy of sweep.json or study.json, NULL: none */
  const cpl_scenario *scenarios;
  cpl_solver solver[CPL_NROLE];
} cpl_sweep_options;

/* Add an axis to the options: a list as cpl_axis_read cuts it. */
tdm_status cpl_sweep_axis(cpl_sweep_options *options, const char *path, const char *list, tdm_error *err);
/* The same as the seeds. */
tdm_status cpl_sweep_repeat(cpl_sweep_options *options, const char *path, const char *list, tdm_error *err);
/* The same as those of a study's seeds that are wanted. */
tdm_status cpl_sweep_seeds(cpl_sweep_options *options, const char *list, tdm_error *err);
void cpl_sweep_free(cpl_sweep_options *options);

/* Run the grid. TDM_OK when every cell was tried, whatever became of it. */
tdm_status cpl_sweep(const cpl_sweep_options *options, tdm_error *err);

/* The same judged by measures: a study. */
tdm_status cpl_sweep_study(const cpl_sweep_options *options, tdm_error *err);

/* ---- results (sweep_report.c) ---- */

/* Table on standard output, sweep.json, sweep.csv, table.html, plots. */
tdm_status cpl_sweep_report(const cpl_sweep_options *options, const cpl_cell *cell, int ncell, tdm_error *err);

/* A file of the results for writing. */
tdm_status cpl_sweep_file(const cpl_sweep_options *options, const char *name, FILE **file, tdm_error *err);

/* Error against run time, price of a window, heat maps (sweep_plots.c). */
tdm_status cpl_sweep_plots(const cpl_sweep_options *options, const cpl_cell *cell, int ncell, const cpl_columns *c,
                           tdm_error *err);

#endif
