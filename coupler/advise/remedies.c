/* Remedies, and what is cheaper: see remedies.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/advise/remedies.h"

#include "coupler/settings/scheme.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- remedies, in the order of [L18] ---- */

static tdm_status shorter_windows(cpl_advisor *v, cpl_candidate c, tdm_error *err) {
  bool taken = false;
  while (!taken && c.n > 1 && cpl_advisor_may_go_on(v) && err->status == TDM_OK) {
    c.n /= 2;
    cpl_advisor_consider(v, &c, &taken, err);
    if (taken)
      cpl_because(&v->a, "remedy: n = %ld", c.n);
  }
  return err->status;
}

static tdm_status other_formulations(cpl_advisor *v, cpl_candidate c, tdm_error *err) {
  const cpl_formulation first = c.formulation;
  bool taken = false;
  for (int f = 0; f < CPL_FORMULATIONS && !taken && cpl_advisor_may_go_on(v) && err->status == TDM_OK; f++) {
    c.formulation = (cpl_formulation)f;
    if (c.formulation == first)
      continue;
    cpl_advisor_consider(v, &c, &taken, err);
    if (taken)
      cpl_because(&v->a, "remedy: formulation %s", cpl_formulation_words[f]);
  }
  return err->status;
}

static const double finer = 1e-2, coarsest = 1e-4, finest = 1e-12; /* a step between tolerances; their range */

static tdm_status tighter_tolerance(cpl_advisor *v, cpl_candidate c, tdm_error *err) {
  bool taken;
  c.tolerance *= finer;
  if (c.tolerance < finest || !cpl_advisor_may_go_on(v) || cpl_advisor_consider(v, &c, &taken, err) != TDM_OK)
    return err->status;
  if (taken)
    cpl_because(&v->a, "remedy: a tolerance of the MBD solver of %g", c.tolerance);
  return TDM_OK;
}

static tdm_status shorter_steps(cpl_advisor *v, cpl_candidate c, tdm_error *err) {
  bool taken = false;
  for (int k = 0; k < 3 && !taken && cpl_advisor_may_go_on(v) && err->status == TDM_OK; k++) {
    c.dt = cpl_round_down(c.dt / 2);
    v->has_single = false;
    cpl_advisor_consider(v, &c, &taken, err);
    if (taken)
      cpl_because(&v->a, "remedy, the last as it costs most: a DEM step of %g s", c.dt);
  }
  return err->status;
}

tdm_status cpl_remedies(cpl_advisor *v, const cpl_candidate *first, tdm_error *err) {
  static tdm_status (*const all[])(cpl_advisor *, cpl_candidate, tdm_error *) = {shorter_windows, other_formulations,
                                                                                 tighter_tolerance, shorter_steps};
  for (int k = 0; k < 4 && !v->a.found && err->status == TDM_OK; k++)
    all[k](v, *first, err);
  return err->status;
}

/* ---- cheaper ones ---- */

/* What a simulated second costs [s/s], of processor time: what else runs on the machine does not choose. */
static double rate_of(const cpl_tried *tried) {
  return tried->simulated > 0 ? tried->processor / tried->simulated : INFINITY;
}

/* A candidate that was taken for its longer windows: back to the one before if
 * it saves nothing (false). */
static bool keep_if_cheaper(cpl_advisor *v, const cpl_tried *before_it, double error) {
  const long n = v->best.of.n;
  const double now = rate_of(&v->best), then = rate_of(before_it);
  if (now < then) {
    cpl_because(&v->a, "n = %ld: a window costs as much as %.2g steps; a second now takes %.3g s, with n = %ld %.3g s",
                n, before_it->window / before_it->step, now, before_it->of.n, then);
    return true;
  }
  cpl_because(&v->a, "n = %ld is not cheaper: a second takes %.3g s, with n = %ld %.3g s", n, now, before_it->of.n,
              then);
  v->best = *before_it;
  v->a.best = before_it->of;
  v->a.coupling = error;
  return false;
}

/* Particles go along the straight path of a body that is driven: its n at most. */
static double most_n_of_path(cpl_advisor *v) {
  const double most =
      v->best.prescribed ? cpl_path_n(v->best.acceleration, cpl_trials_smallest(&v->t), v->best.of.dt) : INFINITY;
  if (isfinite(most))
    cpl_because(&v->a,
                "n = %.0f at most: particles meet a driven body on a straight path within the window, at %.3g m/s2 a "
                "hundredth of the smallest radius beside the true one then",
                floor(most), v->best.acceleration);
  return most;
}

tdm_status cpl_longer_windows(cpl_advisor *v, tdm_error *err) {
  const double most = v->t.settings.time_end / (20 * v->a.best.dt);
  const double useful = fmin(fmin((double)cpl_cheap_n(v->best.window, v->best.step), most), most_n_of_path(v));
  cpl_n_search search = cpl_n_search_from(v->a.best.n, useful);
  cpl_candidate c = v->a.best;
  while ((c.n = cpl_n_search_next(&search)) > 0 && cpl_advisor_may_go_on(v)) {
    const cpl_tried before_it = v->best;
    const double error = v->a.coupling;
    bool taken;
    if (cpl_advisor_consider(v, &c, &taken, err) != TDM_OK)
      return err->status;
    if (taken && !keep_if_cheaper(v, &before_it, error))
      return TDM_OK;
    cpl_n_search_tell(&search, c.n, taken);
  }
  return TDM_OK;
}

