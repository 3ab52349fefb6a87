/* Planes: half-spaces that are solid behind the plane. They have no edges. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/shape/plane.h"

static void read_plane(tdm_object *o, int body, dem_wall_list *list) {
  tdm_vec3 point = tdm_get_vec3(o, "point", &(tdm_vec3){0, 0, 0});
  tdm_vec3 normal = tdm_get_vec3(o, "normal", NULL);
  if (!o->err->status && tdm_norm(normal) < 1e-9)
    tdm_object_fail(o, "normal", "is the zero vector; give the direction from the wall towards the particles");
  dem_walls_append(list, dem_plane(body, point, tdm_unit(normal)), o->err);
}

/* ---- drawing ---- */

/* Keep the part of the polygon where a·x <= b (Sutherland and Hodgman 1974). */
static void cut(dem_polygon *p, tdm_vec3 a, double b) {
  dem_polygon out = *p;
  out.ncorner = 0;
  for (int i = 0; i < p->ncorner; i++) {
    tdm_vec3 x = p->corner[i], y = p->corner[(i + 1) % p->ncorner];
    double dx = tdm_dot(a, x) - b, dy = tdm_dot(a, y) - b;
    if (dx <= 0 && out.ncorner < DEM_CORNERS_MAX)
      out.corner[out.ncorner++] = x;
    if ((dx < 0 && dy > 0) || (dx > 0 && dy < 0))
      if (out.ncorner < DEM_CORNERS_MAX)
        out.corner[out.ncorner++] = tdm_axpy(dx / (dx - dy), tdm_sub(y, x), x);
  }
  *p = out;
}

/* The part of a plane inside a box of edges 2 half around `center`, both in the box's axes. */
static void plane_in_box(dem_polygon *p, tdm_vec3 point, tdm_vec3 normal, tdm_vec3 center, tdm_vec3 half) {
  tdm_vec3 other = fabs(normal.x) < 0.6 ? tdm_v3(1, 0, 0) : tdm_v3(0, 1, 0);
  tdm_vec3 u = tdm_cross(normal, other);
  u = tdm_scale(1 / tdm_norm(u), u);
  tdm_vec3 v = tdm_cross(normal, u);
  double size = 2 * tdm_norm(half);
  tdm_vec3 foot = tdm_axpy(-tdm_dot(tdm_sub(center, point), normal), normal, center);
  p->ncorner = 4;
  for (int k = 0; k < 4; k++)
    p->corner[k] = tdm_axpy(k == 0 || k == 3 ? -size : size, u, tdm_axpy(k < 2 ? -size : size, v, foot));
  const double c[3] = {center.x, center.y, center.z}, h[3] = {half.x, half.y, half.z};
  double slack = 1e-9 * size; /* a face of the box is not cut away */
  for (int a = 0; a < 3; a++) {
    tdm_vec3 axis = tdm_v3(a == 0, a == 1, a == 2);
    cut(p, axis, c[a] + h[a] + slack);
    cut(p, tdm_scale(-1, axis), -(c[a] - h[a]) + slack);
  }
}

/* The container whose face this plane is, NULL when it is none. */
static const dem_box *container_of(const dem_wall_view *view, const dem_wall *wall) {
  for (int k = 0; k < view->nbox; k++) {
    const dem_box *box = &view->box[k];
    tdm_vec3 off = tdm_sub(wall->point, box->center), n = tdm_quat_rotate(tdm_quat_conj(box->turn), wall->normal);
    double depth = fabs(n.x) * box->half.x + fabs(n.y) * box->half.y + fabs(n.z) * box->half.z;
    double largest = fmax(fabs(n.x), fmax(fabs(n.y), fabs(n.z)));
    if (box->body == wall->body && largest > 1 - 1e-12 && fabs(tdm_dot(off, wall->normal) + depth) <= 1e-9 * depth)
      return box;
  }
  return NULL;
}

/* cut to its container, or else to the bounds of the scene */
static void draw_plane(const dem_wall *wall, const dem_wall_view *view, dem_polygons *all, tdm_error *err) {
  dem_polygon p = {.body = wall->body};
  const dem_box *box = container_of(view, wall);
  if (box) { /* in the box's axes: its own turn, then the body's pose */
    tdm_quat back = tdm_quat_conj(box->turn);
    tdm_vec3 point = tdm_quat_rotate(back, tdm_sub(wall->point, box->center));
    plane_in_box(&p, point, tdm_quat_rotate(back, wall->normal), tdm_v3(0, 0, 0), box->half);
    for (int k = 0; k < p.ncorner; k++) {
      tdm_vec3 x = tdm_add(box->center, tdm_quat_rotate(box->turn, p.corner[k]));
      p.corner[k] = tdm_pose_point(*view->pose, tdm_axpy(-view->lid, wall->normal, x));
    }
  } else {
    const dem_bounds *b = view->bounds;
    plane_in_box(&p, view->place->point, view->place->normal, tdm_scale(0.5, tdm_add(b->low, b->high)),
                 tdm_scale(0.5, tdm_sub(b->high, b->low)));
  }
  if (p.ncorner >= 3)
    dem_polygons_add(all, &p, err);
}

const dem_shape dem_shape_plane = {
    .type = "plane",
    .number = 0,
    .half_space = true,
    .read = read_plane,
    .polygons = draw_plane,
};
