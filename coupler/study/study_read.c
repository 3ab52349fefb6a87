/* Reading a study: see study.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/study/study.h"

#include "protocol/base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LEVELS_MAX = 64, FACTORS_MAX = 8, CELLS_MAX = 10000, PUBLISHED_MAX = 64, SETTINGS_MAX = CPL_CELL_SETTINGS - 16 };

/* What the parts of the reader share. */
typedef struct {
  cpl_study *study;
  char *folder;    /* of the study's file, with a slash; "": the working directory */
  tdm_scene scene; /* the study's, on which settings are tried */
  tdm_error *err;
} reader;

static void copy(char *out, size_t size, const char *text) {
  snprintf(out, size, "%s", text);
  tdm_utf8_clean(out);
}

static void *room(const reader *r, size_t n, size_t size) {
  void *p = calloc(n + 1, size);
  if (!p)
    tdm_fail(r->err, TDM_ERR_MEMORY, NULL, "out of memory");
  return p;
}

/* A text, "" when it is missing. */
static void get_text(tdm_object *o, const char *key, char *out, size_t size) {
  copy(out, size, tdm_get_string(o, key, ""));
}

/* An array of n entries under `key`, which is not empty when it is there and not longer than `most`. */
static json_t *get_list(tdm_object *o, const char *key, bool required, size_t most, int *n) {
  json_t *list = tdm_get_array(o, key, required);
  if (list && (json_array_size(list) == 0 || json_array_size(list) > most))
    tdm_object_fail(o, key, "has %zu entries; give 1 to %zu", json_array_size(list), most);
  *n = o->err->status ? 0 : (int)json_array_size(list);
  return list;
}

static tdm_object entry_of(tdm_object *o, const char *key, const json_t *list, int i) {
  char path[TDM_PATH_MAX];
  return tdm_object_open(json_array_get(list, (size_t)i), tdm_path(path, o, key, i), o->err);
}

/* ---- settings ---- */

/* A setting as --set takes it; NULL without memory. */
static char *assignment(const char *path, const json_t *value) {
  char *text = json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT), *set = NULL;
  size_t size = text ? strlen(path) + strlen(text) + 2 : 0;
  if (text)
    set = malloc(size);
  if (set)
    snprintf(set, size, "%s=%s", path, text);
  free(text);
  return set;
}

/* Try a setting of key `key` on the scene: a wrong path is told of at its place in the study. */
static void try_setting(reader *r, tdm_object *o, const char *key, const char *path, const json_t *value) {
  tdm_error wrong = {0};
  if (r->err->status || !r->scene.root)
    return;
  char *set = assignment(path, value);
  if (!set || strchr(path, '=') || tdm_scene_set(&r->scene, set, &wrong) != TDM_OK)
    tdm_object_fail(o, key, "\"%s\" is no place in the scene: %s", path,
                    set && wrong.message[0] ? wrong.message : "write it as time.end or dem.pairs[0].friction");
  free(set);
}

/* An object of settings, {path: value}; a new reference. */
static json_t *get_settings(reader *r, tdm_object *o, const char *key) {
  const char *path;
  json_t *value;
  tdm_object set = tdm_get_object(o, key, false);
  if (json_object_size(set.json) > SETTINGS_MAX)
    tdm_object_fail(o, key, "has %zu settings; give at most %d", json_object_size(set.json), SETTINGS_MAX);
  json_object_foreach(set.json, path, value) try_setting(r, o, key, path, value);
  return set.json ? json_incref(set.json) : json_object();
}

/* ---- factors ---- */

static const char *last_part(const char *path) {
  return strrchr(path, '.') ? strrchr(path, '.') + 1 : path;
}

/* A value as people read it: a number short, a text without its quotes. */
static void label_of(const json_t *value, char *out, size_t size) {
  char *text = json_is_string(value) ? NULL : json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT);
  if (json_is_number(value))
    snprintf(out, size, "%.12g", json_number_value(value));
  else
    copy(out, size, text ? text : json_is_string(value) ? json_string_value(value) : "");
  free(text);
}

