/* The walls of moving bodies: putting them in place, and counting the particles that went through. */
#ifndef DEM_GEOMETRY_WALLS_H
#define DEM_GEOMETRY_WALLS_H

#include "dem/data.h"
#include "dem/geometry/motion.h"

/* Bring the coupled bodies and their walls to step k of a window of n steps along `motion` (ncoupled). */
void dem_bodies_move(dem_data *data, const dem_motion *motion, uint64_t k, uint64_t n);

/* Put the walls of all bodies where the poses say. */
void dem_walls_put(dem_data *data);

/* Note which planes each particle is in front of: the reference for dem_count_lost. */
void dem_mark_front(dem_data *data);

/* Particles that are behind a plane that they began in front of: they went through it and feel it no more. */
long dem_count_lost(const dem_data *data);

#endif
