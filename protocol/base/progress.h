/* Progress of a run on standard error: a bar on a terminal, a plain line now and then otherwise. */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_BASE_PROGRESS_H
#define TDM_BASE_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

/* what clears the bar of a terminal; print it before a line that comes while there is one */
#define TDM_PROGRESS_CLEAR "\r\033[K"

typedef struct {
  bool quiet, terminal;
  double start, last; /* tdm_clock [s] */
  double end;         /* simulated time of the whole run [s] */
  uint64_t last_count;
  const char *unit; /* of what is counted: "windows" */
  double rate;      /* of these a second */
} tdm_progress;

void tdm_progress_begin(tdm_progress *progress, double end, const char *unit, bool quiet);
/* To be called often, with the simulated time reached [s] and what was done so far; prints seldom. */
void tdm_progress_update(tdm_progress *progress, double time, uint64_t count);
/* In place of the bar, what is being done; prints as seldom. */
void tdm_progress_say(tdm_progress *progress, const char *text);
/* Clears the bar. */
void tdm_progress_end(tdm_progress *progress);

#endif
