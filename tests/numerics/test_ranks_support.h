/* Ranks as threads of one process: several engines that share a run, without MPI. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_RANKS_SUPPORT_H
#define TEST_RANKS_SUPPORT_H

#include "dem/adapter/orders.h"
#include "dem/base/ranks.h"
#include "dem/state/data.h"

#include <check.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { THREAD_RANKS_MAX = 16 };

/* What the ranks see of each other: each leaves something, all wait, each takes what it needs, all wait. */
static struct {
  pthread_barrier_t barrier;
  int size;
  void *left[THREAD_RANKS_MAX];
  const dem_mail *mail[THREAD_RANKS_MAX];
  int nmail[THREAD_RANKS_MAX];
} together;

static _Thread_local int this_rank;
static _Thread_local dem_exchanged exchanged;

static void leave(void *what) {
  together.left[this_rank] = what;
  pthread_barrier_wait(&together.barrier);
}

static void taken(void) {
  pthread_barrier_wait(&together.barrier);
}

static void thread_gather(void *array, size_t size, const int *first) {
  leave(array);
  for (int r = 0; r < together.size; r++) {
    ck_assert_int_ge(first[r + 1], first[r]);
    const size_t at = (size_t)first[r] * size;
    if (r != this_rank)
      memcpy((char *)array + at, (char *)together.left[r] + at, (size_t)(first[r + 1] - first[r]) * size);
  }
  taken();
  dem_count_gather(&exchanged, size * (size_t)first[together.size]);
}

static double larger_of(double a, double b) {
  return a > b ? a : b;
}

static double sum_of(double a, double b) {
  return a + b;
}

static void reduce(double *x, int n, double (*of)(double, double)) {
  double *all = calloc((size_t)n, sizeof *all);
  leave(x);
  for (int k = 0; k < n; k++) {
    all[k] = ((double *)together.left[0])[k];
    for (int r = 1; r < together.size; r++)
      all[k] = of(all[k], ((double *)together.left[r])[k]);
  }
  taken();
  memcpy(x, all, (size_t)n * sizeof *x);
  free(all);
  exchanged.reductions++;
}

static void thread_largest(double *x, int n) {
  reduce(x, n, larger_of);
}

static void thread_sum(double *x, int n) {
  reduce(x, n, sum_of);
}

static void thread_begin(const dem_mail *mail, int n) {
  together.mail[this_rank] = mail;
  together.nmail[this_rank] = n;
  dem_count_mail(&exchanged, mail, n);
}

static void thread_finish(void) {
  leave(NULL);
  int next[THREAD_RANKS_MAX] = {0}; /* letter of each rank that is looked at next */
  for (int k = 0; k < together.nmail[this_rank]; k++) {
    const dem_mail *in = &together.mail[this_rank][k], *out;
    if (in->received == 0)
      continue;
    do {
      ck_assert_int_lt(next[in->rank], together.nmail[in->rank]);
      out = &together.mail[in->rank][next[in->rank]++];
    } while (out->rank != this_rank || out->sent == 0);
    ck_assert_uint_eq(out->sent, in->received);
    memcpy(in->receive, out->send, in->received);
  }
  for (int r = 0; r < together.size; r++) /* none is left */
    for (int q = next[r]; q < together.nmail[r]; q++)
      ck_assert(together.mail[r][q].rank != this_rank || together.mail[r][q].sent == 0);
  taken();
}

static void thread_broadcast(void *data, size_t size) {
  leave(data);
  if (this_rank > 0)
    memcpy(data, together.left[0], size);
  taken();
}

static bool thread_meet(int *x, double patience) {
  int worst = *x;
  (void)patience;
  leave(x);
  for (int r = 0; r < together.size; r++)
    worst = *(int *)together.left[r] > worst ? *(int *)together.left[r] : worst;
  taken();
  *x = worst;
  return true;
}

static void thread_abandon(const char *message) {
  fprintf(stderr, "rank %d: %s\n", this_rank, message);
  abort();
}

static dem_ranks ranks_of(int rank) {
  return (dem_ranks){.rank = rank,
                     .size = together.size,
                     .exchanged = &exchanged,
                     .gather = thread_gather,
                     .largest = thread_largest,
                     .sum = thread_sum,
                     .begin = thread_begin,
                     .finish = thread_finish,
                     .broadcast = thread_broadcast,
                     .meet = thread_meet,
                     .abandon = thread_abandon};
}

typedef struct {
  int rank;
  void (*work)(const dem_ranks *ranks, void *context); /* NULL: follow rank 0 */
  void *context;
} thread_rank;

static void *be_rank(void *argument) {
  const thread_rank *t = argument;
  this_rank = t->rank;
  const dem_ranks ranks = ranks_of(this_rank);
  if (t->work) {
    t->work(&ranks, t->context);
  } else {
    dem_orders_join(&ranks);
    dem_orders_follow();
  }
  return NULL;
}

/* Ranks 1 ... size - 1 begin. */
static inline void begin_ranks(int size, thread_rank of, thread_rank rank[], pthread_t thread[]) {
  ck_assert_int_le(size, THREAD_RANKS_MAX);
  together.size = size;
  pthread_barrier_init(&together.barrier, NULL, (unsigned)size);
  for (int r = 1; r < size; r++) {
    rank[r] = of;
    rank[r].rank = r;
    ck_assert_int_eq(pthread_create(&thread[r], NULL, be_rank, &rank[r]), 0);
  }
}

static inline void end_ranks(int size, pthread_t thread[]) {
  for (int r = 1; r < size; r++)
    pthread_join(thread[r], NULL);
  pthread_barrier_destroy(&together.barrier);
}

/* Each of so many ranks does the work. */
static inline void each_rank(int size, void (*work)(const dem_ranks *ranks, void *context), void *context) {
  pthread_t thread[THREAD_RANKS_MAX];
  thread_rank rank[THREAD_RANKS_MAX], own = {.work = work, .context = context};
  begin_ranks(size, own, rank, thread);
  be_rank(&own);
  end_ranks(size, thread);
}

/* Call lead(context) as rank 0 of so many, which the others follow; 1: alone. */
static inline void on_ranks(int size, void (*lead)(void *context), void *context) {
  pthread_t thread[THREAD_RANKS_MAX];
  thread_rank rank[THREAD_RANKS_MAX];
  if (size == 1) {
    lead(context);
    return;
  }
  begin_ranks(size, (thread_rank){0}, rank, thread);
  this_rank = 0;
  const dem_ranks own = ranks_of(0);
  dem_orders_join(&own);
  lead(context);
  dem_orders_give(DEM_ORDER_END, 0);
  end_ranks(size, thread);
  dem_orders_join(NULL);
}

#endif
