/* What a rank does over time: see trace.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/ranks/trace.h"

#include "protocol/base/log.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { KEPT = 100000 }; /* exchanges; of those behind them only the sums */

typedef struct {
  double came, began, ended; /* [s]: waits, exchanges, works on */
  double bytes;              /* that came */
} visit;

static struct {
  const char *file; /* NULL: nothing is measured */
  int rank;
  void (*barrier)(void);
  visit *visit; /* (KEPT) */
  visit now;
  long count;
  double start, exchange, wait; /* [s] */
  double cpu, worked;           /* processor time of this process when it began to work, and of its work so far [s] */
} trace;

static double processor_time(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

bool dem_trace_wanted(void) {
  trace.file = getenv("TANDEM_RANKS_TRACE");
  trace.visit = trace.file ? malloc(KEPT * sizeof *trace.visit) : NULL;
  return trace.visit;
}

void dem_trace_begin(int rank, bool everywhere, void (*barrier)(void)) {
  if (!everywhere) {
    free(trace.visit);
    trace.file = NULL;
    return;
  }
  trace.rank = rank;
  trace.barrier = barrier;
  barrier();
  trace.start = tdm_clock();
  trace.cpu = processor_time();
}

void dem_trace_enter(void) {
  if (!trace.file)
    return;
  trace.worked += processor_time() - trace.cpu;
  trace.now.came = tdm_clock();
  trace.barrier();
  trace.now.began = tdm_clock();
}

void dem_trace_leave(double bytes) {
  if (!trace.file)
    return;
  trace.now.ended = tdm_clock();
  trace.now.bytes = bytes;
  trace.wait += trace.now.began - trace.now.came;
  trace.exchange += trace.now.ended - trace.now.began;
  if (trace.count < KEPT)
    trace.visit[trace.count] = trace.now;
  trace.count++;
  trace.cpu = processor_time();
}

void dem_trace_end(void) {
  if (!trace.file)
    return;
  char name[4096];
  const double all = tdm_clock() - trace.start;
  trace.worked += processor_time() - trace.cpu;
  snprintf(name, sizeof name, "%s.%d", trace.file, trace.rank);
  FILE *f = fopen(name, "w");
  if (!f) {
    fprintf(stderr, "tandem-dem: warning: %s cannot be written: %s\n", name, strerror(errno));
    free(trace.visit);
    return;
  }
  fprintf(f, "begin_s,end_s,what,bytes\n");
  double from = 0;
  for (long k = 0; k < trace.count && k < KEPT; k++) {
    const visit *v = &trace.visit[k];
    fprintf(f, "%.7f,%.7f,compute,0\n%.7f,%.7f,wait,0\n%.7f,%.7f,exchange,%.0f\n", from, v->came - trace.start,
            v->came - trace.start, v->began - trace.start, v->began - trace.start, v->ended - trace.start, v->bytes);
    from = v->ended - trace.start;
  }
  fprintf(f, "all,%.6f,%.6f,%.6f,%.6f\n", all - trace.exchange - trace.wait, trace.exchange, trace.wait, trace.worked);
  if (fclose(f) != 0)
    fprintf(stderr, "tandem-dem: warning: %s cannot be written: %s\n", name, strerror(errno));
  free(trace.visit);
}
