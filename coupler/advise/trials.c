/* Trials of candidates: see trials.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/advise/trials.h"

#include "coupler/cells/cells.h"
#include "coupler/choice/signs.h"
#include "coupler/observe/observers.h"
#include "coupler/scheme/schemes.h"
#include "coupler/trial/trial.h"
#include "protocol/base/log.h"
#include "protocol/parameters/load.h"
#include "protocol/results/results.h"
#include "protocol/scene/json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

enum { SETTINGS = CPL_CANDIDATE_SETTINGS + 4 };

/* ---- the scene ---- */

/* Advice is about the exchange of two solvers that tandem starts. */
static bool is_for_both(const cpl_trials *t, tdm_error *err) {
  const json_t *root = t->loaded.root;
  const bool dem = json_object_get(root, "dem"), mbd = json_object_get(root, "mbd");
  if (dem && !mbd)
    tdm_fail(err, TDM_ERR_SCENE, "mbd",
             "is missing: a scene of particles alone exchanges nothing. "
             "`tandem-dem check` prints the limits of its step "
             "(time.dt), which is all there is to choose");
  else if (!dem)
    tdm_fail(err, TDM_ERR_SCENE, "dem",
             "is missing: a scene of bodies alone exchanges nothing, and its "
             "integrator chooses its steps itself; run it "
             "with tandem-mbd");
  return err->status == TDM_OK;
}

tdm_status cpl_trials_open(cpl_trials *t, tdm_error *err) {
  t->rows = json_array();
  snprintf(t->bed, sizeof t->bed, "%s/bed", t->dir);
  if (tdm_scene_load(&t->loaded, t->scene, t->set, err) == TDM_OK && is_for_both(t, err))
    cpl_settings_read(&t->settings, &t->loaded, cpl_schemes, err);
  tdm_scene_locate(&t->loaded, err);
  return err->status;
}

void cpl_trials_close(cpl_trials *t) {
  cpl_settings_free(&t->settings);
  tdm_scene_destroy(&t->loaded);
  json_decref(t->rows);
  free(t->radius);
}

/* ---- settings ---- */

static const double default_tolerance = 1e-8; /* docs/scene.md */

double cpl_trials_tolerance(const cpl_trials *t) {
  const json_t *own = tdm_scene_value(t->loaded.root, "mbd.solver.relative_tolerance");
  return json_is_number(own) ? json_number_value(own) : default_tolerance;
}

const char *cpl_candidate_n(const cpl_candidate *of, char out[CPL_N_LENGTH]) {
  if (of->n == CPL_AUTO_N)
    snprintf(out, CPL_N_LENGTH, "\"auto\"");
  else
    snprintf(out, CPL_N_LENGTH, "%ld", of->n);
  return out;
}

int cpl_candidate_settings(const cpl_candidate *of, const json_t *root,
                           char out[CPL_CANDIDATE_SETTINGS + 1][CPL_SETTING_LENGTH]) {
  const bool low = of->formulation == CPL_LOW_ORDER, one_step = of->formulation == CPL_ONE_STEP;
  char windows[CPL_N_LENGTH];
  int n = 0;
  snprintf(out[n++], CPL_SETTING_LENGTH, "time.dt=%.15g", of->dt);
  snprintf(out[n++], CPL_SETTING_LENGTH, "coupling.n=%s", cpl_candidate_n(of, windows));
  snprintf(out[n++], CPL_SETTING_LENGTH, "coupling.scheme=\"%s\"", of->scheme);
  out[n][0] = 0;
  if (cpl_is_foreign(root, CPL_MBD))
    return n;
  snprintf(out[n++], CPL_SETTING_LENGTH, "mbd.formulation=\"%s\"", one_step ? "one_step" : "ggl");
  if (low || tdm_scene_value(root, "mbd.corrector"))
    snprintf(out[n++], CPL_SETTING_LENGTH, "mbd.corrector=\"%s\"", low ? "modified" : "original");
  if (low)
    snprintf(out[n++], CPL_SETTING_LENGTH, "mbd.solver.max_order=2");
  snprintf(out[n++], CPL_SETTING_LENGTH, "mbd.solver.relative_tolerance=%.15g", of->tolerance);
  out[n][0] = 0;
  return n;
}

