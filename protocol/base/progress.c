/* Progress of a run on standard error: see progress.h. */
/* SPDX-License-Identifier: MIT */
#include "protocol/base/progress.h"

#include "protocol/base/log.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const double bar_interval = 0.2, line_interval = 10; /* [s] */
enum { BAR_WIDTH = 30 };

void tdm_progress_begin(tdm_progress *p, double end, const char *unit, bool quiet) {
  *p = (tdm_progress){.quiet = quiet, .terminal = isatty(2), .end = end, .unit = unit};
  p->start = p->last = tdm_clock();
}

static void format_left(double seconds, char *out, size_t size) {
  unsigned s = seconds > 0 && seconds < 1e8 ? (unsigned)seconds : 0;
  if (s >= 3600)
    snprintf(out, size, "%u:%02u:%02u", s / 3600, s / 60 % 60, s % 60);
  else
    snprintf(out, size, "%u:%02u", s / 60, s % 60);
}

void tdm_progress_update(tdm_progress *p, double time, uint64_t count) {
  if (p->quiet)
    return;
  double now = tdm_clock();
  if (now - p->last < (p->terminal ? bar_interval : line_interval))
    return;
  p->rate = (double)(count - p->last_count) / (now - p->last);
  p->last = now;
  p->last_count = count;
  char left[32];
  double done = time / p->end;
  format_left(done > 0 ? (now - p->start) * (1 - done) / done : 0, left, sizeof left);
  if (p->terminal) {
    char bar[BAR_WIDTH + 1];
    int full = (int)(done * BAR_WIDTH);
    memset(bar, ' ', BAR_WIDTH);
    memset(bar, '=', (size_t)(full < BAR_WIDTH ? full : BAR_WIDTH));
    bar[BAR_WIDTH] = 0;
    fprintf(stderr, "\r[%s] %3.0f %%  %.4g of %.4g s  %.0f %s/s  %s left \033[K", bar, 100 * done, time, p->end,
            p->rate, p->unit, left);
  } else {
    fprintf(stderr, "tandem: %.0f %%, %.4g of %.4g s, %.0f %s/s, %s left\n", 100 * done, time, p->end, p->rate, p->unit,
            left);
  }
  fflush(stderr);
}

void tdm_progress_say(tdm_progress *p, const char *text) {
  double now = tdm_clock();
  if (p->quiet || now - p->last < (p->terminal ? bar_interval : line_interval))
    return;
  p->last = now;
  if (p->terminal)
    fprintf(stderr, TDM_PROGRESS_CLEAR "%.78s", text);
  else
    fprintf(stderr, "tandem: %s\n", text);
  fflush(stderr);
}

void tdm_progress_end(tdm_progress *p) {
  if (!p->quiet && p->terminal) {
    fprintf(stderr, TDM_PROGRESS_CLEAR);
    fflush(stderr);
  }
}
