/* A calibration under way: its parameters, targets and tries. See calibrate.h.
 *
 *   calibration.c   from the options to what is delivered
 *   points.c        tries: their runs, and how far they are off
 *   search.c        which ones
 *   sensitivity.c   how well the best one is determined
 *   tell.c, plot.c  tables, files, pictures
 *
 * Words: a place is a point of the unit cube, whose edges are the ranges of the parameters; beyond it the cube is
 * mirrored. A try is a place that was tried. The misfit of a try: the root of the mean, over the targets, of the mean
 * square, over a target's rows, of (value - measured)/scale.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_CALIBRATE_CALIBRATION_H
#define CPL_CALIBRATE_CALIBRATION_H

#include "coupler/calibrate/calibrate.h"
#include "coupler/calibrate/target.h"
#include "protocol/results/results.h"

#include <math.h>

enum { CPL_PARAMETERS = 4, CPL_TARGETS = 16 };

typedef struct {
  char path[TDM_PATH_MAX];
  const char *name; /* last part of the path, borrowed from it */
  double from, to;
  bool log;     /* the place is a share of the logarithm's range */
  double start; /* the scene's value, if it is in the range; else the middle */
  bool new;     /* the scene has no value there, but what it belongs to */
  /* of the sensitivity; NaN: unknown */
  double sensitivity; /* rms change of all rows [scales] for a way over the whole range, at the best try */
  double percent;     /* change of the value at which rows change by 0.01, the others fixed; may be infinite */
  double scatter;     /* rms of what rows are off a straight line over three tries [scales] */
  double error;       /* standard error of the value */
  bool at_end;        /* the best value lies at an end of the range */
} cpl_parameter;

typedef struct {
  double place[CPL_PARAMETERS], value[CPL_PARAMETERS];
  char label[CPL_STUDY_NAME]; /* "friction=0.3", the name of its cell */
  double misfit;              /* NaN: nothing to compare */
  char status[24];            /* of its runs, as cells have it */
  char reason[256];           /* why there is no misfit */
  double *row;                /* (nrow) values at the targets' rows, mean of the seeds; owned, NULL: none */
  double *variance;           /* (nrow) of that mean, from the scatter of the seeds; owned, NULL: one run */
  double covered;             /* least share of a target's rows that the run reaches */
  double wall;                /* of its runs, added up [s] */
  bool aside;                 /* of the sensitivity, not of the search */
} cpl_try;

typedef enum { CPL_CONVERGED, CPL_AT_LIMIT, CPL_FLAT, CPL_SPENT, CPL_FAILED, CPL_INTERRUPTED, CPL_RUNNING } cpl_ending;

typedef struct {
  const cpl_calibrate_options *o;
  const tdm_results *results;
  int nparameter, ntarget, nrow, nseed;
  cpl_parameter parameter[CPL_PARAMETERS];
  cpl_target target[CPL_TARGETS];
  int ntry, room;
  cpl_try *tried; /* (ntry) owned */
  int best;       /* of the search, -1: none yet */
  bool known;     /* a run has all that the targets name */
  cpl_ending ending;
  double correlation[CPL_PARAMETERS][CPL_PARAMETERS]; /* NaN: unknown */
  double noise;                                       /* rms standard error of the best try's rows [scales]; NaN */
  int valleys;                                        /* of the misfit over a single parameter; 0: not known */
  bool better_nearby;                                 /* a try of the sensitivity has a smaller misfit */
} cpl_calibration;

/* ---- points.c ---- */

/* The value of a parameter at a place, and the place of a value within its range. */
double cpl_value_at(const cpl_parameter *p, double place);
double cpl_place_of(const cpl_parameter *p, double value);

/* Refuse measures, channels and seeds that no study can have. */
tdm_status cpl_check_study(const cpl_calibration *c, tdm_error *err);

/* Try n places, side by side as far as they are new; which[i] is the try of place i. Errors: those that end the whole
 * (options that a study refuses, targets that runs do not have, an interruption), not what becomes of a run. */
tdm_status cpl_try_all(cpl_calibration *c, int n, double (*place)[CPL_PARAMETERS], bool aside, int *which,
                       tdm_error *err);

/* The try of a place; -1: it was not tried. */
int cpl_try_find(const cpl_calibration *c, const double *place);

/* The runs of one try as a study, which the caller frees: of the results that are there. */
tdm_status cpl_try_again(cpl_calibration *c, int which, cpl_study *study, tdm_error *err);

void cpl_tries_free(cpl_calibration *c);

/* ---- search.c ---- */

/* Seek until c->ending is known. */
tdm_status cpl_search(cpl_calibration *c, tdm_error *err);

/* ---- sensitivity.c ---- */

/* Tries beside the best one, and what follows from them. */
tdm_status cpl_determine(cpl_calibration *c, tdm_error *err);

/* ---- tell.c ---- */

/* One line of a new try, on standard error. */
void cpl_tell_try(const cpl_calibration *c, int which);
/* calibration.json (and `json`), calibration.csv. */
tdm_status cpl_calibration_write(const cpl_calibration *c, const char *json, tdm_error *err);
void cpl_calibration_print(const cpl_calibration *c);
const char *cpl_ending_name(cpl_ending ending);
/* Why the search ended, a sentence; returns out. */
const char *cpl_ending_words(const cpl_calibration *c, char *out, size_t size);

/* ---- plot.c ---- */

tdm_status cpl_calibration_plot(cpl_calibration *c, tdm_error *err);

#endif
