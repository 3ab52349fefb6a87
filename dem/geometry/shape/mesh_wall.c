/* Meshes, thin shells: see geometry/mesh/mesh.h. Their parts are the triangles. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/mesh/mesh.h"
#include "dem/geometry/mesh/mesh_contact.h"
#include "dem/geometry/mesh/mesh_tree.h"
#include "dem/geometry/shape/rows.h"

#include <stdarg.h>
#include <stdio.h>

static void read_mesh(tdm_object *o, int body, dem_wall_list *list) {
  const char *file = tdm_get_string(o, "file", NULL);
  double scale = tdm_get_number(o, "scale", 1, TDM_POSITIVE);
  double facet_angle = tdm_get_number(o, "facet_angle", DEM_MESH_FACET_ANGLE, TDM_NOT_NEGATIVE);
  if (facet_angle > 0.5 * M_PI)
    tdm_object_fail(o, "facet_angle", "is %g rad but must be at most a right angle, %.4g rad", facet_angle, 0.5 * M_PI);
  if (o->err->status)
    return;
  char path[TDM_PATH_MAX];
  tdm_stl stl;
  if (tdm_stl_read(&stl, file, scale, tdm_path(path, o, "file", -1), o->err) == TDM_OK &&
      dem_part_place(o, &list->part, file, scale, &stl) == TDM_OK) {
    dem_mesh *mesh = dem_mesh_make(&stl, file, facet_angle, path, o->err);
    if (mesh)
      dem_walls_append(list, (dem_wall){.shape = &dem_shape_mesh, .body = body, .data = mesh}, o->err);
  }
  tdm_stl_destroy(&stl);
}

static double gap_of_mesh(const dem_wall *wall, tdm_vec3 x, tdm_vec3 *normal) {
  return dem_mesh_gap(wall->data, x, normal);
}

static void box_of_mesh(const dem_wall *wall, tdm_vec3 *low, tdm_vec3 *high) {
  *low = dem_mesh_figures(wall->data)->low;
  *high = dem_mesh_figures(wall->data)->high;
}

static void draw_mesh(const dem_wall *wall, const dem_wall_view *view, dem_polygons *all, tdm_error *err) {
  for (int t = 0; t < dem_mesh_figures(wall->data)->triangles && err->status == TDM_OK; t++) {
    dem_polygon p = {.body = wall->body, .part = t, .ncorner = 3};
    tdm_vec3 corner[3], normal;
    dem_mesh_triangle(wall->data, t, corner, &normal);
    for (int k = 0; k < 3; k++)
      p.corner[k] = dem_wall_world(view->place, corner[k]);
    dem_polygons_add(all, &p, err);
  }
}

static int triangles_of(const dem_wall *wall) {
  return dem_mesh_figures(wall->data)->triangles;
}

static int within(const dem_wall *wall, tdm_vec3 low, tdm_vec3 high) {
  return dem_mesh_within(wall->data, low, high);
}

static int near_triangles(const dem_wall *wall, int from, tdm_vec3 x, double range, int *out, int max) {
  return dem_mesh_near(wall->data, from, x, range, out, max);
}

static int touches_of(const dem_wall *wall, const int *part, size_t stride, int n, tdm_vec3 x, double radius,
                      dem_touch out[DEM_TOUCHES_MAX]) {
  return dem_mesh_contacts(wall->data, part, stride, n, x, radius, out, DEM_TOUCHES_MAX);
}

static const dem_triangles *lanes_of(const dem_wall *wall) {
  return dem_mesh_triangles(wall->data);
}

static bool passes(const dem_wall *wall, int from, int to) {
  return dem_mesh_passes(wall->data, from, to);
}

static const char *file_of(const dem_wall *wall) {
  return dem_mesh_name(wall->data);
}

static void note(json_t *notes, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void note(json_t *notes, const char *format, ...) {
  char text[TDM_MESSAGE_MAX];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  json_array_append_new(notes, json_string(text));
}

static json_t *report_mesh(const dem_wall *wall, json_t *notes) {
  const dem_mesh_report *of = dem_mesh_figures(wall->data);
  const char *name = dem_mesh_name(wall->data);
  if (of->degenerate + of->duplicate > 0)
    note(notes, "\"%s\": %d triangles without area and %d that are there twice were left out", name, of->degenerate,
         of->duplicate);
  if (of->inverted > 0)
    note(notes, "\"%s\": %d of its %d parts are inside out; particles feel it from both sides all the same", name,
         of->inverted, of->parts);
  if (!of->closed && !wall->plates)
    note(notes, "\"%s\": %d edges belong to one triangle only and %d to more than two; a closed part has none", name,
         of->open, of->nonmanifold);
  return dem_mesh_report_json(wall->data);
}

static unsigned long long hash_of(const dem_wall *wall) {
  return dem_mesh_hash(wall->data);
}

static void destroy(void *data) {
  dem_mesh *mesh = data;
  dem_mesh_destroy(&mesh);
}

const dem_shape dem_shape_mesh = {
    .type = "mesh",
    .number = 6,
    .read = read_mesh,
    .gap = gap_of_mesh,
    .box = box_of_mesh,
    .polygons = draw_mesh,
    .parts = triangles_of,
    .within = within,
    .near = near_triangles,
    .touches = touches_of,
    .triangles = lanes_of,
    .passes = passes,
    .file = file_of,
    .report = report_mesh,
    .hash = hash_of,
    .destroy = destroy,
};
