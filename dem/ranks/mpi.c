/* The ranks of a run as processes of MPI: see mpi.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/ranks/mpi.h"
#include "dem/ranks/trace.h"

#include "dem/adapter/orders.h"
#include "protocol/base/log.h"

#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { TAG = 1 };

static dem_ranks own;
static int *counts, *starts;  /* (size) of a gathering */
static MPI_Request *requests; /* (room) of an exchange */
static double coming;         /* bytes of it that this rank receives */
static int nrequest, room;
static dem_exchanged exchanged;
static double entered; /* when this rank came to the present exchange [s] */

static void enter(void) {
  entered = tdm_clock();
  dem_trace_enter();
}

/* `bytes`: that came */
static void leave(double bytes) {
  dem_trace_leave(bytes);
  exchanged.seconds += tdm_clock() - entered;
}

/* MPI ends the program itself when one of its calls fails: MPI_ERRORS_ARE_FATAL */

static void gather(void *array, size_t size, const int *first) {
  MPI_Datatype entry;
  for (int r = 0; r < own.size; r++) {
    starts[r] = first[r];
    counts[r] = first[r + 1] - first[r];
  }
  MPI_Type_contiguous((int)size, MPI_BYTE, &entry);
  MPI_Type_commit(&entry);
  enter();
  MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, array, counts, starts, entry, MPI_COMM_WORLD);
  leave((double)size * (first[own.size] - counts[own.rank]));
  MPI_Type_free(&entry);
  dem_count_gather(&exchanged, size * (size_t)first[own.size]);
}

static void reduce(double *x, int n, MPI_Op operation) {
  enter();
  MPI_Allreduce(MPI_IN_PLACE, x, n, MPI_DOUBLE, operation, MPI_COMM_WORLD);
  leave((double)n * sizeof *x);
  exchanged.reductions++;
}

static void largest(double *x, int n) {
  reduce(x, n, MPI_MAX);
}

static void sum(double *x, int n) {
  reduce(x, n, MPI_SUM);
}

static void abandon(const char *message) {
  fprintf(stderr, "tandem-dem: error: %s\n", message);
  fflush(NULL);
  MPI_Abort(MPI_COMM_WORLD, 1);
  abort();
}

/* a letter goes in pieces of at most so many bytes, as MPI counts them in int */
static const size_t piece = (size_t)1 << 30;

static size_t pieces(size_t bytes) {
  return (bytes + piece - 1) / piece;
}

static int length(size_t bytes, size_t from) {
  return (int)(bytes - from < piece ? bytes - from : piece);
}

/* room for the requests of the letters */
static void reserve(const dem_mail *mail, int n) {
  size_t need = 0;
  for (int k = 0; k < n; k++)
    need += pieces(mail[k].received) + pieces(mail[k].sent);
  if (need <= (size_t)room)
    return;
  free(requests);
  room = (int)need;
  requests = malloc((size_t)room * sizeof *requests);
  if (!requests)
    abandon("no memory for the letters between ranks");
}

static void begin(const dem_mail *mail, int n) {
  nrequest = 0;
  reserve(mail, n);
  coming = 0;
  for (int k = 0; k < n; k++)
    coming += (double)mail[k].received;
  dem_count_mail(&exchanged, mail, n);
  for (int k = 0; k < n; k++)
    for (size_t at = 0; at < mail[k].received; at += piece)
      MPI_Irecv((char *)mail[k].receive + at, length(mail[k].received, at), MPI_BYTE, mail[k].rank, TAG, MPI_COMM_WORLD,
                &requests[nrequest++]);
  for (int k = 0; k < n; k++)
    for (size_t at = 0; at < mail[k].sent; at += piece)
      MPI_Isend((const char *)mail[k].send + at, length(mail[k].sent, at), MPI_BYTE, mail[k].rank, TAG, MPI_COMM_WORLD,
                &requests[nrequest++]);
}

static void finish(void) {
  enter();
  MPI_Waitall(nrequest, requests, MPI_STATUSES_IGNORE);
  leave(coming);
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

const dem_ranks *dem_mpi_begin(int *argc, char ***argv) {
  int level;
  setenv("OMPI_MCA_mpi_yield_when_idle", "1", 0); /* Open MPI: who waits lets others work; the user's own goes before */
  MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &level);
  own = (dem_ranks){.exchanged = &exchanged,
                    .gather = gather,
                    .largest = largest,
                    .sum = sum,
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
  if (!counts || !starts)
    abandon("no memory for the ranks");
  if (own.size > DEM_RANKS_MAX)
    abandon("more than 4096 ranks; take fewer, with more dem.threads each");
  if (level < MPI_THREAD_FUNNELED)
    abandon("this MPI cannot live with threads");
  dem_rank_build here = dem_rank_build_here();
  here.program = dem_rank_build_program();
  const char *differ = dem_ranks_differ(&own, &here);
  if (differ)
    abandon(differ);
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
