/* Reading the shapes of a scene into walls. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/wall/shape.h"

#include <stdlib.h>
#include <string.h>

/* one row a shape: its name in the scene, read by read_<name> */
#define DEM_SHAPE_LIST(X) \
  X(plane)                \
  X(box)                  \
  X(cylinder)             \
  X(cone)                 \
  X(sphere)               \
  X(mesh)

static const char *const sides[] = {"inside", "outside"};

static void append(dem_wall_list *list, dem_wall wall, tdm_error *err) {
  dem_wall *grown = realloc(list->wall, (size_t)(list->count + 1) * sizeof *grown);
  if (!grown) {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for wall %d", list->count);
    return;
  }
  list->wall = grown;
  list->wall[list->count++] = wall;
}

static void read_plane(tdm_object *o, int body, dem_wall_list *list) {
  tdm_vec3 point = tdm_get_vec3(o, "point", &(tdm_vec3){0, 0, 0});
  tdm_vec3 normal = tdm_get_vec3(o, "normal", NULL);
  if (!o->err->status && tdm_norm(normal) < 1e-9)
    tdm_object_fail(o, "normal", "is the zero vector; give the direction from the wall towards the particles");
  append(list, (dem_wall){.primitive = DEM_PLANE, .body = body, .point = point, .normal = tdm_unit(normal)}, o->err);
}

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

/* "lid": the face that is left away while settling, -1: none */
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

static void append_box(dem_wall_list *list, dem_box box, tdm_error *err) {
  dem_box *grown = realloc(list->box, (size_t)(list->nbox + 1) * sizeof *grown);
  if (!grown) {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for box %d", list->nbox);
    return;
  }
  list->box = grown;
  list->box[list->nbox++] = box;
}

static void append_mesh(dem_wall_list *list, dem_mesh *mesh, tdm_error *err) {
  dem_mesh **grown = realloc(list->mesh, (size_t)(list->nmesh + 1) * sizeof *grown);
  if (!grown) {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for mesh %d", list->nmesh);
    dem_mesh_destroy(&mesh);
    return;
  }
  list->mesh = grown;
  list->mesh[list->nmesh++] = mesh;
}

/* The closed faces of a container as plates that end: a mesh of two triangles each. */
static void append_plates(dem_wall_list *list, const dem_box *box, const bool closed[6], const char *path,
                          tdm_error *err) {
  /* corner k has + on axis a where bit a is set; the front of a face is its inside */
  static const int face[6][4] = {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}};
  static const int order[6] = {0, 1, 2, 0, 2, 3};
  tdm_vec3 corner[36];
  tdm_stl stl = {0, corner};
  for (int f = 0; f < 6; f++) {
    for (int i = 0; i < 6 && closed[f]; i++) {
      int k = face[f][order[i]];
      tdm_vec3 own = tdm_v3(k & 1 ? box->half.x : -box->half.x, k & 2 ? box->half.y : -box->half.y,
                            k & 4 ? box->half.z : -box->half.z);
      corner[3 * stl.count + i] = tdm_add(box->center, tdm_quat_rotate(box->turn, own));
    }
    stl.count += closed[f] ? 2 : 0;
  }
  dem_mesh *mesh = dem_mesh_make(&stl, "box", DEM_MESH_FACET_ANGLE, path, err);
  if (!mesh)
    return;
  append(list, (dem_wall){.primitive = DEM_MESH, .body = box->body, .mesh = mesh, .plates = true}, err);
  append_mesh(list, mesh, err);
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
  int side = tdm_get_choice(o, "side", sides, 2, -1);
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
    append(list, (dem_wall){.primitive = DEM_SOLID_BOX, .body = body, .point = center, .turn = turn, .half = half},
           o->err);
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
    dem_wall wall = {.primitive = DEM_PLANE,
                     .body = body,
                     .point = tdm_axpy(h[face / 2], outward, center),
                     .normal = tdm_scale(-1, outward)};
    if (face == lid)
      box.lid = list->count;
    append(list, wall, o->err);
  }
  box.nwall = list->count - box.first_wall;
  append_box(list, box, o->err);
}

/* ---- cylinders and cones ---- */

/* the rotation that turns z into the direction `axis` the short way */
static tdm_quat turn_to(tdm_vec3 axis) {
  tdm_vec3 z = {0, 0, 1}, a = tdm_unit(axis), turn = tdm_cross(z, a);
  double sine = tdm_norm(turn);
  if (sine == 0)
    return a.z < 0 ? (tdm_quat){0, 1, 0, 0} : tdm_quat_identity();
  return tdm_quat_from_rotvec(tdm_scale(atan2(sine, a.z) / sine, turn));
}

