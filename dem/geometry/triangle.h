/* The triangles of a wall as the contact loops read them, DEM_W at a time (contact/loop/triangles.h). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_TRIANGLE_H
#define DEM_GEOMETRY_TRIANGLE_H

#include "protocol/math/vec3.h"

/* A triangle, in the wall's own axes: 24 doubles, read as three records of eight. Corners ascend by vertex; edge k goes
 * from corner DEM_EDGE_FROM(k) to corner DEM_EDGE_TO(k), so that all triangles of an edge measure along it alike. */
typedef struct {
  tdm_vec3 corner[3]; /* [m] */
  tdm_vec3 normal;    /* unit */
  tdm_vec3 inward[3]; /* of each edge: unit, in the plane, perpendicular to it */
  double origin;      /* 0, 1, 2: the corner from which heights are measured */
  int beyond[3];      /* the triangle over each edge; -1: there is none, or there are several */
  int unused;
} dem_triangle;

#define DEM_EDGE_FROM(k) ((k) == 1 ? 1 : 0)
#define DEM_EDGE_TO(k) ((k) == 0 ? 1 : 2)

/* The triangles of a wall on which the following holds for spheres that touch it:
 *   - where the point nearest to the centre lies inside a triangle, it is a contact, with the triangle's normal;
 *   - where it lies on an edge, and the nearest point of the one triangle beyond lies inside that one, that one's is
 * the contact;
 *   - two contacts stay two where their normals have a product below facet_cos.
 * In all other cases, dem_shape.touches says what the contacts are. */
typedef struct {
  const dem_triangle *triangle; /* by part */
  double facet_cos;             /* cosine of the angle up to which neighbours are facets of one surface */
} dem_triangles;

#endif
