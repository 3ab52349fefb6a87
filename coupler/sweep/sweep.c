/* `tandem sweep`: see sweep.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE /* asprintf */
#include "coupler/sweep/sweep.h"

#include "coupler/observe/observers.h"
#include "protocol/app/command_line.h"
#include "protocol/base/log.h"
#include "protocol/math/hash.h"
#include "protocol/parameters/load.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- the grid ---- */

/* A copy of the text from `start` to before `end`, without blanks at its ends. */
static char *trimmed(const char *start, const char *end) {
  while (start < end && isspace((unsigned char)*start))
    start++;
  while (end > start && isspace((unsigned char)end[-1]))
    end--;
  return strndup(start, (size_t)(end - start));
}

/* The same text, or JSON that means the same. */
static bool same_value(const char *a, const char *b) {
  json_t *one = json_loads(a, JSON_DECODE_ANY, NULL), *other = json_loads(b, JSON_DECODE_ANY, NULL);
  bool same = strcmp(a, b) == 0 || (one && other && json_equal(one, other));
  json_decref(one);
  json_decref(other);
  return same;
}

tdm_status cpl_sweep_axis(cpl_sweep_options *o, const char *path, const char *list, tdm_error *err) {
  if (o->naxis == CPL_AXES_MAX - 1 || strlen(path) >= TDM_PATH_MAX)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "sweep: at most %d axes", CPL_AXES_MAX - 1);
  for (int a = 0; a < o->naxis; a++)
    if (strcmp(o->axis[a].path, path) == 0)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "sweep: %s is given twice", path);
  cpl_axis *axis = &o->axis[o->naxis++];
  snprintf(axis->path, sizeof axis->path, "%s", path);
  const char *start = list;
  int depth = 0;
  bool quoted = false;
  for (const char *c = list;; c++) {
    if (quoted && *c == '\\' && c[1]) {
      c++;
      continue;
    }
    quoted = *c == '"' ? !quoted : quoted;
    depth += !quoted && (*c == '[' || *c == '{');
    depth -= !quoted && (*c == ']' || *c == '}');
    if (*c && (*c != ',' || depth > 0 || quoted))
      continue;
    if (c == start || axis->nvalue == CPL_VALUES_MAX)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "sweep: %s=%s: %s", path, list,
                      c == start ? "an empty value" : "too many values");
    char *value = trimmed(start, c);
    for (int i = 0; value && i < axis->nvalue; i++)
      if (same_value(axis->value[i], value))
        tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "sweep: %s has the value %.100s twice", path, value);
    axis->value[axis->nvalue] = value;
    if (!value)
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    axis->nvalue++;
    if (err->status != TDM_OK)
      return err->status;
    start = c + 1;
    if (!*c)
      return TDM_OK;
  }
}

void cpl_sweep_free(cpl_sweep_options *o) {
  for (int a = 0; a < o->naxis; a++)
    for (int i = 0; i < o->axis[a].nvalue; i++)
      free(o->axis[a].value[i]);
  o->naxis = 0;
}

/* Settings that change neither the bed nor anything before the run. */
static bool shares_bed(const char *path) {
  return strncmp(path, "time.", 5) == 0 || strncmp(path, "coupling.", 9) == 0 || strncmp(path, "output.", 7) == 0;
}

/* The directory of a cell: its name with other characters for those that are awkward; a long one is cut and gets its
 * hash, so that cells stay apart. */
static void choose_dir(const cpl_sweep_options *o, const char *full_name, cpl_cell *cell) {
  int n = snprintf(cell->dir, sizeof cell->dir, "%s/cells/", o->out), blanks = 0;
  for (const char *c = full_name; *c; c++)
    blanks += *c == ' ';
  bool awkward = strlen(full_name) > 200 || blanks != o->naxis - 1; /* one between two settings, none in a value */
  snprintf(cell->dir + n, sizeof cell->dir - (size_t)n, "%.200s", full_name);
  for (char *c = cell->dir + n; *c; c++)
    if (!isalnum((unsigned char)*c) && !strchr("=._-+", *c)) {
      awkward = awkward || *c != ' ';
      *c = '_';
    }
  if (awkward)
    snprintf(cell->dir + strlen(cell->dir), 20, "_%08x",
             (unsigned)tdm_hash_bytes(TDM_HASH_START, full_name, strlen(full_name)));
}

