/* Tries: places, their runs and how far they are off. See calibration.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/calibrate/calibration.h"

#include "protocol/math/hash.h"

#include <stdlib.h>
#include <string.h>

/* ---- places and values ---- */

/* A place of the mirrored axis, in [0, 1]. */
static double folded(double place) {
  const double share = fabs(fmod(place, 2));
  return share <= 1 ? share : 2 - share;
}

double cpl_value_at(const cpl_parameter *p, double place) {
  const double u = folded(place);
  char text[32];
  const double value = p->log ? p->from * pow(p->to / p->from, u) : p->from + u * (p->to - p->from);
  snprintf(text, sizeof text, "%.9g", value); /* what names and scenes show is what runs */
  return fmax(p->from, fmin(p->to, strtod(text, NULL)));
}

double cpl_place_of(const cpl_parameter *p, double value) {
  return p->log ? log(value / p->from) / log(p->to / p->from) : (value - p->from) / (p->to - p->from);
}

/* ---- new tries ---- */

/* "friction=0.3 density=2500"; what is too long for a name has a hash. */
static void label_of(const cpl_calibration *c, const double *value, char out[CPL_STUDY_NAME]) {
  char text[CPL_PARAMETERS * (TDM_PATH_MAX + 32)] = "";
  for (int k = 0; k < c->nparameter; k++) {
    const size_t n = strlen(text);
    snprintf(text + n, sizeof text - n, "%s%s=%.9g", n ? " " : "", c->parameter[k].name, value[k]);
  }
  if (strlen(text) < CPL_STUDY_NAME)
    snprintf(out, CPL_STUDY_NAME, "%s", text);
  else
    snprintf(out, CPL_STUDY_NAME, "%.60s... %016llx", text,
             (unsigned long long)tdm_hash_bytes(TDM_HASH_START, text, strlen(text)));
  tdm_utf8_clean(out);
}

static cpl_try new_try(const cpl_calibration *c, const double *place, bool aside) {
  cpl_try new = {.misfit = NAN, .aside = aside};
  for (int k = 0; k < c->nparameter; k++) {
    new.place[k] = folded(place[k]);
    new.value[k] = cpl_value_at(&c->parameter[k], place[k]);
  }
  return new;
}

int cpl_try_find(const cpl_calibration *c, const double *place) {
  const cpl_try new = new_try(c, place, false);
  for (int i = 0; i < c->ntry; i++)
    if (memcmp(c->tried[i].value, new.value, sizeof new.value) == 0)
      return i;
  return -1;
}

/* The try of a place, made if there is none; -1 and an error without memory. */
static int try_of(cpl_calibration *c, const double *place, bool aside, tdm_error *err) {
  cpl_try new = new_try(c, place, aside);
  const int known = cpl_try_find(c, place);
  if (known >= 0)
    return known;
  if (c->ntry == c->room) {
    const int room = 2 * c->room + 16;
    cpl_try *larger = realloc(c->tried, (size_t)room * sizeof *larger);
    if (!larger) {
      tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
      return -1;
    }
    c->tried = larger;
    c->room = room;
  }
  label_of(c, new.value, new.label);
  c->tried[c->ntry] = new;
  return c->ntry++;
}

void cpl_tries_free(cpl_calibration *c) {
  for (int i = 0; i < c->ntry; i++) {
    free(c->tried[i].row);
    free(c->tried[i].variance);
  }
  free(c->tried);
  c->tried = NULL;
  c->ntry = c->room = 0;
}

/* ---- their runs ---- */

/* The settings of all runs as a study's "set" (new reference): paths of tries may lie in what they bring. */
static json_t *settings_json(const cpl_calibration *c) {
  json_t *set = json_object();
  for (const char *const *s = c->o->set; s && *s; s++) {
    const char *is = strchr(*s, '=');
    json_t *value = is ? json_loads(is + 1, JSON_DECODE_ANY, NULL) : NULL;
    if (is)
      json_object_setn_new(set, *s, (size_t)(is - *s), value ? value : json_string(is + 1));
  }
  return set;
}

