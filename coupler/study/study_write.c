/* Files of a study: study.json, study.csv, and what others write. See study.h; the JSON is described in docs/runs.md.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/study/study.h"

#include "protocol/scene/json.h"
#include "protocol/version.h"

#include <errno.h>
#include <math.h>
#include <string.h>

/* ---- study.json ---- */

static json_t *factor_to_json(const cpl_factor *f) {
  json_t *values = json_array();
  for (int i = 0; i < f->nlevel; i++)
    json_array_append_new(values, f->path[0] ? json_deep_copy(json_object_get(f->level[i].set, f->path))
                                             : json_string(f->level[i].label));
  return json_pack("{s:s, s:s, s:s, s:o}", "path", f->path, "title", f->title, "unit", f->unit, "values", values);
}

/* Points of published values, with the labels of cases. */
static json_t *published_to_json(const cpl_study *study, const cpl_study_measure *m) {
  const bool cases = study->nfactor > 0 && !study->factor[0].numbers;
  json_t *all = json_array();
  for (int i = 0; i < m->npublished; i++) {
    const cpl_published *p = &m->published[i];
    json_t *points = json_array();
    for (int k = 0; k < p->npoint; k++)
      json_array_append_new(points, cases ? json_pack("[s, f]", study->factor[0].level[(int)p->x[k]].label, p->y[k])
                                          : json_pack("[f, f]", p->x[k], p->y[k]));
    json_array_append_new(all, json_pack("{s:s, s:s, s:o}", "source", p->source, "label", p->label, "points", points));
  }
  return all;
}

static json_t *measures_to_json(const cpl_study *study) {
  json_t *all = json_array();
  for (int i = 0; i < study->nmeasure; i++) {
    const cpl_study_measure *m = &study->measure[i];
    json_array_append_new(all, json_pack("{s:s, s:s, s:s, s:s, s:o}", "name", m->name, "title", m->title, "unit",
                                         m->unit, m->path[0] ? "path" : "channel", m->path[0] ? m->path : m->channel,
                                         "published", published_to_json(study, m)));
  }
  return all;
}

static json_t *run_to_json(const cpl_study *study, int cell, int seed) {
  const cpl_cell *run = cpl_study_run_of(study, cell, seed);
  const char *inside = run->dir + strlen(study->cells.out) + 1;
  json_t *values = json_object(), *json = json_pack("{s:s, s:s}", "name", run->name, "dir", inside);
  static const char *const keys[] = {"status", "reason", "wall_s", "simulated_s", "settings"};
  for (int k = 0; k < 5; k++) {
    json_t *value = json_object_get(run->row, keys[k]);
    json_object_set_new(json, keys[k], value ? json_incref(value) : json_null());
  }
  for (int m = 0; m < study->nmeasure; m++)
    json_object_set_new(values, study->measure[m].name, tdm_number_to_json(cpl_study_value_of(study, cell, seed, m)));
  if (study->seeds.nlevel > 0)
    json_object_set(json, "seed", json_object_get(study->seeds.level[seed].set, study->seeds.path));
  json_object_set_new(json, "values", values);
  return json;
}

static json_t *value_to_json(cpl_value v) {
  return json_pack("{s:o, s:o, s:o, s:o, s:i}", "mean", tdm_number_to_json(v.mean), "min", tdm_number_to_json(v.min),
                   "max", tdm_number_to_json(v.max), "sd", tdm_number_to_json(v.sd), "n", v.n);
}

static json_t *cell_to_json(const cpl_study *study, int cell) {
  char name[512];
  json_t *levels = json_array(), *runs = json_array(), *measures = json_object();
  for (int f = 0; f < study->nfactor; f++)
    json_array_append_new(levels, json_string(cpl_study_level(study, cell, f)->label));
  for (int s = 0; s < study->nseed; s++)
    if (cpl_study_run_of(study, cell, s))
      json_array_append_new(runs, run_to_json(study, cell, s));
  for (int m = 0; m < study->nmeasure; m++)
    json_object_set_new(measures, study->measure[m].name, value_to_json(cpl_study_value(study, cell, m)));
  return json_pack("{s:s, s:o, s:s, s:o, s:o}", "name", cpl_study_cell_name(study, cell, name, sizeof name), "levels",
                   levels, "status", cpl_study_status(study, cell), "measures", measures, "runs", runs);
}

