/* Observers of the coupled loop: they see every window and change none of it.
 *
 * To add one: a file observe/<name>.c with a row of this type, and its name in observe/observers.h. A program that runs
 * scenes itself can also hand rows to cpl_run.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_LOOP_OBSERVER_H
#define CPL_LOOP_OBSERVER_H

#include "coupler/state/loop.h"
#include "protocol/results/results.h"

/* Where observers may write. */
typedef struct {
  tdm_results *results; /* the result directory */
  const char *scene;    /* its file */
  bool quiet;           /* nothing to the terminal */
} cpl_outlet;

typedef struct cpl_observer {
  const char *name;
  void *context; /* whatever `open` needs from who made the row */
  /* The loop is at t = 0. *own (NULL) is the observer's; it is freed also after an error. NULL: nothing to do. */
  tdm_status (*open)(const struct cpl_observer *self, const cpl_loop *loop, const cpl_outlet *outlet, void **own,
                     tdm_error *err);
  /* The loop has solved a window: from state_start at t0 to state_end at t1, output times in row_time. An error ends
   * the run. NULL: nothing. */
  tdm_status (*window)(void *own, const cpl_loop *loop, tdm_error *err);
  /* The run has come to its end. NULL: nothing. */
  void (*done)(void *own, const cpl_loop *loop);
  /* The run was given up, for this reason. NULL: nothing. */
  void (*failed)(void *own, const cpl_loop *loop, const tdm_error *reason);
  /* After either: close files; an error of the disk that came up late is reported here. NULL: nothing. */
  tdm_status (*close)(void *own, tdm_error *err);
  /* After that: add keys to summary.json. NULL: none. */
  void (*enter)(const void *own, json_t *summary);
  void (*free)(void *own); /* NULL: nothing is */
} cpl_observer;

/* The observers of a run, in the order in which they are called. */
enum { CPL_OBSERVERS_MAX = 32 };
typedef struct {
  int count;
  const cpl_observer *row[CPL_OBSERVERS_MAX];
  void *own[CPL_OBSERVERS_MAX];
} cpl_observers;

/* Open one more; after an error it is among those that are closed and freed. */
tdm_status cpl_observers_open(cpl_observers *observers, const cpl_observer *row, const cpl_loop *loop,
                              const cpl_outlet *outlet, tdm_error *err);

tdm_status cpl_observers_window(const cpl_observers *observers, const cpl_loop *loop, tdm_error *err);

/* The end of the run, which has failed when `err` is set: done or failed, then close. */
void cpl_observers_end(const cpl_observers *observers, const cpl_loop *loop, tdm_error *err);

void cpl_observers_enter(const cpl_observers *observers, json_t *summary);
void cpl_observers_free(cpl_observers *observers);

#endif