/* Two levels with one label are one twice. */
static void refuse_twice(tdm_object *o, const char *key, const cpl_factor *f, int i) {
  for (int k = 0; k < i; k++)
    if (strcmp(f->level[k].label, f->level[i].label) == 0)
      tdm_object_fail(o, key, "has \"%s\" twice; each must differ from the others", f->level[i].label);
}

/* A path and the values that it takes. */
static void read_axis(reader *r, tdm_object *o, cpl_factor *f) {
  copy(f->path, sizeof f->path, tdm_get_string(o, "path", NULL));
  json_t *values = get_list(o, "values", true, LEVELS_MAX, &f->nlevel);
  f->level = room(r, (size_t)f->nlevel, sizeof *f->level);
  f->numbers = true;
  for (int i = 0; f->level && i < f->nlevel; i++) {
    const json_t *value = json_array_get(values, (size_t)i);
    cpl_level *level = &f->level[i];
    level->x = json_is_number(value) ? json_number_value(value) : NAN;
    f->numbers = f->numbers && json_is_number(value);
    level->set = json_object();
    json_object_set(level->set, f->path, (json_t *)value);
    label_of(value, level->label, sizeof level->label);
    refuse_twice(o, "values", f, i);
    try_setting(r, o, "path", f->path, value);
  }
}

static void read_axes(reader *r, tdm_object *o) {
  int n;
  json_t *list = get_list(o, "axes", false, FACTORS_MAX, &n);
  for (int i = 0; i < n && !r->err->status; i++) {
    cpl_factor *f = &r->study->factor[r->study->nfactor++];
    tdm_object axis = entry_of(o, "axes", list, i);
    read_axis(r, &axis, f);
    copy(f->title, sizeof f->title, tdm_get_string(&axis, "title", last_part(f->path)));
    get_text(&axis, "unit", f->unit, sizeof f->unit);
    f->log = tdm_get_bool(&axis, "log", false);
    for (int k = 0; k < f->nlevel && f->log; k++)
      if (!(f->level[k].x > 0))
        tdm_object_fail(&axis, "log", "is true, but %s is not greater than 0", f->level[k].label);
    tdm_object_close(&axis);
  }
}

/* A file's name that starts at the study's folder. */
static char *file_from(const reader *r, const char *name) {
  size_t size = strlen(r->folder) + strlen(name) + 1;
  char *file = room(r, size, 1);
  if (file)
    snprintf(file, size, "%s%s", *name == '/' ? "" : r->folder, name);
  return file;
}

/* Cases with labels; settings of one that has a scene of its own are tried on that one when it runs. */
static void read_cases(reader *r, tdm_object *o) {
  int n;
  json_t *list = get_list(o, "cells", false, LEVELS_MAX, &n);
  if (n == 0)
    return;
  cpl_factor *f = &r->study->factor[r->study->nfactor++];
  copy(f->title, sizeof f->title, "case");
  f->level = room(r, (size_t)n, sizeof *f->level);
  for (int i = 0; f->level && i < n && !r->err->status; i++) {
    tdm_object o_case = entry_of(o, "cells", list, i);
    cpl_level *level = &f->level[f->nlevel++];
    level->x = NAN;
    copy(level->label, sizeof level->label, tdm_get_string(&o_case, "label", NULL));
    if (tdm_has(&o_case, "scene"))
      level->scene = file_from(r, tdm_get_string(&o_case, "scene", NULL));
    tdm_scene common = r->scene;
    r->scene.root = level->scene ? NULL : json_deep_copy(common.root);
    level->set = get_settings(r, &o_case, "set");
    json_decref(r->scene.root);
    r->scene = common;
    refuse_twice(&o_case, "label", f, i);
    tdm_object_close(&o_case);
  }
}

static void read_seeds(reader *r, tdm_object *o) {
  tdm_object seeds = tdm_get_object(o, "seeds", false);
  r->study->nseed = 1;
  if (!seeds.json)
    return;
  read_axis(r, &seeds, &r->study->seeds);
  tdm_object_close(&seeds);
  if (r->study->seeds.nlevel > 0)
    r->study->nseed = r->study->seeds.nlevel;
}

/* ---- measures ---- */

