/* The flow chart: see advise.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/advise/advise.h"

#include "coupler/advise/tell.h"
#include "protocol/app/command_line.h"
#include "protocol/base/log.h"

#include <math.h>
#include <string.h>

static const double least_budget = 30, budget_share = 0.05; /* of trials [s], of the run */
static const double gap_limit = 0.05;                       /* velocity against the derivative of position */
static const double erratic_limit = 4;                      /* variance ratio of the load, against that at n = 1 */
static const double trial_part = 1. / 15;                   /* of the budget, for the first trial */
enum { ROWS = 4000, LEAST_WINDOWS = 40 };

typedef struct {
  cpl_trials t;
  cpl_advice a;
  cpl_facts facts;
  double span, interval;  /* of the trials [s] */
  cpl_tried best, single; /* the best so far; n = 1 at its step */
  cpl_tried twin[2];      /* the first good one, and the same with a change of the
                             size of round-off */
  bool has_single, has_twins;
} advisor;

/* ---- before the trials ---- */

static void tell_step(advisor *v) {
  const cpl_limits *l = &v->a.limits;
  const cpl_step *s = &v->a.step;
  if (isfinite(l->time[CPL_RAYLEIGH]))
    cpl_because(
        &v->a,
        "DEM step: the settled bed has a coordination number of %.2g (%s 4), so %.1f of the Rayleigh step %.3g s "
        "is taken: %.3g s",
        l->coordination, l->coordination > 4 ? "above" : "not above", s->share[CPL_RAYLEIGH], l->time[CPL_RAYLEIGH],
        s->share[CPL_RAYLEIGH] * l->time[CPL_RAYLEIGH]);
  else
    cpl_because(&v->a, "DEM step: there is no Rayleigh step: no particles yet, or contacts without a modulus");
  if (isfinite(l->time[CPL_EIGENFREQUENCY]))
    cpl_because(&v->a,
                "DEM step: %.1f of the stable step %.3g s by the "
                "eigenfrequency of the stiffest particle: %.3g s",
                s->share[CPL_EIGENFREQUENCY], l->time[CPL_EIGENFREQUENCY],
                s->share[CPL_EIGENFREQUENCY] * l->time[CPL_EIGENFREQUENCY]);
  cpl_because(&v->a,
              "DEM step: a twentieth of the shortest contact time %.3g s at "
              "%.3g m/s: %.3g s",
              l->time[CPL_CONTACT], l->speed, s->share[CPL_CONTACT] * l->time[CPL_CONTACT]);
}

/* The step by the limits, which is no longer than the rows of the time
 * histories are apart. */
static double choose_step(advisor *v, double otherwise) {
  v->a.step = cpl_choose_step(&v->a.limits);
  return fmin(v->a.step.dt > 0 ? v->a.step.dt : otherwise, v->t.settings.output_interval);
}

static void tell_method(advisor *v, cpl_formulation f) {
  const cpl_facts *c = &v->facts;
  cpl_because(&v->a,
              "scheme \"%s\": the particles weigh %.3g times the lightest "
              "coupled body; the mechanism acts within the "
              "window, so stiff supports and heavy fills bear long windows",
              v->a.best.scheme, c->particles / c->body);
  if (f == CPL_ONE_STEP && c->abrupt)
    cpl_because(&v->a,
                "formulation one_step, which stands for WSTIFF: a \"%s\" sets "
                "in at once",
                c->abrupt);
  else if (f == CPL_ONE_STEP)
    cpl_because(&v->a,
                "formulation one_step, which stands for WSTIFF: contacts come "
                "and go (%s), so loads jump from window to "
                "window, and an integrator that keeps no history bears that",
                c->flows ? "particles flow" : "a coordination number not above 4");
  else
    cpl_because(&v->a, "formulation ggl with max_order 2, which bears steps "
                       "that change as WSTIFF does, and the modified "
                       "corrector, which judges positions alone: the bed is "
                       "dense and stays together");
}

/* The schemes that a solver may be able to take part in, the best first. */
static tdm_status first_check(advisor *v, tdm_error *err) {
  static const char *const schemes[] = {"proxy", "dem-first", "lommen"};
  const bool foreign = tdm_scene_value(v->t.loaded.root, "coupling.solvers");
  for (int k = 0; k < 3; k++) {
    *err = (tdm_error){0};
    v->a.best = (cpl_candidate){v->t.settings.dt, 5, schemes[k], CPL_ONE_STEP};
    if (cpl_trials_check(&v->t, &v->a.best, 0, &v->a.limits, &v->facts, err) == TDM_OK || !foreign ||
        err->status == TDM_ERR_INTERRUPTED)
      break;
  }
  return err->status;
}

