/* Parametric studies: runs of a scene over a grid of settings or a list of cases, repeated for the spread, and judged
 * by measures: values of summary.json or of time histories (docs/runs.md, section Studies).
 *
 *   cpl_study_read                    a study file, or the same as JSON
 *   cpl_study_run                     all or some of its cells, with seeds, into a directory that is there
 *   cpl_study_value, _find, ...       the numbers
 *   cpl_study_write                   study.json, study.csv, table.html, a picture a measure and a curve
 *
 * Words: a factor is what is varied, a level one of its values or cases; a cell is a combination of levels; a run is a
 * cell with one seed.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_STUDY_STUDY_H
#define CPL_STUDY_STUDY_H

#include "coupler/cells/cells.h"

enum { CPL_STUDY_NAME = 96 };

/* One of a factor's values, or a case with several settings. */
typedef struct {
  char label[CPL_STUDY_NAME]; /* "50", or a case's own */
  double x;                   /* the value; NaN when it is no number */
  char *scene;                /* of the case, owned; NULL: the study's */
  json_t *set;                /* {path: value}, owned */
} cpl_level;

/* What is varied: cases (path ""), or one path of the scene. */
typedef struct {
  char path[TDM_PATH_MAX], title[CPL_STUDY_NAME], unit[32];
  bool numbers; /* all levels have an x */
  bool log;     /* axis of plots */
  int nlevel;
  cpl_level *level; /* (nlevel) owned */
} cpl_factor;

/* Published values beside a measure. */
typedef struct {
  char source[CPL_STUDY_NAME], label[CPL_STUDY_NAME];
  int npoint;
  double *x, *y; /* (npoint) owned; x of the first factor: its number, of cases the index of the level */
} cpl_published;

/* When a channel is measured. */
typedef enum {
  CPL_AT_END,
  CPL_AT_MEAN,
  CPL_AT_MAX,
  CPL_AT_MIN,
  CPL_AT_AMPLITUDE, /* half of the greatest less the least */
} cpl_at;

typedef struct {
  char name[64], title[CPL_STUDY_NAME], unit[32]; /* the name fits files */
  char path[TDM_PATH_MAX];                        /* of summary.json; "": a channel */
  char channel[TDM_PATH_MAX];                     /* "dem:particles.count" */
  cpl_at at;
  double over[2]; /* [s] only this part of the time history; the end is its last value there */
  double factor;  /* of what is read, for its unit */
  bool log;       /* axis of its plot */
  int npublished;
  cpl_published *published; /* (npublished) owned */
  char lack[256];           /* why a run that came to its end has no value; the first one */
} cpl_study_measure;

typedef struct {
  char title[CPL_STUDY_NAME];
  char *file;  /* of the study, owned; NULL: none */
  char *scene; /* file, owned */
  json_t *set; /* {path: value} of all cells, owned */
  int nfactor; /* cases first, then axes; the last runs fastest */
  int nmeasure;
  int ncurve;
  cpl_factor *factor;         /* (nfactor) */
  cpl_factor seeds;           /* without levels: no repetition */
  cpl_study_measure *measure; /* (nmeasure), the run time last unless it is one of them */
  cpl_study_measure *curve;   /* (ncurve) time histories of channels */
  int ncell, nseed;           /* nseed is 1 without repetition */
  /* after cpl_study_run */
  cpl_cells cells; /* the runs that were wanted */
  int *run;        /* (ncell x nseed) their indices, -1: not wanted */
  double *value;   /* (ncell x nseed x nmeasure) NaN: none */
} cpl_study;

/* ---- reading (study_read.c) ---- */

/* Whether the JSON of a file is a study, not a scene. */
bool cpl_study_is(const json_t *root);

/* Read a study file. Errors name file, line, column and JSON path. The caller frees also after an error. */
tdm_status cpl_study_read(cpl_study *study, const char *file, tdm_error *err);

/* The same from JSON (borrowed); relative names of scenes start at the working directory. */
tdm_status cpl_study_read_json(cpl_study *study, json_t *root, tdm_error *err);

void cpl_study_free(cpl_study *study);

/* ---- cells ---- */

