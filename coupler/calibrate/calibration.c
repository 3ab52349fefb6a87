/* `tandem calibrate` from its options to what it delivers: see calibrate.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/calibrate/calibration.h"

#include "protocol/parameters/load.h"
#include "protocol/parameters/rewrite.h"

#include <stdlib.h>
#include <string.h>

const double cpl_calibrate_tolerance = 0.005;

/* ---- parameters ---- */

/* The nearest key of the object in which a path stops to be there: "dem.pairs[0].friction"; "" if there is none.
 * Returns that object, NULL: there is none. */
static const json_t *nearest_path(const json_t *root, const char *path, char out[TDM_PATH_MAX]) {
  char stem[TDM_PATH_MAX];
  const char *known[128], *key, *last = strrchr(path, '.');
  json_t *value;
  int n = 0;
  out[0] = 0;
  if (!last)
    return NULL;
  snprintf(stem, sizeof stem, "%.*s", (int)(last - path), path);
  const json_t *parent = tdm_scene_value(root, stem);
  json_object_foreach((json_t *)parent, key, value) if (n < 128) known[n++] = key;
  const char *near = tdm_nearest(last + 1, known, n);
  if (near)
    snprintf(out, TDM_PATH_MAX, "%.120s.%.120s", stem, near);
  return json_is_object(parent) ? parent : NULL;
}

/* A path without a value: a key that may be added to what is there, unless it looks like a slip. Parameters of the
 * scene are the user's own: nothing would use a new one. */
static tdm_status read_new(cpl_parameter *p, const tdm_scene *scene, tdm_error *err) {
  char near[TDM_PATH_MAX];
  const json_t *parent = nearest_path(scene->written, p->path, near);
  p->new = parent && !*near && !strchr(p->name, '[') && strncmp(p->path, "parameters.", strlen("parameters.")) != 0;
  return p->new ? TDM_OK
                : tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
                           "%s: --parameter %s: the scene has no value there%s%s%s; write one into it, or add --set "
                           "%s=VALUE",
                           scene->file, p->path, *near ? "; did you mean " : "", near, *near ? "?" : "", p->path);
}

/* The number that the scene has at a path, if any. */
static tdm_status read_start(cpl_parameter *p, const tdm_scene *scene, double *start, tdm_error *err) {
  const json_t *written = tdm_scene_value(scene->written, p->path);
  if (!written)
    return read_new(p, scene, err);
  if (json_is_string(written) && *json_string_value(written) == '=')
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
                    "%s: --parameter %s: is the expression \"%s\" there; calibrate what it is made of "
                    "(--parameter parameters.NAME)",
                    scene->file, p->path, json_string_value(written));
  if (!json_is_number(written)) {
    char *text = json_dumps(written, JSON_ENCODE_ANY | JSON_COMPACT);
    tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s: --parameter %s: is %.100s there; name the path of a number", scene->file,
             p->path, text ? text : "no number");
    free(text);
    return err->status;
  }
  *start = json_number_value(written);
  return TDM_OK;
}

static tdm_status read_number(const char *word, const char *path, double *out, tdm_error *err) {
  char *end;
  *out = strtod(word, &end);
  return *word && !*end && isfinite(*out)
             ? TDM_OK
             : tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "calibrate: --range of %s: \"%s\" is no number", path, word);
}

static tdm_status read_range(cpl_parameter *p, const char *const *word, tdm_error *err) {
  if (read_number(word[0], p->path, &p->from, err) != TDM_OK || read_number(word[1], p->path, &p->to, err) != TDM_OK)
    return err->status;
  if (!(p->from < p->to))
    tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "calibrate: --range of %s: %s is not below %s; give the lower end first",
             p->path, word[0], word[1]);
  else if (p->log && !(p->from > 0))
    tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "calibrate: --log %s: its range begins at %s; give one above 0", p->path,
             word[0]);
  return err->status;
}

