/* The log: one line an event, "key=value" pairs, values with spaces quoted.
 *
 *   time=12.031 level=info part=dem event=ready particles=500
 *
 * Each thread writes to its own sink, so that solvers that run as threads of one process keep separate logs.
 * `time` is seconds since the sink was opened (wall clock). Results never come from the log.
 */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_BASE_LOG_H
#define TDM_BASE_LOG_H

#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How grave a line is. */
typedef enum { TDM_LOG_DEBUG, TDM_LOG_INFO, TDM_LOG_WARNING, TDM_LOG_ERROR } tdm_log_level;

/* Send this thread's log to `sink` (borrowed, line-buffered by the caller's choice; NULL: no log) as `part`
 * ("server", "dem", "mbd"; copied). */
void tdm_log_open(FILE *sink, const char *part);

/* Write one line; `pairs` is a printf format that makes "key=value key=value". Flushed at once. */
void tdm_log(tdm_log_level level, const char *event, const char *pairs, ...) __attribute__((format(printf, 3, 4)));

/* Quote a value for the log into `out` (size bytes, always terminated): "a b" with inner quotes and line breaks
 * replaced. Returns out. */
const char *tdm_log_quote(char *out, size_t size, const char *text);

/* Monotonic wall clock [s], origin arbitrary. */
double tdm_clock(void);

#ifdef __cplusplus
}
#endif

#endif
