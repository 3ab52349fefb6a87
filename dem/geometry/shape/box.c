/* Boxes: seen from outside one solid box; seen from inside, a container, up to six planes, which act as if the faces
 * were without end, or with "edges" a mesh of plates. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/mesh/mesh.h"
#include "dem/geometry/shape/plane.h"
#include "dem/geometry/shape/rows.h"

#include <string.h>

/* corner k has + on axis a where bit a is set; corners of a face anticlockwise as seen from inside */
static const int face_corners[6][4] = {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1},
                                       {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}};

static tdm_vec3 corner_of(tdm_vec3 half, int k) {
  return tdm_v3(k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z);
}

/* ---- reading ---- */

static const char *const face_names[] = {"-x", "+x", "-y", "+y", "-z", "+z"};

/* which faces stay: those that "open" does not name */
static void read_open(tdm_object *o, bool closed[6]) {
  json_t *open = tdm_get_array(o, "open", false);
  for (int i = 0; i < 6; i++)
    closed[i] = true;
  for (size_t k = 0; k < json_array_size(open); k++) {
    const char *name = json_string_value(json_array_get(open, k));
    int face = 0;
    while (face < 6 && !(name && strcmp(name, face_names[face]) == 0))
      face++;
    if (face < 6) {
      closed[face] = false;
      continue;
    }
    char path[TDM_PATH_MAX];
    tdm_fail(o->err, TDM_ERR_SCENE, tdm_path(path, o, "open", (int)k),
             "is no face of a box; give \"-x\", \"+x\", \"-y\", \"+y\", \"-z\" or \"+z\"");
  }
}

