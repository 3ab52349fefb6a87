/* Walls that are meshes. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_SHAPE_MESH_WALL_H
#define DEM_GEOMETRY_SHAPE_MESH_WALL_H

#include "dem/geometry/mesh/mesh.h"
#include "dem/geometry/shape/rows.h"

/* The mesh of a wall, NULL: it is of another shape. */
static inline const dem_mesh *dem_wall_mesh(const dem_wall *wall) {
  return wall->shape == &dem_shape_mesh ? wall->data : NULL;
}

#endif