/* The mass of the first coupled body that has one, by some units in its last
 * place; false: there is none. */
static bool round_off_setting(const cpl_trials *t, char out[CPL_SETTING_LENGTH]) {
  const json_t *bodies = tdm_scene_value(t->loaded.root, "mbd.bodies");
  for (size_t i = 0; t->settings.nbody > 0 && i < json_array_size(bodies); i++) {
    const json_t *body = json_array_get(bodies, i), *mass = json_object_get(body, "mass");
    const char *name = json_string_value(json_object_get(body, "name"));
    if (!name || strcmp(name, t->settings.body[0].name[CPL_MBD]) != 0 || !json_is_number(mass) || t->loaded.kept)
      continue;
    snprintf(out, CPL_SETTING_LENGTH, "mbd.bodies[%zu].mass=%.17g", i, json_number_value(mass) * (1 + 1e-13));
    return true;
  }
  return false;
}

/* Settings of a run: the user's, a candidate's, and more. */
typedef struct {
  char candidate[CPL_CANDIDATE_SETTINGS + 1][CPL_SETTING_LENGTH], more[2][CPL_SETTING_LENGTH];
  const char **set; /* NULL-terminated, owned */
  int n;
} run_settings;

/* With room for some more; an error: no memory. */
static tdm_status settings_make(const cpl_trials *t, const cpl_candidate *of, run_settings *s, tdm_error *err) {
  const int ncandidate = cpl_candidate_settings(of, t->loaded.root, s->candidate);
  int given = 0;
  while (t->set && t->set[given])
    given++;
  s->n = 0;
  s->set = calloc((size_t)(given + ncandidate + 4), sizeof *s->set);
  if (!s->set)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int k = 0; k < given; k++)
    s->set[s->n++] = t->set[k];
  for (int k = 0; k < ncandidate; k++)
    s->set[s->n++] = s->candidate[k];
  return TDM_OK;
}

