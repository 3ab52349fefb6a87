/* Pictures of a run, drawn by a program of their own, tandem-draw, while the run goes on.
 *
 * A picture is first written as what there is to see: PREFIX_NNN.frame, a file like frames.tdv with one snapshot.
 * tandem-draw makes PREFIX_NNN.png of it and removes it. The run never waits for a picture: when it is faster than
 * tandem-draw, frames pile up on the disk and it waits once, at the end. Whatever happens to tandem-draw is a notice,
 * and the frames that are left can be drawn later (tandem draw FILE).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_DRAW_DRAWER_H
#define TDM_DRAW_DRAWER_H

#include "protocol/draw/settings.h"
#include "protocol/view/view.h"

#include <sys/types.h>

/* Makes the pictures of one run. */
typedef struct {
  const tdm_pictures *pictures; /* borrowed */
  json_t *json;                 /* the views, as a list */
  char dir[4096];

  int *drawn;       /* (pictures->count) submitted so far, of each view */
  pid_t child;      /* 0: not started */
  int orders;       /* socket to it; -1: closed */
  char *waiting;    /* orders that the socket has not taken yet */
  size_t nwaiting;  /* bytes of them */
  tdm_error notice; /* the first thing that went wrong */
  tdm_view_bytes bytes;
} tdm_drawer;

/* Begin: no picture is due yet, no program started. `json` is the value of output.pictures (a reference is kept),
 * `dir` the result directory. Free with tdm_drawer_end, also after an error. */
tdm_status tdm_drawer_begin(tdm_drawer *drawer, const tdm_pictures *pictures, json_t *json, const char *dir,
                            tdm_error *err);

/* The picture of view k of this state. Returns without waiting. An error (TDM_ERR_FILE: a full disk) means that the
 * frame could not be written; what goes wrong in drawing is drawer->notice. */
tdm_status tdm_drawer_submit(tdm_drawer *drawer, int k, const tdm_scenery *scenery, const tdm_snapshot *snapshot,
                             tdm_error *err);

/* Wait until all pictures are drawn, and those of each view in a row (pictures.png, pictures_NAME.png). A signal ends
 * the wait and tandem-draw. Afterwards *notice has the first thing that went wrong, if any. */
void tdm_drawer_finish(tdm_drawer *drawer, tdm_error *notice);

/* Free; tandem-draw is ended, unless tdm_drawer_finish was called. */
void tdm_drawer_end(tdm_drawer *drawer);

#endif
