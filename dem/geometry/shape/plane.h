/* Planes, for readers of shapes that are made of planes. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_SHAPE_PLANE_H
#define DEM_GEOMETRY_SHAPE_PLANE_H

#include "dem/geometry/shape/rows.h"

/* The plane through `point`; normal: unit, towards the particles; body axes. */
static inline dem_wall dem_plane(int body, tdm_vec3 point, tdm_vec3 normal) {
  return (dem_wall){.shape = &dem_shape_plane, .body = body, .point = point, .normal = normal, .endless = true};
}

#endif