/* Try a candidate, called `name`, which is taken if it does well and takes less than `share` of the best's time. */
static tdm_status take_if_cheaper(cpl_advisor *v, const cpl_candidate *c, const char *name, double share, bool *taken,
                                  tdm_error *err) {
  cpl_tried tried;
  char why[512];
  double error;
  *taken = false;
  if (cpl_advisor_attempt(v, c, false, &tried, err) != TDM_OK)
    return err->status;
  cpl_advisor_judge(v, &tried, why, sizeof why, &error);
  *taken = !why[0] && rate_of(&tried) <= share * rate_of(&v->best);
  cpl_because(&v->a, "%s: %s, a second takes %.3g s instead of %.3g s%s%s", name, *taken ? "taken" : "not taken",
              rate_of(&tried), rate_of(&v->best), why[0] ? ", and " : "", why);
  if (*taken) {
    v->best = tried;
    v->a.best = *c;
    v->a.coupling = isnan(error) ? v->a.coupling : error;
  }
  return TDM_OK;
}

/* A share of the time from which on the MBD solver is worth a trial, and what a change of it has to come down to. */
static const double worth = 0.1, gain = 0.9;

/* Another formulation, where the MBD solver takes much of the time. */
tdm_status cpl_cheaper_formulation(cpl_advisor *v, tdm_error *err) {
  bool taken;
  for (int f = 0; f < CPL_FORMULATIONS && cpl_advisor_may_go_on(v) && v->best.mbd > worth * v->best.loop; f++) {
    cpl_candidate c = v->a.best;
    c.formulation = (cpl_formulation)f;
    if (c.formulation == v->a.best.formulation || c.formulation == CPL_SMOOTH)
      continue;
    if (take_if_cheaper(v, &c, cpl_formulation_words[f], gain, &taken, err) != TDM_OK)
      return err->status;
  }
  return TDM_OK;
}

tdm_status cpl_looser_tolerance(cpl_advisor *v, tdm_error *err) {
  bool taken = true;
  while (taken && v->best.mbd > worth * v->best.loop && v->a.best.tolerance / finer <= coarsest * (1 + 1e-9) &&
         cpl_advisor_may_go_on(v)) {
    cpl_candidate c = v->a.best;
    char name[64];
    c.tolerance = cpl_round_down(c.tolerance / finer);
    snprintf(name, sizeof name, "a tolerance of the MBD solver of %g", c.tolerance);
    if (take_if_cheaper(v, &c, name, gain, &taken, err) != TDM_OK)
      return err->status;
  }
  cpl_because(&v->a, "tolerance of the MBD solver: %g, where it takes %.2g %% of the time", v->a.best.tolerance,
              100 * v->best.mbd / v->best.loop);
  return TDM_OK;
}

/* Of the scheme that the advice is for. */
static bool can_choose_windows(const cpl_advisor *v) {
  for (int k = 0; v->t.settings.schemes[k]; k++)
    if (strcmp(v->t.settings.schemes[k]->name, v->a.best.scheme) == 0)
      return v->t.settings.schemes[k]->mismatch_order > 0;
  return false;
}

tdm_status cpl_own_windows(cpl_advisor *v, tdm_error *err) {
  cpl_candidate c = v->a.best;
  bool taken;
  c.n = CPL_AUTO_N;
  if (!can_choose_windows(v) || !cpl_advisor_may_go_on(v))
    return TDM_OK;
  return take_if_cheaper(v, &c, "n = \"auto\"", 1, &taken, err);
}

/* ---- the step ---- */

static const double shrinks = 0.7; /* an error of the step would come down to a half */

/* Half the step at the same window: the step's error, to first order, is twice the difference. Where halving it again
 * changes as much it is no such error: a change of any size sets grains that collide apart. */
tdm_status cpl_check_step(cpl_advisor *v, tdm_error *err) {
  const cpl_tried first = v->best;
  double before_it = NAN;
  if (first.prescribed) {
    cpl_because(&v->a, "no load moves the coupled bodies: their motion says nothing of the DEM step, its limits stand");
    return TDM_OK;
  }
  for (int k = 0; k < 3 && cpl_advisor_may_go_on(v); k++) {
    cpl_candidate half = v->a.best;
    cpl_tried tried;
    half.dt /= 2;
    half.n *= 2;
    if (cpl_advisor_attempt(v, &half, false, &tried, err) != TDM_OK)
      return err->status;
    const double apart = tried.good ? cpl_trials_apart(&v->t, &v->best, &tried, v->has_twins ? v->twin : NULL) : NAN;
    v->a.dem_step = 2 * apart;
    if (isnan(apart)) {
      cpl_because(&v->a, "the run with half the DEM step is no measure: %.300s", tried.reason);
      return TDM_OK;
    }
    if (v->a.dem_step <= v->a.wanted) {
      cpl_because(&v->a, "half the DEM step changes the motion by %.2g %%: %g s stays", 100 * apart, v->a.best.dt);
      return TDM_OK;
    }
    if (apart > shrinks * before_it) {
      cpl_because(&v->a,
                  "halving it again changes the motion by %.2g %%, as much as before: that is how far grains that "
                  "collide come apart after any change, no error of the step; %g s stays",
                  100 * apart, first.of.dt);
      v->best = first;
      v->a.best = first.of;
      v->a.round_off = fmax(v->a.round_off, apart);
      v->a.dem_step = NAN;
      return TDM_OK;
    }
    cpl_because(&v->a,
                "half the DEM step changes the motion by %.2g %%, more than half of what is wanted: %g s is tried",
                100 * apart, half.dt);
    before_it = apart;
    v->best = tried;
    v->a.best = half;
  }
  return TDM_OK;
}
