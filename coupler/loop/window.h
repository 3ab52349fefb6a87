/* Windows of the coupled loop: from one to the next. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_LOOP_WINDOW_H
#define CPL_LOOP_WINDOW_H

#include "coupler/loop/observer.h"

/* Solve one window by the scheme and show it to the observers. */
tdm_status cpl_loop_advance(cpl_loop *loop, const cpl_observers *observers, tdm_error *err);

/* Works until the end of the window that was solved; those of its start where a solver does not tell them, or a body is
 * prescribed, whose work is the drivers' affair. What loads from elsewhere do (cpl_loop_press) is none of the
 * exchange's. */
cpl_exchange cpl_loop_exchange(const cpl_loop *loop);

#endif
