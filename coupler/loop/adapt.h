/* The length of the next window from the mismatch of this one ("n": "auto"; coupler/README.md). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_LOOP_ADAPT_H
#define CPL_LOOP_ADAPT_H

#include "coupler/session/settings.h"

/* DEM steps of the window after one of n steps, whose mismatch was `excess` times what is allowed and grows with the
 * power `order` of the window. */
long cpl_adapt_next(const cpl_auto *settings, int order, long n, double excess);

/* The most that cpl_adapt_next can make of a window of n steps. */
long cpl_adapt_longest(const cpl_auto *settings, long n);

#endif
