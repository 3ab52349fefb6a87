/* The DEM engine as a participant of a co-simulation. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_ADAPTER_SOLVER_H
#define DEM_ADAPTER_SOLVER_H

#include "protocol/wire/participant.h"

extern const tdm_solver_ops dem_solver_ops;

/* The state of a solver that `create` of these operations made (borrowed). */
const struct dem_data *dem_solver_data(const void *self);

#endif
