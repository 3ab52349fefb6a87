/* Cells of particles alone or bodies alone, which the solver's own program runs: see cells.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/cells/cells.h"

#include "protocol/app/command_line.h"
#include "protocol/app/find.h"
#include "protocol/results/results.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static const char log_name[] = "run.log"; /* what the program says */

const char *cpl_cell_program_of(const cpl_cells *cells, const json_t *scene) {
  const bool dem = json_object_get(scene, "dem"), mbd = json_object_get(scene, "mbd");
  if (dem == mbd || json_object_get(scene, "coupling"))
    return NULL;
  return cells->solver[dem ? CPL_DEM : CPL_MBD].executable;
}

int cpl_cell_become(const cpl_cell *cell, const char *command, const char *const *set) {
  char path[4096], log[4352];
  const char *argv[2 * CPL_CELL_SETTINGS + 16] = {path, command, cell->scene};
  int n = 3;
  if (strcmp(command, "run") == 0) {
    static const char *const more[] = {"--force", "--no-plots", "--out"};
    tdm_make_directory(cell->dir, NULL);
    snprintf(log, sizeof log, "%s/%s", cell->dir, log_name);
    int file = open(log, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (file >= 0)
      dup2(file, 2);
    for (int k = 0; k < 3; k++)
      argv[n++] = more[k];
    argv[n++] = cell->dir;
  }
  for (; *set; set++) {
    argv[n++] = "--set";
    argv[n++] = *set;
  }
  argv[n] = NULL;
  if (tdm_find_program(path, sizeof path, cell->program)) {
    tdm_release_signals();
    execv(path, (char *const *)argv);
  }
  fprintf(stderr, "%s: error: is neither beside this program nor on PATH, or may not be executed\n", cell->program);
  return 127;
}

/* The last error that the program told, without its name in front. */
static void last_error(const cpl_cell *cell, char *out, size_t size) {
  char file[4352], line[2048], start[80];
  snprintf(file, sizeof file, "%s/%s", cell->dir, log_name);
  snprintf(start, sizeof start, "%s: error: ", cell->program);
  FILE *f = fopen(file, "r");
  while (f && fgets(line, sizeof line, f)) {
    line[strcspn(line, "\n")] = 0;
    if (strncmp(line, start, strlen(start)) == 0)
      snprintf(out, size, "%s", line + strlen(start));
  }
  if (f)
    fclose(f);
  tdm_utf8_clean(out);
}

/* Why a run that left no good end failed. */
static void why(const cpl_cell *cell, int wait_status, const json_t *summary, char *out, size_t size) {
  const char *error = json_string_value(json_object_get(summary, "error"));
  if (WIFSIGNALED(wait_status))
    snprintf(out, size, "the cell's process was ended by signal %d", WTERMSIG(wait_status));
  else
    snprintf(out, size, "%s ended with status %d", cell->program, WEXITSTATUS(wait_status));
  last_error(cell, out, size);
  if (error)
    snprintf(out, size, "%s", error);
}

json_t *cpl_cell_alone_row(const cpl_cells *cells, const cpl_cell *cell, int wait_status) {
  json_t *summary = tdm_results_read(cell->dir, "summary.json", &(tdm_error){0});
  const char *told = json_string_value(json_object_get(summary, "status"));
  const bool good = WIFEXITED(wait_status) && WEXITSTATUS(wait_status) == 0;
  const bool numeric = told && strcmp(told, tdm_status_name(TDM_ERR_NUMERIC)) == 0;
  char reason[TDM_MESSAGE_MAX] = "";
  if (!good)
    why(cell, wait_status, summary, reason, sizeof reason);
  json_t *row = cpl_cell_row(cells, cell, good ? "ok" : numeric ? "unstable" : "failed", reason);
  const json_t *wall = tdm_scene_value(summary, "wall_s.all"), *simulated = json_object_get(summary, "simulated_s");
  if (wall)
    json_object_set(row, "wall_s", (json_t *)wall);
  if (simulated)
    json_object_set(row, "simulated_s", (json_t *)simulated);
  if (good)
    cpl_cell_doubt(cell, row, summary);
  json_decref(summary);
  return row;
}