/* The x of a published point: a number, or the label of a case. */
static double point_x(reader *r, tdm_object *o, const json_t *x) {
  const cpl_factor *f = &r->study->factor[0];
  const char *label = json_string_value(x), *known[LEVELS_MAX];
  if (r->study->nfactor == 0 || (f->numbers && json_is_number(x)))
    return json_number_value(x);
  for (int i = 0; i < f->nlevel; i++) {
    char text[CPL_STUDY_NAME];
    label_of(x, text, sizeof text);
    known[i] = f->level[i].label;
    if (strcmp(known[i], text) == 0)
      return i;
  }
  const char *near = label ? tdm_nearest(label, known, f->nlevel) : NULL;
  tdm_object_fail(o, "points", "%s%s%s has no cell%s%s%s", label ? "\"" : "", label ? label : "a number",
                  label ? "\"" : "",
                  near         ? "; did you mean \""
                  : f->numbers ? "; give a number"
                               : "; give its label",
                  near ? near : "", near ? "\"?" : "");
  return NAN;
}

static void read_published(reader *r, tdm_object *o, cpl_published *p) {
  int n;
  get_text(o, "source", p->source, sizeof p->source);
  copy(p->label, sizeof p->label, tdm_get_string(o, "label", p->source[0] ? p->source : "published"));
  json_t *points = get_list(o, "points", true, 1000, &n);
  p->x = room(r, (size_t)n, sizeof *p->x);
  p->y = room(r, (size_t)n, sizeof *p->y);
  for (int i = 0; p->x && p->y && i < n && !r->err->status; i++) {
    const json_t *point = json_array_get(points, (size_t)i), *y = json_array_get(point, 1);
    if (json_array_size(point) != 2 || !json_is_number(y)) {
      tdm_object_fail(o, "points",
                      "entry %d is not [x, y]; give a value of the first axis, or a cell's label, and a "
                      "number",
                      i);
      break;
    }
    p->x[p->npoint] = point_x(r, o, json_array_get(point, 0));
    p->y[p->npoint++] = json_number_value(y);
  }
  tdm_object_close(o);
}

/* One object, or a list of them. */
static void read_all_published(reader *r, tdm_object *o, cpl_study_measure *m) {
  int n = 0;
  json_t *given = tdm_has(o, "published") ? json_object_get(o->json, "published") : NULL;
  const bool one = json_is_object(given);
  json_t *list = one ? NULL : get_list(o, "published", false, PUBLISHED_MAX, &n);
  n = one ? 1 : n;
  m->published = room(r, (size_t)n, sizeof *m->published);
  for (int i = 0; m->published && i < n && !r->err->status; i++) {
    tdm_object p = one ? tdm_get_object(o, "published", true) : entry_of(o, "published", list, i);
    read_published(r, &p, &m->published[m->npublished++]);
  }
}

static const char *const at_words[] = {"end", "mean", "max", "min", "amplitude"}; /* of cpl_at */
enum { N_AT = sizeof at_words / sizeof *at_words };

static void read_times(tdm_object *o, const char *key, double *over) {
  tdm_get_numbers(o, key, over, 2, true);
  if (!o->err->status && !(over[1] > over[0]))
    tdm_object_fail(o, key, "is from %g s to %g s; give the earlier time first", over[0], over[1]);
}

/* When: a word, over the whole run or a part of it; or the part, of which the mean is taken. */
static void read_at(tdm_object *o, cpl_study_measure *m) {
  if (tdm_has(o, "at") && json_is_array(json_object_get(o->json, "at"))) {
    m->at = CPL_AT_MEAN;
    read_times(o, "at", m->over);
    return;
  }
  const int at = tdm_get_choice(o, "at", at_words, N_AT, CPL_AT_END);
  m->at = at < 0 ? CPL_AT_END : (cpl_at)at;
  if (tdm_has(o, "over"))
    read_times(o, "over", m->over);
}

/* A name for files and columns from the path or the channel. */
static void default_name(const cpl_study_measure *m, char *out, size_t size) {
  const char *from = m->path[0] ? m->path : strchr(m->channel, ':') ? strchr(m->channel, ':') + 1 : m->channel;
  const bool channel = !m->path[0], part = channel && isfinite(m->over[0]),
             word = part ? m->at != CPL_AT_MEAN : channel && m->at != CPL_AT_END;
  snprintf(out, size, "%.40s%s%s%s", from, word ? "_" : "", word ? at_words[m->at] : "", part ? "_span" : "");
  for (char *c = out; *c; c++)
    if (!strchr("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-.", *c))
      *c = '_';
}

