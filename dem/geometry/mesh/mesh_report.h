/* What a mesh is like. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_MESH_MESH_REPORT_H
#define DEM_GEOMETRY_MESH_MESH_REPORT_H

#include "protocol/math/vec3.h"

#include <stdbool.h>

/* Triangles, in body axes, from the centre of mass. Immutable after it was made. */
typedef struct dem_mesh dem_mesh;

typedef struct {
  int triangles, vertices, edges;
  int degenerate, duplicate; /* triangles of the file that were dropped */
  int open, nonmanifold;     /* edges of one triangle, of more than two */
  int flat, convex, concave; /* edges of two triangles */
  int flipped;               /* edges whose two triangles face opposite sides */
  bool closed;               /* as tdm_surface_look finds it, of all triangles of the file; so the next four */
  bool oriented;             /* closed, and its triangles face one side */
  int parts, inverted;       /* that hang together; that are inside out: if oriented, else 0 */
  double volume;             /* [m3], positive when the triangles face outward; if oriented, else 0 */
  tdm_vec3 centre;           /* of the volume, body axes [m] */
  double area;               /* [m2] */
  tdm_vec3 low, high;        /* bounding box [m] */
} dem_mesh_report;

#endif
