/* The multibody solver as a participant of a co-simulation. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_ADAPTER_SOLVER_H
#define MBD_ADAPTER_SOLVER_H

#include "mbd/mechanics/state.h"
#include "protocol/wire/participant.h"

extern const tdm_solver_ops mbd_solver_ops;

/* The model of a solver that was created, and its counters up to now (valid until the next step). For runs without a
 * server. */
const mbd_model *mbd_solver_model(const void *solver);
const mbd_stats *mbd_solver_stats(void *solver);

/* The most that the balance of energies was off at the end of a window [J], and as a share of the energy (guard.h). */
double mbd_solver_off(const void *solver, double *share);

#endif