static tdm_status before(advisor *v, tdm_error *err) {
  if (first_check(v, err) != TDM_OK)
    return err->status;
  cpl_candidate *c = &v->a.best;
  c->dt = choose_step(v, c->dt);
  c->formulation = cpl_choose_formulation(&v->facts);
  c->n = cpl_first_n(&v->facts, c->dt, v->a.step.share[CPL_RAYLEIGH] * v->a.limits.time[CPL_RAYLEIGH]);
  return TDM_OK;
}

/* ---- trials ---- */

/* What is kept for the last trials, which tell the cost, and the most that one
 * takes: parts of the budget. */
static const double kept = 0.25, one_part = 0.2;

static bool may_go_on(const advisor *v) {
  return v->t.spent < (1 - kept) * v->t.budget;
}

/* How long to try: shorter where windows are so many that a trial would take
 * too much of the budget. */
static double length_of(const advisor *v, const cpl_candidate *c) {
  const double window = (double)c->n * c->dt;
  const double takes = v->span * (v->best.step / c->dt + v->best.window / window); /* [s] */
  const double allowed = one_part * v->t.budget;
  return takes > allowed ? fmin(v->span, fmax(v->span * allowed / takes, LEAST_WINDOWS * window)) : v->span;
}

static tdm_status attempt(advisor *v, const cpl_candidate *c, bool round_off, cpl_tried *tried, tdm_error *err) {
  v->interval = v->interval > 0 ? fmax(v->interval, c->dt) : 0;
  return cpl_trials_run(&v->t, c, length_of(v, c), v->interval, round_off, tried, err);
}

/* How long trials are: so that the first takes a part of the budget, and has
 * windows enough. */
static void choose_span(advisor *v, const cpl_tried *probe) {
  const double rate = probe->step / probe->of.dt + probe->window / ((double)probe->of.n * probe->of.dt); /* [s/s] */
  const double end = v->t.settings.time_end, whole = v->t.setup + rate * end;
  v->t.budget = fmax(least_budget, budget_share * whole);
  v->span = fmin(end, fmax(trial_part * v->t.budget / rate, LEAST_WINDOWS * (double)probe->of.n * probe->of.dt));
  v->interval = fmin(v->t.settings.output_interval, fmax(probe->of.dt, v->span / ROWS));
}

/* The first look at what steps and windows cost, and how fast particles get. */
static tdm_status probe(advisor *v, tdm_error *err) {
  const cpl_candidate *c = &v->a.best;
  cpl_tried p;
  v->span = fmin(v->t.settings.time_end, 200 * (double)c->n * c->dt);
  v->interval = 0;
  if (attempt(v, c, false, &p, err) != TDM_OK)
    return err->status;
  if (!(p.step > 0) || !(p.window >= 0)) /* it did not come far: a guess */
    p.step = p.window = 1e-4;
  choose_span(v, &p);
  return TDM_OK;
}

/* The contact time at the speed that a trial met, and the step from that. True:
 * it has changed. */
static bool look_at_speed(advisor *v, const cpl_tried *tried, tdm_error *err) {
  const double before_dt = v->a.best.dt;
  cpl_limits limits;
  cpl_facts ignored;
  tdm_error check = {0};
  if (!(tried->speed > 0))
    return false;
  if (cpl_trials_check(&v->t, &v->a.best, tried->speed, &limits, &ignored, &check) != TDM_OK) {
    if (check.status == TDM_ERR_INTERRUPTED || check.status == TDM_ERR_MEMORY)
      *err = check;
    return false;
  }
  v->a.limits = limits;
  v->a.best.dt = choose_step(v, before_dt);
  return v->a.best.dt != before_dt;
}

/* ---- judging ---- */

/* Why a trial is not to be taken; "": it is. `error` (may be NULL): against n
 * = 1. */
