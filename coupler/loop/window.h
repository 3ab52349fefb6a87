/* Windows of the coupled loop: from one to the next. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_LOOP_WINDOW_H
#define CPL_LOOP_WINDOW_H

#include "coupler/loop/observer.h"

/* Solve one window by the scheme and show it to the observers. */
tdm_status cpl_loop_advance(cpl_loop *loop, const cpl_observers *observers, tdm_error *err);

#endif
