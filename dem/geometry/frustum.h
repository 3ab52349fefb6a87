/* Cylinders, cones and rings. Own axes: z along the axis, from the end with radius[0] at z = 0 to the end with
 * radius[1] at z = length; a cylinder has two equal radii. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_FRUSTUM_H
#define DEM_GEOMETRY_FRUSTUM_H

#include "protocol/math/vec3.h"

#include <math.h>

/* The curved surface alone, a thin shell with open ends: distance of x (>= 0) from its nearest point, on the rims too,
 * and the unit normal from there to x. On the axis, where all directions are alike, the normal lies in the x-z plane.
 */
double dem_shell_gap(const double radius[2], double length, tdm_vec3 x, tdm_vec3 *normal);

/* A solid with flat ends: signed distance, negative inside, and the unit normal; a point inside leaves by the nearest
 * surface. */
double dem_frustum_gap(const double radius[2], double length, tdm_vec3 x, tdm_vec3 *normal);

/* A cylinder without ends, solid outside (`inside`: the particles are) or inside: signed distance and normal. */
double dem_cylinder_gap(double radius, int inside, tdm_vec3 x, tdm_vec3 *normal);

/* A flat ring of no thickness in the plane z = 0, between two radii; inner 0: a disc. Distance (>= 0) from its nearest
 * point, on its rims too, and the unit normal from there to x: +z in the ring itself, in the x-z plane on the axis. */
static inline double dem_ring_gap(double inner, double outer, tdm_vec3 x, tdm_vec3 *normal) {
  double rho = hypot(x.x, x.y), beside = rho - fmax(inner, fmin(rho, outer)), from = hypot(beside, x.z);
  *normal = tdm_v3(0, 0, 1);
  if (from > 0) {
    double out = rho > 0 ? beside / (rho * from) : 0;
    *normal = tdm_v3(rho > 0 ? out * x.x : beside / from, out * x.y, x.z / from);
  }
  return from;
}

#endif