/* "lid": the face that is left out while settling, -1: none */
static int read_lid(tdm_object *o, const bool closed[6], dem_box *box) {
  if (!tdm_has(o, "lid"))
    return -1;
  tdm_object lid = tdm_get_object(o, "lid", true);
  int face = tdm_get_choice(&lid, "face", face_names, 6, -1);
  box->gap = tdm_get_number(&lid, "gap", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  box->press = tdm_get_number(&lid, "press", 0, TDM_NOT_NEGATIVE);
  if (face >= 0 && !closed[face])
    tdm_object_fail(&lid, "face", "\"%s\" is open; remove it from \"open\", or the lid", face_names[face]);
  tdm_object_close(&lid);
  return face;
}

/* The closed faces of a container as plates that end: a mesh of two triangles each. */
static void append_plates(dem_wall_list *list, const dem_box *box, const bool closed[6], const char *path,
                          tdm_error *err) {
  static const int order[6] = {0, 1, 2, 0, 2, 3};
  tdm_vec3 corner[36];
  tdm_stl stl = {0, corner};
  for (int f = 0; f < 6; f++) {
    for (int i = 0; i < 6 && closed[f]; i++) {
      tdm_vec3 own = corner_of(box->half, face_corners[f][order[i]]);
      corner[3 * stl.count + i] = tdm_add(box->center, tdm_quat_rotate(box->turn, own));
    }
    stl.count += closed[f] ? 2 : 0;
  }
  dem_mesh *mesh = dem_mesh_make(&stl, "box", DEM_MESH_FACET_ANGLE, path, err);
  if (mesh)
    dem_walls_append(list, (dem_wall){.shape = &dem_shape_mesh, .body = box->body, .data = mesh, .plates = true}, err);
}

/* "edges": do the walls of a container end? One that is open and does not say so is remembered, for a warning. */
static bool read_edges(tdm_object *o, const bool closed[6], dem_box *box) {
  bool edges = tdm_get_bool(o, "edges", false), any = false, all = true;
  for (int f = 0; f < 6; f++) {
    any = any || closed[f];
    all = all && closed[f];
  }
  box->unsaid = !tdm_has(o, "edges") && !all && !tdm_has(o, "lid");
  if (edges && tdm_has(o, "lid"))
    tdm_object_fail(o, "edges", "a box with a \"lid\" is made of planes, which do not end; remove one of the two keys");
  if (edges && !any)
    tdm_object_fail(o, "open", "leaves no face of the box");
  return edges && !o->err->status;
}

static void read_box(tdm_object *o, int body, dem_wall_list *list) {
  tdm_vec3 size = tdm_get_vec3(o, "size", NULL);
  tdm_vec3 center = tdm_get_vec3(o, "center", &(tdm_vec3){0, 0, 0});
  tdm_quat turn = tdm_get_orientation(o, "orientation");
  int side = tdm_get_choice(o, "side", dem_sides, 2, -1);
  bool closed[6];
  read_open(o, closed);
  if (!o->err->status && !(size.x > 0 && size.y > 0 && size.z > 0))
    tdm_object_fail(o, "size", "is [%g, %g, %g] but all three edge lengths must be greater than 0", size.x, size.y,
                    size.z);
  tdm_vec3 half = tdm_scale(0.5, size);
  if (side == 1) {
    if (tdm_has(o, "open"))
      tdm_object_fail(o, "open", "only a box with \"side\": \"inside\" has open faces; remove the key");
    if (tdm_has(o, "edges"))
      tdm_object_fail(o, "edges", "only a box with \"side\": \"inside\" has walls that may end; remove the key");
    if (tdm_has(o, "lid"))
      tdm_object_fail(o, "lid", "only a box with \"side\": \"inside\" has a lid; remove the key");
    dem_wall wall = {.shape = &dem_shape_box, .body = body, .point = center, .turn = turn, .half = half, .solid = true};
    dem_walls_append(list, wall, o->err);
    return;
  }
  const double h[3] = {half.x, half.y, half.z};
  dem_box box = {.body = body, .center = center, .turn = turn, .half = half, .lid = -1};
  char path[TDM_PATH_MAX];
  if (read_edges(o, closed, &box)) {
    append_plates(list, &box, closed, tdm_path(path, o, "size", -1), o->err);
    return;
  }
  int lid = read_lid(o, closed, &box);
  box.first_wall = list->count;
  for (int face = 0; face < 6; face++) {
    if (!closed[face])
      continue;
    double out[3] = {0, 0, 0};
    out[face / 2] = face % 2 ? 1 : -1;
    tdm_vec3 outward = tdm_quat_rotate(turn, tdm_v3(out[0], out[1], out[2]));
    dem_wall wall = dem_plane(body, tdm_axpy(h[face / 2], outward, center), tdm_scale(-1, outward));
    if (face == lid)
      box.lid = list->count;
    dem_walls_append(list, wall, o->err);
  }
  box.nwall = list->count - box.first_wall;
  dem_walls_append_box(list, box, o->err);
}

/* ---- the solid box ---- */

static double gap_of_box(const dem_wall *wall, tdm_vec3 c, tdm_vec3 *normal) {
  tdm_vec3 half = wall->half;
  tdm_vec3 q =
      tdm_v3(fmax(-half.x, fmin(half.x, c.x)), fmax(-half.y, fmin(half.y, c.y)), fmax(-half.z, fmin(half.z, c.z)));
  tdm_vec3 d = tdm_sub(c, q);
  double dist2 = tdm_dot(d, d);
  if (dist2 > 0) {
    double dist = sqrt(dist2);
    *normal = tdm_scale(1 / dist, d);
    return dist;
  }
  double gx = fabs(c.x) - half.x, gy = fabs(c.y) - half.y, gz = fabs(c.z) - half.z;
  double gap = fmax(gx, fmax(gy, gz));
  if (gap == gx)
    *normal = tdm_v3(c.x < 0 ? -1 : 1, 0, 0);
  else if (gap == gy)
    *normal = tdm_v3(0, c.y < 0 ? -1 : 1, 0);
  else
    *normal = tdm_v3(0, 0, c.z < 0 ? -1 : 1);
  return gap;
}

static void box_of_box(const dem_wall *wall, tdm_vec3 *low, tdm_vec3 *high) {
  *low = tdm_scale(-1, wall->half);
  *high = wall->half;
}

static void draw_box(const dem_wall *wall, const dem_wall_view *view, dem_polygons *all, tdm_error *err) {
  for (int f = 0; f < 6 && err->status == TDM_OK; f++) {
    dem_polygon p = {.body = wall->body, .solid = true, .ncorner = 4};
    for (int i = 0; i < 4; i++)
      p.corner[i] = dem_wall_world(view->place, corner_of(wall->half, face_corners[f][i]));
    dem_polygons_add(all, &p, err);
  }
}

const dem_shape dem_shape_box = {
    .type = "box",
    .number = 1,
    .read = read_box,
    .gap = gap_of_box,
    .box = box_of_box,
    .polygons = draw_box,
};
