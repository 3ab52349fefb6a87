/* Cylinders and cones. Their walls are of three surfaces: a cylinder without ends is solid behind its surface; a piece
 * of a cylinder or a cone is a thin shell when the particles are inside, so they can leave by its ends and meet it from
 * behind, and a solid with flat ends when they are outside. With windows it is a thin shell always. Distances:
 * frustum.h, windows.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/frustum.h"
#include "dem/geometry/shape/plane.h"
#include "dem/geometry/windows.h"

#include <stdlib.h>

static const dem_shape solid_frustum, with_windows;

/* ---- reading ---- */

/* the rotation that turns z into the direction `axis` the short way */
static tdm_quat turn_to(tdm_vec3 axis) {
  tdm_vec3 z = {0, 0, 1}, a = tdm_unit(axis), turn = tdm_cross(z, a);
  double sine = tdm_norm(turn);
  if (sine == 0)
    return a.z < 0 ? (tdm_quat){0, 1, 0, 0} : tdm_quat_identity();
  return tdm_quat_from_rotvec(tdm_scale(atan2(sine, a.z) / sine, turn));
}

/* the rotation that turns z into `axis` and x into the projection of the body's x across it, of its y where the axis is
 * along x: angles of windows count from there */
static tdm_quat turn_from_x(tdm_vec3 axis) {
  tdm_vec3 a = tdm_unit(axis), x = tdm_axpy(-a.x, a, tdm_v3(1, 0, 0));
  x = tdm_unit(tdm_norm(x) > 1e-6 ? x : tdm_axpy(-a.y, a, tdm_v3(0, 1, 0)));
  tdm_vec3 y = tdm_cross(a, x);
  return tdm_quat_from_matrix((tdm_mat3){{{x.x, y.x, a.x}, {x.y, y.y, a.y}, {x.z, y.z, a.z}}});
}

/* "windows": the wall takes them */
static void read_windows(tdm_object *o, tdm_vec3 axis, bool endless, dem_wall *wall) {
  if (!tdm_has(o, "windows"))
    return;
  if (!wall->inside)
    tdm_object_fail(o, "windows",
                    "are in walls seen from inside; give \"side\": \"inside\": a wall with windows is "
                    "felt from outside too");
  else if (endless)
    tdm_object_fail(o, "windows", "are in walls that end; give \"length\" too");
  wall->data = dem_windows_read(o, wall->length);
  if (!wall->data)
    return;
  wall->turn = turn_from_x(axis);
  wall->shape = &with_windows;
  wall->endless = false;
}

/* a flat end: a plane that looks along `out` times the axis, seen from inside */
static void append_end(dem_wall_list *list, const dem_wall *of, double z, double out, tdm_error *err) {
  tdm_vec3 axis = tdm_quat_rotate(of->turn, tdm_v3(0, 0, 1));
  dem_walls_append(list, dem_plane(of->body, tdm_axpy(z, axis, of->point), tdm_scale(-out, axis)), err);
}

/* what cylinders and cones have in common; radius and length are set */
static void read_round(tdm_object *o, dem_wall wall, bool endless, dem_wall_list *list) {
  wall.point = tdm_get_vec3(o, "point", &(tdm_vec3){0, 0, 0});
  tdm_vec3 axis = tdm_get_vec3(o, "axis", &(tdm_vec3){0, 0, 1});
  if (!o->err->status && tdm_norm(axis) < 1e-9)
    tdm_object_fail(o, "axis", "is the zero vector; give the direction from the first end to the second");
  wall.turn = turn_to(axis);
  wall.surface.angular.z = tdm_get_number(o, "surface_spin", 0, TDM_ANY);
  wall.inside = tdm_get_choice(o, "side", dem_sides, 2, -1) == 0;
  bool ends = tdm_get_bool(o, "ends", false);
  if (tdm_has(o, "ends")) {
    if (!wall.inside)
      tdm_object_fail(o, "ends", "only \"side\": \"inside\" asks for ends: a solid has them; remove the key");
    else if (ends && endless)
      tdm_object_fail(o, "ends", "are where the length ends; give \"length\" too, or remove the key");
  }
  bool cylinder = wall.radius[0] == wall.radius[1];
  bool whole = endless || (cylinder && ends);
  wall.shape = whole ? &dem_shape_cylinder : wall.inside ? &dem_shape_cone : &solid_frustum;
  wall.endless = whole && wall.inside;
  read_windows(o, axis, endless, &wall);
  dem_walls_append(list, wall, o->err);
  if (ends) {
    append_end(list, &wall, 0, -1, o->err);
    append_end(list, &wall, wall.length, 1, o->err);
  }
}

