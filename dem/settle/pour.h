/* Pouring: particles that fall into a bed while it settles (dem.particles of the type "poured").
 *
 * What comes is fixed in the model: number, sizes and masses. They come layer by layer: the region is cut into cells
 * that hold a particle of the largest radius each, and every cell that is free makes one, at a random place inside it.
 * The next layer is tried when this one has fallen out of the region. One entry of the scene pours after the other.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SETTLE_POUR_H
#define DEM_SETTLE_POUR_H

#include "dem/state/data.h"

/* How far it is; zero at first. Times are those of the settling [s]. */
typedef struct {
  double next;    /* when the next layer is tried */
  double last;    /* when the last particle came */
  uint64_t layer; /* tried so far */
} dem_pour;

/* Are all particles of the model there? */
bool dem_pour_over(const dem_data *data);

/* Between two steps, at time t of the settling: a layer, if it is time for one. Errors: no memory; no particle found
 * room for dem.settle.max_time. */
tdm_status dem_pour_now(dem_data *data, dem_pour *pour, double t, tdm_error *err);

#endif
