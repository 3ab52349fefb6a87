/* The cells of a study, and running them: see study.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/study/study.h"

#include <stdlib.h>
#include <string.h>

/* ---- cells ---- */

const cpl_level *cpl_study_level(const cpl_study *study, int cell, int factor) {
  for (int f = study->nfactor - 1; f > factor; f--)
    cell /= study->factor[f].nlevel;
  const cpl_factor *f = &study->factor[factor];
  return &f->level[cell % f->nlevel];
}

/* "rpm=50", or a case's label, behind what is there. */
static void add_name(char *out, size_t size, const cpl_factor *f, const cpl_level *level) {
  const char *last = strrchr(f->path, '.') ? strrchr(f->path, '.') + 1 : f->path;
  size_t n = strlen(out);
  snprintf(out + n, size - n, "%s%s%s%s", n ? " " : "", last, f->path[0] ? "=" : "", level->label);
}

const char *cpl_study_cell_name(const cpl_study *study, int cell, char *out, size_t size) {
  out[0] = 0;
  for (int f = 0; f < study->nfactor; f++)
    add_name(out, size, &study->factor[f], cpl_study_level(study, cell, f));
  if (!out[0])
    snprintf(out, size, "scene"); /* repeated only */
  return out;
}

int cpl_study_find_cell(const cpl_study *study, const char *name, tdm_error *err) {
  char text[512], nearest[512] = "";
  for (int cell = 0; cell < study->ncell; cell++) {
    if (strcmp(cpl_study_cell_name(study, cell, text, sizeof text), name) == 0)
      return cell;
    if (!nearest[0] && tdm_nearest(name, (const char *const[]){text}, 1))
      memcpy(nearest, text, sizeof nearest);
  }
  tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "the study has no cell \"%s\"; %s%s", name,
           nearest[0] ? "did you mean " : "cells are named as ",
           nearest[0] ? nearest : cpl_study_cell_name(study, 0, text, sizeof text));
  return -1;
}

int cpl_study_find_measure(const cpl_study *study, const char *name, tdm_error *err) {
  const char *known[128];
  int n = 0;
  for (; n < study->nmeasure && n < 128; n++) {
    known[n] = study->measure[n].name;
    if (strcmp(known[n], name) == 0)
      return n;
  }
  const char *near = tdm_nearest(name, known, n);
  tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "the study has no measure \"%s\"; %s%s", name,
           near ? "did you mean " : "one of its names is ", near ? near : known[0]);
  return -1;
}

const cpl_cell *cpl_study_run_of(const cpl_study *study, int cell, int seed) {
  const int i = study->run ? study->run[cell * study->nseed + seed] : -1;
  return i < 0 ? NULL : &study->cells.cell[i];
}

bool cpl_study_has_seed(const cpl_study *study, int seed) {
  bool found = false;
  for (int cell = 0; cell < study->ncell; cell++)
    found = found || cpl_study_run_of(study, cell, seed);
  return found;
}

const char *cpl_study_status(const cpl_study *study, int cell) {
  const char *status = NULL;
  for (int s = 0; s < study->nseed; s++) {
    const cpl_cell *run = cpl_study_run_of(study, cell, s);
    const char *one = run ? json_string_value(json_object_get(run->row, "status")) : NULL;
    if (one && (!status || strcmp(status, "ok") == 0))
      status = one;
  }
  return status;
}

/* ---- runs ---- */

static void add_settings(cpl_cell *run, const json_t *set, tdm_error *err) {
  const char *path;
  json_t *value;
  json_object_foreach((json_t *)set, path, value) {
    char *text = json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT);
    if (text)
      cpl_cell_set(run, path, text, err);
    else
      tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    free(text);
  }
}

/* Settings of the command line: "path=value". */
static void add_further(cpl_cell *run, const char *const *set, tdm_error *err) {
  for (; set && *set && err->status == TDM_OK; set++) {
    char path[TDM_PATH_MAX];
    const char *equals = strchr(*set, '=');
    if (!equals || equals == *set || (size_t)(equals - *set) >= sizeof path || run->nset >= CPL_CELL_SETTINGS - 12)
      tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "--set %s: %s", *set,
               equals ? "too long, or one too many" : "write PATH=VALUE");
    else {
      snprintf(path, sizeof path, "%.*s", (int)(equals - *set), *set);
      cpl_cell_set(run, path, equals + 1, err);
    }
  }
}

