/* Progress of a run on standard error: a bar on a terminal, a plain line now and then otherwise. */
#ifndef CPL_PROGRESS_H
#define CPL_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
  bool quiet, terminal;
  double start, last; /* tdm_clock [s] */
  double end;         /* simulated time of the whole run [s] */
  uint64_t last_window;
  double rate; /* windows a second, smoothed */
} cpl_progress;

void cpl_progress_begin(cpl_progress *progress, double end, bool quiet);
/* To be called after every window; prints seldom. */
void cpl_progress_update(cpl_progress *progress, double time, uint64_t window);
/* Clears the bar. */
void cpl_progress_end(cpl_progress *progress);

#endif
