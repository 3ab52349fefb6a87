/* Discs: flat rings of no thickness, felt from both sides, whose rims are edges. Distance: dem_ring_gap, as of decks.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/frustum.h"
#include "dem/geometry/shape/rows.h"

static void read_disc(tdm_object *o, int body, dem_wall_list *list) {
  double inner = tdm_get_number(o, "inner_radius", 0, TDM_NOT_NEGATIVE);
  double outer = tdm_get_number(o, "radius", TDM_REQUIRED, TDM_POSITIVE);
  if (!o->err->status && inner >= outer)
    tdm_object_fail(o, "inner_radius", "is %g m but must be less than \"radius\", %g m", inner, outer);
  dem_wall wall = {.shape = &dem_shape_disc, .body = body, .radius = {inner, outer}};
  wall.point = tdm_get_vec3(o, "center", &(tdm_vec3){0, 0, 0});
  wall.turn = tdm_get_orientation(o, "orientation");
  dem_walls_append(list, wall, o->err);
}

static double gap_of_disc(const dem_wall *wall, tdm_vec3 x, tdm_vec3 *normal) {
  return dem_ring_gap(wall->radius[0], wall->radius[1], x, normal);
}

static void box_of_disc(const dem_wall *wall, tdm_vec3 *low, tdm_vec3 *high) {
  const double r = wall->radius[1];
  *low = tdm_v3(-r, -r, 0);
  *high = tdm_v3(r, r, 0);
}

static void draw_disc(const dem_wall *wall, const dem_wall_view *view, dem_polygons *all, tdm_error *err) {
  dem_wall_draw_ring(wall, view, wall->radius[0], wall->radius[1], false, all, err);
}

const dem_shape dem_shape_disc = {
    .type = "disc",
    .number = 12,
    .read = read_disc,
    .gap = gap_of_disc,
    .box = box_of_disc,
    .polygons = draw_disc,
};
