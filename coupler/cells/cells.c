/* Cells: see cells.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/cells/cells.h"

#include "coupler/cells/jobs.h"
#include "protocol/app/command_line.h"
#include "protocol/math/hash.h"
#include "protocol/parameters/load.h"
#include "protocol/results/results.h"

#include <assert.h>
#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- names and settings ---- */

tdm_status cpl_cells_make(cpl_cells *cells, int n, tdm_error *err) {
  cells->cell = calloc((size_t)n + 1, sizeof *cells->cell);
  cells->ncell = cells->cell ? n : 0;
  return cells->cell ? TDM_OK : tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
}

void cpl_cells_free(cpl_cells *cells) {
  for (int i = 0; i < cells->ncell; i++) {
    json_decref(cells->cell[i].row);
    for (char **set = cells->cell[i].set; *set; set++)
      free(*set);
  }
  free(cells->cell);
  cells->cell = NULL;
  cells->ncell = 0;
}

const char *cpl_cell_add(cpl_cell *cell, const char *path, const char *value, tdm_error *err) {
  size_t size = strlen(path) + strlen(value) + 2;
  int n = 0;
  while (cell->set[n])
    n++;
  assert(n < CPL_CELL_SETTINGS + 3);
  cell->set[n] = malloc(size);
  if (cell->set[n])
    snprintf(cell->set[n], size, "%s=%s", path, value);
  else
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  return cell->set[n];
}

tdm_status cpl_cell_set(cpl_cell *cell, const char *path, const char *value, tdm_error *err) {
  assert(cell->nset < CPL_CELL_SETTINGS && !cell->set[cell->nset]);
  cell->nset += cpl_cell_add(cell, path, value, err) != NULL;
  return err->status;
}

/* The directory of a cell: its name with other characters for those that are awkward; a long one is cut and gets its
 * hash, so that cells stay apart. */
static void choose_dir(const cpl_cells *cells, cpl_cell *cell, const char *name, int nvalue) {
  int n = snprintf(cell->dir, sizeof cell->dir, "%s/cells/", cells->out), blanks = 0;
  for (const char *c = name; *c; c++)
    blanks += *c == ' ';
  bool awkward = strlen(name) > 200 || blanks != nvalue - 1; /* one between two settings, none in a value */
  snprintf(cell->dir + n, sizeof cell->dir - (size_t)n, "%.200s", name);
  for (char *c = cell->dir + n; *c; c++)
    if (!isalnum((unsigned char)*c) && !strchr("=._-+", *c)) {
      awkward = awkward || *c != ' ';
      *c = '_';
    }
  if (awkward)
    snprintf(cell->dir + strlen(cell->dir), 20, "_%08x", (unsigned)tdm_hash_bytes(TDM_HASH_START, name, strlen(name)));
}

void cpl_cell_place(const cpl_cells *cells, cpl_cell *cell, const char *name, int nvalue) {
  snprintf(cell->name, sizeof cell->name, "%s", name);
  tdm_utf8_clean(cell->name);
  choose_dir(cells, cell, name, nvalue);
}