/* Cell number -> values of its axes; the first axis runs slowest. */
static tdm_status fill_cell(const cpl_sweep_options *o, int index, cpl_cell *cell, tdm_error *err) {
  int value[CPL_AXES_MAX];
  char *name = strdup("");
  if (!name)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int a = o->naxis - 1; a >= 0; a--) {
    value[a] = index % o->axis[a].nvalue;
    index /= o->axis[a].nvalue;
  }
  for (int a = 0; a < o->naxis && name; a++) {
    const cpl_axis *axis = &o->axis[a];
    const char *last = strrchr(axis->path, '.') ? strrchr(axis->path, '.') + 1 : axis->path;
    char *longer;
    if (asprintf(&longer, "%s%s%s=%s", name, a ? " " : "", last, axis->value[value[a]]) < 0)
      longer = NULL;
    if (asprintf(&cell->assignment[a], "%s=%s", axis->path, axis->value[value[a]]) < 0)
      cell->assignment[a] = NULL;
    if (!longer || !cell->assignment[a])
      tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    cell->set[a] = cell->assignment[a];
    free(name);
    name = longer;
  }
  snprintf(cell->name, sizeof cell->name, "%s", name ? name : "");
  tdm_utf8_clean(cell->name);
  choose_dir(o, name ? name : "", cell);
  free(name);
  return err->status;
}

/* ---- the settled bed ---- */

/* Let a cell take its bed from a file that all cells with the same bed share: its name is the hash of all of the scene
 * that is neither time, coupling nor output. Only tandem's own DEM knows the key. */
static void share_bed(const cpl_sweep_options *o, cpl_cell *cell) {
  static const char *const others[] = {"time", "coupling", "output", "title", "scenario", "$schema", "parameters"};
  tdm_scene scene = {0};
  tdm_error err = {0};
  if (tdm_scene_load(&scene, o->scene, cell->set, &err) == TDM_OK) {
    bool ours = tdm_scene_value(scene.root, "dem.settle") && !tdm_scene_value(scene.root, "dem.settle.store") &&
                !tdm_scene_value(scene.root, "coupling.solvers.dem");
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
      json_object_del(scene.root, others[i]);
    char *text = ours ? json_dumps(scene.root, JSON_COMPACT | JSON_SORT_KEYS) : NULL;
    if (text && asprintf(&cell->assignment[o->naxis], "dem.settle.store=%s/bed_%016llx", o->out,
                         (unsigned long long)tdm_hash_bytes(TDM_HASH_START, text, strlen(text))) < 0)
      cell->assignment[o->naxis] = NULL; /* every cell settles its own */
    cell->set[o->naxis] = cell->assignment[o->naxis];
    free(text);
  }
  tdm_scene_destroy(&scene);
}

/* Settle once for each bed, before cells run side by side. A bed that cannot be made fails in its cells, with words. */
static void make_beds(const cpl_sweep_options *o, const cpl_cell *cell, int ncell) {
  for (int i = 0; i < ncell && !tdm_interrupted; i++) {
    const char *store = cell[i].assignment[o->naxis], *set[CPL_AXES_MAX + 2];
    if (!store || cell[i].row || access(strchr(store, '=') + 1, R_OK) == 0)
      continue;
    int nset = 0; /* what has nothing to do with the bed may be wrong in this cell: leave it out */
    for (int a = 0; a < o->naxis; a++)
      if (!shares_bed(o->axis[a].path))
        set[nset++] = cell[i].assignment[a];
    set[nset++] = store;
    set[nset] = NULL;
    tdm_error err = {0};
    cpl_run_result result;
    char out[4200];
    snprintf(out, sizeof out, "%s/bed-out", o->out);
    fprintf(stderr, "tandem: settling the bed\n");
    cpl_run_options run = {.scene = o->scene, .set = set, .out = out, .force = true, .quiet = true, .check = true};
    memcpy(run.solver, o->solver, sizeof run.solver);
    cpl_run(&run, &result, &err);
  }
}

