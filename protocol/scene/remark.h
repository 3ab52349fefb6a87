/* Remarks: what a run should tell its user that does not end it. A warning makes results doubtful, a notice is worth
 * knowing. The same event may come a thousand times: the first one's place, time and words are kept, and it is counted.
 *
 * Each thread adds to its own table, as it has its own log. A solver's table goes to the server (message REMARKS), and
 * from there, as from a run of one solver alone, to the terminal, summary.json and the report. SAVE and RESTORE of a
 * solver's state keep its table, so that windows that are tried several times count once.
 */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_SCENE_REMARK_H
#define TDM_SCENE_REMARK_H

#include "protocol/scene/scene.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How grave a remark is. */
typedef enum { TDM_NOTICE, TDM_WARNING } tdm_remark_level;

/* What is known of an event. */
typedef struct {
  char event[96];                /* "overlap"; of several of a kind with its name: "source_waits.inlet" */
  tdm_remark_level level;        /* how grave it is */
  char path[TDM_PATH_MAX];       /* of the first: JSON path in the scene, or "" */
  char message[TDM_MESSAGE_MAX]; /* of the first: what, where, when, and what to do */
  uint64_t count;                /* how often it came */
  double first, last;            /* simulated time [s] */
} tdm_remark_entry;

enum { TDM_REMARKS_MAX = 32 };

/* Zero-initialise. */
typedef struct {
  uint64_t changes;                        /* goes up with every change */
  int count;                               /* events so far */
  tdm_remark_entry entry[TDM_REMARKS_MAX]; /* (count) in the order of their first coming */
} tdm_remarks;

/* Send this thread's remarks to `table` (borrowed; NULL: to the log alone). */
void tdm_remarks_open(tdm_remarks *table);

/* Add a remark at the simulated time t [s], with printf's arguments; path may be NULL. The first ten of an event are
 * logged. */
void tdm_remark(tdm_remark_level level, const char *event, const char *path, double t, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/* Make dst what src is; its number of changes goes on. */
void tdm_remarks_copy(tdm_remarks *dst, const tdm_remarks *src);

/* ---- doubts about a scene, before the start ---- */

/* A doubtful setting: its JSON path, and what is wrong with the cure. */
typedef struct {
  char path[TDM_PATH_MAX];       /* "dem.pairs[0].restitution", or "" */
  char message[TDM_MESSAGE_MAX]; /* one line */
} tdm_warning;

/* Fill it: the message by printf's format; what is too long is cut. */
void tdm_warning_set(tdm_warning *warning, const char *path, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void tdm_warning_vset(tdm_warning *warning, const char *path, const char *format, va_list args)
    __attribute__((format(printf, 3, 0)));

/* ---- as JSON ---- */

/* The table as an array (new reference) of {event, level, path, message, count, first_s, last_s}, with "from" unless
 * that is NULL. Simulated times that are not finite become null. */
json_t *tdm_remarks_to_json(const tdm_remarks *table, const char *from);

/* An array that came over the wire, as tdm_remarks_to_json makes it; NULL after an error (TDM_ERR_PROTOCOL). */
json_t *tdm_remarks_from_json(const json_t *remarks, const char *from, tdm_error *err);

/* Append the array's entries to "warnings" and "notices" of a summary, by their level; places are named as `scene`
 * (borrowed, may be NULL) was written. */
void tdm_remarks_enter(json_t *summary, const json_t *remarks, const tdm_scene *scene);

/* Keeps track of what a terminal has been told. Zero-initialise. */
typedef struct {
  const char *program;    /* "tandem" */
  const tdm_scene *scene; /* that places are named in; NULL: none */
  json_t *told;           /* events so far */
} tdm_teller;

/* Print the entries of the array that have not been told yet, a line each on standard error; `before` (may be NULL) is
 * printed first if there are any. */
void tdm_remarks_tell(tdm_teller *teller, const json_t *remarks, const char *before);

/* At the end of a run: print what has not been told yet, and say again, in a line each, which warnings came before, and
 * of all that came more than once how often, when, and where first. `doubts`: warnings from before the start. */
void tdm_remarks_tell_end(tdm_teller *teller, const json_t *remarks, size_t doubts);

/* *teller is as new. */
void tdm_teller_free(tdm_teller *teller);

#ifdef __cplusplus
}
#endif

#endif
