/* Walls as polygons, for pictures and ParaView: see polygon.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/output/polygon.h"

#include <stdlib.h>

static const tdm_vec3 unknown = {NAN, NAN, NAN};

void dem_polygons_free(dem_polygons *p) {
  free(p->polygon);
  *p = (dem_polygons){0};
}

static tdm_status append(dem_polygons *all, const dem_polygon *polygon, tdm_error *err) {
  if (all->count == all->capacity) {
    int room = 2 * all->capacity + 16;
    dem_polygon *grown = realloc(all->polygon, (size_t)room * sizeof *grown);
    if (!grown)
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d walls", all->count);
    all->polygon = grown;
    all->capacity = room;
  }
  all->polygon[all->count++] = *polygon;
  return TDM_OK;
}

/* ---- planes ---- */

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
static const dem_box *container_of(const dem_model *m, const dem_wall *wall) {
  for (int k = 0; k < m->nbox; k++) {
    const dem_box *box = &m->box[k];
    tdm_vec3 off = tdm_sub(wall->point, box->center), n = tdm_quat_rotate(tdm_quat_conj(box->turn), wall->normal);
    double depth = fabs(n.x) * box->half.x + fabs(n.y) * box->half.y + fabs(n.z) * box->half.z;
    double largest = fmax(fabs(n.x), fmax(fabs(n.y), fabs(n.z)));
    if (box->body == wall->body && largest > 1 - 1e-12 && fabs(tdm_dot(off, wall->normal) + depth) <= 1e-9 * depth)
      return box;
  }
  return NULL;
}

static tdm_status add_plane(dem_polygons *all, const dem_data *d, int w, const dem_bounds *bounds, tdm_error *err) {
  const dem_wall *wall = &d->model->wall[w];
  dem_polygon p = {.body = wall->body, .force = unknown};
  const dem_box *box = container_of(d->model, wall);
  if (box) { /* in the box's axes: its own turn, then the body's pose */
    tdm_quat back = tdm_quat_conj(box->turn);
    tdm_vec3 point = tdm_quat_rotate(back, tdm_sub(wall->point, box->center));
    plane_in_box(&p, point, tdm_quat_rotate(back, wall->normal), tdm_v3(0, 0, 0), box->half);
    for (int k = 0; k < p.ncorner; k++) {
      tdm_vec3 x = tdm_add(box->center, tdm_quat_rotate(box->turn, p.corner[k]));
      p.corner[k] = tdm_pose_point(d->pose[wall->body], tdm_axpy(-d->lid[w], wall->normal, x));
    }
  } else {
    plane_in_box(&p, d->wall[w].point, d->wall[w].normal, tdm_scale(0.5, tdm_add(bounds->low, bounds->high)),
                 tdm_scale(0.5, tdm_sub(bounds->high, bounds->low)));
  }
  return p.ncorner < 3 ? TDM_OK : append(all, &p, err);
}

/* ---- solids, shells, meshes ---- */

static tdm_vec3 to_world(const dem_wall_place *place, tdm_vec3 own) {
  return tdm_add(place->point, tdm_m3_mul(place->axes, own));
}

static void add_box(dem_polygons *all, const dem_wall *wall, const dem_wall_place *place, tdm_error *err) {
  /* corner k has + on axis a where bit a is set */
  static const int face[6][4] = {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}};
  for (int f = 0; f < 6 && err->status == TDM_OK; f++) {
    dem_polygon p = {.body = wall->body, .solid = true, .ncorner = 4, .force = unknown};
    for (int i = 0; i < 4; i++) {
      int k = face[f][i];
      p.corner[i] = to_world(place, tdm_v3(k & 1 ? wall->half.x : -wall->half.x, k & 2 ? wall->half.y : -wall->half.y,
                                           k & 4 ? wall->half.z : -wall->half.z));
    }
    append(all, &p, err);
  }
}

