/* What a rank does over time: works, tells others, waits for them. Measured where the environment asks for it, as
 *   TANDEM_RANKS_TRACE=FILE: rank r writes FILE.r, "begin_s,end_s,what,bytes" from the start of the program on (bytes
 *   that came by the exchange), and a last line with the sums "all,compute_s,exchange_s,wait_s,compute_cpu_s", the last
 *   in processor time
 * Waiting is told from exchanging by a barrier before each exchange, which costs a little; without the variable there
 * is none. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_RANKS_TRACE_H
#define DEM_RANKS_TRACE_H

#include <stdbool.h>

/* Whether this rank is asked to measure, and can. */
bool dem_trace_wanted(void);

/* Begin for rank `rank` if that is so `everywhere`; `barrier` waits until all ranks are there. */
void dem_trace_begin(int rank, bool everywhere, void (*barrier)(void));

/* Around each exchange: before it (waits for the others), and after; bytes that came. */
void dem_trace_enter(void);
void dem_trace_leave(double bytes);

/* Write the file. */
void dem_trace_end(void);

#endif