/* Differences of neighbours in all measures; "larger" is null where there is no spread. */
static json_t *neighbours_to_json(const cpl_study *study) {
  json_t *all = json_array();
  char name[512], next[512];
  for (int cell = 0; cell < study->ncell; cell++) {
    const int other = cpl_study_neighbour(study, cell);
    if (other < 0 || !cpl_study_status(study, cell) || !cpl_study_status(study, other))
      continue;
    for (int m = 0; m < study->nmeasure; m++) {
      const cpl_difference d = cpl_study_difference(study, cell, other, m);
      json_array_append_new(
          all, json_pack("{s:s, s:s, s:s, s:o, s:o, s:o}", "measure", study->measure[m].name, "from",
                         cpl_study_cell_name(study, cell, name, sizeof name), "to",
                         cpl_study_cell_name(study, other, next, sizeof next), "difference",
                         tdm_number_to_json(d.difference), "spread", tdm_number_to_json(d.spread), "larger",
                         isnan(d.spread) ? json_null() : json_boolean(fabs(d.difference) > d.spread)));
    }
  }
  return all;
}

static json_t *study_to_json(const cpl_study *study) {
  json_t *factors = json_array(), *cells = json_array();
  for (int f = 0; f < study->nfactor; f++)
    json_array_append_new(factors, factor_to_json(&study->factor[f]));
  for (int cell = 0; cell < study->ncell; cell++)
    if (cpl_study_status(study, cell))
      json_array_append_new(cells, cell_to_json(study, cell));
  return json_pack("{s:s, s:s, s:s, s:O, s:o, s:o, s:o, s:o, s:o}", "tandem", TDM_VERSION, "title", study->title,
                   "scene", study->scene, "set", study->set, "axes", factors, "seeds",
                   study->seeds.nlevel > 0 ? factor_to_json(&study->seeds) : json_null(), "measures",
                   measures_to_json(study), "cells", cells, "neighbours", neighbours_to_json(study));
}

static void write_json(const cpl_study *study, const char *out, const char *copy, tdm_error *err) {
  char file[4352];
  json_t *json = study_to_json(study);
  snprintf(file, sizeof file, "%s/study.json", out);
  const char *files[] = {file, copy};
  for (int i = 0; i < 2; i++)
    if (files[i] && json_dump_file(json, files[i], JSON_INDENT(2) | JSON_REAL_PRECISION(15)) != 0)
      tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", files[i],
               json ? strerror(errno) : "out of memory");
  json_decref(json);
}

/* ---- study.csv ---- */

/* A text as a cell of CSV: what would end the cell is left out. */
static void write_text(FILE *f, const char *text) {
  for (; *text; text++)
    fputc(strchr(",\"\r\n", *text) ? ' ' : *text, f);
}

static void write_head(const cpl_study *study, FILE *f) {
  static const char *const parts[] = {"", ".min", ".max", ".sd"};
  for (int i = 0; i < study->nfactor; i++) {
    const char *path = study->factor[i].path;
    write_text(f, path[0] ? path : "case");
    fputc(',', f);
  }
  fputs("status", f);
  for (int m = 0; m < study->nmeasure; m++) {
    for (int k = 0; k < 4; k++) {
      fprintf(f, ",%s%s [", study->measure[m].name, parts[k]);
      write_text(f, study->measure[m].unit[0] ? study->measure[m].unit : "1");
      fputc(']', f);
    }
    fprintf(f, ",%s.n [1]", study->measure[m].name);
  }
  fputc('\n', f);
}

static void write_row(const cpl_study *study, int cell, FILE *f) {
  for (int i = 0; i < study->nfactor; i++) {
    write_text(f, cpl_study_level(study, cell, i)->label);
    fputc(',', f);
  }
  fputs(cpl_study_status(study, cell), f);
  for (int m = 0; m < study->nmeasure; m++) {
    const cpl_value v = cpl_study_value(study, cell, m);
    fprintf(f, ",%.9g,%.9g,%.9g,%.9g,%d", v.mean, v.min, v.max, v.sd, v.n);
  }
  fputc('\n', f);
}

static void write_csv(const cpl_study *study, const char *out, tdm_error *err) {
  char file[4352];
  snprintf(file, sizeof file, "%s/study.csv", out);
  FILE *f = fopen(file, "w");
  if (f) {
    write_head(study, f);
    for (int cell = 0; cell < study->ncell; cell++)
      if (cpl_study_status(study, cell))
        write_row(study, cell, f);
  }
  if (!f || fclose(f) != 0)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno));
}

/* ---- all of them ---- */

tdm_status cpl_study_write(const cpl_study *study, const char *out, const char *json, tdm_error *err) {
  tdm_error plot = {0};
  write_json(study, out, json, err);
  write_csv(study, out, err);
  if (cpl_study_plot(study, out, &plot) != TDM_OK)
    fprintf(stderr, "tandem: notice: %s\n", plot.message);
  cpl_study_page(study, out, err);
  for (int m = 0; m < study->nmeasure; m++)
    if (study->measure[m].lack[0])
      fprintf(stderr, "tandem: notice: measure %s has no number: %s\n", study->measure[m].name, study->measure[m].lack);
  return err->status;
}