tdm_status cpl_cell_scene(const cpl_cell *cell, tdm_scene *scene, tdm_error *err) {
  return tdm_scene_load(scene, cell->scene, (const char *const *)cell->set, err);
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

/* A row as cells write it: its names become names of files and words of gnuplot. */
static bool is_row(const cpl_cell *cell, const json_t *row) {
  const char *scheme = json_string_value(json_object_get(row, "scheme"));
  const char *status = json_string_value(json_object_get(row, "status"));
  if (!status || !cpl_name_fits_file(status))
    return false;
  return cell->program || (scheme && cpl_name_fits_file(scheme) && strlen(scheme) <= 32 &&
                           names_fit(json_object_get(row, "r2")) && names_fit(json_object_get(row, "nse")));
}

json_t *cpl_cell_bare(json_t *scene) {
  static const char *const shared_by[] = {"threads", "ranks"};
  json_t *dem = json_object_get(scene, "dem"), *decomposition = json_object_get(dem, "decomposition");
  for (int k = 0; k < 2 && !cpl_is_foreign(scene, CPL_DEM); k++)
    json_object_del(dem, shared_by[k]);
  json_object_del(decomposition, "balance");
  if (decomposition && json_object_size(decomposition) == 0)
    json_object_del(dem, "decomposition");
  return scene;
}

static bool same_scene(json_t *a, json_t *b) {
  return json_equal(cpl_cell_bare(a), cpl_cell_bare(b));
}

/* The row of an earlier run of the cell, if it was of the very same scene. */
static json_t *earlier_row(const cpl_cell *cell) {
  char file[4352];
  tdm_scene scene = {0};
  tdm_error err = {0};
  json_t *row = NULL;
  snprintf(file, sizeof file, "%s/scene.json", cell->dir);
  json_t *before = json_load_file(file, 0, NULL);
  if (before && cpl_cell_scene(cell, &scene, &err) == TDM_OK) {
    row_file(cell, file, sizeof file);
    if (same_scene(before, scene.written))
      row = json_load_file(file, 0, NULL);
    const char *status = json_string_value(json_object_get(row, "status"));
    if (row && (!is_row(cell, row) || strcmp(status, "failed") == 0)) { /* what failed is tried again */
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
  cpl_cells *cells;
  int done;
} cell_work;

/* A cell that has no row is wanted. One that fails early must not stand beside another scene's results. */
static bool begin_cell(void *context, int i) {
  static const char *const old[] = {"row.json", "scene.json", "summary.json", "comparison.csv", "comparison.png"};
  const cpl_cell *cell = &((const cell_work *)context)->cells->cell[i];
  char file[4352];
  if (cell->row)
    return false;
  for (int k = 0; k < 5; k++) {
    snprintf(file, sizeof file, "%s/%s", cell->dir, old[k]);
    unlink(file);
  }
  return true;
}

static int run_cell(void *context, int i) {
  const cpl_cells *cells = ((const cell_work *)context)->cells;
  const cpl_cell *cell = &cells->cell[i];
  char file[4352];
  if (cell->program)
    return cpl_cell_become(cell, "run", (const char *const *)cell->set);
  row_file(cell, file, sizeof file);
  json_t *row = cpl_cell_run(cells, cell);
  tdm_make_directory(cell->dir, NULL); /* a scene that is refused has made none */
  return !row || !tdm_json_replace(file, row);
}

static void print_cell(const cpl_cell *cell, int done, int ncell, double seconds, bool quiet) {
  const char *status = json_string_value(json_object_get(cell->row, "status"));
  const char *reason = json_string_value(json_object_get(cell->row, "reason"));
  if (quiet) {
    if (isatty(2))
      fprintf(stderr, "\r\033[K[%d/%d] %s", done, ncell, cell->name);
    return;
  }
  fprintf(stderr, "tandem: [%d/%d] %s: %s%s%.100s, %.1f s\n", done, ncell, cell->name, status ? status : "?",
          reason && *reason ? ", " : "", reason ? reason : "", seconds);
}

/* The row of a cell whose process left none. */
static json_t *late_row(const cpl_cells *cells, const cpl_cell *cell, int status) {
  char reason[96];
  if (cell->program && status != -1)
    return cpl_cell_alone_row(cells, cell, status);
  if (status == -1)
    snprintf(reason, sizeof reason, "no process could be made for this cell");
  else if (WIFSIGNALED(status))
    snprintf(reason, sizeof reason, "the cell's process was ended by signal %d", WTERMSIG(status));
  else
    snprintf(reason, sizeof reason, "the cell's results cannot be written into its directory");
  return cpl_cell_row(cells, cell, "failed", reason);
}

/* A cell that was tried: its row. One that was interrupted has none. */
static void end_cell(void *context, int i, int status, double seconds) {
  cell_work *work = context;
  cpl_cell *cell = &work->cells->cell[i];
  const bool whole = status != -1 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  char file[4352];
  row_file(cell, file, sizeof file);
  cell->row = status == -1 ? NULL : json_load_file(file, 0, NULL);
  if (!cell->row && tdm_interrupted && !(whole && cell->program))
    return;
  if (!cell->row) {
    cell->row = late_row(work->cells, cell, status);
    if (cell->program)
      tdm_json_replace(file, cell->row); /* where that fails it is run again */
  }
  print_cell(cell, ++work->done, work->cells->ncell, seconds, work->cells->quiet);
}

/* ---- all of them ---- */

/* A slip in the name of a parameter is wrong in every cell: say so before the first. */
static void check_parameters(const cpl_cell *cell, tdm_scene *scene, tdm_error *err) {
  for (int k = 0; k < cell->nset && err->status == TDM_OK; k++)
    if (strncmp(cell->set[k], "parameters.", 11) == 0)
      tdm_scene_set(scene, cell->set[k], err);
}

/* Each scene can be read, its scenario and its parameters are known. */
static tdm_status check_scenes(const cpl_cells *cells, tdm_error *err) {
  for (int i = 0; i < cells->ncell && err->status == TDM_OK; i++) {
    tdm_scene scene = {0};
    if (i > 0 && cells->cell[i].scene == cells->cell[i - 1].scene)
      continue;
    if (tdm_scene_read(&scene, cells->cell[i].scene, err) == TDM_OK)
      cpl_scenario_of(cells->scenarios, scene.root, err);
    tdm_scene_locate(&scene, err);
    if (err->status == TDM_OK)
      check_parameters(&cells->cell[i], &scene, err);
    tdm_scene_destroy(&scene);
  }
  return err->status;
}

/* One of what `path` names, unless the cell itself says how many. */
static void take_one(const cpl_cells *cells, cpl_cell *cell, const json_t *scene, const char *path, tdm_error *err) {
  for (int k = 0; k < cell->nset; k++)
    if (strncmp(cell->set[k], path, strlen(path)) == 0 && cell->set[k][strlen(path)] == '=')
      return;
  if (cells->jobs > 1 && cells->ncell > 1 && !cpl_is_foreign(scene, CPL_DEM) &&
      json_number_value(tdm_scene_value(scene, path)) > 1)
    cpl_cell_add(cell, path, "1", err);
}

/* Cells side by side share the processors. */
static void limit_threads(const cpl_cells *cells, cpl_cell *cell, const json_t *scene, tdm_error *err) {
  take_one(cells, cell, scene, "dem.threads", err);
  take_one(cells, cell, scene, "dem.ranks", err);
}

/* Who runs it, what it shares with others, and what is there of it. */
static void prepare_cell(const cpl_cells *cells, cpl_cell *cell, tdm_error *err) {
  tdm_scene scene = {0};
  cpl_cell_scene(cell, &scene, &(tdm_error){0});
  cell->program = cpl_cell_program_of(cells, scene.root);
  limit_threads(cells, cell, scene.root, err);
  cpl_cell_share_bed(cells, cell, scene.root);
  tdm_scene_destroy(&scene);
  if (cells->resume)
    cell->row = earlier_row(cell);
}

static tdm_status prepare(cpl_cells *cells, tdm_error *err) {
  char dir[4200];
  snprintf(dir, sizeof dir, "%s/cells", cells->out);
  if (check_scenes(cells, err) != TDM_OK || tdm_make_directory(dir, err) != TDM_OK)
    return err->status;
  for (int i = 0; i < cells->ncell && err->status == TDM_OK; i++)
    prepare_cell(cells, &cells->cell[i], err);
  return err->status;
}

tdm_status cpl_cells_run(cpl_cells *cells, tdm_error *err) {
  if (prepare(cells, err) != TDM_OK)
    return err->status;
  cpl_cells_make_beds(cells);
  cell_work work = {.cells = cells};
  for (int i = 0; i < cells->ncell; i++)
    work.done += cells->cell[i].row != NULL;
  if (work.done > 0 && !cells->quiet)
    fprintf(stderr, "tandem: %d of %d cells are there already\n", work.done, cells->ncell);
  cpl_jobs_run(&(cpl_jobs){cells->ncell, cells->jobs, &work, begin_cell, run_cell, end_cell});
  return tdm_interrupted ? tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted; --resume continues the sweep")
                         : TDM_OK;
}