static void judge(advisor *v, const cpl_tried *tried, char *why, size_t size, double *error) {
  const double window = (double)tried->of.n * tried->of.dt;
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
static tdm_status consider(advisor *v, const cpl_candidate *c, bool *taken, tdm_error *err) {
  char why[512];
  double error;
  cpl_tried tried;
  *taken = false;
  if (attempt(v, c, false, &tried, err) != TDM_OK)
    return err->status;
  judge(v, &tried, why, sizeof why, &error);
  if (why[0]) {
    cpl_because(&v->a, "tried n = %ld, dt = %g s, %s: %s", c->n, c->dt, cpl_formulation_words[c->formulation], why);
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
static tdm_status make_twins(advisor *v, tdm_error *err) {
  if (v->best.prescribed) /* which its mass does not change */
    return TDM_OK;
  v->twin[0] = v->best;
  if (attempt(v, &v->a.best, true, &v->twin[1], err) != TDM_OK || !v->twin[1].good)
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
static tdm_status make_single(advisor *v, tdm_error *err) {
  cpl_candidate c = v->a.best;
  c.n = 1;
  if (attempt(v, &c, false, &v->single, err) != TDM_OK)
    return err->status;
  v->has_single = v->single.good;
  if (!v->has_single)
    cpl_because(&v->a, "the run with n = 1 is no measure: %.300s", v->single.reason);
  return TDM_OK;
}

/* ---- remedies, in the order of [L18] ---- */

static tdm_status shorter_windows(advisor *v, cpl_candidate c, tdm_error *err) {
  bool taken = false;
  while (!taken && c.n > 1 && may_go_on(v) && err->status == TDM_OK) {
    c.n /= 2;
    consider(v, &c, &taken, err);
    if (taken)
      cpl_because(&v->a, "remedy: n = %ld", c.n);
  }
  return err->status;
}

static tdm_status other_formulations(advisor *v, cpl_candidate c, tdm_error *err) {
  const cpl_formulation first = c.formulation;
  bool taken = false;
  for (int f = 0; f < CPL_FORMULATIONS && !taken && may_go_on(v) && err->status == TDM_OK; f++) {
    c.formulation = (cpl_formulation)f;
    if (c.formulation == first)
      continue;
    consider(v, &c, &taken, err);
    if (taken)
      cpl_because(&v->a, "remedy: formulation %s", cpl_formulation_words[f]);
  }
  return err->status;
}

static tdm_status shorter_steps(advisor *v, cpl_candidate c, tdm_error *err) {
  bool taken = false;
  for (int k = 0; k < 3 && !taken && may_go_on(v) && err->status == TDM_OK; k++) {
    c.dt = cpl_round_down(c.dt / 2);
    v->has_single = false;
    consider(v, &c, &taken, err);
    if (taken)
      cpl_because(&v->a, "remedy, the last as it costs most: a DEM step of %g s", c.dt);
  }
  return err->status;
}

static tdm_status remedies(advisor *v, const cpl_candidate *first, tdm_error *err) {
  static tdm_status (*const all[])(advisor *, cpl_candidate, tdm_error *) = {shorter_windows, other_formulations,
                                                                             shorter_steps};
  for (int k = 0; k < 3 && !v->a.found && err->status == TDM_OK; k++)
    all[k](v, *first, err);
  return err->status;
}

/* ---- cheaper ones ---- */

static long round_n(double n) {
  return n < 10 ? lround(n) : lround(cpl_round_down(n));
}

/* What a simulated second costs [s/s]. */
static double rate_of(const cpl_tried *tried) {
  return tried->simulated > 0 ? tried->loop / tried->simulated : INFINITY;
}

/* A candidate that was taken for its longer windows: back to the one before if
 * it saves nothing. */
static void keep_if_cheaper(advisor *v, const cpl_tried *before_it, double error) {
  const long n = v->best.of.n;
  const double now = rate_of(&v->best), then = rate_of(before_it);
  if (now < then) {
    cpl_because(&v->a, "n = %ld: a window costs as much as %.2g steps; a second now takes %.3g s, with n = %ld %.3g s",
                n, before_it->window / before_it->step, now, before_it->of.n, then);
    return;
  }
  cpl_because(&v->a, "n = %ld is not cheaper: a second takes %.3g s, with n = %ld %.3g s", n, now, before_it->of.n,
              then);
  v->best = *before_it;
  v->a.best = before_it->of;
  v->a.coupling = error;
}

/* Particles go along the straight path of a body that is driven: its n at most. */
static double most_n_of_path(advisor *v) {
  const double most =
      v->best.prescribed ? cpl_path_n(v->best.acceleration, cpl_trials_smallest(&v->t), v->best.of.dt) : INFINITY;
  if (isfinite(most))
    cpl_because(&v->a,
                "n = %.0f at most: particles meet a driven body on a straight path within the window, at %.3g m/s2 a "
                "hundredth of the smallest radius beside the true one then",
                floor(most), v->best.acceleration);
  return most;
}

/* Longer windows, as long as they save something and bear it. */
static tdm_status longer_windows(advisor *v, tdm_error *err) {
  cpl_candidate c = v->a.best;
  const cpl_tried before_it = v->best;
  const double most = v->t.settings.time_end / (20 * c.dt), error = v->a.coupling;
  double n = fmin(fmin((double)cpl_cheap_n(v->best.window, v->best.step), most), most_n_of_path(v));
  bool taken = false;
  for (int k = 0; k < 3 && !taken && n > 1.3 * (double)before_it.of.n && may_go_on(v); k++) {
    c.n = round_n(n);
    if (consider(v, &c, &taken, err) != TDM_OK)
      return err->status;
    if (taken)
      keep_if_cheaper(v, &before_it, error);
    n = sqrt(n * (double)before_it.of.n);
  }
  return err->status;
}

/* Another formulation, where the MBD solver takes much of the time. */
static tdm_status cheaper_formulation(advisor *v, tdm_error *err) {
  cpl_tried tried;
  char why[512];
  for (int f = 0; f < CPL_FORMULATIONS && may_go_on(v) && v->best.mbd > 0.1 * v->best.loop; f++) {
    cpl_candidate c = v->a.best;
    c.formulation = (cpl_formulation)f;
    if (c.formulation == v->a.best.formulation || c.formulation == CPL_SMOOTH)
      continue;
    if (attempt(v, &c, false, &tried, err) != TDM_OK)
      return err->status;
    judge(v, &tried, why, sizeof why, NULL);
    if (why[0] || rate_of(&tried) > 0.9 * rate_of(&v->best)) {
      cpl_because(&v->a, "%s is not cheaper: a second takes %.3g s instead of %.3g s%s%s", cpl_formulation_words[f],
                  rate_of(&tried), rate_of(&v->best), why[0] ? ", and " : "", why);
      continue;
    }
    cpl_because(&v->a, "%s is cheaper: a second takes %.3g s instead of %.3g s", cpl_formulation_words[f],
                rate_of(&tried), rate_of(&v->best));
    v->best = tried;
    v->a.best = c;
  }
  return TDM_OK;
}

/* ---- the step ---- */

static const double shrinks = 0.7; /* an error of the step would come down to a half */

/* Half the step at the same window: the step's error, to first order, is twice the difference. Where halving it again
 * changes as much it is no such error: a change of any size sets grains that collide apart. */
static tdm_status check_step(advisor *v, tdm_error *err) {
  const cpl_tried first = v->best;
  double before_it = NAN;
  if (first.prescribed) {
    cpl_because(&v->a, "no load moves the coupled bodies: their motion says nothing of the DEM step, its limits stand");
    return TDM_OK;
  }
  for (int k = 0; k < 3 && may_go_on(v); k++) {
    cpl_candidate half = v->a.best;
    cpl_tried tried;
    half.dt /= 2;
    half.n *= 2;
    if (attempt(v, &half, false, &tried, err) != TDM_OK)
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

/* ---- cost ---- */

/* Two runs with the scene's own rows, one longer than the other: what a second
 * costs after the start, where the number of particles goes on as it went. */
static tdm_status predict(advisor *v, tdm_error *err) {
  const double end = v->t.settings.time_end, rate = v->best.loop / v->best.simulated;
  const double left = fmax(v->t.budget - v->t.spent, 0.1 * v->t.budget);
  const double all = fmin(end, fmax(0.5 * v->span, 0.7 * left / rate)); /* both together 1.3 times that */
  cpl_tried shorter = {.loop = 0}, longer;
  if (all < end && cpl_trials_run(&v->t, &v->a.best, 0.3 * all, 0, false, &shorter, err) != TDM_OK)
    return err->status;
  if (cpl_trials_run(&v->t, &v->a.best, all, 0, false, &longer, err) != TDM_OK)
    return err->status;
  v->a.estimate = longer.estimate;
  v->a.setup = v->t.setup;
  v->a.loop = longer.loop;
  if (longer.simulated < end * (1 - 1e-9)) {
    const double way = longer.simulated - shorter.simulated, rest = end - longer.simulated;
    const double slope = (longer.last - longer.half) / (longer.simulated / 2); /* particles a second */
    const double grown = longer.half > 0 ? fmax(0.1, (longer.last + slope * rest / 2) / longer.half) : 1;
    const double steps = longer.step / longer.of.dt, others = fmax(0, (longer.loop - shorter.loop) / way - steps);
    v->a.loop += rest * (steps * grown + others);
    if (fabs(grown - 1) > 0.05)
      cpl_because(&v->a,
                  "the number of particles changes; the expected time takes it "
                  "to go on so, to %.2g times that of "
                  "the trial",
                  grown);
  }
  v->a.wall = v->a.setup + v->a.loop;
  return TDM_OK;
}

/* ---- the flow chart ---- */

/* Where the first trial took longer than was expected the others are shorter.
 */
static void shorten(advisor *v) {
  const double took = v->best.loop / (trial_part * v->t.budget);
  const double least = LEAST_WINDOWS * (double)v->best.of.n * v->best.of.dt;
  if (took > 1.5)
    v->span = fmin(v->span, fmax(least, v->span / took));
}

static tdm_status first_trial(advisor *v, tdm_error *err) {
  bool taken;
  if (probe(v, err) != TDM_OK)
    return err->status;
  const cpl_candidate first = v->a.best;
  consider(v, &first, &taken, err);
  if (err->status == TDM_OK && taken && look_at_speed(v, &v->best, err)) {
    const cpl_candidate again = v->a.best;
    v->a.found = false;
    consider(v, &again, &taken, err);
  }
  return err->status;
}

static tdm_status walk(advisor *v, tdm_error *err) {
  if (before(v, err) != TDM_OK || first_trial(v, err) != TDM_OK)
    return err->status;
  const cpl_candidate first = v->a.best;
  tell_step(v);
  tell_method(v, first.formulation);
  cpl_because(&v->a, "first n = %ld: %s", first.n,
              first.n > 5 ? "a small step and a heavy body, so more than 5" : "where to begin");
  if (!v->a.found && remedies(v, &first, err) != TDM_OK)
    return err->status;
  if (!v->a.found)
    return tdm_fail(err, TDM_ERR_NUMERIC, NULL,
                    "no settings were found with which the trials run well; "
                    "the reasons above say why");
  shorten(v);
  if (make_twins(v, err) != TDM_OK || make_single(v, err) != TDM_OK)
    return err->status;
  char why[512];
  judge(v, &v->best, why, sizeof why, &v->a.coupling);
  if (why[0]) {
    cpl_because(&v->a, "n = %ld will not do: %s", v->a.best.n, why);
    v->a.found = false;
    const cpl_candidate bad = v->a.best;
    if (remedies(v, &bad, err) != TDM_OK)
      return err->status;
    if (!v->a.found)
      cpl_because(&v->a,
                  "no remedy brought the error down to what is wanted: n = %ld "
                  "is what there is",
                  bad.n);
    v->a.best = v->a.found ? v->a.best : bad;
    v->a.found = true;
  } else if (longer_windows(v, err) != TDM_OK) {
    return err->status;
  }
  if (cheaper_formulation(v, err) != TDM_OK || check_step(v, err) != TDM_OK)
    return err->status;
  if (!may_go_on(v))
    cpl_because(&v->a,
                "the trials took %.3g s, all that they may; more may be found "
                "by a longer look",
                v->t.spent);
  return predict(v, err);
}

static tdm_status deliver(advisor *v, const cpl_advise_options *o, const tdm_results *results, tdm_error *err) {
  tdm_error file = {0};
  v->a.trials = v->t.spent;
  json_t *json = cpl_advice_to_json(&v->a, &v->t);
  tdm_results_json(results, "advice.json", json, &file);
  if (o->json && json_dump_file(json, o->json, JSON_INDENT(2)) != 0)
    tdm_fail(&file, TDM_ERR_FILE, NULL, "%s: cannot be written", o->json);
  json_decref(json);
  if (err->status == TDM_OK)
    cpl_advice_print(&v->a, v->t.loaded.root);
  if (err->status == TDM_OK && o->write)
    cpl_advice_write(&v->a, &v->t, o->write, &file);
  if (file.status != TDM_OK)
    tdm_fail(err, file.status, NULL, "%s", file.message);
  return err->status;
}

tdm_status cpl_advise(const cpl_advise_options *o, tdm_error *err) {
  advisor v = {.t = {.scene = o->scene, .set = o->set, .dir = o->out, .budget = least_budget},
               .a = {.wanted = o->error, .coupling = NAN, .dem_step = NAN, .round_off = NAN, .estimate = NAN}};
  tdm_results results;
  memcpy(v.t.solver, o->solver, sizeof v.t.solver);
  v.a.reasons = json_array();
  const tdm_results_def def = {.dir = o->out, .scene = o->scene, .force = o->force};
  if (cpl_trials_open(&v.t, err) == TDM_OK && tdm_check_writable(o->json, err) == TDM_OK &&
      tdm_check_writable(o->write, err) == TDM_OK && tdm_results_open(&results, &def, err) == TDM_OK) {
    remove(v.t.bed); /* of an earlier advice: what settling takes is to be known */
    if (tdm_results_start(&results, err) == TDM_OK && walk(&v, err) != TDM_ERR_INTERRUPTED)
      deliver(&v, o, &results, err);
    tdm_results_close(&results);
  }
  cpl_trials_close(&v.t);
  json_decref(v.a.reasons);
  return err->status;
}