static void read_cylinder(tdm_object *o, int body, dem_wall_list *list) {
  double radius = tdm_get_number(o, "radius", TDM_REQUIRED, TDM_POSITIVE);
  bool endless = !tdm_has(o, "length");
  double length = tdm_get_number(o, "length", 1, TDM_POSITIVE);
  read_round(o, (dem_wall){.body = body, .radius = {radius, radius}, .length = length}, endless, list);
}

static void read_cone(tdm_object *o, int body, dem_wall_list *list) {
  dem_wall wall = {.body = body};
  bool there = tdm_get_numbers(o, "radii", wall.radius, 2, true);
  if (there && !(wall.radius[0] >= 0 && wall.radius[1] >= 0 && wall.radius[0] + wall.radius[1] > 0))
    tdm_object_fail(o, "radii", "are [%g, %g] m but must be 0 or greater, and not both 0", wall.radius[0],
                    wall.radius[1]);
  wall.length = tdm_get_number(o, "length", TDM_REQUIRED, TDM_POSITIVE);
  read_round(o, wall, false, list);
}

/* ---- what all three do ---- */

static void box_of_piece(const dem_wall *wall, tdm_vec3 *low, tdm_vec3 *high) {
  const double r = fmax(wall->radius[0], wall->radius[1]);
  *low = tdm_v3(-r, -r, 0);
  *high = tdm_v3(r, r, wall->length);
}

static void include(tdm_vec3 x, tdm_vec3 up, double reach, double *low, double *high) {
  *low = fmin(*low, tdm_dot(x, up) - reach);
  *high = fmax(*high, tdm_dot(x, up) + reach);
}

/* an end is a disc: its radius times the sine between axis and up */
static void extent_of_piece(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 up, double *low, double *high) {
  tdm_vec3 axis = tdm_m3_mul(place->axes, tdm_v3(0, 0, 1));
  double sine = tdm_norm(tdm_cross(axis, up));
  include(place->point, up, wall->radius[0] * sine, low, high);
  include(tdm_axpy(wall->length, axis, place->point), up, wall->radius[1] * sine, low, high);
}

/* it is largest on the rims, where enough places are looked at */
static double belt_speed_of_piece(const dem_wall *wall) {
  enum { AROUND = 32 };
  double fastest = 0;
  for (int k = 0; k < 2 * AROUND; k++) {
    double angle = 2 * M_PI * (k / 2) / AROUND, r = wall->radius[k % 2];
    tdm_vec3 own = {r * cos(angle), r * sin(angle), k % 2 * wall->length};
    fastest = fmax(fastest, tdm_norm(dem_wall_belt(wall, own)));
  }
  return fastest;
}

/* A panel of the curved surface, between two angles and two heights at which it has these radii. */
static void draw_panel(const dem_wall *wall, const dem_wall_view *view, const double angle[2], const double height[2],
                       const double radius[2], dem_polygons *all, tdm_error *err) {
  dem_polygon p = {.body = wall->body, .solid = wall->shape == &solid_frustum, .ncorner = 4};
  for (int k = 0; k < 4; k++) {
    double a = angle[k == 1 || k == 2], r = radius[k / 2];
    p.corner[k] = dem_wall_world(view->place, tdm_v3(r * cos(a), r * sin(a), height[k / 2]));
  }
  dem_polygons_add(all, &p, err);
}

enum { SIDES = 60 };

static double side_angle(int k) {
  return 2 * M_PI * k / SIDES;
}

/* the curved surface between z = low and z = high */
static void draw_round(const dem_wall *wall, const dem_wall_view *view, double low, double high, dem_polygons *all,
                       tdm_error *err) {
  for (int k = 0; k < SIDES && err->status == TDM_OK; k++)
    draw_panel(wall, view, (double[]){side_angle(k), side_angle(k + 1)}, (double[]){low, high}, wall->radius, all, err);
}

static void draw_piece(const dem_wall *wall, const dem_wall_view *view, dem_polygons *all, tdm_error *err) {
  draw_round(wall, view, 0, wall->length, all, err);
}

/* ---- without ends ---- */

static double gap_of_cylinder(const dem_wall *wall, tdm_vec3 x, tdm_vec3 *normal) {
  return dem_cylinder_gap(wall->radius[0], wall->inside, x, normal);
}

