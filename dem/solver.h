/* The DEM engine as a participant of a co-simulation. */
#ifndef DEM_SOLVER_H
#define DEM_SOLVER_H

#include "protocol/participant.h"

extern const tdm_solver_ops dem_solver_ops;

#endif
