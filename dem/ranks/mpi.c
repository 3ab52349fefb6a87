/* The ranks of a run as processes of MPI: see mpi.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/ranks/mpi.h"
#include "dem/ranks/trace.h"

#include "dem/state/data.h"
#include "protocol/base/log.h"
#include "protocol/version.h"

#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { TAG = 1 };

static dem_ranks own;
static int *counts, *starts;  /* (size) of a gathering */
static MPI_Request *requests; /* (2 size) of an exchange */
static int nrequest;

/* MPI ends the program itself when one of its calls fails: MPI_ERRORS_ARE_FATAL */

static void gather(void *array, size_t size, const int *first) {
  MPI_Datatype entry;
  for (int r = 0; r < own.size; r++) {
    starts[r] = first[r];
    counts[r] = first[r + 1] - first[r];
  }
  MPI_Type_contiguous((int)size, MPI_BYTE, &entry);
  MPI_Type_commit(&entry);
  dem_trace_enter();
  MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, array, counts, starts, entry, MPI_COMM_WORLD);
  dem_trace_leave();
  MPI_Type_free(&entry);
}

static void largest(double *x, int n) {
  dem_trace_enter();
  MPI_Allreduce(MPI_IN_PLACE, x, n, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  dem_trace_leave();
}

static void begin(const dem_mail *mail, int n) {
  nrequest = 0;
  for (int k = 0; k < n; k++)
    if (mail[k].received > 0)
      MPI_Irecv(mail[k].receive, (int)mail[k].received, MPI_BYTE, mail[k].rank, TAG, MPI_COMM_WORLD,
                &requests[nrequest++]);
  for (int k = 0; k < n; k++)
    if (mail[k].sent > 0)
      MPI_Isend(mail[k].send, (int)mail[k].sent, MPI_BYTE, mail[k].rank, TAG, MPI_COMM_WORLD, &requests[nrequest++]);
}

static void finish(void) {
  dem_trace_enter();
  MPI_Waitall(nrequest, requests, MPI_STATUSES_IGNORE);
  dem_trace_leave();
  nrequest = 0;
}

/* Wait for a request: at first without a pause, then with longer and longer ones. False: it took longer than `patience`
 * [s]; < 0: for ever. */
static bool wait_for(MPI_Request *request, double patience) {
  const double start = tdm_clock(), longest = 1e-3;
  double pause = 1e-6;
  for (int done = 0; MPI_Test(request, &done, MPI_STATUS_IGNORE), !done;) {
    const double waited = tdm_clock() - start;
    if (patience >= 0 && waited > patience)
      return false;
    if (waited < longest)
      continue;
    nanosleep(&(struct timespec){.tv_nsec = (long)(1e9 * pause)}, NULL);
    pause = pause < longest ? 1.5 * pause : longest;
  }
  return true;
}

static void broadcast(void *data, size_t size) {
  MPI_Request request;
  MPI_Ibcast(data, (int)size, MPI_BYTE, 0, MPI_COMM_WORLD, &request);
  wait_for(&request, -1);
}

static bool meet(int *x, double patience) {
  static int all; /* lives as long as the request, which may never end */
  MPI_Request request;
  all = *x;
  MPI_Iallreduce(MPI_IN_PLACE, &all, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD, &request);
  if (!wait_for(&request, patience))
    return false;
  *x = all;
  return true;
}

static void barrier(void) {
  MPI_Barrier(MPI_COMM_WORLD);
}

static void abandon(const char *message) {
  fprintf(stderr, "tandem-dem: error: %s\n", message);
  fflush(NULL);
  MPI_Abort(MPI_COMM_WORLD, 1);
  abort();
}

/* what must be the same everywhere: the version, how numbers lie in memory, how large records are */
static void check_alike(void) {
  struct {
    char version[32];
    double number;
    unsigned order;
    unsigned long size;
  } here, first;
  memset(&here, 0, sizeof here);
  snprintf(here.version, sizeof here.version, "%s", TDM_VERSION);
  here.number = 1.0 / 3;
  here.order = 0x01020304;
  here.size = sizeof(dem_state);
  first = here;
  MPI_Bcast(&first, (int)sizeof first, MPI_BYTE, 0, MPI_COMM_WORLD);
  double other = memcmp(&first, &here, sizeof here) != 0;
  largest(&other, 1);
  if (other > 0)
    abandon("the ranks run different versions of tandem, or on machines of different kinds; install one version on "
            "machines of one kind");
}

const dem_ranks *dem_mpi_begin(int *argc, char ***argv) {
  int level;
  setenv("OMPI_MCA_mpi_yield_when_idle", "1", 0); /* Open MPI: who waits lets others work; the user's own goes before */
  MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &level);
  own = (dem_ranks){.gather = gather,
                    .largest = largest,
                    .begin = begin,
                    .finish = finish,
                    .broadcast = broadcast,
                    .meet = meet,
                    .abandon = abandon};
  MPI_Comm_rank(MPI_COMM_WORLD, &own.rank);
  MPI_Comm_size(MPI_COMM_WORLD, &own.size);
  const size_t n = (size_t)own.size;
  counts = malloc(n * sizeof *counts);
  starts = malloc(n * sizeof *starts);
  requests = malloc(2 * n * sizeof *requests);
  if (!counts || !starts || !requests)
    abandon("no memory for the ranks");
  if (own.size > DEM_RANKS_MAX)
    abandon("more than 4096 ranks; take fewer, with more dem.threads each");
  if (level < MPI_THREAD_FUNNELED)
    abandon("this MPI cannot live with threads");
  check_alike();
  double missing = !dem_trace_wanted();
  MPI_Allreduce(MPI_IN_PLACE, &missing, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  dem_trace_begin(own.rank, missing == 0, barrier);
  return &own;
}

void dem_mpi_end(void) {
  dem_trace_end();
  MPI_Finalize();
  free(counts);
  free(starts);
  free(requests);
}
