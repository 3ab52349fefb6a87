/* What a calibration compares runs with: curves that were measured, and numbers.
 *
 * A curve is a CSV file of two columns. Their names are "time" or channels of the run ("dem:body.piston.fz",
 * "mbd:joint.guide.translation", as the measures of studies have them), with a minus in front for the channel's
 * negative; units behind a blank are for the reader. The abscissa goes one way, or out and back once.
 *
 * The run's curve is cut where its abscissa is farthest out. On the way out, and on the way back, only rows count
 * whose abscissa goes beyond all rows before; between them it is a straight line, beyond its ends the value of the
 * nearest end.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_CALIBRATE_TARGET_H
#define CPL_CALIBRATE_TARGET_H

#include "coupler/study/study.h"

typedef struct {
  char name[160];                /* of the file without its folder, or the measure */
  char *file;                    /* of a curve, owned; NULL: a number of a measure */
  char column[2][TDM_PATH_MAX];  /* names of the columns, as they are written */
  char channel[2][TDM_PATH_MAX]; /* of abscissa and values; the abscissa's "": time. Of a number: the measure in [1] */
  double sign[2];                /* of them: 1 or -1 */
  int n;                         /* rows; 1: a number */
  int back;                      /* the first row of the way back; n: there is none */
  double *x, *y;                 /* (n) owned; x of a number: 0 */
  double scale;                  /* what differences are divided by: greatest less least of y, else |y|, else 1 */
} cpl_target;

/* A curve's file, or, with a measure, a number. The caller frees also after an error. */
tdm_status cpl_target_read(cpl_target *target, const char *word, const char *measure, tdm_error *err);
void cpl_target_free(cpl_target *target);

/* Add what a study must record for target number k to its lists of measures and curves. */
void cpl_target_enter(const cpl_target *target, int k, json_t *measures, json_t *curves);

/* The values of a run at the target's rows: value (n), and the share of the rows that its abscissa reaches. `measure`
 * is the value of the study's measure, of a number. Errors: nothing to compare, with the reason. */
tdm_status cpl_target_values(const cpl_target *target, int k, const cpl_study *study, const cpl_cell *run,
                             double measure, double *value, double *covered, tdm_error *err);

/* Whether a run that came to its end has such a channel or number at all: the error lists what there is. */
tdm_status cpl_target_known(const cpl_target *target, const cpl_cell *run, tdm_error *err);

/* The run's own curve as it is compared: (n) abscissa and value in *x, *y, which the caller frees, the way back (if the
 * target has one) from *back on; returns n, 0 and an error when there is none. */
int cpl_target_curve(const cpl_target *target, int k, const cpl_study *study, const cpl_cell *run, double **x,
                     double **y, int *back, tdm_error *err);

#endif
