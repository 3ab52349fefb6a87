/* Pieces of work side by side, each in a process of its own: whatever happens to one, the others go on. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_CELLS_JOBS_H
#define CPL_CELLS_JOBS_H

#include <stdbool.h>

enum { CPL_JOBS_MAX = 64 };

typedef struct {
  int count;   /* pieces of work */
  int at_once; /* 1 to CPL_JOBS_MAX */
  void *context;
  /* Before the process of piece i is made; false: it is not wanted. */
  bool (*begin)(void *context, int i);
  /* In that process, whose output goes nowhere; returns its exit status. */
  int (*work)(void *context, int i);
  /* It has ended after `seconds`, with a status as waitpid gives it; -1: no process could be made. */
  void (*end)(void *context, int i, int status, double seconds);
} cpl_jobs;

/* All pieces, in order. After Ctrl-C or a SIGTERM no further one begins, and those under way are told to end;
 * they are told, too, when this process is killed. */
void cpl_jobs_run(const cpl_jobs *jobs);

/* Processors of this machine, at most CPL_JOBS_MAX. */
int cpl_jobs_processors(void);

#endif
