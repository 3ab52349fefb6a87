/* The surfaces of primitive shapes: see outline.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/shape/outline.h"

#include <math.h>

enum { SIDES = 24, ARC = 6, PROFILE_MAX = 2 * ARC + 2 };

/* the profile of a solid of revolution about z, with its outer side to the right */
typedef struct {
  int n;
  double rho[PROFILE_MAX], z[PROFILE_MAX];
} profile;

static void add(profile *p, double rho, double z) {
  p->rho[p->n] = rho;
  p->z[p->n++] = z;
}

/* a quarter of a circle about (0, z), from the angle `from` against the plane z [rad] */
static void add_arc(profile *p, double radius, double z, double from) {
  for (int k = 0; k <= ARC; k++) {
    double angle = from + k * 0.5 * M_PI / ARC;
    bool pole = k == (from < 0 ? 0 : ARC);
    add(p, pole ? 0 : radius * cos(angle), z + radius * sin(angle));
  }
}

static tdm_vec3 at(const profile *p, int k, int side) {
  double angle = 2 * M_PI * (side % SIDES) / SIDES;
  return tdm_v3(p->rho[k] * cos(angle), p->rho[k] * sin(angle), p->z[k]);
}

static tdm_status revolve(const profile *p, int body, tdm_scenery *scenery, tdm_error *err) {
  tdm_status status = TDM_OK;
  for (int k = 0; k + 1 < p->n; k++)
    for (int side = 0; side < SIDES && status == TDM_OK; side++) {
      tdm_view_polygon piece = {.body = body, .solid = true};
      piece.corner[piece.ncorner++] = at(p, k, side);
      if (p->rho[k] > 0)
        piece.corner[piece.ncorner++] = at(p, k, side + 1);
      piece.corner[piece.ncorner++] = at(p, k + 1, side + 1);
      if (p->rho[k + 1] > 0)
        piece.corner[piece.ncorner++] = at(p, k + 1, side);
      status = tdm_scenery_add_polygon(scenery, &piece, err);
    }
  return status;
}

tdm_status mbd_outline_sphere(const mbd_outline *o, int body, tdm_scenery *scenery, tdm_error *err) {
  const mbd_outline ends = {.size = {o->size[0], 0, 0}};
  return mbd_outline_capsule(&ends, body, scenery, err);
}

tdm_status mbd_outline_cylinder(const mbd_outline *o, int body, tdm_scenery *scenery, tdm_error *err) {
  const double r = o->size[0], end = 0.5 * o->size[2];
  const profile p = {.n = 4, .rho = {0, r, r, 0}, .z = {-end, -end, end, end}};
  return revolve(&p, body, scenery, err);
}

tdm_status mbd_outline_tube(const mbd_outline *o, int body, tdm_scenery *scenery, tdm_error *err) {
  const double r = o->size[0], inner = o->size[1], end = 0.5 * o->size[2];
  const profile p = {.n = 5, .rho = {inner, r, r, inner, inner}, .z = {-end, -end, end, end, -end}};
  return revolve(&p, body, scenery, err);
}

tdm_status mbd_outline_cone(const mbd_outline *o, int body, tdm_scenery *scenery, tdm_error *err) {
  const double r = o->size[0], l = o->size[2];
  const profile p = {.n = 3, .rho = {0, r, 0}, .z = {-0.25 * l, -0.25 * l, 0.75 * l}};
  return revolve(&p, body, scenery, err);
}

tdm_status mbd_outline_capsule(const mbd_outline *o, int body, tdm_scenery *scenery, tdm_error *err) {
  profile p = {.n = 0};
  add_arc(&p, o->size[0], -0.5 * o->size[2], -0.5 * M_PI);
  if (!(o->size[2] > 0))
    p.n--; /* a sphere: the halves share their rim */
  add_arc(&p, o->size[0], 0.5 * o->size[2], 0);
  return revolve(&p, body, scenery, err);
}

tdm_status mbd_outline_box(const mbd_outline *o, int body, tdm_scenery *scenery, tdm_error *err) {
  /* faces by the bits of their corners, x y z, seen from outside counterclockwise */
  static const int face[6][4] = {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}};
  tdm_status status = TDM_OK;
  for (int f = 0; f < 6 && status == TDM_OK; f++) {
    tdm_view_polygon piece = {.body = body, .solid = true, .ncorner = 4};
    for (int k = 0; k < 4; k++) {
      int bits = face[f][3 - k];
      piece.corner[k] = tdm_v3((bits & 1 ? 0.5 : -0.5) * o->size[0], (bits & 2 ? 0.5 : -0.5) * o->size[1],
                               (bits & 4 ? 0.5 : -0.5) * o->size[2]);
    }
    status = tdm_scenery_add_polygon(scenery, &piece, err);
  }
  return status;
}