static void read_channel(tdm_object *o, cpl_study_measure *m) {
  char file[TDM_PATH_MAX];
  m->over[0] = -INFINITY;
  m->over[1] = INFINITY;
  copy(m->channel, sizeof m->channel, tdm_get_string(o, "channel", NULL));
  snprintf(file, sizeof file, "%.*s", (int)strcspn(m->channel, ":"), m->channel);
  if (!o->err->status && (!strchr(m->channel, ':') || !cpl_name_fits_file(file)))
    tdm_object_fail(o, "channel", "is \"%s\"; write SOLVER:NAME, such as dem:particles.count", m->channel);
}

/* What measures and curves share. */
static void read_labels(tdm_object *o, cpl_study_measure *m) {
  char name[sizeof m->name];
  default_name(m, name, sizeof name);
  copy(m->name, sizeof m->name, tdm_get_string(o, "name", name));
  copy(m->title, sizeof m->title, tdm_get_string(o, "title", m->name));
  get_text(o, "unit", m->unit, sizeof m->unit);
  m->factor = tdm_get_number(o, "factor", 1, TDM_ANY);
  m->log = tdm_get_bool(o, "log", false);
  if (!o->err->status && !cpl_name_fits_file(m->name))
    tdm_object_fail(o, "name", "\"%s\" becomes the name of a file; take letters, digits, _, - and dots", m->name);
}

static void refuse_name(tdm_object *o, const cpl_study_measure *list, int i) {
  for (int k = 0; k < i; k++)
    if (strcmp(list[k].name, list[i].name) == 0)
      tdm_object_fail(o, "name", "is \"%s\" as that of another; give it a name of its own", list[i].name);
}

static void read_measure(reader *r, tdm_object *o, cpl_study_measure *m) {
  static const char summary[] = "summary.";
  const bool channel = tdm_has(o, "channel");
  if (tdm_has(o, "path") == channel)
    tdm_object_fail(o, channel ? "channel" : NULL, "give one of \"path\" (of summary.json) and \"channel\"");
  if (channel) {
    read_channel(o, m);
    read_at(o, m);
  } else {
    const char *path = tdm_get_string(o, "path", NULL);
    if (strncmp(path, summary, strlen(summary)) != 0)
      tdm_object_fail(o, "path", "is \"%s\"; write summary. and a path in a run's summary.json: summary.wall_s.all",
                      path);
    else
      copy(m->path, sizeof m->path, path + strlen(summary));
  }
  read_labels(o, m);
  read_all_published(r, o, m);
}

/* Run time is always measured. */
static void add_run_time(cpl_study *s) {
  static const char path[] = "wall_s.all";
  for (int k = 0; k < s->nmeasure; k++)
    if (strcmp(s->measure[k].path, path) == 0)
      return;
  cpl_study_measure *m = &s->measure[s->nmeasure++];
  *m = (cpl_study_measure){.name = "run_time", .title = "run time", .unit = "s", .factor = 1};
  snprintf(m->path, sizeof m->path, "%s", path);
}

static void read_measures(reader *r, tdm_object *o) {
  cpl_study *s = r->study;
  int n;
  json_t *list = get_list(o, "measures", false, 64, &n);
  s->measure = room(r, (size_t)n + 1, sizeof *s->measure);
  for (int i = 0; s->measure && i < n && !r->err->status; i++) {
    tdm_object measure = entry_of(o, "measures", list, i);
    read_measure(r, &measure, &s->measure[s->nmeasure++]);
    refuse_name(&measure, s->measure, i);
    tdm_object_close(&measure);
  }
  if (s->measure)
    add_run_time(s);
  list = get_list(o, "curves", false, 64, &n);
  s->curve = room(r, (size_t)n, sizeof *s->curve);
  for (int i = 0; s->curve && i < n && !r->err->status; i++) {
    tdm_object curve = entry_of(o, "curves", list, i);
    read_channel(&curve, &s->curve[s->ncurve++]);
    read_labels(&curve, &s->curve[i]);
    refuse_name(&curve, s->curve, i);
    tdm_object_close(&curve);
  }
}

