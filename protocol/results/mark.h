/* The mark of a result directory: a file .tandem that says that the directory is tandem's, holds its lock, and lists
 * the files that tandem wrote there. Only those are ever removed.
 *
 *   tandem results: ...       first line
 *   holds results             a run came as far as its first row
 *   file NAME                 a file of the directory that a new run may remove
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_RESULTS_MARK_H
#define TDM_RESULTS_MARK_H

#include "protocol/base/status.h"

#include <stdbool.h>

typedef struct {
  int fd; /* locked; closed: see `open` */
  bool open;
  bool made;    /* it was not there before */
  bool results; /* an earlier run left results */
} tdm_mark;

/* Lock the mark of `dir`, which is there; make one when it has none. Refused: a directory that another run writes into,
 * and, unless `force`, one that holds files but no mark. */
tdm_status tdm_mark_open(tdm_mark *mark, const char *dir, bool force, tdm_error *err);

/* Let go of it. `undo`: nothing was written, so a mark that was made goes again. */
void tdm_mark_close(tdm_mark *mark, const char *dir, bool undo);

/* Remove the listed files of `dir`, and forget them. */
void tdm_mark_clear(tdm_mark *mark, const char *dir);

/* From now on the directory holds results. */
void tdm_mark_results(tdm_mark *mark);

/* List a file. One that cannot be listed (a full disk) is only not removed later. */
void tdm_mark_add(const tdm_mark *mark, const char *name);

/* The same for a directory that somebody else may have open; nothing happens in one without a mark. */
void tdm_mark_add_in(const char *dir, const char *name);

/* Whether `name` is listed. */
bool tdm_mark_lists(const tdm_mark *mark, const char *name);

/* Whether `dir` still is the directory that was opened: not removed, not another one of its name. */
bool tdm_mark_there(const tdm_mark *mark, const char *dir);

/* Whether `dir` has a mark. */
bool tdm_mark_has(const char *dir);

#endif
