/* Support for the tests of meshes: triangles, the contacts of a sphere, and distances found in another way. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_MESH_SUPPORT_H
#define TEST_MESH_SUPPORT_H

#include "dem/geometry/mesh/mesh.h"
#include "dem/geometry/mesh/mesh_contact.h"
#include "dem/geometry/mesh/mesh_tree.h"
#include "test_dem_support.h"
#include "test_random.h"

/* a growing list of triangles */
static inline void add(tdm_stl *s, tdm_vec3 a, tdm_vec3 b, tdm_vec3 c) {
  s->corner = realloc(s->corner, 3 * (size_t)(s->count + 1) * sizeof *s->corner);
  tdm_vec3 *to = &s->corner[3 * (size_t)s->count++];
  to[0] = a;
  to[1] = b;
  to[2] = c;
}

static inline void add_quad(tdm_stl *s, tdm_vec3 a, tdm_vec3 b, tdm_vec3 c, tdm_vec3 d) {
  add(s, a, b, c);
  add(s, a, c, d);
}

/* make a mesh and forget the triangles */
static inline dem_mesh *mesh_of(tdm_stl *s, double facet_angle) {
  tdm_error err = {0};
  dem_mesh *m = dem_mesh_make(s, "test", facet_angle, NULL, &err);
  ck_assert_msg(m != NULL, "%s", err.message);
  tdm_stl_destroy(s);
  return m;
}

/* the faces of a cube of edge 1 around `at`, outward; `faces`: bits of -x +x -y +y -z +z */
static inline void add_cube(tdm_stl *s, tdm_vec3 at, unsigned faces) {
  for (int face = 0; face < 6; face++) {
    if (!(faces >> face & 1))
      continue;
    int axis = face / 2;
    double out = face % 2 ? 0.5 : -0.5;
    tdm_vec3 c[4];
    for (int k = 0; k < 4; k++) {
      double u = k == 1 || k == 2 ? 0.5 : -0.5, v = k >= 2 ? 0.5 : -0.5, x[3];
      x[axis] = out;
      x[(axis + 1) % 3] = u;
      x[(axis + 2) % 3] = v;
      c[out > 0 ? k : 3 - k] = tdm_add(at, tdm_v3(x[0], x[1], x[2]));
    }
    add_quad(s, c[0], c[1], c[2], c[3]);
  }
}

static inline int contacts(const dem_mesh *m, tdm_vec3 x, double radius, dem_touch *out) {
  int near[4096], n = dem_mesh_near(m, 0, x, radius, near, 4096);
  ck_assert_int_le(n, 4096);
  return dem_mesh_contacts(m, near, 1, n, x, radius, out, DEM_TOUCHES_MAX);
}

/* a soup of triangles of very different sizes */
static inline dem_mesh *soup(int n) {
  tdm_stl s = {0};
  random_state = 7;
  for (int t = 0; t < n; t++) {
    tdm_vec3 a = tdm_v3(between(-1, 1), between(-1, 1), between(-1, 1));
    double size = pow(10, between(-2.5, 0));
    tdm_vec3 b = tdm_v3(a.x + size * uniform(), a.y + size * uniform(), a.z - size * uniform());
    tdm_vec3 c = tdm_v3(a.x - size * uniform(), a.y + size * uniform(), a.z + size * uniform());
    add(&s, a, b, c);
  }
  return mesh_of(&s, DEM_MESH_FACET_ANGLE);
}

/* the point of a triangle nearest to x: in its plane by the normal equations, else the best of the three sides */
static inline tdm_vec3 nearest_by_projection(const tdm_vec3 c[3], tdm_vec3 x) {
  tdm_vec3 u = tdm_sub(c[1], c[0]), v = tdm_sub(c[2], c[0]), r = tdm_sub(x, c[0]), best = c[0];
  double uu = tdm_dot(u, u), uv = tdm_dot(u, v), vv = tdm_dot(v, v), ru = tdm_dot(r, u), rv = tdm_dot(r, v);
  double det = uu * vv - uv * uv, p = (vv * ru - uv * rv) / det, q = (uu * rv - uv * ru) / det;
  if (p >= 0 && q >= 0 && p + q <= 1)
    return tdm_axpy(p, u, tdm_axpy(q, v, c[0]));
  for (int k = 0; k < 3; k++) {
    tdm_vec3 e = tdm_sub(c[(k + 1) % 3], c[k]), w = tdm_sub(x, c[k]);
    tdm_vec3 on = tdm_axpy(fmax(0, fmin(1, tdm_dot(w, e) / tdm_dot(e, e))), e, c[k]);
    if (tdm_norm(tdm_sub(x, on)) < tdm_norm(tdm_sub(x, best)))
      best = on;
  }
  return best;
}

static inline double distance_by_projection(const tdm_vec3 c[3], tdm_vec3 x) {
  return tdm_norm(tdm_sub(x, nearest_by_projection(c, x)));
}

#endif