/* a flat end: a plane that looks along `out` times the axis, seen from inside */
static void append_end(dem_wall_list *list, const dem_wall *of, double z, double out, tdm_error *err) {
  tdm_vec3 axis = tdm_quat_rotate(of->turn, tdm_v3(0, 0, 1));
  append(list,
         (dem_wall){.primitive = DEM_PLANE,
                    .body = of->body,
                    .point = tdm_axpy(z, axis, of->point),
                    .normal = tdm_scale(-out, axis)},
         err);
}

/* what cylinders and cones have in common; radius and length are set */
static void read_round(tdm_object *o, dem_wall wall, bool endless, dem_wall_list *list) {
  wall.point = tdm_get_vec3(o, "point", &(tdm_vec3){0, 0, 0});
  tdm_vec3 axis = tdm_get_vec3(o, "axis", &(tdm_vec3){0, 0, 1});
  if (!o->err->status && tdm_norm(axis) < 1e-9)
    tdm_object_fail(o, "axis", "is the zero vector; give the direction from the first end to the second");
  wall.turn = turn_to(axis);
  wall.surface.angular.z = tdm_get_number(o, "surface_spin", 0, TDM_ANY);
  wall.inside = tdm_get_choice(o, "side", sides, 2, -1) == 0;
  bool ends = tdm_get_bool(o, "ends", false);
  if (tdm_has(o, "ends")) {
    if (!wall.inside)
      tdm_object_fail(o, "ends", "only \"side\": \"inside\" asks for ends: a solid has them; remove the key");
    else if (ends && endless)
      tdm_object_fail(o, "ends", "are where the length ends; give \"length\" too, or remove the key");
  }
  bool cylinder = wall.radius[0] == wall.radius[1];
  wall.primitive = endless || (cylinder && ends) ? DEM_CYLINDER : wall.inside ? DEM_SHELL : DEM_SOLID_FRUSTUM;
  append(list, wall, o->err);
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

/* ---- spheres ---- */

static void read_sphere(tdm_object *o, int body, dem_wall_list *list) {
  double radius = tdm_get_number(o, "radius", TDM_REQUIRED, TDM_POSITIVE);
  tdm_vec3 center = tdm_get_vec3(o, "center", &(tdm_vec3){0, 0, 0});
  bool inside = tdm_get_choice(o, "side", sides, 2, 1) == 0;
  append(list,
         (dem_wall){.primitive = DEM_BALL, .body = body, .point = center, .radius = {radius, radius}, .inside = inside},
         o->err);
}

/* ---- meshes ---- */

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
    if (mesh) {
      append(list, (dem_wall){.primitive = DEM_MESH, .body = body, .mesh = mesh}, o->err);
      append_mesh(list, mesh, o->err);
    }
  }
  tdm_stl_destroy(&stl);
}

/* ---- all ---- */

/* what the surface does, as a twist of the body's origin, body axes; a cylinder's own spin is with its wall */
static tdm_twist read_surface(tdm_object *o) {
  tdm_twist belt = {.velocity = tdm_get_vec3(o, "surface_velocity", &(tdm_vec3){0, 0, 0})};
  if (!tdm_has(o, "surface_rotation"))
    return belt;
  tdm_object r = tdm_get_object(o, "surface_rotation", true);
  tdm_vec3 point = tdm_get_vec3(&r, "point", &(tdm_vec3){0, 0, 0});
  tdm_vec3 axis = tdm_get_vec3(&r, "axis", NULL);
  double rate = tdm_get_number(&r, "rate", TDM_REQUIRED, TDM_ANY);
  if (!o->err->status && tdm_norm(axis) < 1e-9)
    tdm_object_fail(&r, "axis", "is the zero vector; give the direction about which the belt turns");
  tdm_object_close(&r);
  belt.angular = tdm_scale(rate, tdm_unit(axis));
  belt.velocity = tdm_sub(belt.velocity, tdm_cross(belt.angular, point));
  return belt;
}

/* the surface of one wall: `belt` in the wall's own axes, of its own origin, with the spin that it has */
static void set_surface(dem_wall *wall, tdm_twist belt) {
  tdm_quat back = tdm_quat_conj(tdm_quat_unit(wall->turn));
  tdm_vec3 there = tdm_add(belt.velocity, tdm_cross(belt.angular, wall->point));
  wall->surface.velocity = tdm_quat_rotate(back, there);
  wall->surface.angular = tdm_add(wall->surface.angular, tdm_quat_rotate(back, belt.angular));
  wall->moves = tdm_norm(wall->surface.velocity) > 0 || tdm_norm(wall->surface.angular) > 0;
}

