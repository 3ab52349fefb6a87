/* The table of observers: see observers.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/observe/observers.h"

const cpl_observer *const cpl_observer_table[] = {
#define X(name) &cpl_observer_##name,
    CPL_OBSERVER_LIST(X)
#undef X
        NULL,
};
