/* The processes that share a run (ranks), as the engine sees them: which one this is, and what they can tell each
 * other. The program that starts them fills this in (dem/ranks/mpi.c). All ranks call the same operations in the same
 * order, except `abandon`. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_BASE_RANKS_H
#define DEM_BASE_RANKS_H

#include "protocol/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

/* What goes to another rank and comes from it in an exchange. */
typedef struct {
  int rank;              /* the other one */
  const void *send;      /* (sent) */
  void *receive;         /* (received) */
  size_t sent, received; /* [bytes]; 0: nothing */
} dem_mail;

enum { DEM_RANKS_MAX = TDM_RANKS_MAX };

/* What a rank has exchanged with others so far: numbers, so that they can be added and shared. */
typedef struct {
  double messages, message_bytes; /* sent and received */
  double gathers, gathered_bytes; /* calls of `gather`; bytes of whole arrays */
  double reductions;              /* calls of `largest` and `sum` */
  double seconds;                 /* in all of these, waiting for others included */
} dem_exchanged;

/* The work of a rank in the steps of the run (dem_engine_work): sums over the steps, and what it exchanged in them. */
typedef struct {
  double steps;
  double particles, near, contacts; /* at home: particles, entries of the lists, contacts that touch */
  double visitors;                  /* particles of other ranks that the lists name */
  double seconds;                   /* exchanges included */
  dem_exchanged exchanged;
} dem_rank_work;

typedef struct dem_ranks {
  int rank, size;           /* this one, 0 ... size - 1; how many, at most DEM_RANKS_MAX */
  dem_exchanged *exchanged; /* by `gather`, `largest`, `sum`, `begin` and `finish`, which count themselves */
  /* Entries first[r] ... first[r + 1] - 1 of the array, of `size` bytes each, become what they are on rank r. */
  void (*gather)(void *array, size_t size, const int *first);
  /* Each of n numbers becomes the largest of all ranks. */
  void (*largest)(double *x, int n);
  /* Likewise the sum, of whole numbers, so that it has no round-off. */
  void (*sum)(double *x, int n);
  /* Start to exchange n letters; and wait until all have come and gone. Several between two ranks are in the same order
   * on both. */
  void (*begin)(const dem_mail *mail, int n);
  void (*finish)(void);
  /* `size` bytes become those of rank 0. A rank that waits for a long time sleeps in between. */
  void (*broadcast)(void *data, size_t size);
  /* *x becomes the largest of all ranks. False: not all have come here within `patience` [s]; < 0: wait for ever. */
  bool (*meet)(int *x, double patience);
  /* End all ranks, with a message on standard error. Does not return. */
  void (*abandon)(const char *message);
} dem_ranks;

/* For `gather` and `begin`: count what they exchange. */
static inline void dem_count_gather(dem_exchanged *sum, size_t bytes) {
  sum->gathers++;
  sum->gathered_bytes += (double)bytes;
}

static inline void dem_count_mail(dem_exchanged *sum, const dem_mail *mail, int n) {
  for (int k = 0; k < n; k++) {
    sum->messages += (mail[k].sent > 0) + (mail[k].received > 0);
    sum->message_bytes += (double)(mail[k].sent + mail[k].received);
  }
}

#endif