/* ---- rows on disk ---- */

static void row_file(const cpl_cell *cell, char *out, size_t size) {
  snprintf(out, size, "%s/row.json", cell->dir);
}

static bool names_fit(const json_t *group) {
  const char *key;
  json_t *value;
  json_object_foreach((json_t *)group, key, value) if (!cpl_name_fits_file(key) || strlen(key) > 32) return false;
  return true;
}

/* A row as a sweep writes it: its names become names of files and words of gnuplot. */
static bool is_row(const json_t *row) {
  const char *scheme = json_string_value(json_object_get(row, "scheme"));
  const char *status = json_string_value(json_object_get(row, "status"));
  return scheme && status && cpl_name_fits_file(scheme) && strlen(scheme) <= 32 && cpl_name_fits_file(status) &&
         names_fit(json_object_get(row, "r2")) && names_fit(json_object_get(row, "nse"));
}

/* The row of an earlier sweep, if it was of the very same scene. */
static json_t *earlier_row(const cpl_sweep_options *o, const cpl_cell *cell) {
  char file[4352];
  tdm_scene scene = {0};
  tdm_error err = {0};
  json_t *row = NULL;
  snprintf(file, sizeof file, "%s/scene.json", cell->dir);
  json_t *before = json_load_file(file, 0, NULL);
  if (before && tdm_scene_load(&scene, o->scene, cell->set, &err) == TDM_OK) {
    row_file(cell, file, sizeof file);
    if (json_equal(before, scene.written))
      row = json_load_file(file, 0, NULL);
    const char *status = json_string_value(json_object_get(row, "status"));
    if (row && (!is_row(row) || strcmp(status, "failed") == 0)) { /* what failed is tried again */
      json_decref(row);
      row = NULL;
    }
  }
  tdm_scene_destroy(&scene);
  json_decref(before);
  return row;
}

/* ---- cells as jobs ---- */

typedef struct {
  const cpl_sweep_options *options;
  cpl_cell *cell;
  int ncell, done;
} sweep_work;

/* A cell that has no row is wanted. One that fails early must not stand beside another scene's results. */
static bool begin_cell(void *context, int i) {
  static const char *const old[] = {"row.json", "scene.json", "summary.json", "comparison.csv", "comparison.png"};
  const sweep_work *work = context;
  char file[4352];
  if (work->cell[i].row)
    return false;
  for (int k = 0; k < 5; k++) {
    snprintf(file, sizeof file, "%s/%s", work->cell[i].dir, old[k]);
    unlink(file);
  }
  return true;
}

static int run_cell(void *context, int i) {
  const sweep_work *work = context;
  const cpl_cell *cell = &work->cell[i];
  char file[4352];
  row_file(cell, file, sizeof file);
  json_t *row = cpl_cell_run(work->options, cell);
  tdm_make_directory(cell->dir, NULL); /* a scene that is refused has made none */
  return !row || json_dump_file(row, file, JSON_INDENT(2)) != 0;
}

static void print_cell(const cpl_cell *cell, int done, int ncell, double seconds) {
  const char *status = json_string_value(json_object_get(cell->row, "status"));
  const char *reason = json_string_value(json_object_get(cell->row, "reason"));
  fprintf(stderr, "tandem: [%d/%d] %s: %s%s%.100s, %.1f s\n", done, ncell, cell->name, status ? status : "?",
          reason && *reason ? ", " : "", reason ? reason : "", seconds);
}

