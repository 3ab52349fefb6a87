/* Pieces of work side by side, each in a process of its own: see jobs.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/cells/jobs.h"

#include "protocol/app/command_line.h"
#include "protocol/base/log.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

typedef struct {
  pid_t pid; /* 0: free */
  int piece;
  double begin;
} job;

static pid_t start(const cpl_jobs *jobs, int piece) {
  fflush(NULL);
  pid_t parent = getpid(), pid = fork();
  if (pid != 0)
    return pid;
  prctl(PR_SET_PDEATHSIG, SIGTERM); /* nobody would end it when its parent was killed */
  if (getppid() != parent)
    _exit(1);
  int null = open("/dev/null", O_WRONLY);
  dup2(null, 1);
  dup2(null, 2);
  _exit(jobs->work(jobs->context, piece));
}

/* Give work to those that have none. *next: the first piece that has not been looked at. Returns how many began. */
static int start_some(const cpl_jobs *jobs, job *job_of, int *next) {
  int started = 0;
  for (int j = 0; j < jobs->at_once && !tdm_interrupted; j++) {
    if (job_of[j].pid)
      continue;
    while (*next < jobs->count && !jobs->begin(jobs->context, *next))
      ++*next;
    if (*next == jobs->count)
      return started;
    int piece = (*next)++;
    job_of[j] = (job){start(jobs, piece), piece, tdm_clock()};
    if (job_of[j].pid < 0) {
      job_of[j].pid = 0;
      jobs->end(jobs->context, piece, -1, 0);
    } else {
      started++;
    }
  }
  return started;
}

/* Take the end of one process. Returns whether there was one. */
static bool end_one(const cpl_jobs *jobs, job *job_of) {
  int status;
  pid_t pid = waitpid(-1, &status, WNOHANG);
  for (int j = 0; j < jobs->at_once && pid > 0; j++)
    if (job_of[j].pid == pid) {
      job_of[j].pid = 0;
      jobs->end(jobs->context, job_of[j].piece, status, tdm_clock() - job_of[j].begin);
      return true;
    }
  if (pid <= 0)
    nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
  return false;
}

void cpl_jobs_run(const cpl_jobs *jobs) {
  job job_of[CPL_JOBS_MAX] = {{0}};
  int next = 0, running = 0;
  sig_atomic_t told = 0; /* signals */
  while (running > 0 || (next < jobs->count && !tdm_interrupted)) {
    running += start_some(jobs, job_of, &next);
    const sig_atomic_t signals = tdm_signal_count;
    if (signals != told)
      for (int j = 0; j < jobs->at_once; j++)
        if (job_of[j].pid)
          kill(job_of[j].pid, SIGTERM); /* Ctrl-C reaches them anyway, a signal to this process alone does not */
    told = signals;
    if (running > 0)
      running -= end_one(jobs, job_of);
  }
}

int cpl_jobs_processors(void) {
  long n = sysconf(_SC_NPROCESSORS_ONLN);
  return n < 1 ? 1 : n > CPL_JOBS_MAX ? CPL_JOBS_MAX : (int)n;
}