/* Tries `which` (n of them; 0: the scene as it is) as the cases of a study (new reference). */
static json_t *study_json(const cpl_calibration *c, const int *which, int n) {
  json_t *cells = json_array(), *measures = json_array(), *curves = json_array();
  for (int i = 0; i < n; i++) {
    const cpl_try *t = &c->tried[which[i]];
    json_t *set = json_object();
    for (int k = 0; k < c->nparameter; k++)
      json_object_set_new(set, c->parameter[k].path, json_real(t->value[k]));
    json_array_append_new(cells, json_pack("{s:s, s:o}", "label", t->label, "set", set));
  }
  for (int k = 0; k < c->ntarget; k++)
    cpl_target_enter(&c->target[k], k, measures, curves);
  json_t *study = json_pack("{s:s, s:o}", "scene", c->o->scene, "set", settings_json(c));
  if (n > 0)
    json_object_set(study, "cells", cells);
  if (json_array_size(measures) > 0)
    json_object_set(study, "measures", measures);
  if (json_array_size(curves) > 0)
    json_object_set(study, "curves", curves);
  if (c->o->repeat.nvalue > 0)
    json_object_set_new(study, "seeds", cpl_axis_to_json(&c->o->repeat));
  json_decref(cells);
  json_decref(measures);
  json_decref(curves);
  return study;
}

tdm_status cpl_check_study(const cpl_calibration *c, tdm_error *err) {
  cpl_study study = {0};
  json_t *json = study_json(c, NULL, 0);
  cpl_study_read_json(&study, json, err);
  cpl_study_free(&study);
  json_decref(json);
  return err->status;
}

/* Run them; those that are there already are kept if `resume`. The caller frees the study. */
static tdm_status run_tries(cpl_calibration *c, const int *which, int n, bool resume, cpl_study *study,
                            tdm_error *err) {
  const cpl_calibrate_options *o = c->o;
  cpl_study_options options = {
      .out = o->out, .jobs = o->jobs, .resume = resume, .quiet = true, .scenarios = o->scenarios, .set = o->set};
  memcpy(options.solver, o->solver, sizeof options.solver);
  json_t *json = study_json(c, which, n);
  if (cpl_study_read_json(study, json, err) == TDM_OK)
    cpl_study_run(study, &options, err);
  json_decref(json);
  return err->status;
}

/* ---- how far they are off ---- */

/* The run came to its end, whatever happened in it. */
static bool is_whole(const cpl_cell *run) {
  json_t *summary = run && run->row ? tdm_results_read(run->dir, "summary.json", &(tdm_error){0}) : NULL;
  const char *status = json_string_value(json_object_get(summary, "status"));
  const bool whole = status && strcmp(status, tdm_status_name(TDM_OK)) == 0;
  json_decref(summary);
  return whole;
}

/* The values of one run into out (nrow). */
static tdm_status run_values(const cpl_calibration *c, const cpl_study *study, int cell, int seed, double *out,
                             double *covered, tdm_error *err) {
  const cpl_cell *run = cpl_study_run_of(study, cell, seed);
  const char *reason = json_string_value(json_object_get(run->row, "reason"));
  if (!is_whole(run))
    return tdm_fail(err, TDM_ERR_NUMERIC, NULL, "%s", reason && *reason ? reason : "the run did not come to its end");
  *covered = 1;
  for (int k = 0, measure = 0; k < c->ntarget && err->status == TDM_OK; k++) {
    const cpl_target *t = &c->target[k];
    double reached = 0;
    const double number = t->file ? NAN : cpl_study_value_of(study, cell, seed, measure++);
    cpl_target_values(t, k, study, run, number, out, &reached, err);
    *covered = fmin(*covered, reached);
    out += t->n;
  }
  return err->status;
}

/* The mean of the seeds' values (nseed x nrow) and its variance. */
static void take_mean(cpl_try *t, const double *values, int nseed, int nrow) {
  for (int i = 0; i < nrow; i++) {
    double mean = 0, squares = 0;
    for (int s = 0; s < nseed; s++)
      mean += values[s * nrow + i] / nseed;
    for (int s = 0; s < nseed; s++)
      squares += (values[s * nrow + i] - mean) * (values[s * nrow + i] - mean);
    t->row[i] = mean;
    if (t->variance)
      t->variance[i] = squares / (nseed - 1) / nseed;
  }
}

static double misfit_of(const cpl_calibration *c, const double *row) {
  double sum = 0;
  for (int k = 0; k < c->ntarget; k++) {
    const cpl_target *t = &c->target[k];
    for (int i = 0; i < t->n; i++, row++)
      sum += pow((*row - t->y[i]) / t->scale, 2) / t->n / c->ntarget;
  }
  return sqrt(sum);
}

