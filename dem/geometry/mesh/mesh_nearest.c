/* The nearest point of a triangle of a mesh: see mesh_nearest.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/mesh/mesh_nearest.h"

/* The regions of a triangle: the prism over its face, bounded by the planes through its edges; outside of one of them
 * and between the edge's ends the edge; else the nearest corner. All triangles of an edge take the same number for the
 * place along it, so that they agree on where it ends. */
dem_nearest dem_mesh_nearest(const dem_mesh *m, int face, tdm_vec3 x) {
  const dem_face *f = &m->face[face];
  dem_nearest best = {.distance2 = INFINITY};
  bool within = true;
  for (int k = 0; k < 3; k++) {
    const dem_edge *e = &m->edge[f->edge[k]];
    tdm_vec3 from = m->vertex[e->a], r = tdm_sub(x, from);
    double in = tdm_dot(r, f->inward[k]), along = tdm_dot(r, e->along);
    if (in > 0 || (in == 0 && !f->strict[k]))
      continue;
    within = false;
    if (!(along > 0 && along < e->length2))
      continue;
    tdm_vec3 q = tdm_axpy(along / e->length2, e->along, from), d = tdm_sub(x, q);
    double distance2 = tdm_dot(d, d);
    if (distance2 < best.distance2)
      best = (dem_nearest){DEM_ON_EDGE, f->edge[k], q, distance2};
  }
  if (within) {
    double h = tdm_dot(tdm_sub(x, m->vertex[f->vertex[0]]), f->normal);
    return (dem_nearest){DEM_ON_FACE, face, tdm_axpy(-h, f->normal, x), h * h};
  }
  if (best.distance2 < INFINITY)
    return best;
  for (int k = 0; k < 3; k++) {
    int v = f->vertex[k];
    tdm_vec3 d = tdm_sub(x, m->vertex[v]);
    double distance2 = tdm_dot(d, d);
    if (distance2 < best.distance2 || (distance2 == best.distance2 && v < best.feature))
      best = (dem_nearest){DEM_ON_VERTEX, v, m->vertex[v], distance2};
  }
  return best;
}

double dem_mesh_normal(const dem_mesh *m, int face, const dem_nearest *at, tdm_vec3 x, tdm_vec3 *normal) {
  const dem_face *f = &m->face[face];
  bool flat = at->on == DEM_ON_FACE || (at->on == DEM_ON_EDGE && m->edge[at->feature].kind == DEM_EDGE_FLAT) ||
              (at->on == DEM_ON_VERTEX && m->flat[at->feature]);
  double gap = sqrt(at->distance2);
  if (flat || gap == 0) {
    double h = tdm_dot(tdm_sub(x, m->vertex[f->vertex[0]]), f->normal);
    *normal = h < 0 ? tdm_scale(-1, f->normal) : f->normal;
    return flat ? fabs(h) : 0;
  }
  *normal = tdm_scale(1 / gap, tdm_sub(x, at->point));
  return gap;
}