/* The run of a cell with a seed: its scene, settings and name. */
static void fill_run(const cpl_study *study, const cpl_study_options *o, int cell, int seed, tdm_error *err) {
  cpl_cell *run = &study->cells.cell[study->run[cell * study->nseed + seed]];
  char name[512];
  run->scene = study->scene;
  add_settings(run, study->set, err);
  add_further(run, o->set, err);
  cpl_study_cell_name(study, cell, name, sizeof name);
  for (int f = 0; f < study->nfactor; f++) {
    const cpl_level *level = cpl_study_level(study, cell, f);
    run->scene = level->scene ? level->scene : run->scene;
    add_settings(run, level->set, err);
  }
  if (study->seeds.nlevel > 0) {
    add_settings(run, study->seeds.level[seed].set, err);
    add_name(name, sizeof name, &study->seeds, &study->seeds.level[seed]);
  }
  cpl_cell_place(&study->cells, run, name, study->nfactor + (study->seeds.nlevel > 0));
}

/* Whether a name is in the list; one that is not there has all. */
static bool listed(const char *const *list, const char *name) {
  bool found = !list;
  for (; list && *list; list++)
    found = found || strcmp(*list, name) == 0;
  return found;
}

/* Number the wanted runs; returns how many there are. */
static int choose_runs(cpl_study *study, const cpl_study_options *o) {
  char name[512];
  int n = 0;
  for (int cell = 0; cell < study->ncell; cell++) {
    const bool wanted = listed(o->only, cpl_study_cell_name(study, cell, name, sizeof name));
    for (int seed = 0; seed < study->nseed; seed++)
      study->run[cell * study->nseed + seed] =
          wanted && (!o->seeds || listed(o->seeds, study->seeds.level[seed].label)) ? n++ : -1;
  }
  return n;
}

tdm_status cpl_study_check(const cpl_study *study, const cpl_study_options *o, tdm_error *err) {
  const cpl_factor *seeds = &study->seeds;
  char has[256] = "";
  for (const char *const *only = o->only; only && *only; only++)
    cpl_study_find_cell(study, *only, err);
  for (int s = 0; s < seeds->nlevel && strlen(has) < sizeof has - 1; s++)
    snprintf(has + strlen(has), sizeof has - strlen(has), "%s%s", s ? ", " : "", seeds->level[s].label);
  for (const char *const *seed = o->seeds; seed && *seed; seed++) {
    bool found = false;
    for (int s = 0; s < seeds->nlevel; s++)
      found = found || strcmp(seeds->level[s].label, *seed) == 0;
    if (!found)
      tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "the study has no seed \"%s\"; %s%s", *seed,
               seeds->nlevel > 0 ? "its seeds are " : "it repeats nothing", has);
  }
  return err->status;
}

static tdm_status fill_runs(cpl_study *study, const cpl_study_options *o, tdm_error *err) {
  if (cpl_study_check(study, o, err) != TDM_OK)
    return err->status;
  cpl_cells_free(&study->cells);
  free(study->run);
  study->run = calloc((size_t)(study->ncell * study->nseed) + 1, sizeof *study->run);
  if (!study->run)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  study->cells =
      (cpl_cells){.out = o->out, .jobs = o->jobs, .resume = o->resume, .quiet = o->quiet, .scenarios = o->scenarios};
  memcpy(study->cells.solver, o->solver, sizeof o->solver);
  if (cpl_cells_make(&study->cells, choose_runs(study, o), err) != TDM_OK)
    return err->status;
  for (int cell = 0; cell < study->ncell; cell++)
    for (int seed = 0; seed < study->nseed && err->status == TDM_OK; seed++)
      if (cpl_study_run_of(study, cell, seed))
        fill_run(study, o, cell, seed, err);
  return err->status;
}

tdm_status cpl_study_run(cpl_study *study, const cpl_study_options *o, tdm_error *err) {
  tdm_error late = {0};
  if (fill_runs(study, o, err) != TDM_OK)
    return err->status;
  cpl_cells_run(&study->cells, err);
  if (err->status != TDM_OK && err->status != TDM_ERR_INTERRUPTED)
    return err->status;
  if (cpl_study_collect(study, &late) != TDM_OK)
    tdm_fail(err, late.status, NULL, "%s", late.message);
  return err->status;
}
