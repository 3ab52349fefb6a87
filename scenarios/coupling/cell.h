/* Cells of a grid over Δt and n, one scheme each: their names, runs and numbers. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_COUPLING_CELL_H
#define SCN_COUPLING_CELL_H

#include "scenarios/support.h"

enum { SCN_STEPS = 7, SCN_CELLS_MAX = 96 };

extern const int scn_steps[SCN_STEPS]; /* n of [L18] Table II */

typedef struct {
  const char *scheme, *dt; /* as the case has them: "proxy", "1e-4" */
  int n;
  const char *more;             /* the rest of the case's name ("e=0.5"), or NULL */
  double least_nse, least_load; /* limits of nse and of r2 of the load's means over 20 ms; 0: none */
  /* measured */
  bool stable;
  double nse[2], r2_load, r2_load_20ms; /* NaN when the run ended early */
  double iterations;                    /* a window, NaN when the scheme does not iterate */
} scn_cell;

typedef tdm_status scn_compare(const char *dir, cpl_comparison *c, tdm_error *err);

/* Length of the cell's window [s]. */
double scn_cell_window(const scn_cell *cell);

/* Name and settings of the cell's run; scene: the scenario whose scene it is. */
void scn_cell_prepare(const scn_cell *cell, const char *scene, cpl_verify_case *run);

/* Numbers of a cell that ran, against its reference. A run that ended unstable is no error, one that was refused is. */
tdm_status scn_cell_judge(scn_cell *cell, const cpl_verify_case *run, scn_compare *compare, tdm_error *err);

/* Report a cell: nse of both states and r2 of the load, by the names of `state` and `load`. */
void scn_cell_measure(cpl_verify *v, const scn_cell *cell, const cpl_verify_case *run, const char *const state[2],
                      const char *load);

/* The cells of a scheme and Δt as NAME.csv in the scenario's directory, for plots: H, 1 - nse, r2. */
void scn_cell_write(cpl_verify *v, int ncell, const scn_cell *cell, const char *scheme, const char *dt,
                    const char *more, const char *name);

#endif
