/* `tandem run --estimate`: after a run, a share of it is repeated from its start with half the window, with half the
 * DEM step, and with a change of the size of round-off. What the repetitions differ by tells the error of the exchange
 * and that of the DEM step apart, and how near two runs can be at all where the motion is chaotic.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_TRIAL_REPEAT_H
#define CPL_TRIAL_REPEAT_H

#include "coupler/trial/trial.h"

typedef struct {
  const char *scene;      /* file, as it was run */
  const char *const *set; /* as it was run */
  const char *out;        /* result directory of the run; repetitions go into its folder "estimate" */
  double share;           /* of the run that is repeated, in (0, 1] */
  bool quiet;
  cpl_solver solver[CPL_NROLE];
} cpl_repeat_options;

/* Before the run: whether it can be repeated. Else an error that says why. */
tdm_status cpl_repeat_check(const cpl_repeat_options *options, tdm_error *err);

/* After the run: repeat, enter what comes of it into out/summary.json as error_estimate.repetition, and print it. A
 * repetition that fails is told there, and is no error. */
tdm_status cpl_repeat(const cpl_repeat_options *options, tdm_error *err);

#endif