/* Its values, if all of its runs have them. */
static tdm_status judge(cpl_calibration *c, const cpl_study *study, int cell, cpl_try *t, tdm_error *err) {
  const size_t nrow = (size_t)c->nrow, nseed = (size_t)study->nseed;
  double *values = malloc(nseed * nrow * sizeof *values);
  tdm_error wrong = {0};
  t->row = malloc(nrow * sizeof *t->row);
  t->variance = nseed > 1 ? malloc(nrow * sizeof *t->variance) : NULL;
  if (!values || !t->row || (nseed > 1 && !t->variance)) {
    free(values);
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  }
  t->covered = 1;
  for (int s = 0; s < study->nseed && wrong.status == TDM_OK; s++) {
    double covered = 0;
    run_values(c, study, cell, s, values + (size_t)s * nrow, &covered, &wrong);
    t->covered = fmin(t->covered, covered);
  }
  if (wrong.status == TDM_OK) {
    take_mean(t, values, study->nseed, c->nrow);
    t->misfit = misfit_of(c, t->row);
  }
  if (!isfinite(t->misfit)) {
    snprintf(t->reason, sizeof t->reason, "%.250s", wrong.status ? wrong.message : "the misfit is not finite");
    tdm_utf8_clean(t->reason);
    t->misfit = NAN;
    free(t->row);
    free(t->variance);
    t->row = t->variance = NULL;
  }
  free(values);
  return err->status;
}

/* The first run that came to its end shows whether runs have what the targets name. */
static tdm_status look_for_targets(cpl_calibration *c, const cpl_study *study, tdm_error *err) {
  for (int i = 0; i < study->cells.ncell && !c->known; i++)
    if (is_whole(&study->cells.cell[i])) {
      for (int k = 0; k < c->ntarget && err->status == TDM_OK; k++)
        cpl_target_known(&c->target[k], &study->cells.cell[i], err);
      c->known = err->status == TDM_OK;
      return err->status;
    }
  return TDM_OK;
}

static tdm_status take_tries(cpl_calibration *c, const cpl_study *study, const int *which, int n, tdm_error *err) {
  if (look_for_targets(c, study, err) != TDM_OK)
    return err->status;
  for (int i = 0; i < n && err->status == TDM_OK; i++) {
    cpl_try *t = &c->tried[which[i]];
    const char *status = cpl_study_status(study, i);
    snprintf(t->status, sizeof t->status, "%s", status ? status : "not run");
    for (int s = 0; s < study->nseed; s++)
      t->wall += json_number_value(json_object_get(cpl_study_run_of(study, i, s)->row, "wall_s"));
    judge(c, study, i, t, err);
    if (!t->aside && !isnan(t->misfit) && (c->best < 0 || t->misfit < c->tried[c->best].misfit))
      c->best = which[i];
    cpl_tell_try(c, which[i]);
  }
  return err->status;
}

tdm_status cpl_try_all(cpl_calibration *c, int n, double (*place)[CPL_PARAMETERS], bool aside, int *which,
                       tdm_error *err) {
  int new[64], nnew = 0;
  for (int i = 0; i < n && err->status == TDM_OK; i++) {
    const int before = c->ntry;
    which[i] = try_of(c, place[i], aside, err);
    if (c->ntry > before)
      new[nnew++] = which[i];
  }
  if (err->status != TDM_OK || nnew == 0)
    return err->status;
  cpl_study study = {0};
  if (run_tries(c, new, nnew, c->o->resume, &study, err) == TDM_OK) {
    c->nseed = study.nseed;
    take_tries(c, &study, new, nnew, err);
  }
  cpl_study_free(&study);
  if (err->status != TDM_OK) /* as if they had not been tried */
    while (c->ntry > 0 && !c->tried[c->ntry - 1].status[0])
      c->ntry--;
  tdm_error late = {0};
  if (cpl_calibration_write(c, NULL, &late) != TDM_OK)
    tdm_fail(err, late.status, NULL, "%s", late.message);
  return err->status;
}

tdm_status cpl_try_again(cpl_calibration *c, int which, cpl_study *study, tdm_error *err) {
  return run_tries(c, &which, 1, true, study, err);
}
