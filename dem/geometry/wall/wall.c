/* What all walls do alike: see wall.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/wall/wall.h"

#include <stdlib.h>

const char *const dem_sides[2] = {"inside", "outside"};

void dem_walls_append(dem_wall_list *list, dem_wall wall, tdm_error *err) {
  dem_wall *grown = realloc(list->wall, (size_t)(list->count + 1) * sizeof *grown);
  if (!grown) {
    dem_wall_release(&wall);
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for wall %d", list->count);
    return;
  }
  list->wall = grown;
  list->wall[list->count++] = wall;
}

void dem_walls_append_box(dem_wall_list *list, dem_box box, tdm_error *err) {
  dem_box *grown = realloc(list->box, (size_t)(list->nbox + 1) * sizeof *grown);
  if (!grown) {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for box %d", list->nbox);
    return;
  }
  list->box = grown;
  list->box[list->nbox++] = box;
}

void dem_wall_release(dem_wall *wall) {
  if (wall->shape->destroy)
    wall->shape->destroy(wall->data);
  wall->data = NULL;
}

dem_wall_place dem_wall_put(const dem_wall *wall, const tdm_pose *pose) {
  dem_wall_place place;
  tdm_mat3 body = tdm_quat_to_matrix(pose->orientation);
  place.point = tdm_add(pose->position, tdm_m3_mul(body, wall->point));
  place.normal = tdm_m3_mul(body, wall->normal);
  place.axes = tdm_quat_to_matrix(tdm_quat_mul(pose->orientation, tdm_quat_unit(wall->turn)));
  return place;
}

/* corner k of 0 ... 7 of the box around the wall, own axes */
static tdm_vec3 corner_of(const dem_wall *wall, int k) {
  tdm_vec3 least, most;
  wall->shape->box(wall, &least, &most);
  return tdm_v3(k & 1 ? most.x : least.x, k & 2 ? most.y : least.y, k & 4 ? most.z : least.z);
}

/* The speed of a rotation with a translation is convex: it is largest at a corner. */
double dem_wall_belt_speed(const dem_wall *wall) {
  if (wall->shape->belt_speed)
    return wall->shape->belt_speed(wall);
  double fastest = 0;
  for (int k = 0; k < 8; k++)
    fastest = fmax(fastest, tdm_norm(dem_wall_belt(wall, corner_of(wall, k))));
  return fastest;
}

bool dem_wall_extent(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 up, double *low, double *high) {
  if (!dem_wall_ends(wall))
    return false;
  *low = INFINITY;
  *high = -INFINITY;
  if (wall->shape->extent) {
    wall->shape->extent(wall, place, up, low, high);
    return true;
  }
  for (int k = 0; k < 8; k++) {
    double at = tdm_dot(dem_wall_world(place, corner_of(wall, k)), up);
    *low = fmin(*low, at);
    *high = fmax(*high, at);
  }
  return true;
}

void dem_wall_bounds(const dem_wall *wall, const tdm_pose *pose, dem_bounds *bounds) {
  tdm_pose frame = dem_frame_at(pose, wall->point, wall->turn);
  if (wall->shape->bounds) {
    wall->shape->bounds(wall, &frame, bounds);
  } else if (dem_wall_ends(wall)) {
    tdm_vec3 low = corner_of(wall, 0), high = corner_of(wall, 7);
    frame = dem_frame_at(&frame, tdm_scale(0.5, tdm_add(low, high)), (tdm_quat){0});
    dem_bounds_add_box(bounds, frame, tdm_scale(0.5, tdm_sub(high, low)));
  }
}

void dem_wall_draw_ring(const dem_wall *wall, const dem_wall_view *view, double inner, double outer, bool solid,
                        dem_polygons *all, tdm_error *err) {
  enum { SECTORS = 72 };
  for (int k = 0; k < SECTORS && err->status == TDM_OK; k++) {
    dem_polygon p = {.body = wall->body, .solid = solid, .part = -1, .ncorner = 4};
    for (int c = 0; c < 4; c++) {
      double angle = 2 * M_PI * (k + c / 2) / SECTORS, r = c == 0 || c == 3 ? inner : outer;
      p.corner[c] = dem_wall_world(view->place, tdm_v3(r * cos(angle), r * sin(angle), 0));
    }
    dem_polygons_add(all, &p, err);
  }
}
