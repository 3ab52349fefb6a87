/* The settled bed that cells share: see cells.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/cells/cells.h"

#include "coupler/cells/jobs.h"
#include "protocol/app/command_line.h"
#include "protocol/math/hash.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char key[] = "dem.settle.store";

/* Settings that change neither the bed nor anything before the run. */
static bool is_beside(const char *path) {
  return strncmp(path, "time.", 5) == 0 || strncmp(path, "coupling.", 9) == 0 || strncmp(path, "output.", 7) == 0;
}

/* The hash of all of the scene that is neither time, coupling nor output. */
static uint64_t bed_hash(json_t *root) {
  static const char *const others[] = {"time", "coupling", "output", "title", "scenario", "$schema", "parameters"};
  cpl_cell_bare(root);
  for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
    json_object_del(root, others[i]);
  char *text = json_dumps(root, JSON_COMPACT | JSON_SORT_KEYS);
  uint64_t hash = text ? tdm_hash_bytes(TDM_HASH_START, text, strlen(text)) : 0;
  free(text);
  return hash;
}

void cpl_cell_share_bed(const cpl_cells *cells, cpl_cell *cell, json_t *scene) {
  char file[4200];
  bool ours = tdm_scene_value(scene, "dem.settle") && !tdm_scene_value(scene, key) && !cpl_is_foreign(scene, CPL_DEM);
  uint64_t hash = ours ? bed_hash(scene) : 0;
  snprintf(file, sizeof file, "%s/bed_%016llx", cells->out, (unsigned long long)hash);
  if (hash) /* without memory every cell settles its own */
    cell->store = cpl_cell_add(cell, key, file, &(tdm_error){0});
}

/* ---- settling, by the solver's program where it runs alone ---- */

typedef struct {
  const cpl_cell *cell;
  const char *const *set;
} bed_work;

static bool begin(void *context, int i) {
  (void)context;
  (void)i;
  return true;
}

static int work(void *context, int i) {
  const bed_work *bed = context;
  (void)i;
  return cpl_cell_become(bed->cell, "check", bed->set);
}

static void end(void *context, int i, int status, double seconds) {
  (void)context;
  (void)i;
  (void)status;
  (void)seconds;
}

static void check_alone(const cpl_cell *cell, const char *const *set) {
  cpl_jobs_run(&(cpl_jobs){1, 1, &(bed_work){cell, set}, begin, work, end});
}

/* Settle and stop. What has nothing to do with the bed may be wrong in this cell: it is left out. */
static void make_bed(const cpl_cells *cells, const cpl_cell *cell) {
  const char *set[CPL_CELL_SETTINGS + 3];
  char out[4200];
  int nset = 0;
  for (int k = 0; k < cell->nset; k++)
    if (!is_beside(cell->set[k]))
      set[nset++] = cell->set[k];
  set[nset++] = cell->store;
  set[nset] = NULL;
  snprintf(out, sizeof out, "%s/bed-out", cells->out);
  if (!cells->quiet)
    fprintf(stderr, "tandem: settling the bed\n");
  if (cell->program) {
    check_alone(cell, set);
    return;
  }
  cpl_run_options run = {.scene = cell->scene, .set = set, .out = out, .force = true, .quiet = true, .check = true};
  memcpy(run.solver, cells->solver, sizeof run.solver);
  cpl_run(&run, &(cpl_run_result){0}, &(tdm_error){0});
}

void cpl_cells_make_beds(const cpl_cells *cells) {
  for (int i = 0; i < cells->ncell && !tdm_interrupted; i++) {
    const cpl_cell *cell = &cells->cell[i];
    if (cell->store && !cell->row && access(strchr(cell->store, '=') + 1, R_OK) != 0)
      make_bed(cells, cell);
  }
}
