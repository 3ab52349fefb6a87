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
 * Errors name `path`. `bytes` is workspace that the caller frees. A snapshot may be a share of the state: the others
 * write theirs, by tdm_frames_write_share, into the places that `place` tells. Until tdm_frames_end the record says
 * that it is longer than the file, so it looks cut off. */
tdm_status tdm_frames_write_scenery(FILE *file, const char *path, const tdm_scenery *scenery, tdm_view_bytes *bytes,
                                    tdm_error *err);

/* Where a snapshot is in the file [bytes]. */
typedef struct {
  long start, end; /* of its record */
  long arrays;     /* where those of the particles begin */
} tdm_frame_place;

tdm_status tdm_frames_write(FILE *file, const char *path, const tdm_snapshot *snapshot, tdm_frame_place *place,
                            tdm_view_bytes *bytes, tdm_error *err);
tdm_status tdm_frames_end(FILE *file, const char *path, const tdm_frame_place *place, tdm_error *err);

/* The particles of a share, by another process, into the file, which it opens. */
tdm_status tdm_frames_write_share(const char *path, const tdm_snapshot *share, long arrays, tdm_error *err);

/* `size` bytes to place `at`; false: not all of them, and errno says why. */
bool tdm_put_at(FILE *file, long at, const void *data, size_t size);

/* The values, of `width` bytes each, of a share, into an array of all that begins at place `at`. Likewise. */
bool tdm_put_share(FILE *file, long at, const tdm_snapshot *share, const void *values, size_t width);

/* Open a file that another process has begun. NULL and an error when it cannot be. */
FILE *tdm_share_open(const char *path, tdm_error *err);

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
