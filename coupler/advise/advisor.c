/* Who walks the flow chart: see advisor.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/advise/advisor.h"

#include <math.h>
#include <stdio.h>

static const double gap_limit = 0.05;  /* velocity against the derivative of position */
static const double erratic_limit = 4; /* variance ratio of the load, against that at n = 1 */

/* ---- trials ---- */

/* What is kept for the last trials, which tell the cost, and the most that one
 * takes: parts of the budget. */
static const double kept = 0.25, one_part = 0.2;

bool cpl_advisor_may_go_on(const cpl_advisor *v) {
  return v->t.spent < (1 - kept) * v->t.budget;
}

/* How long to try: shorter where windows are so many that a trial would take
 * too much of the budget. */
static double length_of(const cpl_advisor *v, const cpl_candidate *c) {
  const double window = c->n == CPL_AUTO_N ? v->best.length : (double)c->n * c->dt;
  const double takes = v->span * (v->best.step / c->dt + v->best.window / window); /* [s] */
  const double allowed = one_part * v->t.budget;
  return takes > allowed ? fmin(v->span, fmax(v->span * allowed / takes, CPL_LEAST_WINDOWS * window)) : v->span;
}

tdm_status cpl_advisor_attempt(cpl_advisor *v, const cpl_candidate *c, bool round_off, cpl_tried *tried,
                               tdm_error *err) {
  v->interval = v->interval > 0 ? fmax(v->interval, c->dt) : 0;
  return cpl_trials_run(&v->t, c, length_of(v, c), v->interval, round_off, tried, err);
}

/* ---- judging ---- */

/* Why a trial is not to be taken; "": it is. `error` (may be NULL): against n
 * = 1. */
void cpl_advisor_judge(cpl_advisor *v, const cpl_tried *tried, char *why, size_t size, double *error) {
  const double window = tried->length;
  const double apart = v->has_single ? cpl_trials_apart(&v->t, tried, &v->single, v->has_twins ? v->twin : NULL) : NAN;
  const double here = cpl_trials_erratic(&v->t, tried, window);
  const double there = v->has_single ? cpl_trials_erratic(&v->t, &v->single, window) : NAN;
  why[0] = 0;
  if (error)
    *error = apart;
  if (!tried->good)
    snprintf(why, size, "%.300s", tried->reason);
  else if (tried->gap > gap_limit)
    snprintf(why, size,
             "the velocity is %.2g off the derivative of the position: the "
             "window is too long",
             tried->gap);
  else if (!tried->prescribed && here > erratic_limit * there)
    snprintf(why, size,
             "the load is erratic: %.2g of its variance above the window's "
             "frequency, against %.2g at n = 1",
             here, there);
  else if (apart > v->a.wanted)
    snprintf(why, size, "it is %.2g %% off the run with n = 1", 100 * apart);
  else if (v->has_single && cpl_estimate_too_large(tried->estimate, v->single.estimate, v->a.wanted))
    snprintf(why, size, "its own estimate of what the exchange is off is %.2g %%, that of n = 1 %.2g %%",
             100 * tried->estimate, 100 * v->single.estimate);
}

/* Try a candidate; if it is good it becomes the best. */
tdm_status cpl_advisor_consider(cpl_advisor *v, const cpl_candidate *c, bool *taken, tdm_error *err) {
  char why[512], n[CPL_N_LENGTH];
  double error;
  cpl_tried tried;
  *taken = false;
  if (cpl_advisor_attempt(v, c, false, &tried, err) != TDM_OK)
    return err->status;
  cpl_advisor_judge(v, &tried, why, sizeof why, &error);
  if (why[0]) {
    cpl_because(&v->a, "tried n = %s, dt = %g s, %s, tolerance %g: %s", cpl_candidate_n(c, n), c->dt,
                cpl_formulation_words[c->formulation], c->tolerance, why);
    return TDM_OK;
  }
  v->best = tried;
  v->a.best = *c;
  v->a.found = *taken = true;
  if (!isnan(error))
    v->a.coupling = error;
  return TDM_OK;
}

/* ---- what others are measured by ---- */

/* The best beside itself with a change of the size of round-off. */
tdm_status cpl_advisor_make_twins(cpl_advisor *v, tdm_error *err) {
  if (v->best.prescribed) /* which its mass does not change */
    return TDM_OK;
  v->twin[0] = v->best;
  if (cpl_advisor_attempt(v, &v->a.best, true, &v->twin[1], err) != TDM_OK || !v->twin[1].good)
    return err->status;
  v->a.round_off = cpl_trials_apart(&v->t, &v->twin[0], &v->twin[1], NULL);
  v->has_twins = true;
  cpl_because(&v->a,
              "two runs that differ by round-off differ by %.2g %%: what is "
              "nearer cannot be told apart",
              100 * v->a.round_off);
  return TDM_OK;
}

/* The run with n = 1 at the step of the best. */
tdm_status cpl_advisor_make_single(cpl_advisor *v, tdm_error *err) {
  cpl_candidate c = v->a.best;
  c.n = 1;
  if (cpl_advisor_attempt(v, &c, false, &v->single, err) != TDM_OK)
    return err->status;
  v->has_single = v->single.good;
  if (!v->has_single)
    cpl_because(&v->a, "the run with n = 1 is no measure: %.300s", v->single.reason);
  return TDM_OK;
}