static tdm_status read_parameter(cpl_calibration *c, int k, const tdm_scene *scene, tdm_error *err) {
  const cpl_calibrate_options *o = c->o;
  cpl_parameter *p = &c->parameter[k];
  double start = NAN;
  if (strlen(o->parameter[k]) >= sizeof p->path)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "calibrate: --parameter %.80s...: too long", o->parameter[k]);
  snprintf(p->path, sizeof p->path, "%s", o->parameter[k]);
  p->name = strrchr(p->path, '.') ? strrchr(p->path, '.') + 1 : p->path;
  p->sensitivity = p->percent = p->scatter = p->error = NAN;
  for (int i = 0; i < k; i++)
    if (strcmp(c->parameter[i].path, p->path) == 0)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "calibrate: --parameter %s is given twice", p->path);
  for (int i = 0; i < o->nlog; i++)
    p->log = p->log || strcmp(o->log[i], p->path) == 0;
  if (read_range(p, o->range + 2 * k, err) != TDM_OK || read_start(p, scene, &start, err) != TDM_OK)
    return err->status;
  p->start = start >= p->from && start <= p->to ? start : cpl_value_at(p, 0.5);
  return TDM_OK;
}

/* --log names parameters, --repeat does not. */
static tdm_status check_others(const cpl_calibration *c, tdm_error *err) {
  const cpl_calibrate_options *o = c->o;
  for (int k = 0; k < c->nparameter; k++)
    if (strcmp(o->repeat.path, c->parameter[k].path) == 0)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "calibrate: --repeat %s is a --parameter, too; repeat with seeds",
                      o->repeat.path);
  for (int i = 0; i < o->nlog; i++) {
    bool found = false;
    for (int k = 0; k < c->nparameter; k++)
      found = found || strcmp(o->log[i], c->parameter[k].path) == 0;
    if (!found)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "calibrate: --log %s is no --parameter; the first one is %s",
                      o->log[i], c->parameter[0].path);
  }
  return TDM_OK;
}

static tdm_status read_parameters(cpl_calibration *c, tdm_error *err) {
  const cpl_calibrate_options *o = c->o;
  tdm_scene scene = {0};
  if (o->nparameter < 1 || o->nparameter > CPL_PARAMETERS)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "calibrate: %d --parameter; give one to %d, each with its --range",
                    o->nparameter, CPL_PARAMETERS);
  if (o->nrange != o->nparameter)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
                    "calibrate: %d --parameter, but %d --range; give each parameter a range FROM TO, in their order",
                    o->nparameter, o->nrange);
  tdm_scene_load(&scene, o->scene, o->set, err);
  tdm_scene_locate(&scene, err);
  for (int k = 0; k < o->nparameter && err->status == TDM_OK; k++) {
    read_parameter(c, k, &scene, err);
    c->nparameter = k + 1;
  }
  tdm_scene_destroy(&scene);
  return err->status == TDM_OK ? check_others(c, err) : err->status;
}

/* ---- targets ---- */

static bool is_number(const char *word) {
  char *end;
  strtod(word, &end);
  return *word && !*end;
}

static tdm_status read_targets(cpl_calibration *c, tdm_error *err) {
  const cpl_calibrate_options *o = c->o;
  int measure = 0;
  if (o->ntarget < 1 || o->ntarget > CPL_TARGETS)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
                    "calibrate: %d --target; give 1 to %d: CSV files of curves, or numbers for --measure", o->ntarget,
                    CPL_TARGETS);
  for (int k = 0; k < o->ntarget && err->status == TDM_OK; k++) {
    const char *of = NULL;
    if (is_number(o->target[k]) && measure == o->nmeasure)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
                      "calibrate: --target %s: a number needs its --measure PATH|CHANNEL; a file of that name is ./%s",
                      o->target[k], o->target[k]);
    if (is_number(o->target[k]))
      of = o->measure[measure++];
    if (of && strlen(of) >= sizeof c->target[k].name)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "calibrate: --measure %.80s...: too long", of);
    cpl_target_read(&c->target[c->ntarget++], o->target[k], of, err);
    c->nrow += c->target[k].n;
  }
  if (err->status == TDM_OK && measure < o->nmeasure)
    tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
             "calibrate: --measure %s has no number to be compared with; give it as --target VALUE (a curve's file "
             "names its channels itself)",
             o->measure[measure]);
  return err->status;
}

