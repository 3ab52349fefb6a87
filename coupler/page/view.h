/* `tandem view DIR`: a result directory as one page that plays the run in a browser. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_PAGE_VIEW_H
#define CPL_PAGE_VIEW_H

#include "protocol/base/status.h"

/* Of the page's frames, when not told otherwise [bytes]. */
#define CPL_VIEW_BUDGET 150e6

/* Write DIR/view.html, or `out` unless it is NULL. Frames are thinned evenly to about `budget` bytes, and the page says
 * so. What a directory lacks (frames, histories, a summary) is a note on the page; one that has neither frames nor
 * histories is an error. Prints what was made. */
tdm_status cpl_view(const char *dir, const char *out, double budget, tdm_error *err);

#endif
