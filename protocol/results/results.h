/* A result directory: its mark and lock, its files. What lies in it is the business of those who write it.
 *
 * CSV files hold nothing that differs between two runs of the same scene: no wall times, no dates. Numbers are written
 * with 17 digits, so that they read back as the same doubles.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_RESULTS_RESULTS_H
#define TDM_RESULTS_RESULTS_H

#include "protocol/results/mark.h"

#include <jansson.h>
#include <stdio.h>

typedef struct {
  char dir[4096];  /* where files go now; "": not ours to write */
  char home[4096]; /* the directory itself: `dir` once the run has started */
  FILE *log;
  tdm_mark mark; /* its lock keeps other runs out */
  bool staged;   /* the start is written beside the results of an earlier run */
} tdm_results;

typedef struct {
  const char *dir;
  const char *scene;   /* file of the scene, which must not be overwritten; may be NULL */
  const char *log;     /* the log's name; NULL: no log, and nothing of an earlier run is removed */
  bool force;          /* replace the results of an earlier run, and write between files that are not tandem's */
  bool beside;         /* results of an earlier run are no reason to refuse: they will stay */
  const char *instead; /* a further way out for the message that refuses them: "go on with --resume, "; may be NULL */
} tdm_results_def;

/* Whether a file that is written at the end can be: looked at before the work begins, with what is in it kept. NULL: no
 * such file. */
tdm_status tdm_check_writable(const char *file, tdm_error *err);

/* Make a directory and its parents; one that is there is fine. */
tdm_status tdm_make_directory(const char *dir, tdm_error *err);

/* Make the directory (and its parents), lock it and mark it as tandem's, and open the log. Refused: a directory that
 * another run writes into; one that holds files but no mark, or results, without `force`; one whose scene.json is the
 * scene itself. Results that are there stay as they are until tdm_results_start: what is written before lies in
 * DIR/start, and stays there when the run is refused. */
tdm_status tdm_results_open(tdm_results *results, const tdm_results_def *def, tdm_error *err);

/* The run begins: the files of an earlier run go, those of the start take their place, and summary.json says
 * "unfinished" until tdm_results_summary. */
tdm_status tdm_results_start(tdm_results *results, tdm_error *err);

/* An error when the directory is no longer there. */
tdm_status tdm_results_there(const tdm_results *results, tdm_error *err);

void tdm_results_close(tdm_results *results);

/* dir/name into out (size bytes). */
const char *tdm_results_path(const tdm_results *results, const char *name, char *out, size_t size);

/* The same for a file that somebody else will write: from now on it is one of the directory's own. */
const char *tdm_results_claim(const tdm_results *results, const char *name, char *out, size_t size);

/* Open a file of the directory for writing, with a large buffer; NULL and an error when it cannot be. */
FILE *tdm_results_file(const tdm_results *results, const char *name, tdm_error *err);

/* A row of a time history: the time [s], then n values. */
void tdm_write_row(FILE *file, double time, const double *values, int n);

/* Write `json` (borrowed) to a file, whole or not at all. Returns whether it is there; errno says why not. */
bool tdm_json_replace(const char *path, const json_t *json);

/* The same as a file of the directory. */
tdm_status tdm_results_json(const tdm_results *results, const char *name, const json_t *json, tdm_error *err);

/* Write `json` as summary.json, after tdm_results_start also on a full disk; when even that fails, less of it. */
tdm_status tdm_results_summary(const tdm_results *results, const json_t *json, tdm_error *err);

/* Read a JSON file of a result directory (new reference); NULL and an error when `dir` is none. */
json_t *tdm_results_read(const char *dir, const char *name, tdm_error *err);

#endif
