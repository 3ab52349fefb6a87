/* Time histories of a run: files of the result directory that are flushed now and then, so that they can be read while
 * the run goes on. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_OBSERVE_HISTORIES_H
#define CPL_OBSERVE_HISTORIES_H

#include "protocol/results/results.h"

/* Zero-initialise but for `results`. */
typedef struct {
  tdm_results *results; /* borrowed */
  int nfile;
  FILE **file; /* (nfile) */
  double last_flush;
} cpl_histories;

/* Open a further file, closed with the others; NULL and an error when it cannot be. */
FILE *cpl_histories_open(cpl_histories *histories, const char *name, tdm_error *err);

/* Rows were written: what is late by more than a second goes to the disk. */
tdm_status cpl_histories_written(cpl_histories *histories, tdm_error *err);

/* Close all, and free. An error of the disk that came up late is reported here. */
tdm_status cpl_histories_close(cpl_histories *histories, tdm_error *err);

#endif
