/* A scenario that `tandem verify` knows: how it is verified, and the reference that runs of its scene are compared
 * with. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_RESULTS_SCENARIO_H
#define CPL_RESULTS_SCENARIO_H

#include "coupler/results/compare.h"

struct cpl_verify;

typedef struct {
  const char *name, *group;
  const char *summary;
  tdm_status (*verify)(struct cpl_verify *v, tdm_error *err);
  /* Fill *c (zeroed; freed by the caller also after an error) from a result directory; NULL: no reference as curves. */
  tdm_status (*compare)(const char *dir, cpl_comparison *c, tdm_error *err);
  const char *state[3]; /* names of the comparison's states and of its load, for rows without numbers */
  const char *load;
  bool rigid_fill; /* its reference takes the particles for a mass fixed to the body: what they do beside that is an
                    * error by this measure */
} cpl_scenario;

/* The scenario that a scene names as its own in the key "scenario"; NULL when it names none, or (an error) none that is
 * in the table. */
const cpl_scenario *cpl_scenario_of(const cpl_scenario *table, const json_t *scene, tdm_error *err);

#endif
