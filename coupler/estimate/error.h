/* The error of a coupled body's motion, estimated from its trace: what the two solvers differed by, as a force that
 * the body should not have felt, carried through the run by the motion that the run itself shows
 * (docs/theory/coupling.md, "The error of a run").
 *
 * All errors are rms over the run. What a program that tries settings needs is in cpl_error_worst.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_ESTIMATE_ERROR_H
#define CPL_ESTIMATE_ERROR_H

#include "coupler/estimate/trace.h"

typedef enum { CPL_POSITION, CPL_VELOCITY, CPL_ANGLE, CPL_ANGULAR_VELOCITY, CPL_QUANTITIES } cpl_quantity;

extern const char *const cpl_quantity_names[CPL_QUANTITIES]; /* "position" ... */
extern const char *const cpl_quantity_units[CPL_QUANTITIES]; /* "m" ... */

/* One quantity of a body; NaN: unknown. */
typedef struct {
  double coupling; /* error that the exchange makes [unit of the quantity] */
  double rattle; /* by which two runs may differ that round-off sets apart: the jitter that the particles' load makes */
  double rms;    /* root of the sum of the squares of both */
  double spread; /* standard deviation of the quantity over the run */
  double share;  /* rms / spread: the root of 1 - nse; NaN where it hardly moves */
  double fill;   /* no error: how far the motion is from one in which the particles are a mass fixed to the body, as
                  * some references have it */
} cpl_error_of;

typedef struct {
  cpl_error_of of[CPL_QUANTITIES];
  double added[CPL_PARTS]; /* inertia that the particles add to the body's, as their load shows [kg, kg m2] */
} cpl_error;

/* Of the bodies of a run (nbody each), whose traces have the same rows: errors of one move those that are tied to it.
 * NaN where the traces are too short to say (fewer than 8 rows). False: no memory. */
bool cpl_error_estimate(int nbody, const cpl_trace *trace, cpl_error *error);

#endif
