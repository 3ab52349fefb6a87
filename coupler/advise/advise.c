/* The flow chart: see advise.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/advise/advise.h"

#include "coupler/advise/remedies.h"
#include "protocol/app/command_line.h"
#include "protocol/base/log.h"

#include <math.h>
#include <string.h>

static const double least_budget = 30, budget_share = 0.05; /* of trials [s] of processor time, of the run */
static const double trial_part = 1. / 15;                   /* of the budget, for the first trial */
enum { ROWS = 4000 };

/* ---- before the trials ---- */

static void tell_step(cpl_advisor *v) {
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
static double choose_step(cpl_advisor *v, double otherwise) {
  v->a.step = cpl_choose_step(&v->a.limits);
  return fmin(v->a.step.dt > 0 ? v->a.step.dt : otherwise, v->t.settings.output_interval);
}

static void tell_method(cpl_advisor *v, cpl_formulation f) {
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
static tdm_status first_check(cpl_advisor *v, tdm_error *err) {
  static const char *const schemes[] = {"proxy", "dem-first", "lommen"};
  const bool foreign = cpl_is_foreign(v->t.loaded.root, CPL_MBD) || cpl_is_foreign(v->t.loaded.root, CPL_DEM);
  for (int k = 0; k < 3; k++) {
    *err = (tdm_error){0};
    v->a.best = (cpl_candidate){v->t.settings.dt, 5, schemes[k], CPL_ONE_STEP, cpl_trials_tolerance(&v->t)};
    if (cpl_trials_check(&v->t, &v->a.best, 0, &v->a.limits, &v->facts, err) == TDM_OK || !foreign ||
        err->status == TDM_ERR_INTERRUPTED)
      break;
  }
  return err->status;
}

static tdm_status before(cpl_advisor *v, tdm_error *err) {
  if (first_check(v, err) != TDM_OK || /* which settles; again, for what a start takes without that */
      cpl_trials_check(&v->t, &v->a.best, 0, &v->a.limits, &v->facts, err) != TDM_OK)
    return err->status;
  cpl_candidate *c = &v->a.best;
  c->dt = choose_step(v, c->dt);
  c->formulation = cpl_choose_formulation(&v->facts);
  c->n = cpl_first_n(&v->facts, c->dt, v->a.step.share[CPL_RAYLEIGH] * v->a.limits.time[CPL_RAYLEIGH]);
  return TDM_OK;
}

/* ---- the first trial ---- */

/* How long trials are: so that the first takes a part of the budget, and has
 * windows enough. */
static void choose_span(cpl_advisor *v, const cpl_tried *probe) {
  const double rate = probe->step / probe->of.dt + probe->window / ((double)probe->of.n * probe->of.dt); /* [s/s] */
  const double end = v->t.settings.time_end, whole = v->t.start + rate * end;
  v->t.budget = fmax(least_budget, budget_share * whole);
  v->span = fmin(end, fmax(trial_part * v->t.budget / rate, CPL_LEAST_WINDOWS * (double)probe->of.n * probe->of.dt));
  v->interval = fmin(v->t.settings.output_interval, fmax(probe->of.dt, v->span / ROWS));
}

/* The first look at what steps and windows cost, and how fast particles get. */
static tdm_status probe(cpl_advisor *v, tdm_error *err) {
  const cpl_candidate *c = &v->a.best;
  cpl_tried p;
  v->span = fmin(v->t.settings.time_end, 200 * (double)c->n * c->dt);
  v->interval = 0;
  if (cpl_advisor_attempt(v, c, false, &p, err) != TDM_OK)
    return err->status;
  if (!(p.step > 0) || !(p.window >= 0)) /* it did not come far: a guess */
    p.step = p.window = 1e-4;
  choose_span(v, &p);
  return TDM_OK;
}

/* The contact time at the speed that a trial met, and the step from that. True:
 * it has changed. */
static bool look_at_speed(cpl_advisor *v, const cpl_tried *tried, tdm_error *err) {
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

/* ---- cost ---- */

/* What a second costs later on [s/s]: `all` by the trials, of which `steps` of the particles grow with their number. */
static double goes_on(double steps, double all, double grown) {
  return steps * grown + fmax(0, all - steps);
}

/* Two runs with the scene's own rows, one longer than the other: what a second
 * costs after the start, where the number of particles goes on as it went. */
static tdm_status predict(cpl_advisor *v, tdm_error *err) {
  const double end = v->t.settings.time_end, rate = v->best.processor / v->best.simulated;
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
  v->a.processor = v->t.settled + longer.processor;
  if (longer.simulated < end * (1 - 1e-9)) {
    const double way = longer.simulated - shorter.simulated, rest = end - longer.simulated;
    const double slope = (longer.last - longer.half) / (longer.simulated / 2); /* particles a second */
    const double grown = longer.half > 0 ? fmax(0.1, (longer.last + slope * rest / 2) / longer.half) : 1;
    const double steps = longer.step / longer.of.dt, busy = longer.loop / longer.processor;
    v->a.loop += rest * goes_on(busy * steps, (longer.loop - shorter.loop) / way, grown);
    v->a.processor += rest * goes_on(steps, (longer.processor - shorter.processor) / way, grown);
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
static void shorten(cpl_advisor *v) {
  const double took = v->best.processor / (trial_part * v->t.budget);
  const double least = CPL_LEAST_WINDOWS * (double)v->best.of.n * v->best.of.dt;
  if (took > 1.5)
    v->span = fmin(v->span, fmax(least, v->span / took));
}

static tdm_status first_trial(cpl_advisor *v, tdm_error *err) {
  bool taken;
  if (probe(v, err) != TDM_OK)
    return err->status;
  const cpl_candidate first = v->a.best;
  cpl_advisor_consider(v, &first, &taken, err);
  if (err->status == TDM_OK && taken && look_at_speed(v, &v->best, err)) {
    const cpl_candidate again = v->a.best;
    v->a.found = false;
    cpl_advisor_consider(v, &again, &taken, err);
  }
  return err->status;
}

static tdm_status walk(cpl_advisor *v, tdm_error *err) {
  if (before(v, err) != TDM_OK || first_trial(v, err) != TDM_OK)
    return err->status;
  const cpl_candidate first = v->a.best;
  tell_step(v);
  tell_method(v, first.formulation);
  cpl_because(&v->a, "first n = %ld: %s", first.n,
              first.n > 5 ? "a small step and a heavy body, so more than 5" : "where to begin");
  if (!v->a.found && cpl_remedies(v, &first, err) != TDM_OK)
    return err->status;
  if (!v->a.found)
    return tdm_fail(err, TDM_ERR_NUMERIC, NULL,
                    "no settings were found with which the trials run well; "
                    "the reasons above say why");
  shorten(v);
  if (cpl_advisor_make_twins(v, err) != TDM_OK || cpl_advisor_make_single(v, err) != TDM_OK)
    return err->status;
  char why[512];
  cpl_advisor_judge(v, &v->best, why, sizeof why, &v->a.coupling);
  if (why[0]) {
    cpl_because(&v->a, "n = %ld will not do: %s", v->a.best.n, why);
    v->a.found = false;
    const cpl_candidate bad = v->a.best;
    if (cpl_remedies(v, &bad, err) != TDM_OK)
      return err->status;
    if (!v->a.found)
      cpl_because(&v->a,
                  "no remedy brought the error down to what is wanted: n = %ld "
                  "is what there is",
                  bad.n);
    v->a.best = v->a.found ? v->a.best : bad;
    v->a.found = true;
  } else if (cpl_longer_windows(v, err) != TDM_OK) {
    return err->status;
  }
  if (cpl_cheaper_formulation(v, err) != TDM_OK || cpl_looser_tolerance(v, err) != TDM_OK ||
      cpl_own_windows(v, err) != TDM_OK || cpl_check_step(v, err) != TDM_OK)
    return err->status;
  if (!cpl_advisor_may_go_on(v))
    cpl_because(&v->a,
                "the trials took %.3g s, all that they may; more may be found "
                "by a longer look",
                v->t.spent);
  return predict(v, err);
}

static tdm_status deliver(cpl_advisor *v, const cpl_advise_options *o, const tdm_results *results, tdm_error *err) {
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
  cpl_advisor v = {.t = {.scene = o->scene, .set = o->set, .dir = o->out, .budget = least_budget},
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
