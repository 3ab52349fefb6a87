/* Cells: runs of scenes with settings of their own, side by side, each in a process and in a result directory of its
 * own, with a row that says what became of it.
 *
 *   OUT/bed_<hash>       the settled bed that cells share (one for each combination of other settings)
 *   OUT/cells/<name>/    result directory of a cell, its comparison, and row.json, which `resume` reads
 *
 * A scene of particles alone or of bodies alone is run by the solver's program, whose words are in run.log then. Where
 * cells run side by side each has one thread and one process for its particles (dem.threads, dem.ranks): results do
 * not depend on these.
 *
 * A cell that fails or is unstable is a result, not a failure of the whole.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_CELLS_CELLS_H
#define CPL_CELLS_CELLS_H

#include "coupler/results/scenario.h"
#include "coupler/run/run.h"

enum { CPL_CELL_SETTINGS = 64 };

typedef struct {
  char name[512];                   /* "dt=1e-5 n=10 scheme=lommen" */
  char dir[4096];                   /* its result directory */
  const char *scene;                /* file, borrowed */
  const char *program;              /* solver that runs it alone, borrowed; NULL: both, coupled */
  int nset;                         /* settings of its own: what its row tells */
  char *set[CPL_CELL_SETTINGS + 4]; /* "path=value" of these, then what cells add themselves; NULL-terminated, owned */
  const char *store;                /* the stored bed's among them, NULL: none */
  json_t *row;                      /* NULL until it was tried */
} cpl_cell;

typedef struct {
  const char *out;               /* directory, which is there */
  int jobs;                      /* cells at a time */
  bool resume;                   /* keep the rows that are there */
  bool quiet;                    /* no line for each cell on standard error */
  const cpl_scenario *scenarios; /* table ended by a NULL name */
  cpl_solver solver[CPL_NROLE];
  int ncell;
  cpl_cell *cell; /* (ncell) owned */
} cpl_cells;

/* Make room for n cells without names and settings. */
tdm_status cpl_cells_make(cpl_cells *cells, int n, tdm_error *err);
void cpl_cells_free(cpl_cells *cells);

/* Add a setting of the cell's own: the value as --set takes it. */
tdm_status cpl_cell_set(cpl_cell *cell, const char *path, const char *value, tdm_error *err);
/* Add one that its row does not tell, after all of its own. Its text, NULL after an error. */
const char *cpl_cell_add(cpl_cell *cell, const char *path, const char *value, tdm_error *err);

/* Name a cell by `nvalue` values with blanks between them, and choose its directory. */
void cpl_cell_place(const cpl_cells *cells, cpl_cell *cell, const char *name, int nvalue);

/* Run all cells that have no row. TDM_OK when every one was tried, whatever became of it; TDM_ERR_INTERRUPTED when some
 * were not. */
tdm_status cpl_cells_run(cpl_cells *cells, tdm_error *err);

/* The scene of a cell as it runs, without the settings that cannot be made (an error); the caller destroys it also
 * after an error. */
tdm_status cpl_cell_scene(const cpl_cell *cell, tdm_scene *scene, tdm_error *err);

/* Take out of a scene (borrowed, returned) what no result of tandem's own DEM engine depends on. */
json_t *cpl_cell_bare(json_t *scene);

/* ---- the settled bed (cell_bed.c) ---- */

/* Let a cell take its bed from a file that all cells with the same bed share: its name is the hash of all of the cell's
 * scene (which loses the rest) that is neither time, coupling nor output. Only tandem's own DEM knows the key. */
void cpl_cell_share_bed(const cpl_cells *cells, cpl_cell *cell, json_t *scene);

/* Settle once for each bed, before cells run side by side. A bed that cannot be made fails in its cells, with words. */
void cpl_cells_make_beds(const cpl_cells *cells);

/* ---- one cell (cell_run.c) ---- */

/* Run a cell and judge it: its row (new reference), NULL after an interruption. */
json_t *cpl_cell_run(const cpl_cells *cells, const cpl_cell *cell);

/* The row of a cell that has no numbers. */
json_t *cpl_cell_row(const cpl_cells *cells, const cpl_cell *cell, const char *status, const char *reason);

/* Look for what a run that came to its end may still have: particles that left, energy that grew. `summary` is its
 * summary.json. */
void cpl_cell_doubt(const cpl_cell *cell, json_t *row, const json_t *summary);

/* ---- one cell that a solver runs alone (cell_alone.c) ---- */

/* The program for a scene, borrowed from the solvers; NULL: both are needed. */
const char *cpl_cell_program_of(const cpl_cells *cells, const json_t *scene);

/* In a process of its own: become the cell's program with "run" or "check" and these settings. Returns only when that
 * fails: the exit status. */
int cpl_cell_become(const cpl_cell *cell, const char *command, const char *const *set);

/* The row of a cell whose process has ended with a status as waitpid gives it (new reference). */
json_t *cpl_cell_alone_row(const cpl_cells *cells, const cpl_cell *cell, int wait_status);

#endif