/* as far as its middle */
static void bounds_of_cylinder(const dem_wall *wall, const tdm_pose *frame, dem_bounds *bounds) {
  const double r = wall->radius[0];
  dem_bounds_add_box(bounds, *frame, tdm_v3(r, r, 0));
}

/* as far as the bounds reach along its axis */
static void draw_cylinder(const dem_wall *wall, const dem_wall_view *view, dem_polygons *all, tdm_error *err) {
  const dem_bounds *bounds = view->bounds;
  double low = INFINITY, high = -INFINITY;
  for (int k = 0; k < 8; k++) {
    tdm_vec3 corner = tdm_v3(k & 1 ? bounds->high.x : bounds->low.x, k & 2 ? bounds->high.y : bounds->low.y,
                             k & 4 ? bounds->high.z : bounds->low.z);
    double z = dem_wall_own(view->place, corner).z;
    low = fmin(low, z);
    high = fmax(high, z);
  }
  draw_round(wall, view, low, high, all, err);
}

const dem_shape dem_shape_cylinder = {
    .type = "cylinder",
    .number = 2,
    .read = read_cylinder,
    .gap = gap_of_cylinder,
    .bounds = bounds_of_cylinder,
    .polygons = draw_cylinder,
};

/* ---- pieces ---- */

static double gap_of_shell(const dem_wall *wall, tdm_vec3 x, tdm_vec3 *normal) {
  return dem_shell_gap(wall->radius, wall->length, x, normal);
}

const dem_shape dem_shape_cone = {
    .type = "cone",
    .number = 3,
    .read = read_cone,
    .gap = gap_of_shell,
    .box = box_of_piece,
    .extent = extent_of_piece,
    .belt_speed = belt_speed_of_piece,
    .polygons = draw_piece,
};

static double gap_of_frustum(const dem_wall *wall, tdm_vec3 x, tdm_vec3 *normal) {
  return dem_frustum_gap(wall->radius, wall->length, x, normal);
}

static const dem_shape solid_frustum = {
    .number = 5,
    .gap = gap_of_frustum,
    .box = box_of_piece,
    .extent = extent_of_piece,
    .belt_speed = belt_speed_of_piece,
    .polygons = draw_piece,
};

/* ---- with windows ---- */

static double gap_of_rest(const dem_wall *wall, tdm_vec3 x, tdm_vec3 *normal) {
  return dem_windows_gap(wall->data, wall->radius, wall->length, x, normal);
}

static unsigned long long hash_of_windows(const dem_wall *wall) {
  return dem_windows_hash(wall->data);
}

static int by_number(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* the angles at which panels end, ascending: those of a wall without windows, and where windows begin and end; their
 * number */
static int cuts_of(const dem_windows *windows, double cut[SIDES + 1 + 2 * DEM_WINDOWS_MAX]) {
  int n = 0;
  for (int k = 0; k <= SIDES; k++)
    cut[n++] = side_angle(k);
  for (int k = 0; k < windows->count; k++)
    for (int e = 0; e < 2; e++) {
      double a = fmod(windows->window[k].angle + e * windows->window[k].width, 2 * M_PI);
      cut[n++] = a < 0 ? a + 2 * M_PI : a;
    }
  qsort(cut, (size_t)n, sizeof *cut, by_number);
  return n;
}

static void draw_rest(const dem_wall *wall, const dem_wall_view *view, dem_polygons *all, tdm_error *err) {
  double cut[SIDES + 1 + 2 * DEM_WINDOWS_MAX], rise = (wall->radius[1] - wall->radius[0]) / wall->length;
  const int n = cuts_of(wall->data, cut);
  for (int k = 0; k + 1 < n && err->status == TDM_OK; k++) {
    double height[2] = {0, 0};
    for (; cut[k] < cut[k + 1] &&
           dem_windows_piece(wall->data, wall->length, 0.5 * (cut[k] + cut[k + 1]), &height[0], &height[1]);
         height[0] = height[1])
      draw_panel(wall, view, &cut[k], height,
                 (double[]){wall->radius[0] + rise * height[0], wall->radius[0] + rise * height[1]}, all, err);
  }
}

static const dem_shape with_windows = {
    .number = 11,
    .gap = gap_of_rest,
    .box = box_of_piece,
    .extent = extent_of_piece,
    .belt_speed = belt_speed_of_piece,
    .polygons = draw_rest,
    .hash = hash_of_windows,
    .destroy = free,
};
