/* Who walks the flow chart: what is known so far, trials of candidates, and the verdict on each. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_ADVISE_ADVISOR_H
#define CPL_ADVISE_ADVISOR_H

#include "coupler/advise/tell.h"

enum { CPL_LEAST_WINDOWS = 40 }; /* of a trial */

typedef struct {
  cpl_trials t;
  cpl_advice a;
  cpl_facts facts;
  double span, interval;  /* of the trials [s] */
  cpl_tried best, single; /* the best so far; n = 1 at its step */
  cpl_tried twin[2];      /* the first good one, and the same with a change of the size of round-off */
  bool has_single, has_twins;
} cpl_advisor;

/* Is there time for another trial, beside the last ones, which tell the cost? */
bool cpl_advisor_may_go_on(const cpl_advisor *advisor);

/* Run a candidate for as long as trials are. A trial that fails is no error. Round-off: as cpl_trials_run has it. */
tdm_status cpl_advisor_attempt(cpl_advisor *advisor, const cpl_candidate *c, bool round_off, cpl_tried *tried,
                               tdm_error *err);

/* Why a trial is not to be taken, in `why` (size bytes); "": it is. `error` (may be NULL): against n = 1. */
void cpl_advisor_judge(cpl_advisor *advisor, const cpl_tried *tried, char *why, size_t size, double *error);

/* Try a candidate; if it is good it becomes the best. */
tdm_status cpl_advisor_consider(cpl_advisor *advisor, const cpl_candidate *c, bool *taken, tdm_error *err);

/* What others are measured by: the best beside itself with a change of the size of round-off; n = 1 at its step. */
tdm_status cpl_advisor_make_twins(cpl_advisor *advisor, tdm_error *err);
tdm_status cpl_advisor_make_single(cpl_advisor *advisor, tdm_error *err);

#endif