/* A cell that was tried: its row, or why there is none. */
static void end_cell(void *context, int i, int status, double seconds) {
  sweep_work *work = context;
  cpl_cell *cell = &work->cell[i];
  char file[4352], reason[96];
  row_file(cell, file, sizeof file);
  cell->row = status == -1 ? NULL : json_load_file(file, 0, NULL);
  if (!cell->row && tdm_interrupted)
    return;
  if (!cell->row) {
    if (status == -1)
      snprintf(reason, sizeof reason, "no process could be made for this cell");
    else if (WIFSIGNALED(status))
      snprintf(reason, sizeof reason, "the cell's process was ended by signal %d", WTERMSIG(status));
    else
      snprintf(reason, sizeof reason, "the cell's results cannot be written into its directory");
    cell->row = cpl_cell_row(work->options, cell, "failed", reason);
  }
  print_cell(cell, ++work->done, work->ncell, seconds);
}

static void run_cells(const cpl_sweep_options *o, cpl_cell *cell, int ncell) {
  sweep_work work = {o, cell, ncell, 0};
  for (int i = 0; i < ncell; i++)
    work.done += cell[i].row != NULL;
  if (work.done > 0)
    fprintf(stderr, "tandem: %d of %d cells are there already\n", work.done, ncell);
  cpl_jobs_run(&(cpl_jobs){ncell, o->jobs, &work, begin_cell, run_cell, end_cell});
}

/* ---- the sweep ---- */

/* A slip in the name of a parameter is wrong in every cell: say so before the first. */
static tdm_status check_parameters(const cpl_sweep_options *o, tdm_scene *scene, tdm_error *err) {
  char assignment[TDM_PATH_MAX + 4];
  for (int a = 0; a < o->naxis && err->status == TDM_OK; a++) {
    snprintf(assignment, sizeof assignment, "%s=0", o->axis[a].path);
    if (strncmp(assignment, "parameters.", 11) == 0)
      tdm_scene_set(scene, assignment, err);
  }
  return err->status;
}

static tdm_status prepare(const cpl_sweep_options *o, cpl_cell *cell, int ncell, tdm_error *err) {
  tdm_scene scene = {0};
  char dir[4200];
  snprintf(dir, sizeof dir, "%s/cells", o->out);
  if (tdm_scene_read(&scene, o->scene, err) == TDM_OK)
    cpl_scenario_of(o->scenarios, scene.root, err);
  tdm_scene_locate(&scene, err);
  if (err->status == TDM_OK)
    check_parameters(o, &scene, err);
  if (err->status == TDM_OK && tdm_make_directory(dir, err) == TDM_OK)
    for (int i = 0; i < ncell && fill_cell(o, i, &cell[i], err) == TDM_OK; i++) {
      share_bed(o, &cell[i]);
      if (o->resume)
        cell[i].row = earlier_row(o, &cell[i]);
    }
  tdm_scene_destroy(&scene);
  return err->status;
}

/* The grid, into a directory that is open. */
static tdm_status sweep_cells(const cpl_sweep_options *o, long ncell, tdm_error *err) {
  cpl_cell *cell = calloc((size_t)ncell, sizeof *cell);
  if (!cell)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  if (prepare(o, cell, (int)ncell, err) == TDM_OK) {
    make_beds(o, cell, (int)ncell);
    run_cells(o, cell, (int)ncell);
    cpl_sweep_report(o, cell, (int)ncell, err);
    if (tdm_interrupted)
      tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted; --resume continues the sweep");
  }
  for (long i = 0; i < ncell; i++) {
    json_decref(cell[i].row);
    for (int a = 0; a <= o->naxis; a++)
      free(cell[i].assignment[a]);
  }
  free(cell);
  return err->status;
}

tdm_status cpl_sweep(const cpl_sweep_options *o, tdm_error *err) {
  long ncell = 1;
  for (int a = 0; a < o->naxis; a++) {
    ncell *= o->axis[a].nvalue;
    if (ncell > 10000)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "sweep: more than 10000 cells");
  }
  tdm_results results;
  const tdm_results_def def = {
      .dir = o->out, .force = o->force, .beside = o->resume, .instead = "go on with it with --resume, "};
  if (tdm_results_open(&results, &def, err) != TDM_OK)
    return err->status;
  if (tdm_check_writable(o->json, err) == TDM_OK && tdm_results_start(&results, err) == TDM_OK)
    sweep_cells(o, ncell, err);
  tdm_results_close(&results);
  return err->status;
}