void dem_shape_read(json_t *json, const char *path, int body, int geometry, dem_wall_list *list, tdm_error *err) {
  static const char *const names[] = {
#define X(name) #name,
      DEM_SHAPE_LIST(X)
#undef X
  };
  static void (*const read[])(tdm_object *, int, dem_wall_list *) = {
#define X(name) read_##name,
      DEM_SHAPE_LIST(X)
#undef X
  };
  tdm_object o = tdm_object_open(json, path, err);
  int shape = tdm_get_choice(&o, "type", names, sizeof names / sizeof names[0], -1);
  if (shape < 0)
    return;
  int first = list->count;
  read[shape](&o, body, list);
  tdm_twist belt = read_surface(&o);
  for (int w = first; w < list->count; w++) {
    list->wall[w].geometry = geometry;
    set_surface(&list->wall[w], belt);
  }
  tdm_object_close(&o);
}

dem_wall_place dem_wall_put(const dem_wall *wall, const tdm_pose *pose) {
  dem_wall_place place;
  tdm_mat3 body = tdm_quat_to_matrix(pose->orientation);
  place.point = tdm_add(pose->position, tdm_m3_mul(body, wall->point));
  place.normal = tdm_m3_mul(body, wall->normal);
  place.axes = tdm_quat_to_matrix(tdm_quat_mul(pose->orientation, tdm_quat_unit(wall->turn)));
  return place;
}

/* corner k of 0 ... 7 of the box around a solid box, a ball or a mesh, own axes */
static tdm_vec3 corner_of(const dem_wall *wall, int k) {
  tdm_vec3 least = tdm_scale(-1, wall->half), most = wall->half;
  if (wall->primitive == DEM_BALL) {
    most = tdm_v3(wall->radius[0], wall->radius[0], wall->radius[0]);
    least = tdm_scale(-1, most);
  } else if (wall->primitive == DEM_MESH) {
    least = dem_mesh_figures(wall->mesh)->low;
    most = dem_mesh_figures(wall->mesh)->high;
  }
  return tdm_v3(k & 1 ? most.x : least.x, k & 2 ? most.y : least.y, k & 4 ? most.z : least.z);
}

/* The speed of a rotation with a translation is convex: it is largest at a corner, or on the rims of a frustum, where
 * enough places are looked at. */
double dem_wall_belt_speed(const dem_wall *wall) {
  enum { AROUND = 32 };
  double fastest = 0;
  if (wall->primitive == DEM_SHELL || wall->primitive == DEM_SOLID_FRUSTUM) {
    for (int k = 0; k < 2 * AROUND; k++) {
      double angle = 2 * M_PI * (k / 2) / AROUND, r = wall->radius[k % 2];
      tdm_vec3 own = {r * cos(angle), r * sin(angle), k % 2 * wall->length};
      fastest = fmax(fastest, tdm_norm(dem_wall_belt(wall, own)));
    }
  } else if (wall->primitive == DEM_BALL) { /* the rotation's part across the velocity at the centre adds up at most */
    fastest = tdm_norm(wall->surface.velocity) + tdm_norm(wall->surface.angular) * wall->radius[0];
  } else if (wall->primitive == DEM_SOLID_BOX || wall->primitive == DEM_MESH) {
    for (int k = 0; k < 8; k++)
      fastest = fmax(fastest, tdm_norm(dem_wall_belt(wall, corner_of(wall, k))));
  }
  return fastest;
}

static void include(tdm_vec3 x, tdm_vec3 up, double reach, double *low, double *high) {
  *low = fmin(*low, tdm_dot(x, up) - reach);
  *high = fmax(*high, tdm_dot(x, up) + reach);
}

bool dem_wall_extent(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 up, double *low, double *high) {
  if (wall->primitive == DEM_PLANE || wall->primitive == DEM_CYLINDER)
    return false;
  *low = INFINITY;
  *high = -INFINITY;
  if (wall->primitive == DEM_BALL) {
    include(place->point, up, wall->radius[0], low, high);
    return true;
  }
  if (wall->primitive == DEM_SHELL || wall->primitive == DEM_SOLID_FRUSTUM) {
    /* an end is a disc: its radius times the sine between axis and up */
    tdm_vec3 axis = tdm_m3_mul(place->axes, tdm_v3(0, 0, 1));
    double sine = tdm_norm(tdm_cross(axis, up));
    include(place->point, up, wall->radius[0] * sine, low, high);
    include(tdm_axpy(wall->length, axis, place->point), up, wall->radius[1] * sine, low, high);
    return true;
  }
  for (int k = 0; k < 8; k++)
    include(tdm_add(place->point, tdm_m3_mul(place->axes, corner_of(wall, k))), up, 0, low, high);
  return true;
}
