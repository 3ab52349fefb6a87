/* A share of a run, repeated: see repeat.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/trial/repeat.h"

#include "coupler/scheme/schemes.h"
#include "protocol/parameters/load.h"
#include "protocol/results/results.h"
#include "protocol/scene/json.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double least_windows = 20; /* repeated, whatever the share */
static const double round_off = 1e-13;  /* of a body's mass */
static const double dem_order = 1; /* of the DEM step: contacts begin somewhere in a step, which first order it is */
static const double above = 2;     /* times what round-off makes: less than that is no difference of the settings */

typedef enum { HALF_WINDOW, HALF_STEP, ROUND_OFF, VARIANTS } variant;
static const char *const names[VARIANTS] = {"half_window", "half_step", "round_off"};
static const char *const keys[VARIANTS] = {"coupling", "dem_step", "round_off"};
static const char *const words[VARIANTS] = {"exchange", "DEM step", "round-off"};

enum { SETS = 4, LINE = 160 };

/* What changes in a repetition, and how much of the difference is the error of the run. */
typedef struct {
  int nset; /* 0: it cannot be made */
  char set[SETS][LINE];
  const char *why_not;
  double factor;
} change;

typedef struct {
  const cpl_repeat_options *options;
  tdm_scene scene;
  cpl_settings settings;
  const cpl_scheme *scheme; /* that ran */
  double until;             /* [s] */
} repetition;

/* ---- before the run ---- */

static tdm_status load(repetition *r, tdm_error *err) {
  if (tdm_scene_load(&r->scene, r->options->scene, r->options->set, err) == TDM_OK)
    cpl_settings_read(&r->settings, &r->scene, cpl_schemes, err);
  r->scheme = r->settings.scheme;
  return err->status;
}

static void let_go(repetition *r) {
  cpl_settings_free(&r->settings);
  tdm_scene_destroy(&r->scene);
}

tdm_status cpl_repeat_check(const cpl_repeat_options *options, tdm_error *err) {
  repetition r = {.options = options};
  if (load(&r, err) == TDM_OK)
    for (int role = 0; role < CPL_NROLE; role++)
      if (r.settings.by_hand[role])
        tdm_fail(err, TDM_ERR_SCENE, r.settings.solver_path[role],
                 "%s is started by hand, so no part of the run can be repeated for --estimate; let tandem start it, or "
                 "leave --estimate out: the estimate from the exchange alone is in summary.json of every run",
                 cpl_role_names[role]);
  if (err->status == TDM_OK && r.settings.nbody == 0)
    tdm_fail(err, TDM_ERR_SCENE, "coupling.bodies",
             "no body is coupled, so there is no exchange whose error --estimate could tell; leave it out");
  tdm_scene_locate(&r.scene, err);
  let_go(&r);
  return err->status;
}

/* ---- what is repeated ---- */

/* Whole windows, at least so many, at most all. */
static double time_to_repeat(const repetition *r) {
  const cpl_settings *s = &r->settings;
  const double window = (double)s->n * s->dt, end = (double)cpl_total_steps(s) * s->dt;
  const double wanted = fmax(r->options->share * end, least_windows * (s->adapt.on ? s->dt : window));
  const double whole = s->adapt.on ? wanted : ceil(wanted / window - 1e-6) * window;
  return fmin(whole, end);
}

static double richardson(double ratio, double order) {
  return 1 / (1 - pow(ratio, order));
}

static void set_number(change *c, const char *path, double value) {
  snprintf(c->set[c->nset++], LINE, "%s=%.17g", path, value);
}

/* Half the window: with a window that adapts, a mismatch that half the window would have. */
static void halve_window(const repetition *r, change *c) {
  const cpl_settings *s = &r->settings;
  const double order = r->scheme->order > 0 ? r->scheme->order : 1;
  if (s->adapt.on) {
    set_number(c, "coupling.auto.tolerance", s->adapt.tolerance * pow(0.5, r->scheme->mismatch_order));
    c->factor = richardson(0.5, order);
  } else if (s->n > 1) {
    const long n = (s->n + 1) / 2;
    set_number(c, "coupling.n", (double)n);
    c->factor = richardson((double)n / (double)s->n, order);
  } else {
    c->why_not = "a window of one DEM step cannot be halved: the error of the exchange is within that of the step";
  }
}

/* Half the DEM step, with the same windows. */
static void halve_step(const repetition *r, change *c) {
  const cpl_settings *s = &r->settings;
  set_number(c, "time.dt", 0.5 * s->dt);
  if (s->adapt.on) {
    set_number(c, "coupling.auto.n_min", 2 * (double)s->adapt.n_min);
    set_number(c, "coupling.auto.n_max", 2 * (double)s->adapt.n_max);
  } else {
    set_number(c, "coupling.n", 2 * (double)s->n);
  }
  c->factor = richardson(0.5, dem_order);
}

