/* The state at the start of a scene. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_PARTICLES_CREATE_H
#define DEM_PARTICLES_CREATE_H

#include "dem/state/data.h"

/* Particles and bodies as the scene gives them, without lists and forces: dem_forces_begin makes these. NULL when
 * memory runs out. The model must outlive the data. */
dem_data *dem_data_create(const dem_model *model);

#endif