/* The curved surface between z = low and z = high of the wall's own axes. */
static void add_round(dem_polygons *all, const dem_wall *wall, const dem_wall_place *place, double low, double high,
                      tdm_error *err) {
  enum { SIDES = 60 };
  for (int k = 0; k < SIDES && err->status == TDM_OK; k++) {
    double a = 2 * M_PI * k / SIDES, b = 2 * M_PI * (k + 1) / SIDES;
    dem_polygon p = {.body = wall->body, .solid = wall->primitive == DEM_SOLID_FRUSTUM, .ncorner = 4};
    p.force = unknown;
    p.corner[0] = to_world(place, tdm_v3(wall->radius[0] * cos(a), wall->radius[0] * sin(a), low));
    p.corner[1] = to_world(place, tdm_v3(wall->radius[0] * cos(b), wall->radius[0] * sin(b), low));
    p.corner[2] = to_world(place, tdm_v3(wall->radius[1] * cos(b), wall->radius[1] * sin(b), high));
    p.corner[3] = to_world(place, tdm_v3(wall->radius[1] * cos(a), wall->radius[1] * sin(a), high));
    append(all, &p, err);
  }
}

/* A ball as facets between circles of latitude. */
static void add_ball(dem_polygons *all, const dem_wall *wall, const dem_wall_place *place, tdm_error *err) {
  enum { BANDS = 18, SIDES = 36 };
  const double r = wall->radius[0];
  for (int k = 0; k < BANDS * SIDES && err->status == TDM_OK; k++) {
    const double low = M_PI * (k / SIDES) / BANDS - M_PI / 2, high = low + M_PI / BANDS;
    const double from = 2 * M_PI * (k % SIDES) / SIDES, to = from + 2 * M_PI / SIDES;
    const double latitude[] = {low, low, high, high}, longitude[] = {from, to, to, from};
    dem_polygon p = {.body = wall->body, .solid = !wall->inside, .ncorner = 4, .force = unknown};
    for (int c = 0; c < 4; c++)
      p.corner[c] = to_world(place, tdm_v3(r * cos(latitude[c]) * cos(longitude[c]),
                                           r * cos(latitude[c]) * sin(longitude[c]), r * sin(latitude[c])));
    append(all, &p, err);
  }
}

/* A cylinder without ends, as far as the bounds reach along its axis. */
static void add_cylinder(dem_polygons *all, const dem_wall *wall, const dem_wall_place *place, const dem_bounds *bounds,
                         tdm_error *err) {
  double low = INFINITY, high = -INFINITY;
  for (int k = 0; k < 8; k++) {
    tdm_vec3 corner = tdm_v3(k & 1 ? bounds->high.x : bounds->low.x, k & 2 ? bounds->high.y : bounds->low.y,
                             k & 4 ? bounds->high.z : bounds->low.z);
    double z = dem_wall_own(place, corner).z;
    low = fmin(low, z);
    high = fmax(high, z);
  }
  add_round(all, wall, place, low, high, err);
}

/* force: of its triangles, or NULL */
static void add_mesh(dem_polygons *all, const dem_wall *wall, const dem_wall_place *place, const tdm_vec3 *force,
                     tdm_error *err) {
  for (int t = 0; t < dem_mesh_figures(wall->mesh)->triangles && err->status == TDM_OK; t++) {
    dem_polygon p = {.body = wall->body, .ncorner = 3, .force = force ? force[t] : unknown};
    tdm_vec3 corner[3], normal;
    dem_mesh_triangle(wall->mesh, t, corner, &normal);
    for (int k = 0; k < 3; k++)
      p.corner[k] = to_world(place, corner[k]);
    append(all, &p, err);
  }
}

tdm_status dem_polygons_make(dem_polygons *all, const dem_data *d, const dem_bounds *bounds, tdm_error *err) {
  const dem_model *m = d->model;
  all->count = 0;
  all->forces = d->traction.force != NULL;
  for (int w = 0; w < m->nwall && err->status == TDM_OK; w++) {
    const dem_wall *wall = &m->wall[w];
    const dem_wall_place *place = &d->wall[w];
    switch (wall->primitive) {
    case DEM_PLANE:
      add_plane(all, d, w, bounds, err);
      break;
    case DEM_SOLID_BOX:
      add_box(all, wall, place, err);
      break;
    case DEM_CYLINDER:
      add_cylinder(all, wall, place, bounds, err);
      break;
    case DEM_BALL:
      add_ball(all, wall, place, err);
      break;
    case DEM_SHELL:
    case DEM_SOLID_FRUSTUM:
      add_round(all, wall, place, 0, wall->length, err);
      break;
    case DEM_MESH:
      add_mesh(all, wall, place, all->forces ? &d->traction.force[m->first_triangle[w]] : NULL, err);
      break;
    }
  }
  return err->status;
}
