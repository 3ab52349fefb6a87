/* One DEM step, the table of contents of the engine. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_STEP_STEP_H
#define DEM_STEP_STEP_H

#include "dem/bodies/path.h"
#include "dem/state/data.h"

/* From step k - 1 to step k (1 … n) of a window: coupled bodies follow `motion` (ncoupled); NULL: they stay where they
 * are. `settling`: with the restitution and friction of the settle phase. False: no memory. */
bool dem_step(dem_data *data, const dem_path *motion, uint64_t k, uint64_t n, bool settling, double dt);

/* Evaluate the forces at the present positions and velocities without advancing anything. False: no memory. */
bool dem_forces_now(dem_data *data, bool settling);

/* For benchmarks: the contact loops alone, on the lists as they are, histories advanced by dt. Sums over chunks stay
 * unfinished: dem_forces_again is to follow. */
void dem_forces_frozen(dem_data *data, double dt);

/* The same on the lists as they are, histories advanced by dt [s] (0: only evaluate). Particles stay where they are. */
void dem_forces_again(dem_data *data, bool settling, double dt);

#endif
