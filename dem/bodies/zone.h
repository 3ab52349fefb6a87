/* Where a sink takes particles: a box, what is behind a plane, a sector of a ring; at rest, or in the axes of a body
 * that moves. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_BODIES_ZONE_H
#define DEM_BODIES_ZONE_H

#include "dem/state/data.h"

/* A sink's place at one moment. */
typedef struct {
  const dem_sink *sink;
  tdm_vec3 origin; /* of the body, world [m] */
  tdm_mat3 axes;   /* x_world = origin + axes x_body */
  tdm_vec3 middle; /* of a sphere around all of it, world [m] */
  double radius2;  /* of that sphere, squared [m^2]; INFINITY: it has no end */
} dem_zone;

/* The place of sink s now. */
dem_zone dem_zone_now(const dem_data *data, int s);

/* Is a point [m], world, in the sphere around the zone? Quick: most points are not. */
static inline bool dem_zone_near(const dem_zone *zone, tdm_vec3 x) {
  const tdm_vec3 away = tdm_sub(x, zone->middle);
  return tdm_dot(away, away) <= zone->radius2;
}

/* Is a point [m], world, inside? Never for a sink that takes after a contact. */
bool dem_zone_inside(const dem_zone *zone, tdm_vec3 x);

/* The lowest place of the zone along the unit vector `up` [m], at most a little below it; -INFINITY: none. */
double dem_zone_lowest(const dem_zone *zone, tdm_vec3 up);

#endif
