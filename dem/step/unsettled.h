/* Laws that iterate to a tolerance (contact/multi/), watched by the step as the guard watches the rest. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_STEP_UNSETTLED_H
#define DEM_STEP_UNSETTLED_H

#include "dem/state/data.h"

/* After a step: by how much the forces of its contacts would change in one more iteration, share of the largest one,
 * where a law iterates to a tolerance; else 0. Forces stay as they are. */
double dem_forces_unsettled(dem_data *data);

#endif
