/* The table of observers: see observers.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/observe/observers.h"

const cpl_observer *const cpl_observer_table[] = {
    &cpl_observer_record,   /* time histories of bodies and of both solvers' channels */
    &cpl_observer_ledger,   /* impulse, work and energy of the exchange, and the guard */
    &cpl_observer_view,     /* frames for ParaView and viewers */
    &cpl_observer_progress, /* how far the run is */
    NULL,
};
