/* The progress of the coupled loop on the terminal. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/base/progress.h"
#include "coupler/observe/observers.h"

#include <stdlib.h>

static tdm_status begin(const cpl_observer *self, const cpl_loop *loop, const cpl_outlet *outlet, void **own,
                        tdm_error *err) {
  (void)self;
  tdm_progress *progress = *own = calloc(1, sizeof *progress);
  if (!progress)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  tdm_progress_begin(progress, (double)cpl_total_steps(loop->settings) * loop->settings->dt, "windows", outlet->quiet);
  return TDM_OK;
}

static tdm_status window(void *own, const cpl_loop *loop, tdm_error *err) {
  (void)err;
  tdm_progress_update(own, loop->t1, loop->window + 1);
  return TDM_OK;
}

static tdm_status end(void *own, tdm_error *err) {
  (void)err;
  if (own)
    tdm_progress_end(own);
  return TDM_OK;
}

const cpl_observer cpl_observer_progress = {
    .name = "progress",
    .open = begin,
    .window = window,
    .close = end,
    .free = free,
};
