/* Walls that are meshes. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_WALL_MESH_WALL_H
#define DEM_GEOMETRY_WALL_MESH_WALL_H

#include "dem/geometry/mesh.h"
#include "dem/geometry/wall/rows.h"

/* The mesh of a wall, NULL: it is of another shape. */
static inline const dem_mesh *dem_wall_mesh(const dem_wall *wall) {
  return wall->shape == &dem_shape_mesh ? wall->data : NULL;
}

#endif
