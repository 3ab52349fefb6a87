/* The file frames.tdv of a result directory: the scenery, then snapshots in the order of their times, as the records of
 * view.h in single precision. It is what pictures, animations and the viewer's page are made of after a run. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_VIEW_FRAMES_H
#define TDM_VIEW_FRAMES_H

#include "protocol/view/view.h"

#include <stdio.h>

#define TDM_FRAMES_FILE "frames.tdv"

/* ---- writing ---- */

/* Append to an open file; each record is on disk as a whole or, after a killed run, the last one in it is cut off.
 * Errors name `path`. `bytes` is workspace that the caller frees. */
tdm_status tdm_frames_write_scenery(FILE *file, const char *path, const tdm_scenery *scenery, tdm_view_bytes *bytes,
                                    tdm_error *err);
tdm_status tdm_frames_write(FILE *file, const char *path, const tdm_snapshot *snapshot, tdm_view_bytes *bytes,
                            tdm_error *err);

/* ---- reading ---- */

/* An open file. Zero-initialise; free with tdm_frames_close. */
typedef struct {
  char path[4096];
  FILE *file;
  tdm_scenery scenery;
  int count; /* of whole snapshots */
  int capacity;
  double *time; /* (count) [s] */
  long *offset; /* (count) in the file [bytes] */
  size_t *size; /* (count) [bytes] */
  bool cut;     /* the file ends inside a record: the run was killed, or is going on */
  tdm_view_bytes bytes;
} tdm_frames;

/* Open DIR/frames.tdv and find its snapshots. TDM_ERR_FILE: there is none; the message says how a run writes one. */
tdm_status tdm_frames_open(tdm_frames *frames, const char *dir, tdm_error *err);
/* The same of a file of any name. */
tdm_status tdm_frames_open_file(tdm_frames *frames, const char *path, tdm_error *err);

/* Snapshot k into *snapshot, checked against the scenery. */
tdm_status tdm_frames_load(tdm_frames *frames, int k, tdm_snapshot *snapshot, tdm_error *err);

void tdm_frames_close(tdm_frames *frames);

#endif
