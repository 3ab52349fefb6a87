/* Energy stored in particles and contacts, from the present state alone: it costs nothing in the steps between. Elastic
 * is all that the scene's laws store: the normal part, tangential and rolling springs. What cohesion stores is left
 * out.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_WATCH_STORED_H
#define DEM_WATCH_STORED_H

#include "dem/state/data.h"

typedef struct {
  double kinetic;
  double potential; /* in gravity and the constant forces of groups, zero at the world's origin */
  double elastic;
  double magnitude; /* sum of the potentials' magnitudes, for round-off */
} dem_stored;       /* [J] */

/* In all particles, and in the contacts of the lists. */
dem_stored dem_stored_now(const dem_data *data);

/* Of all particles at the speed that counts as rest (dem.settle.speed) [J]: less than that is no motion to judge by. */
double dem_rest_energy(const dem_data *data);

/* Kinetic energy of particle i, and its potential one [J]. */
double dem_particle_energy(const dem_data *data, int i, double *potential);

#endif