/* The mass of a coupled body, by a little more. */
static void change_round_off(const repetition *r, change *c) {
  const json_t *bodies = tdm_scene_value(r->scene.root, "mbd.bodies");
  size_t i;
  json_t *body;
  json_array_foreach((json_t *)bodies, i, body) {
    const char *name = json_string_value(json_object_get(body, "name"));
    const json_t *mass = json_object_get(body, "mass");
    char path[64];
    if (!name || strcmp(name, r->settings.body[0].name[CPL_MBD]) != 0 || !json_is_number(mass))
      continue;
    snprintf(path, sizeof path, "mbd.bodies[%zu].mass", i);
    set_number(c, path, json_number_value(mass) * (1 + round_off));
    c->factor = 1;
    return;
  }
  c->why_not = "the scene has no mass of a coupled body that could be changed by round-off";
}

static change change_for(const repetition *r, variant v) {
  change c = {.factor = NAN};
  if (v == HALF_WINDOW)
    halve_window(r, &c);
  else if (v == HALF_STEP)
    halve_step(r, &c);
  else
    change_round_off(r, &c);
  return c;
}

/* ---- repetitions ---- */

typedef struct {
  bool there;
  char why_not[TDM_MESSAGE_MAX];
  double wall;           /* [s] */
  cpl_apart_runs *apart; /* (nbody) */
} outcome;

static void folder(const repetition *r, variant v, char *out, size_t size) {
  snprintf(out, size, "%s/estimate/%s", r->options->out, names[v]);
}

static tdm_status compare(const repetition *r, const char *dir, outcome *o, tdm_error *err) {
  for (int i = 0; i < r->settings.nbody; i++)
    if (cpl_trial_compare(r->options->out, dir, r->settings.body[i].name[CPL_MBD], r->until * (1 + 1e-12), &o->apart[i],
                          err) != TDM_OK)
      return err->status;
  o->there = o->apart[0].nrow >= 2;
  if (!o->there)
    snprintf(o->why_not, sizeof o->why_not, "less than two rows of output to compare");
  return TDM_OK;
}

static tdm_status repeat(const repetition *r, variant v, const char *bed, outcome *o, tdm_error *err) {
  const change c = change_for(r, v);
  char dir[4352];
  int given = 0;
  if (c.nset == 0) {
    snprintf(o->why_not, sizeof o->why_not, "%s", c.why_not);
    return TDM_OK;
  }
  while (r->options->set && r->options->set[given])
    given++;
  const char **set = calloc((size_t)(given + SETS + 1), sizeof *set);
  if (!set)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int k = 0; k < given; k++)
    set[k] = r->options->set[k];
  for (int k = 0; k < c.nset; k++)
    set[given + k] = c.set[k];
  folder(r, v, dir, sizeof dir);
  cpl_trial_options trial = {.scene = r->options->scene, .set = set, .dir = dir, .bed = bed, .end = r->until};
  memcpy(trial.solver, r->options->solver, sizeof trial.solver);
  cpl_trial t;
  cpl_trial_run(&trial, &t, err);
  o->wall = t.run.wall;
  if (err->status == TDM_OK && t.status != TDM_OK)
    snprintf(o->why_not, sizeof o->why_not, "%s", t.reason);
  else if (err->status == TDM_OK)
    compare(r, dir, o, err);
  cpl_trial_free(&t);
  free(set);
  return err->status;
}

/* ---- what comes of it ---- */

/* What a repetition tells of a quantity of a body: the error of the run, or NaN. */
static double error_of(const repetition *r, const outcome *o, variant v, int body, int quantity) {
  return o[v].there ? change_for(r, v).factor * o[v].apart[body].rms[quantity] : NAN;
}

/* Is what a change of the settings makes not more than what round-off makes? */
static bool at_ceiling(const repetition *r, const outcome *o, variant v, int body, int quantity) {
  return o[v].there && o[ROUND_OFF].there &&
         !(o[v].apart[body].rms[quantity] > above * error_of(r, o, ROUND_OFF, body, quantity));
}

static json_t *quantity_of(const repetition *r, const outcome *o, int body, int quantity) {
  json_t *json = json_object();
  double spread = NAN;
  for (int v = 0; v < VARIANTS; v++) {
    json_object_set_new(json, keys[v], tdm_number_to_json(error_of(r, o, (variant)v, body, quantity)));
    if (v != ROUND_OFF)
      json_object_set_new(json, v == HALF_WINDOW ? "coupling_at_ceiling" : "dem_step_at_ceiling",
                          json_boolean(at_ceiling(r, o, (variant)v, body, quantity)));
    spread = o[v].there ? o[v].apart[body].spread[quantity] : spread;
  }
  json_object_set_new(json, "spread", tdm_number_to_json(spread));
  return json;
}

