/* Spheres: solid balls, or containers when the particles are inside. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/shape/rows.h"

static void read_sphere(tdm_object *o, int body, dem_wall_list *list) {
  double radius = tdm_get_number(o, "radius", TDM_REQUIRED, TDM_POSITIVE);
  tdm_vec3 center = tdm_get_vec3(o, "center", &(tdm_vec3){0, 0, 0});
  bool inside = tdm_get_choice(o, "side", dem_sides, 2, 1) == 0;
  dem_wall wall = {.shape = &dem_shape_sphere,
                   .body = body,
                   .point = center,
                   .radius = {radius, radius},
                   .inside = inside,
                   .endless = inside,
                   .solid = !inside};
  dem_walls_append(list, wall, o->err);
}

static double gap_of_sphere(const dem_wall *wall, tdm_vec3 c, tdm_vec3 *normal) {
  double radius = wall->radius[0], from = tdm_norm(c);
  tdm_vec3 out = from > 0 ? tdm_scale(1 / from, c) : tdm_v3(0, 0, 1);
  *normal = wall->inside ? tdm_scale(-1, out) : out;
  return wall->inside ? radius - from : from - radius;
}

static void box_of_sphere(const dem_wall *wall, tdm_vec3 *low, tdm_vec3 *high) {
  const double r = wall->radius[0];
  *low = tdm_v3(-r, -r, -r);
  *high = tdm_v3(r, r, r);
}

static void extent_of_sphere(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 up, double *low,
                             double *high) {
  double at = tdm_dot(place->point, up);
  *low = at - wall->radius[0];
  *high = at + wall->radius[0];
}

/* the rotation's part across the velocity at the centre adds up at most */
static double belt_speed_of_sphere(const dem_wall *wall) {
  return tdm_norm(wall->surface.velocity) + tdm_norm(wall->surface.angular) * wall->radius[0];
}

static void bounds_of_sphere(const dem_wall *wall, const tdm_pose *frame, dem_bounds *bounds) {
  dem_bounds_add(bounds, frame->position, wall->radius[0]);
}

/* facets between circles of latitude */
static void draw_sphere(const dem_wall *wall, const dem_wall_view *view, dem_polygons *all, tdm_error *err) {
  enum { BANDS = 18, SIDES = 36 };
  const double r = wall->radius[0];
  for (int k = 0; k < BANDS * SIDES && err->status == TDM_OK; k++) {
    const double low = M_PI * (k / SIDES) / BANDS - M_PI / 2, high = low + M_PI / BANDS;
    const double from = 2 * M_PI * (k % SIDES) / SIDES, to = from + 2 * M_PI / SIDES;
    const double latitude[] = {low, low, high, high}, longitude[] = {from, to, to, from};
    dem_polygon p = {.body = wall->body, .solid = !wall->inside, .ncorner = 4};
    for (int c = 0; c < 4; c++) {
      tdm_vec3 own = tdm_v3(r * cos(latitude[c]) * cos(longitude[c]), r * cos(latitude[c]) * sin(longitude[c]),
                            r * sin(latitude[c]));
      p.corner[c] = dem_wall_world(view->place, own);
    }
    dem_polygons_add(all, &p, err);
  }
}

const dem_shape dem_shape_sphere = {
    .type = "sphere",
    .number = 4,
    .read = read_sphere,
    .gap = gap_of_sphere,
    .box = box_of_sphere,
    .extent = extent_of_sphere,
    .belt_speed = belt_speed_of_sphere,
    .bounds = bounds_of_sphere,
    .polygons = draw_sphere,
};
