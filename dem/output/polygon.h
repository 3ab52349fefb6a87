/* Walls as polygons, for pictures and ParaView. A plane is cut to its container, or else to the bounds of the scene. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_OUTPUT_POLYGON_H
#define DEM_OUTPUT_POLYGON_H

#include "dem/output/snapshot.h"

enum { DEM_CORNERS_MAX = 12 };

typedef struct {
  int body;
  bool solid;     /* a face of a solid body, not a cut through a plane */
  tdm_vec3 force; /* of the particles on a triangle of a mesh, world [N]; NaN: not known */
  int ncorner;
  tdm_vec3 corner[DEM_CORNERS_MAX]; /* world [m], in order around the polygon */
} dem_polygon;

typedef struct {
  int count, capacity;
  dem_polygon *polygon; /* (count) */
  bool forces;          /* those of triangles are known */
} dem_polygons;

/* The walls where they are now. */
tdm_status dem_polygons_make(dem_polygons *polygons, const dem_data *data, const dem_bounds *bounds, tdm_error *err);
void dem_polygons_free(dem_polygons *polygons);

#endif