/* ---- all of it ---- */

static void count_cells(reader *r, tdm_object *o) {
  long n = 1;
  for (int f = 0; f < r->study->nfactor; f++)
    n = n > CELLS_MAX ? n : n * r->study->factor[f].nlevel;
  r->study->ncell = (int)n;
  if (!r->err->status && n * r->study->nseed > CELLS_MAX)
    tdm_object_fail(o, NULL, "more than %d runs; take fewer values or seeds", CELLS_MAX);
}

static void read_scene(reader *r, tdm_object *o) {
  tdm_error wrong = {0};
  const char *name = tdm_get_string(o, "scene", NULL);
  if (r->err->status)
    return;
  r->study->scene = file_from(r, name);
  if (r->study->scene && tdm_scene_read(&r->scene, r->study->scene, &wrong) != TDM_OK)
    tdm_object_fail(o, "scene", "cannot be read: %s", wrong.message);
}

static tdm_status read_all(reader *r, json_t *root) {
  cpl_study *s = r->study;
  tdm_object o = tdm_object_open(root, "", r->err);
  tdm_get_string(&o, "$schema", "");
  get_text(&o, "title", s->title, sizeof s->title);
  read_scene(r, &o);
  s->set = get_settings(r, &o, "set");
  s->factor = room(r, FACTORS_MAX + 1, sizeof *s->factor);
  if (s->factor && !r->err->status) {
    read_cases(r, &o);
    read_axes(r, &o);
  }
  read_seeds(r, &o);
  read_measures(r, &o);
  tdm_object_close(&o);
  count_cells(r, &o);
  tdm_scene_destroy(&r->scene);
  return r->err->status;
}

static tdm_status read_from(cpl_study *study, json_t *root, char *folder, tdm_error *err) {
  tdm_memory_watch_json();
  const unsigned long before = tdm_memory_notes();
  reader r = {.study = study, .folder = folder, .err = err};
  read_all(&r, root);
  return tdm_memory_since(before, NULL, err);
}

tdm_status cpl_study_read_json(cpl_study *study, json_t *root, tdm_error *err) {
  char here[] = "";
  *study = (cpl_study){0};
  return read_from(study, root, here, err);
}

tdm_status cpl_study_read(cpl_study *study, const char *file, tdm_error *err) {
  tdm_scene text = {0};
  *study = (cpl_study){.file = strdup(file)};
  char *folder = strdup(file);
  if (!folder || !study->file)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  else if (tdm_scene_read(&text, file, err) == TDM_OK) {
    char *slash = strrchr(folder, '/');
    slash ? slash[1] = 0 : (folder[0] = 0);
    read_from(study, text.root, folder, err);
    tdm_scene_locate(&text, err);
  }
  tdm_scene_destroy(&text);
  free(folder);
  return err->status;
}

bool cpl_study_is(const json_t *root) {
  static const char *const keys[] = {"scene", "axes", "cells", "measures"};
  for (int k = 0; k < 4; k++)
    if (json_object_get(root, keys[k]) && !json_object_get(root, "time"))
      return true;
  return false;
}

static void free_factor(cpl_factor *f) {
  for (int i = 0; f->level && i < f->nlevel; i++) {
    free(f->level[i].scene);
    json_decref(f->level[i].set);
  }
  free(f->level);
}

static void free_measures(cpl_study_measure *m, int n) {
  for (int i = 0; i < n; i++) {
    for (int k = 0; k < m[i].npublished; k++) {
      free(m[i].published[k].x);
      free(m[i].published[k].y);
    }
    free(m[i].published);
  }
  free(m);
}

void cpl_study_free(cpl_study *study) {
  for (int f = 0; f < study->nfactor; f++)
    free_factor(&study->factor[f]);
  free(study->factor);
  free_factor(&study->seeds);
  free_measures(study->measure, study->nmeasure);
  free_measures(study->curve, study->ncurve);
  cpl_cells_free(&study->cells);
  json_decref(study->set);
  free(study->file);
  free(study->scene);
  free(study->run);
  free(study->value);
  *study = (cpl_study){0};
}
