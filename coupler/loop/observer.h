/* Observers: what looks at a coupled run while it goes on, window by window, and changes nothing of it.
 *
 * To add one: a file with its row, and the row in observers.c. The loop knows no observer by name.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_LOOP_OBSERVER_H
#define CPL_LOOP_OBSERVER_H

#include "protocol/base/status.h"

#include <jansson.h>
#include <stdbool.h>

struct cpl_loop;

/* Any operation but `window` may be NULL. `own` is what `open` has set, or what cpl_loop_observe was given. */
typedef struct cpl_observer {
  const char *name;
  /* Both solvers are READY, the loop stands at t = 0. */
  tdm_status (*open)(const struct cpl_loop *loop, void **own, tdm_error *err);
  /* A window is solved: loop->t0 ... t1, state_start and state_end, result. An error ends the run. */
  tdm_status (*window)(const struct cpl_loop *loop, void *own, tdm_error *err);
  /* The run has come to its end in order. */
  void (*end)(const struct cpl_loop *loop, void *own);
  /* Keys of its own for summary.json, also after an error. */
  void (*enter)(const struct cpl_loop *loop, const void *own, json_t *summary);
  /* Free what `open` has made; also when it has failed half-way (own may be NULL). */
  void (*close)(void *own);
} cpl_observer;

/* An observer at work. */
typedef struct {
  const cpl_observer *observer;
  void *own;
} cpl_observing;

enum { CPL_OBSERVERS_MAX = 16 };

/* The table, NULL-terminated: they are called in this order. */
extern const cpl_observer *cpl_observers[CPL_OBSERVERS_MAX + 1];

/* Add an observer to the table, for all runs from now on. False: it is full. */
bool cpl_observer_register(const cpl_observer *observer);

/* Add one with a context of its own, `own`, to a loop that is set up; its `open` is not called. False: there are too
 * many. */
bool cpl_loop_observe(struct cpl_loop *loop, const cpl_observer *observer, void *own);

extern const cpl_observer cpl_observer_record, cpl_observer_ledger;

#endif
