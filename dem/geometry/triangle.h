/* The triangles of a wall as the contact loops read them, DEM_W at a time (contact/loop/triangles.h). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_TRIANGLE_H
#define DEM_GEOMETRY_TRIANGLE_H

#include "protocol/math/vec3.h"

#include <stdbool.h>

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

/* Square of the distance of x, own axes, from a triangle [m2]. */
static inline double dem_triangle_distance2(const dem_triangle *t, tdm_vec3 x) {
  double nearest = INFINITY;
  bool within = true;
  for (int k = 0; k < 3; k++) {
    tdm_vec3 from = t->corner[DEM_EDGE_FROM(k)], r = tdm_sub(x, from);
    if (tdm_dot(r, t->inward[k]) > 0)
      continue;
    within = false;
    tdm_vec3 edge = tdm_sub(t->corner[DEM_EDGE_TO(k)], from);
    double along = tdm_dot(r, edge), length2 = tdm_dot(edge, edge);
    if (!(along > 0 && along < length2))
      continue;
    tdm_vec3 d = tdm_axpy(-along / length2, edge, r);
    double distance2 = tdm_dot(d, d);
    nearest = distance2 < nearest ? distance2 : nearest;
  }
  if (within) {
    double h = tdm_dot(tdm_sub(x, t->corner[0]), t->normal);
    return h * h;
  }
  if (nearest < INFINITY)
    return nearest;
  for (int k = 0; k < 3; k++) {
    tdm_vec3 d = tdm_sub(x, t->corner[k]);
    double distance2 = tdm_dot(d, d);
    nearest = distance2 < nearest ? distance2 : nearest;
  }
  return nearest;
}

/* The triangles of a wall on which the following holds for spheres that touch it:
 *   - where the point nearest to the centre lies inside a triangle, it is a contact, with the triangle's normal;
 *   - where it lies on an edge with exactly one other triangle, and that triangle's nearest point lies inside it, the
 * contact is the other triangle's;
 *   - two contacts stay two where their normals have a product below facet_cos.
 * In all other cases, dem_shape.touches says what the contacts are. */
typedef struct {
  const dem_triangle *triangle; /* by part */
  double facet_cos;             /* cosine of the angle up to which neighbours are facets of one surface */
} dem_triangles;

#endif
