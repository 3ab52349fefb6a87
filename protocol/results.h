/* A result directory: its lock, its files. What lies in it is the business of those who write it.
 *
 * CSV files hold nothing that differs between two runs of the same scene: no wall times, no dates. Numbers are written
 * with 17 digits, so that they read back as the same doubles.
 */
#ifndef TDM_RESULTS_H
#define TDM_RESULTS_H

#include "protocol/status.h"

#include <jansson.h>
#include <stdio.h>

typedef struct {
  char dir[4096]; /* "": not ours to write */
  FILE *log;      /* its lock keeps other runs out */
} tdm_results;

/* Make a directory and its parents; one that is there is fine. */
tdm_status tdm_make_directory(const char *dir, tdm_error *err);

/* Make the directory (and its parents), remove what an earlier run left there (`old`: NULL-terminated patterns), and
 * open the log `log_name`. The log is locked until it is closed: a second run into the same directory is refused, and
 * so is a directory whose scene.json is the scene `scene` itself, which would be overwritten. */
tdm_status tdm_results_open(tdm_results *results, const char *dir, const char *scene, const char *log_name,
                            const char *const *old, tdm_error *err);
void tdm_results_close(tdm_results *results);

/* dir/name into out (size bytes). */
const char *tdm_results_path(const tdm_results *results, const char *name, char *out, size_t size);

/* Open a file of the directory for writing, with a large buffer; NULL and an error when it cannot be. */
FILE *tdm_results_file(const tdm_results *results, const char *name, tdm_error *err);

/* A row of a time history: the time [s], then n values. */
void tdm_write_row(FILE *file, double time, const double *values, int n);

/* Write `json` (borrowed) as a file of the directory. */
tdm_status tdm_results_json(const tdm_results *results, const char *name, const json_t *json, tdm_error *err);

/* Read a JSON file of a result directory (new reference); NULL and an error when `dir` is none. */
json_t *tdm_results_read(const char *dir, const char *name, tdm_error *err);

#endif
