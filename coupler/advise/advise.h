/* `tandem advise`: the flow chart of [L18] Fig. 12, walked by tandem itself. Which DEM step, windows, scheme and
 * formulation suit a scene, how near that is, and what the run will cost: from the limits that the DEM engine reports
 * of the settled bed, from the scene's mechanism, and from short trial runs.
 *
 *   OUT/bed           the settled bed of all trials
 *   OUT/trial_NN/     result directories of the trials
 *   OUT/advice.json   the advice
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_ADVISE_ADVISE_H
#define CPL_ADVISE_ADVISE_H

#include "coupler/session/launch.h"

typedef struct {
  const char *scene;      /* file */
  const char *const *set; /* "path=value", NULL-terminated, may be NULL */
  const char *out;        /* directory */
  bool force;             /* replace what an earlier advice left there */
  const char *json;       /* further copy of advice.json, NULL: none */
  const char *write;      /* file for the scene with the settings, NULL: none */
  double error;           /* wanted: of position and velocity of the coupled bodies, as a share of their spread */
  cpl_solver solver[CPL_NROLE];
} cpl_advise_options;

/* Advise, and print it. Errors: the scene does not load, is not one for both solvers, or no settings were found with
 * which it runs (TDM_ERR_NUMERIC, after all has been printed); TDM_ERR_INTERRUPTED. A trial that fails is no error. */
tdm_status cpl_advise(const cpl_advise_options *options, tdm_error *err);

#endif
