/* A frame that several processes write: each has a share of the particles (protocol/view/view.h). The one that leads
 * writes all but the others' shares, tells them where, and closes the frame when they are done. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_OUTPUT_SHARE_H
#define TDM_OUTPUT_SHARE_H

#include "protocol/view/view.h"

/* Where the shares of a frame go: bytes that can be sent to other processes. */
typedef struct {
  char dir[4096]; /* the result directory, the same for all of them */
  int number;     /* of particles_NNNNNN.vtp */
  long arrays;    /* where the particles' arrays of the frame begin in frames.tdv [bytes] */
} tdm_shared_frame;

/* Write a share into both files, which are there but for it. Errors: TDM_ERR_FILE, TDM_ERR_MEMORY. */
tdm_status tdm_share_write(const tdm_shared_frame *frame, const tdm_snapshot *share, tdm_error *err);

/* How the one that leads has the others write theirs. `with`: whatever `write` wants. */
typedef struct {
  tdm_status (*write)(void *with, const tdm_shared_frame *frame, tdm_error *err);
  void *with;
} tdm_sharers;

#endif
