/* Spheres and triangles, DEM_W couples at a time: where the nearest point lies. The same operations in the same order
 * as dem_mesh_nearest (geometry/mesh/mesh_nearest.c). Only loops.h includes it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LOOP_TRIANGLES_H
#define DEM_CONTACT_LOOP_TRIANGLES_H

#include "dem/contact/law/contact.h"
#include "dem/geometry/triangle.h"

_Static_assert(sizeof(dem_triangle) == 24 * sizeof(double), "three records of eight doubles");

/* Where the point of a triangle lies that is nearest to a sphere's centre. EDGE + k, CORNER + k: on that one. */
enum {
  APART, /* not within the radius */
  INSIDE,
  UNCLEAR, /* on a border of two */
  EDGE,
  CORNER = EDGE + 3
};

typedef struct {
  vd at;        /* APART ... */
  vd height;    /* of the centre over the triangle [m] */
  vd distance2; /* of the centre from the point on the edge or at the corner [m2] */
  vd3 normal;   /* of the triangle, own axes */
} triangle_look;

/* of the lanes' triangles */
typedef struct {
  vd3 corner[3], normal, inward[3];
  vd origin;
} triangle_lanes;

DEM_KERNEL triangle_lanes load_triangles(const dem_triangle *triangle, const int *part) {
  vd q[24];
  int record[DEM_W];
  for (int b = 0; b < 3; b++) {
    for (int l = 0; l < DEM_W; l++)
      record[l] = 3 * part[l] + b;
    vd_records(&triangle->corner[0].x, record, q + 8 * b);
  }
  triangle_lanes t = {.normal = {q[9], q[10], q[11]}, .origin = q[21]};
  for (int k = 0; k < 3; k++) {
    t.corner[k] = (vd3){q[3 * k], q[3 * k + 1], q[3 * k + 2]};
    t.inward[k] = (vd3){q[12 + 3 * k], q[13 + 3 * k], q[14 + 3 * k]};
  }
  return t;
}

/* the nearest of three, so far */
typedef struct {
  vd distance2, which;
  vm tie; /* two are */
} nearest;

DEM_KERNEL void look_at_one(nearest *of, int which, vd distance2) {
  vm closer = vm_less(distance2, of->distance2);
  of->tie = vm_or(vm_without(of->tie, closer), vm_equal(distance2, of->distance2));
  of->distance2 = vd_pick(closer, distance2, of->distance2);
  of->which = vd_pick(closer, vd_set(which), of->which);
}

/* The nearest point of the lanes that are outside is on an edge, else at a corner. in: over the plane of each edge. */
DEM_KERNEL void look_at_edges(const triangle_lanes *t, vd3 x, const vd in[3], vm outside, vd radius2,
                              triangle_look *out) {
  const vm none = vm_without(outside, outside);
  const vd far = vd_set(INFINITY);
  nearest edge = {far, vd_set(0), none}, corner = edge;
  for (int k = 0; k < 3; k++) {
    vd3 from = t->corner[DEM_EDGE_FROM(k)], r = vd3_sub(x, from), along = vd3_sub(t->corner[DEM_EDGE_TO(k)], from);
    vd length2 = vd3_dot(along, along), at = vd3_dot(r, along);
    vm over = vm_and(vm_less(in[k], vd_set(0)), vm_and(vm_less(vd_set(0), at), vm_less(at, length2)));
    vd3 d = vd3_sub(x, vd3_axpy(at / length2, along, from)), c = vd3_sub(x, t->corner[k]);
    look_at_one(&edge, k, vd_pick(over, vd3_dot(d, d), far));
    look_at_one(&corner, k, vd3_dot(c, c));
  }
  vm at_edge = vm_less(edge.distance2, far);
  out->distance2 = vd_pick(at_edge, edge.distance2, corner.distance2);
  vm near = vm_and(outside, vm_less(out->distance2, radius2));
  vm tie = vm_or(vm_and(at_edge, edge.tie), vm_without(corner.tie, at_edge));
  vd at = vd_pick(at_edge, vd_set(EDGE) + edge.which, vd_set(CORNER) + corner.which);
  out->at = vd_pick(near, vd_pick(tie, vd_set(UNCLEAR), at), out->at);
}

/* Spheres with the centre x, own axes, and triangles, by their parts. */
DEM_KERNEL triangle_look look_at_triangles(const dem_triangle *triangle, const int *part, vd3 x, vd radius) {
  const vm all = vm_first(DEM_W);
  const triangle_lanes t = load_triangles(triangle, part);
  const vd radius2 = radius * radius;
  vm within = all, border = vm_without(all, all);
  vd in[3];
  for (int k = 0; k < 3; k++) {
    in[k] = vd3_dot(vd3_sub(x, t.corner[DEM_EDGE_FROM(k)]), t.inward[k]);
    within = vm_and(within, vm_less(vd_set(0), in[k]));
    border = vm_or(border, vm_equal(in[k], vd_set(0)));
  }
  vd3 origin = vd3_pick(vm_less(t.origin, vd_set(0.5)), t.corner[0],
                        vd3_pick(vm_less(t.origin, vd_set(1.5)), t.corner[1], t.corner[2]));
  triangle_look out = {.height = vd3_dot(vd3_sub(x, origin), t.normal), .distance2 = vd_set(0), .normal = t.normal};
  out.at = vd_pick(vm_and(within, vm_less(out.height * out.height, radius2)), vd_set(INSIDE), vd_set(APART));
  vm outside = vm_without(all, within);
  if (vm_any(outside))
    look_at_edges(&t, x, in, outside, radius2, &out);
  out.at = vd_pick(border, vd_set(UNCLEAR), out.at);
  return out;
}

#endif
