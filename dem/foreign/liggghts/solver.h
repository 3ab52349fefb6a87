/* LIGGGHTS as the DEM side of a co-simulation. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_FOREIGN_LIGGGHTS_SOLVER_H
#define DEM_FOREIGN_LIGGGHTS_SOLVER_H

#include "protocol/wire/participant.h"

/* Rank 0 of this many (for the report). */
tdm_solver_ops lig_solver_ops(int ranks);

#endif