/* Level of a factor in a cell. */
const cpl_level *cpl_study_level(const cpl_study *study, int cell, int factor);
/* "rpm=50 beta=1"; returns out. */
const char *cpl_study_cell_name(const cpl_study *study, int cell, char *out, size_t size);
/* The cell of that name, the measure of that name; -1 and an error that names the nearest one when there is none. */
int cpl_study_find_cell(const cpl_study *study, const char *name, tdm_error *err);
int cpl_study_find_measure(const cpl_study *study, const char *name, tdm_error *err);

/* ---- running (study_run.c) ---- */

typedef struct {
  const char *out;               /* directory, which is there */
  int jobs;                      /* runs at a time */
  bool resume;                   /* keep the runs that are there */
  bool quiet;                    /* no line for each run on standard error */
  const cpl_scenario *scenarios; /* table ended by a NULL name */
  cpl_solver solver[CPL_NROLE];
  const char *const *set;   /* further "path=value" for all cells, over the study's own; NULL-terminated, may be NULL */
  const char *const *only;  /* names of the cells that are wanted; NULL-terminated, NULL: all */
  const char *const *seeds; /* values of the seeds that are wanted ("1"); NULL-terminated, NULL: all */
} cpl_study_options;

/* Refuse cells and seeds that the study does not have. */
tdm_status cpl_study_check(const cpl_study *study, const cpl_study_options *options, tdm_error *err);

/* Run the wanted cells and measure them. TDM_OK when each was tried, whatever became of it. */
tdm_status cpl_study_run(cpl_study *study, const cpl_study_options *options, tdm_error *err);

/* The run of a cell with its seed number `seed`; NULL: not wanted. */
const cpl_cell *cpl_study_run_of(const cpl_study *study, int cell, int seed);

/* Whether any cell runs with seed number `seed`. */
bool cpl_study_has_seed(const cpl_study *study, int seed);

/* What became of a cell: "ok" when all of its runs are, else the first other status; NULL: it was not run. */
const char *cpl_study_status(const cpl_study *study, int cell);

/* ---- numbers (study_value.c) ---- */

/* A measure of a cell over its seeds. */
typedef struct {
  int n;                     /* runs that have a value */
  double mean, min, max, sd; /* of these; NaN without one (sd: without two) */
} cpl_value;

cpl_value cpl_study_value(const cpl_study *study, int cell, int measure);

/* The value of one run; NaN: none. */
double cpl_study_value_of(const cpl_study *study, int cell, int seed, int measure);

/* The mean of a measure in a cell, both by name; NaN when there is none. */
double cpl_study_mean(const cpl_study *study, const char *cell, const char *measure);

/* The next cell along the first factor, with the same levels of all others; -1: none. */
int cpl_study_neighbour(const cpl_study *study, int cell);

/* A difference between two cells beside the spread of their seeds. */
typedef struct {
  double difference; /* of the means, second less first */
  double spread;     /* the larger of both max - min; NaN: one of them has less than two runs */
} cpl_difference;

cpl_difference cpl_study_difference(const cpl_study *study, int first, int second, int measure);

/* Fill study->value from the runs' directories. */
tdm_status cpl_study_collect(cpl_study *study, tdm_error *err);

/* The file of a run that has the time history of a channel ("dem:particles.count"). */
void cpl_study_history_file(const cpl_cell *run, const char *channel, char *out, size_t size);

/* A run's time history of a channel, times the factor: room for the caller to free in *time and *value (n); 0 and an
 * error when there is none. */
int cpl_study_history(const cpl_cell *run, const cpl_study_measure *m, double **time, double **value, tdm_error *err);

/* ---- results ---- */

/* All of them into a directory; `json`: a further copy of study.json, NULL: none. Pictures that cannot be made are a
 * notice. */
tdm_status cpl_study_write(const cpl_study *study, const char *out, const char *json, tdm_error *err);

/* Pictures (study_plot.c), the page (study_page.c), the table of a terminal (study_page.c). */
tdm_status cpl_study_plot(const cpl_study *study, const char *out, tdm_error *err);
tdm_status cpl_study_page(const cpl_study *study, const char *out, tdm_error *err);
void cpl_study_print(const cpl_study *study);

#endif
