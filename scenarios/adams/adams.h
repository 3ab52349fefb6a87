/* 28 models of one joint, spring or actuator against Adams' own results. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_ADAMS_H
#define SCN_ADAMS_H

#include "protocol/base/status.h"

extern const char *const scn_adams_model[]; /* names, which are also folders of scenarios/adams; ended by NULL */

/* The largest difference from a model's table, of all its quantities: over the table's own error, half a unit of its
 * last digit or 1e-9, whichever is largest. */
typedef struct {
  double share;
  char quantity[32];         /* where it is: "Rforce" */
  double position, reaction; /* how far these are off beyond the table's own error, over their largest in the table */
  double wall;               /* of the integration [s] */
} scn_adams_difference;

/* Run the model in the folder `dir` at a relative tolerance and compare. */
tdm_status scn_adams_compare(scn_adams_difference *d, const char *dir, double tolerance, tdm_error *err);

#endif