static json_t *to_json(const repetition *r, const outcome *o) {
  json_t *bodies = json_object(), *failed = json_object();
  double wall = 0;
  for (int i = 0; i < r->settings.nbody; i++) {
    json_t *body = json_object();
    for (int q = 0; q < CPL_QUANTITIES; q++)
      json_object_set_new(body, cpl_quantity_names[q], quantity_of(r, o, i, q));
    json_object_set_new(bodies, r->settings.body[i].name[CPL_MBD], body);
  }
  for (int v = 0; v < VARIANTS; v++) {
    wall += o[v].wall;
    if (!o[v].there)
      json_object_set_new(failed, keys[v], json_string(o[v].why_not));
  }
  return json_pack("{s:f, s:f, s:f, s:i, s:o, s:o}", "share", r->until / r->settings.time_end, "until_s", r->until,
                   "wall_s", wall, "order", r->scheme->order, "unknown", failed, "bodies", bodies);
}

static void print(const repetition *r, const outcome *o) {
  double wall = 0;
  for (int v = 0; v < VARIANTS; v++)
    wall += o[v].wall;
  printf("  repeated until %.4g s (%.3g %% of the run, %.2f s wall): error until then, rms\n  %-12s %-17s", r->until,
         100 * r->until / r->settings.time_end, wall, "body", "quantity");
  for (int v = 0; v < VARIANTS; v++)
    printf(" %12s", words[v]);
  printf("\n");
  for (int i = 0; i < r->settings.nbody; i++)
    for (int q = 0; q < CPL_ANGLE; q++) {
      printf("  %-12.12s %-17s", r->settings.body[i].name[CPL_MBD], cpl_quantity_names[q]);
      for (int v = 0; v < VARIANTS; v++) {
        const double e = error_of(r, o, (variant)v, i, q);
        char text[24] = "unknown";
        if (!isnan(e))
          snprintf(text, sizeof text, "%.2g%s", e, v != ROUND_OFF && at_ceiling(r, o, (variant)v, i, q) ? " *" : "");
        printf(" %12s", text);
      }
      printf(" %s\n", cpl_quantity_units[q]);
    }
  bool ceiling = false;
  for (int v = 0; v < ROUND_OFF; v++)
    ceiling = ceiling || at_ceiling(r, o, (variant)v, 0, CPL_VELOCITY);
  if (ceiling)
    printf("  * no more than two runs differ that round-off sets apart: the motion is chaotic, and smaller steps bring "
           "no run nearer\n");
  for (int v = 0; v < VARIANTS; v++)
    if (!o[v].there)
      printf("  %s: unknown: %s\n", words[v], o[v].why_not);
}

/* into summary.json: whole, or not at all */
static tdm_status enter(const repetition *r, const outcome *o, tdm_error *err) {
  char file[4352];
  json_t *summary = tdm_results_read(r->options->out, "summary.json", err);
  if (!summary)
    return err->status;
  json_t *estimate = json_object_get(summary, "error_estimate");
  if (estimate)
    json_object_set_new(estimate, "repetition", to_json(r, o));
  snprintf(file, sizeof file, "%s/summary.json", r->options->out);
  if (!tdm_json_replace(file, summary))
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno));
  json_decref(summary);
  return err->status;
}

/* The scheme that ran may be the fallback. */
static void take_scheme(repetition *r) {
  json_t *summary = tdm_results_read(r->options->out, "summary.json", &(tdm_error){0});
  const char *ran = json_string_value(tdm_scene_value(summary, "settings.coupling.scheme"));
  ran = ran ? ran : json_string_value(json_object_get(json_object_get(summary, "settings"), "coupling.scheme"));
  for (int k = 0; ran && cpl_schemes[k]; k++)
    if (strcmp(cpl_schemes[k]->name, ran) == 0)
      r->scheme = cpl_schemes[k];
  json_decref(summary);
}

tdm_status cpl_repeat(const cpl_repeat_options *options, tdm_error *err) {
  repetition r = {.options = options};
  outcome o[VARIANTS] = {{0}};
  char bed[4352];
  if (load(&r, err) != TDM_OK) {
    let_go(&r);
    return err->status;
  }
  take_scheme(&r);
  r.until = time_to_repeat(&r);
  snprintf(bed, sizeof bed, "%s/estimate/bed", options->out);
  for (int v = 0; v < VARIANTS && err->status == TDM_OK; v++) {
    o[v].apart = calloc((size_t)r.settings.nbody + 1, sizeof *o[v].apart);
    if (!o[v].apart)
      tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    else
      repeat(&r, (variant)v, bed, &o[v], err);
  }
  if (err->status == TDM_OK && enter(&r, o, err) == TDM_OK && !options->quiet)
    print(&r, o);
  for (int v = 0; v < VARIANTS; v++)
    free(o[v].apart);
  let_go(&r);
  return err->status;
}