/* ---- all of it ---- */

/* The scene with the user's settings and the best values. */
static tdm_status write_scene(const cpl_calibration *c, tdm_error *err) {
  char best[CPL_PARAMETERS][TDM_PATH_MAX + 40];
  int n = 0;
  while (c->o->set && c->o->set[n])
    n++;
  const char **set = calloc((size_t)n + CPL_PARAMETERS + 1, sizeof *set);
  if (!set)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int i = 0; i < n; i++)
    set[i] = c->o->set[i];
  for (int k = 0; k < c->nparameter; k++) {
    snprintf(best[k], sizeof best[k], "%s=%.9g", c->parameter[k].path, c->tried[c->best].value[k]);
    set[n + k] = best[k];
  }
  tdm_scene_rewrite(c->o->scene, set, c->o->write, err);
  free(set);
  return err->status;
}

/* What was found, also before an interruption. */
static tdm_status deliver(cpl_calibration *c, tdm_error *err) {
  tdm_error late = {0}, plot = {0};
  cpl_calibration_write(c, c->o->json, &late);
  cpl_calibration_print(c);
  if (c->best >= 0 && c->ending != CPL_INTERRUPTED && cpl_calibration_plot(c, &plot) != TDM_OK)
    fprintf(stderr, "tandem: notice: %s\n", plot.message);
  if (c->best >= 0 && c->o->write && c->ending != CPL_INTERRUPTED && write_scene(c, &late) == TDM_OK)
    printf("%s: the scene with these values\n", c->o->write);
  printf("calibration.json, calibration.csv, plots and the runs' directories in %s\n", c->o->out);
  if (late.status != TDM_OK)
    tdm_fail(err, late.status, NULL, "%s", late.message);
  return err->status;
}

static tdm_status calibrate(cpl_calibration *c, tdm_error *err) {
  char words[768];
  cpl_search(c, err);
  if (err->status == TDM_OK && c->best >= 0 && c->ending != CPL_FLAT)
    cpl_determine(c, err);
  if (err->status == TDM_ERR_INTERRUPTED)
    c->ending = CPL_INTERRUPTED;
  else if (err->status != TDM_OK)
    return err->status; /* options or targets that cannot be */
  if (err->status == TDM_OK && c->ending == CPL_FAILED)
    tdm_fail(err, TDM_ERR_NUMERIC, NULL, "%s", cpl_ending_words(c, words, sizeof words));
  deliver(c, err);
  if (err->status == TDM_ERR_INTERRUPTED)
    snprintf(err->message, sizeof err->message, "%s", cpl_ending_words(c, words, sizeof words));
  return err->status;
}

tdm_status cpl_calibrate(const cpl_calibrate_options *o, tdm_error *err) {
  tdm_results results;
  cpl_calibration *c = calloc(1, sizeof *c);
  if (!c)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  *c = (cpl_calibration){.o = o, .results = &results, .nseed = 1, .best = -1, .ending = CPL_RUNNING, .noise = NAN};
  for (int a = 0; a < CPL_PARAMETERS; a++)
    for (int b = 0; b < CPL_PARAMETERS; b++)
      c->correlation[a][b] = NAN;
  const tdm_results_def def = {.dir = o->out,
                               .scene = o->scene,
                               .force = o->force,
                               .beside = o->resume,
                               .instead = "go on with it with --resume, "};
  if (read_parameters(c, err) == TDM_OK && read_targets(c, err) == TDM_OK && cpl_check_study(c, err) == TDM_OK &&
      tdm_check_writable(o->json, err) == TDM_OK && tdm_check_writable(o->write, err) == TDM_OK &&
      tdm_results_open(&results, &def, err) == TDM_OK) {
    if (tdm_results_start(&results, err) == TDM_OK)
      calibrate(c, err);
    tdm_results_close(&results);
  }
  for (int k = 0; k < c->ntarget; k++)
    cpl_target_free(&c->target[k]);
  cpl_tries_free(c);
  free(c);
  return err->status;
}
