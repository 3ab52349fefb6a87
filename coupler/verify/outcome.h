/* What became of a verified scenario: its measures, printed as a table and written as JSON. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_VERIFY_OUTCOME_H
#define CPL_VERIFY_OUTCOME_H

#include "coupler/results/scenario.h"
#include "coupler/run/run.h"

typedef enum {
  CPL_NO_LIMIT, /* reported only */
  CPL_AT_LEAST, /* value >= limit */
  CPL_AT_MOST   /* |value| <= limit */
} cpl_limit_kind;

typedef struct {
  char name[64], case_name[64];
  double value, limit;
  cpl_limit_kind kind;
  bool pass;
  cpl_run_result run; /* of the run that it was measured in */
} cpl_measure;

typedef struct {
  const cpl_scenario *scenario;
  cpl_measure *measure;
  int nmeasure;
  double wall;
  cpl_run_result total; /* sum over the scenario's runs */
  json_t *detail;       /* what it found besides, NULL: nothing */
  tdm_error err;
  bool pass;
} cpl_outcome;

void cpl_outcome_head(void);
/* Its measures, a row each, and why it failed. */
void cpl_outcome_print(const cpl_outcome *outcome);

/* All of them as a JSON file. */
tdm_status cpl_outcomes_write(const char *file, const cpl_outcome *outcomes, int n, bool pass, double wall,
                              tdm_error *err);

#endif
