/* What of walls is drawn: the box around them, and polygons. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_WALL_OUTLINE_H
#define DEM_GEOMETRY_WALL_OUTLINE_H

#include "protocol/base/status.h"
#include "protocol/math/pose.h"

#include <stdbool.h>

/* An axis-parallel box [m]. */
typedef struct {
  tdm_vec3 low, high;
} dem_bounds;

/* Take a ball of radius `margin` around x in. */
void dem_bounds_add(dem_bounds *bounds, tdm_vec3 x, double margin);

/* Take a box of edges 2 half in, whose own axes `frame` brings to the world's. */
void dem_bounds_add_box(dem_bounds *bounds, tdm_pose frame, tdm_vec3 half);

/* The frame of something at `point` with `turn` (all zeros: none) in the axes of `frame`. */
tdm_pose dem_frame_at(const tdm_pose *frame, tdm_vec3 point, tdm_quat turn);

enum { DEM_CORNERS_MAX = 12 };

typedef struct {
  int body;
  int wall;   /* that it is of; set by who asks for the polygons */
  int part;   /* of a wall with parts: whose force it shows, at most one polygon a part; -1: none */
  bool solid; /* a face of a solid body, not a cut through a plane */
  int ncorner;
  tdm_vec3 corner[DEM_CORNERS_MAX]; /* [m], in order around the polygon */
} dem_polygon;

typedef struct {
  int count, capacity;
  dem_polygon *polygon; /* (count) */
} dem_polygons;

tdm_status dem_polygons_add(dem_polygons *polygons, const dem_polygon *polygon, tdm_error *err);
void dem_polygons_free(dem_polygons *polygons);

#endif
