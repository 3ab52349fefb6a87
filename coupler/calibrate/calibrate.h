/* `tandem calibrate`: one to four values of a scene are sought with which its runs are nearest to what was measured.
 * docs/calibrate.md says how, and what is in calibration.json.
 *
 *   OUT/cells/NAME/          result directories of the runs (cells/cells.h), which --resume finds again
 *   OUT/calibration.json     after each try, and in the end
 *   OUT/calibration.csv      the tries
 *   OUT/path.png, fit.png, sensitivity.png
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_CALIBRATE_CALIBRATE_H
#define CPL_CALIBRATE_CALIBRATE_H

#include "coupler/cells/cells.h"
#include "coupler/study/words.h"

enum { CPL_CALIBRATE_TRIES = 100 };          /* unless the options say another number */
extern const double cpl_calibrate_tolerance; /* likewise */

typedef struct {
  const char *scene;            /* file */
  const char *const *set;       /* "path=value" for all runs, NULL-terminated, may be NULL */
  const char *const *parameter; /* (nparameter) paths of the scene */
  int nparameter;
  const char *const *range; /* (nrange) two words each: from, to */
  int nrange;
  const char *const *log; /* (nlog) those of the paths that are sought in their logarithm */
  int nlog;
  const char *const *target; /* (ntarget) files of curves, and a number for each measure, in their order */
  int ntarget;
  const char *const *measure; /* (nmeasure) paths of summary.json, or channels, as a study from options has them */
  int nmeasure;
  cpl_axis repeat;  /* each try runs with each of these; without values: once */
  double tolerance; /* share of the ranges at which the search ends */
  int tries;        /* at most, without those of the sensitivity */
  int jobs;         /* runs at a time */
  bool force;       /* replace what an earlier calibration left there */
  bool resume;      /* keep the runs that are there */
  const char *out;
  const char *json;  /* further copy of calibration.json, NULL: none */
  const char *write; /* file for the scene with the values, NULL: none */
  const cpl_scenario *scenarios;
  cpl_solver solver[CPL_NROLE];
} cpl_calibrate_options;

/* Calibrate, and print what came of it. Errors: options, scene or targets that cannot be (before the first run); no run
 * that could be compared (TDM_ERR_NUMERIC, after all has been written); TDM_ERR_INTERRUPTED. A run that fails is no
 * error. */
tdm_status cpl_calibrate(const cpl_calibrate_options *options, tdm_error *err);

#endif