/* Processor time of this process and of the solvers that have ended [s]. */
static double processor_time(void) {
  static const int whose[] = {RUSAGE_SELF, RUSAGE_CHILDREN};
  double sum = 0;
  for (int k = 0; k < 2; k++) {
    struct rusage use;
    getrusage(whose[k], &use);
    sum += (double)(use.ru_utime.tv_sec + use.ru_stime.tv_sec);
    sum += 1e-6 * (double)(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
  }
  return sum;
}

/* ---- what the solvers report ---- */

static double number(const json_t *root, const char *path, double otherwise) {
  const json_t *value = tdm_scene_value(root, path);
  return json_is_number(value) ? json_number_value(value) : otherwise;
}

static void take_limits(const json_t *report, cpl_limits *l) {
  for (int k = 0; k < CPL_LIMITS; k++) {
    char path[64];
    snprintf(path, sizeof path, "limits.%s.time", cpl_limit_names[k]);
    l->time[k] = number(report, path, INFINITY);
  }
  l->speed = number(report, "contact_speed", NAN);
  l->coordination = number(report, "coordination", 0);
}

/* Forces that set in at once, and laws that jump. */
static const char *abrupt_force(const json_t *root) {
  static const char *const types[] = {"stop", "cable", "friction", "bump"};
  const json_t *forces = tdm_scene_value(root, "mbd.forces");
  for (size_t i = 0; i < json_array_size(forces); i++) {
    const char *type = json_string_value(json_object_get(json_array_get(forces, i), "type"));
    for (int k = 0; type && k < 4; k++)
      if (strcmp(type, types[k]) == 0)
        return types[k];
  }
  return NULL;
}

static void take_facts(const json_t *root, const json_t *report, cpl_facts *f) {
  const json_t *ratios = json_object_get(report, "mass_ratios");
  *f = (cpl_facts){.abrupt = abrupt_force(root), .body = INFINITY, .coordination = number(report, "coordination", 0)};
  f->flows = number(report, "sources", 0) + number(report, "sinks", 0) > 0;
  f->particles = number(report, "particle_mass", 0);
  for (size_t i = 0; i < json_array_size(ratios); i++) {
    const json_t *one = json_array_get(ratios, i);
    const double mass = number(one, "mass", INFINITY);
    f->body = fmin(f->body, mass);
    f->heaviest = fmax(f->heaviest, mass * number(one, "heaviest_particle", 0));
  }
}

/* Whether trials can share a bed: tandem's own DEM settles it, and the scene
 * does not keep it itself. */
static bool shares_bed(const cpl_trials *t) {
  return tdm_scene_value(t->loaded.root, "dem.settle") && !tdm_scene_value(t->loaded.root, "dem.settle.store") &&
         !cpl_is_foreign(t->loaded.root, CPL_DEM);
}

/* Of the mean moment of inertia; 1 where a solver does not tell. Without memory all are. */
static void take_radii(cpl_trials *t, const json_t *bodies) {
  if (!t->radius)
    t->radius = calloc((size_t)t->settings.nbody + 1, sizeof *t->radius);
  for (int b = 0; t->radius && b < t->settings.nbody; b++) {
    const json_t *body = json_object_get(bodies, t->settings.body[b].name[CPL_MBD]);
    const double mass = number(body, "mass", 0);
    const json_t *inertia = json_object_get(body, "inertia");
    double mean = 0;
    for (size_t k = 0; k < 3; k++)
      mean += json_number_value(json_array_get(inertia, k)) / 3;
    t->radius[b] = mass > 0 && mean > 0 ? sqrt(mean / mass) : 1;
  }
}

tdm_status cpl_trials_check(cpl_trials *t, const cpl_candidate *of, double speed, cpl_limits *limits, cpl_facts *facts,
                            tdm_error *err) {
  run_settings s;
  char dir[4300], bed[4400];
  cpl_run_result result;
  if (settings_make(t, of, &s, err) != TDM_OK)
    return err->status;
  snprintf(dir, sizeof dir, "%s/check", t->dir);
  snprintf(bed, sizeof bed, "dem.settle.store=%s", t->bed);
  snprintf(s.more[0], CPL_SETTING_LENGTH, "dem.expected_speed=%.6g", speed);
  if (shares_bed(t))
    s.set[s.n++] = bed;
  if (speed > 0 && !cpl_is_foreign(t->loaded.root, CPL_DEM))
    s.set[s.n++] = s.more[0];
  cpl_run_options run = {.scene = t->scene, .set = s.set, .out = dir, .force = true, .quiet = true, .check = true};
  memcpy(run.solver, t->solver, sizeof run.solver);
  const double before = processor_time();
  if (cpl_run(&run, &result, err) == TDM_OK) {
    const double took = processor_time() - before;
    t->settled = fmax(t->settled, took);
    if (t->setup > 0) /* the bed has settled before */
      t->start = took;
    json_t *summary = tdm_results_read(dir, "summary.json", err);
    const json_t *report = tdm_scene_value(summary, "solvers.dem.report");
    take_limits(report, limits);
    take_facts(t->loaded.root, report, facts);
    take_radii(t, tdm_scene_value(summary, "solvers.mbd.report.bodies"));
    json_decref(summary);
  }
  t->setup = fmax(t->setup, result.wall);
  free(s.set);
  return err->status;
}

/* ---- a trial ---- */

/* A history of a result directory; false: there is none. */
static bool read_table(const cpl_tried *tried, const char *name, cpl_table *table) {
  char file[4608];
  snprintf(file, sizeof file, "%s/%s", tried->dir, name);
  *table = (cpl_table){0};
  return cpl_table_read(table, file, &(tdm_error){0}) == TDM_OK && table->nrow > 0;
}

static bool read_body(const cpl_trials *t, const cpl_tried *tried, int body, cpl_table *table) {
  char name[256];
  return read_table(tried, cpl_record_body_file(t->settings.body[body].name[CPL_MBD], name, sizeof name), table);
}

/* What the particles say: speeds at which contacts began, how many there were.
 */
static void look_at_particles(cpl_tried *tried) {
  cpl_table dem;
  if (read_table(tried, "dem.csv", &dem)) {
    const double *speed = cpl_table_column(&dem, "particles.impact_speed", NULL);
    const double *count = cpl_table_column(&dem, "particles.count", NULL);
    for (int i = 0; speed && i < dem.nrow; i++)
      tried->speed = fmax(tried->speed, speed[i]);
    if (count) {
      tried->half = count[dem.nrow / 2];
      tried->last = count[dem.nrow - 1];
    }
  }
  cpl_table_free(&dem);
}

/* Velocity against the derivative of position, of all bodies along all axes
 * that carry a tenth of the motion. */
static double gap_of(const cpl_table *table, double interval) {
  static const char *const place[] = {"x", "y", "z"}, *const rate[] = {"vx", "vy", "vz"};
  double worst = NAN, spread[3] = {0}, most = 0;
  for (int a = 0; a < 3; a++) {
    const double *v = cpl_table_column(table, rate[a], NULL);
    double mean = 0;
    for (int i = 0; v && i < table->nrow; i++)
      mean += v[i] / table->nrow;
    for (int i = 0; v && i < table->nrow; i++)
      spread[a] += (v[i] - mean) * (v[i] - mean);
    most = fmax(most, spread[a]);
  }
  for (int a = 0; a < 3; a++)
    if (most > 0 && spread[a] > 0.01 * most)
      worst = fmax(worst, cpl_velocity_gap(cpl_table_column(table, place[a], NULL),
                                           cpl_table_column(table, rate[a], NULL), table->nrow - 1, interval));
  return worst; /* without the last row, which may be off the grid */
}

/* The largest change of the velocity over its time. */
static double acceleration_of(const cpl_table *table, double interval) {
  static const char *const rate[] = {"vx", "vy", "vz"};
  const double *v[3];
  double most = 0;
  for (int a = 0; a < 3; a++)
    v[a] = cpl_table_column(table, rate[a], NULL);
  for (int i = 1; i + 1 < table->nrow; i++) {
    double square = 0;
    for (int a = 0; a < 3; a++)
      square += v[a] ? (v[a][i] - v[a][i - 1]) * (v[a][i] - v[a][i - 1]) : 0;
    most = fmax(most, sqrt(square) / interval);
  }
  return most;
}

static void look_at_bodies(const cpl_trials *t, cpl_tried *tried) {
  tried->gap = NAN;
  for (int b = 0; b < t->settings.nbody; b++) {
    cpl_table table;
    if (read_body(t, tried, b, &table)) {
      tried->gap = fmax(tried->gap, gap_of(&table, tried->interval));
      tried->acceleration = fmax(tried->acceleration, acceleration_of(&table, tried->interval));
    }
    cpl_table_free(&table);
  }
}

/* Whether a run that came to its end is one to count: particles that leave make
 * runs cheap. */
static void doubt(cpl_tried *tried, const json_t *summary) {
  cpl_cell cell = {.name = ""};
  json_t *row = json_pack("{s:s, s:s}", "status", "ok", "reason", "");
  snprintf(cell.dir, sizeof cell.dir, "%.4000s", tried->dir);
  cpl_cell_doubt(&cell, row, summary);
  const char *status = json_string_value(json_object_get(row, "status"));
  tried->good = status && strcmp(status, "ok") == 0;
  snprintf(tried->reason, sizeof tried->reason, "%s", json_string_value(json_object_get(row, "reason")));
  json_decref(row);
}

static bool all_prescribed(const json_t *summary) {
  const char *name;
  json_t *body;
  bool all = true;
  json_object_foreach((json_t *)tdm_scene_value(summary, "error_estimate.bodies"), name, body) all =
      all && json_is_true(json_object_get(body, "prescribed"));
  return all;
}

static void take_cost(const cpl_trial *trial, cpl_tried *tried) {
  const cpl_run_result *r = &trial->run;
  const double steps = r->simulated / tried->of.dt;
  const double share = r->loop > 0 ? tried->processor / r->loop : 1;
  tried->simulated = r->simulated;
  tried->loop = r->loop;
  tried->mbd = r->step[CPL_MBD];
  tried->step = steps > 0 ? share * r->step[CPL_DEM] / steps : NAN;
  tried->length = r->windows > 0 ? r->simulated / (double)r->windows : NAN;
  tried->window = r->windows > 0 ? share * fmax(0, r->loop - r->step[CPL_DEM]) / (double)r->windows : NAN;
  tried->estimate = r->error_coupling;
  tried->prescribed = all_prescribed(trial->summary);
}

static void add_row(cpl_trials *t, const cpl_tried *tried) {
  const cpl_candidate *c = &tried->of;
  json_t *n = c->n == CPL_AUTO_N ? json_string("auto") : json_integer(c->n);
  json_array_append_new(
      t->rows, json_pack("{s:f, s:o, s:s, s:s, s:f, s:f, s:f, s:s, s:s, s:f, s:o, s:o}", "dt", c->dt, "n", n, "scheme",
                         c->scheme, "formulation", cpl_formulation_words[c->formulation], "tolerance", c->tolerance,
                         "simulated_s", tried->simulated, "processor_s", tried->processor, "status",
                         tried->good ? "ok" : "failed", "reason", tried->reason, "loop_s", tried->loop, "velocity_gap",
                         tdm_number_to_json(tried->gap), "estimate", tdm_number_to_json(tried->estimate)));
}

static tdm_status run_in(cpl_trials *t, run_settings *s, double end, cpl_tried *tried, tdm_error *err) {
  cpl_trial trial;
  cpl_trial_options o = {
      .scene = t->scene, .set = s->set, .dir = tried->dir, .bed = shares_bed(t) ? t->bed : NULL, .end = end};
  memcpy(o.solver, t->solver, sizeof o.solver);
  const double before = processor_time();
  if (cpl_trial_run(&o, &trial, err) == TDM_OK) {
    const double took = processor_time() - before;
    tried->processor = fmax(took - t->start, 0.1 * took);
    take_cost(&trial, tried);
    look_at_particles(tried);
    look_at_bodies(t, tried);
    if (trial.status == TDM_OK)
      doubt(tried, trial.summary);
    else
      snprintf(tried->reason, sizeof tried->reason, "%s", trial.reason);
    add_row(t, tried);
  }
  cpl_trial_free(&trial);
  t->spent += processor_time() - before;
  return err->status;
}

tdm_status cpl_trials_run(cpl_trials *t, const cpl_candidate *of, double end, double interval, bool round_off,
                          cpl_tried *tried, tdm_error *err) {
  run_settings s;
  *tried = (cpl_tried){.of = *of, .interval = interval > 0 ? interval : t->settings.output_interval};
  snprintf(tried->dir, sizeof tried->dir, "%s/trial_%02d", t->dir, t->ntrial);
  if (settings_make(t, of, &s, err) != TDM_OK)
    return err->status;
  snprintf(s.more[0], CPL_SETTING_LENGTH, "output.interval=%.15g", tried->interval);
  s.set[s.n++] = s.more[0];
  if (round_off && round_off_setting(t, s.more[1]))
    s.set[s.n++] = s.more[1];
  t->ntrial++;
  run_in(t, &s, end, tried, err);
  free(s.set);
  return err->status;
}

/* ---- trials against each other ---- */

/* The smallest radius of sizes: a number, a range, or a distribution by its list, its least or its mean. */
static double least_of(const json_t *radius) {
  static const char *const keys[] = {"radii", "min", "mean"};
  double least = json_is_number(radius) ? json_number_value(radius) : INFINITY;
  for (size_t i = 0; i < json_array_size(radius); i++)
    least = fmin(least, least_of(json_array_get(radius, i)));
  for (int k = 0; k < 3 && isinf(least); k++)
    if (json_object_get(radius, keys[k]))
      least = least_of(json_object_get(radius, keys[k]));
  return least;
}

double cpl_trials_smallest(const cpl_trials *t) {
  static const char *const lists[] = {"dem.particles", "dem.sources"};
  double least = INFINITY;
  for (int k = 0; k < 2 && !cpl_is_foreign(t->loaded.root, CPL_DEM); k++) {
    const json_t *list = tdm_scene_value(t->loaded.root, lists[k]);
    for (size_t i = 0; i < json_array_size(list); i++)
      least = fmin(least, least_of(json_object_get(json_array_get(list, i), "radius")));
  }
  return least;
}

/* The larger share of one body's position and velocity, in which turns count by the way at radius r [m]. */
static double apart_of(const cpl_apart_runs *d, const cpl_apart_runs *c, double r) {
  static const int way[] = {CPL_POSITION, CPL_VELOCITY}, turn[] = {CPL_ANGLE, CPL_ANGULAR_VELOCITY};
  double worst = 0;
  for (int k = 0; k < 2; k++) {
    const double apart = hypot(d->rms[way[k]], r * d->rms[turn[k]]);
    const double spread = hypot(d->spread[way[k]], r * d->spread[turn[k]]);
    const double above = c ? 2 * hypot(c->rms[way[k]], r * c->rms[turn[k]]) : 0;
    if (spread > 1e-9 && apart > above)
      worst = fmax(worst, apart / spread);
  }
  return worst;
}

/* Of one body, over the time that both have; false: too few rows. */
static bool compare(const cpl_tried *a, const cpl_tried *b, const char *body, cpl_apart_runs *out) {
  const double end = fmin(a->simulated, b->simulated) * (1 + 1e-9);
  return cpl_trial_compare(a->dir, b->dir, body, end, out, &(tdm_error){0}) == TDM_OK && out->nrow >= 5;
}

/* The spread of a body over the whole of a trial, where that is more: a body that a stream pushes has hardly moved in
 * the time that a run with n = 1 takes of the budget. */
static void widen(const cpl_tried *a, const char *body, cpl_apart_runs *d) {
  cpl_apart_runs whole;
  if (compare(a, a, body, &whole))
    for (int k = 0; k < CPL_QUANTITIES; k++)
      d->spread[k] = fmax(d->spread[k], whole.spread[k]);
}

double cpl_trials_apart(const cpl_trials *t, const cpl_tried *a, const cpl_tried *b, const cpl_tried twins[2]) {
  double worst = NAN;
  for (int i = 0; i < t->settings.nbody && !a->prescribed; i++) {
    const char *body = t->settings.body[i].name[CPL_MBD];
    cpl_apart_runs d, c;
    if (!compare(a, b, body, &d))
      continue;
    widen(a, body, &d);
    const bool known = twins && compare(&twins[0], &twins[1], body, &c);
    worst = fmax(worst, apart_of(&d, known ? &c : NULL, t->radius ? t->radius[i] : 1));
  }
  return worst;
}

static double variance(const double *f, int n) {
  double mean = 0, square = 0;
  for (int i = 0; i < n; i++)
    mean += f[i] / n;
  for (int i = 0; i < n; i++)
    square += (f[i] - mean) * (f[i] - mean) / n;
  return square;
}

/* Of the axis along which the load of a body varies most. Rows are means since
 * the row before: the first is none. */
static double erratic_of(const cpl_table *table, int width) {
  static const char *const load[] = {"fx", "fy", "fz"};
  double most = -1, ratio = NAN;
  for (int a = 0; a < 3 && table->nrow > 2; a++) {
    const double *f = cpl_table_column(table, load[a], NULL), v = f ? variance(f + 1, table->nrow - 2) : -1;
    if (v > most) {
      most = v;
      ratio = cpl_variance_ratio(f + 1, table->nrow - 2, width);
    }
  }
  return ratio;
}

double cpl_trials_erratic(const cpl_trials *t, const cpl_tried *tried, double window) {
  const int width = (int)lround(fmax(window, 4 * tried->interval) / tried->interval);
  double worst = NAN;
  for (int b = 0; b < t->settings.nbody; b++) {
    cpl_table table;
    if (read_body(t, tried, b, &table))
      worst = fmax(worst, erratic_of(&table, width));
    cpl_table_free(&table);
  }
  return worst;
}
