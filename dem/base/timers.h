/* Where the time of the steps goes, for benchmarks: one clock that is read between the phases. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_BASE_TIMERS_H
#define DEM_BASE_TIMERS_H

#include "protocol/base/log.h"

/* Phases of a step: name in C, name. search: finding the pairs; list: all else that a new list takes. */
#define DEM_PHASE_LIST(X) \
  X(SEARCH, "search")     \
  X(LIST, "list")         \
  X(CONTACTS, "contacts") \
  X(INTEGRATION, "integration")

#define X(phase, name) DEM_PHASE_##phase,
typedef enum { DEM_PHASE_LIST(X) DEM_PHASES } dem_phase;
#undef X

typedef struct {
  double mark; /* when the present phase began [s] */
  double spent[DEM_PHASES];
} dem_timers;

/* The time since the last call was spent in this phase. NULL: nobody wants to know. */
static inline void dem_time_spent(dem_timers *timers, dem_phase phase) {
  if (!timers)
    return;
  double now = tdm_clock();
  timers->spent[phase] += now - timers->mark;
  timers->mark = now;
}

#endif
