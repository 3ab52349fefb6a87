/* The nearest point of a triangle of a mesh. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_MESH_MESH_NEAREST_H
#define DEM_GEOMETRY_MESH_MESH_NEAREST_H

#include "dem/geometry/mesh/mesh_data.h"

/* Where on a triangle the point nearest to x lies. */
typedef enum { DEM_ON_FACE, DEM_ON_EDGE, DEM_ON_VERTEX } dem_on;

typedef struct {
  dem_on on;
  int feature; /* triangle, edge or vertex */
  tdm_vec3 point;
  double distance2; /* of x from it [m2] */
} dem_nearest;

dem_nearest dem_mesh_nearest(const dem_mesh *mesh, int face, tdm_vec3 x);

/* Gap and normal of that point of `face` as seen from x. */
double dem_mesh_normal(const dem_mesh *mesh, int face, const dem_nearest *nearest, tdm_vec3 x, tdm_vec3 *normal);

#endif
