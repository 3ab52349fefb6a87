/* The state at the start of a scene. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_PARTICLES_CREATE_H
#define DEM_PARTICLES_CREATE_H

#include "dem/state/data.h"

/* Particles and bodies as the scene gives them, without lists and forces: dem_forces_begin makes these. NULL when
 * memory runs out. The model must outlive the data. */
dem_data *dem_data_create(const dem_model *model);

/* The same on one of several ranks: of the particles it has those of its home (seam/homes.h). ranks: borrowed; NULL:
 * it is alone. */
dem_data *dem_data_create_on(const dem_model *model, const dem_ranks *ranks);

/* The first skin of the neighbour lists, where the scene gives none, for particles of this mean radius [m]: that of the
 * scene (dem_data_create), or of particles that a program adds itself. */
void dem_skin_begin(dem_data *data, double mean_radius);

#endif
