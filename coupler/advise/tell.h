/* The advice, and how it is told: on the terminal, as JSON, as a scene. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_ADVISE_TELL_H
#define CPL_ADVISE_TELL_H

#include "coupler/advise/trials.h"

typedef struct {
  cpl_candidate best;
  bool found; /* some settings with which it runs */
  cpl_limits limits;
  cpl_step step;
  double wanted;                                  /* error, as all below a share of the spread */
  double coupling, dem_step, round_off, estimate; /* NaN: unknown */
  double wall, setup, loop;                       /* expected of the whole run [s] */
  double processor, trials;                       /* the same of processor time; what the trials took of that [s] */
  json_t *reasons;                                /* sentences */
} cpl_advice;

/* Add a sentence. */
void cpl_because(cpl_advice *advice, const char *format, ...) __attribute__((format(printf, 2, 3)));

void cpl_advice_print(const cpl_advice *advice, const json_t *root);

/* docs/runs.md has the keys. New reference. */
json_t *cpl_advice_to_json(const cpl_advice *advice, const cpl_trials *trials);

/* The scene with the user's settings and those of the advice, all else as it is written. */
tdm_status cpl_advice_write(const cpl_advice *advice, const cpl_trials *trials, const char *file, tdm_error *err);

#endif
