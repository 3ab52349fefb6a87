/* Particles that come and go between two steps, and their order. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_PARTICLES_PARTICLES_H
#define DEM_PARTICLES_PARTICLES_H

#include "dem/state/data.h"

typedef struct {
  tdm_vec3 position, velocity; /* world [m], [m/s] */
  double radius, mass;         /* [m], [kg] */
  int material;                /* index of dem_model.material */
} dem_newcomer;

/* Append a particle between two steps: without spin and contacts, with the next id. The lists are rebuilt at the next
 * step. Pointers into the data's particle arrays become invalid. Errors: TDM_ERR_MEMORY. */
tdm_status dem_data_add(dem_data *data, const dem_newcomer *newcomer);

/* Remove the particles with gone[i] >= 0 (nparticle) between two steps. The others keep their order, contacts and
 * histories, and the lists become those that would be built of them, but for pairs that are too far. Errors:
 * TDM_ERR_MEMORY. */
tdm_status dem_data_remove(dem_data *data, const int *gone);

/* Put the particles in a new order: place p gets what was at from[p]. The lists keep the old numbers, and push loses
 * what it has: they are to be built next. Errors: TDM_ERR_MEMORY. */
tdm_status dem_data_permute(dem_data *data, const int *from);

#endif
