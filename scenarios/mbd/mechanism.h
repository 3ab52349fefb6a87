/* Published mechanisms: how their coordinates come from the solver's channels, and what is measured on them. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_MECHANISM_H
#define SCN_MECHANISM_H

#include "coupler/results/table.h"
#include "scenarios/mbd/motion.h"

enum { SCN_COORDINATES = 8 };

typedef enum {
  SCN_CHANNEL, /* `of` is a channel */
  SCN_ANGLE,   /* angle of the body `of` about z, less that of `less` (NULL: none) [rad] */
  SCN_ROTATION /* orientation of the body `of`; reference columns q0, q1, q2, q3; its error is an angle [rad] */
} scn_coordinate_kind;

typedef struct {
  const char *column; /* of reference.csv */
  scn_coordinate_kind kind;
  const char *of, *less;
  double offset;
} scn_coordinate;

typedef enum {
  SCN_NO_MOMENTUM,
  SCN_VERTICAL_MOMENTUM, /* about the world's origin, along z */
  SCN_WHOLE_MOMENTUM     /* of a body whose centre of mass rests: all three components */
} scn_momentum;

typedef struct {
  const char *name; /* of the scenario and its folder */
  double at;        /* time at which digits are counted, a row of the reference [s] */
  double absolute;  /* absolute tolerance over the relative one: the size of what is near zero now and then; 0: the
                       default */
  scn_coordinate coordinate[SCN_COORDINATES];
  const char *body; /* whose momentum it is */
  scn_momentum momentum;
  double turns; /* time of 100 turns of that body [s] */
} scn_mechanism;

/* A mechanism's scene and reference, read once. */
typedef struct {
  const scn_mechanism *of;
  json_t *mbd;
  cpl_table reference;
  int row; /* of the reference at of->at */
} scn_case;

/* Zero-initialise; free with scn_case_free, also after an error. */
tdm_status scn_case_read(scn_case *c, cpl_verify *v, const scn_mechanism *of, tdm_error *err);
void scn_case_free(scn_case *c);

/* Largest relative error over the coordinates at the last sample of m against row `row` of the reference. Whole turns
 * of an angle count only if `turns`. An angle of rotation counts in rad. NaN: a channel or a column is missing. */
double scn_case_error(const scn_case *c, const scn_motion *m, int row, bool turns);

/* The same over all samples, which are the rows of the reference from the first on, relative to the largest value that
 * a coordinate has. */
double scn_case_path_error(const scn_case *c, const scn_motion *m);

static inline double scn_digits(double error) {
  return -log10(fmax(error, 1e-16));
}

/* Run at the tightest tolerance that the default formulation gets through in time: samples at the rows of the
 * reference. *tolerance is the one. */
tdm_status scn_case_tightest(const scn_case *c, cpl_verify *v, scn_motion *m, double *tolerance, tdm_error *err);

/* Wall time [s] of a run to `end` without samples but the last: the least of a few. m is the last of them. */
tdm_status scn_case_time(const scn_case *c, const scn_method *method, double tolerance, double end, long most_steps,
                         scn_motion *m, double *wall, tdm_error *err);

/* Error over run time for every method and tolerance (scn_methods): CSV files, a plot in the scenario's directory. */
tdm_status scn_work_precision(const scn_case *c, cpl_verify *v, tdm_error *err);

enum { SCN_GGL, SCN_GGL_MODIFIED, SCN_INDEX3, SCN_INDEX3_MODIFIED, SCN_ONE_STEP };
extern const scn_method scn_methods[]; /* ended by a NULL name; the default is the first */

#endif
