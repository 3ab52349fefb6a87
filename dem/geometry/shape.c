/* Reading the shapes of a scene into walls. */
#include "dem/geometry/shape.h"

#include <stdlib.h>
#include <string.h>

/* one row a shape: its name in the scene, read by read_<name> */
#define DEM_SHAPE_LIST(X) \
  X(plane)                \
  X(box)

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

static void read_box(tdm_object *o, int body, dem_wall_list *list) {
  static const char *const sides[] = {"inside", "outside"};
  tdm_vec3 size = tdm_get_vec3(o, "size", NULL);
  tdm_vec3 center = tdm_get_vec3(o, "center", &(tdm_vec3){0, 0, 0});
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
    if (tdm_has(o, "lid"))
      tdm_object_fail(o, "lid", "only a box with \"side\": \"inside\" has a lid; remove the key");
    append(list, (dem_wall){.primitive = DEM_SOLID_BOX, .body = body, .point = center, .half = half}, o->err);
    return;
  }
  const double h[3] = {half.x, half.y, half.z};
  dem_box box = {.body = body, .center = center, .half = half, .lid = -1};
  int lid = read_lid(o, closed, &box);
  for (int face = 0; face < 6; face++) {
    if (!closed[face])
      continue;
    double out[3] = {0, 0, 0};
    out[face / 2] = face % 2 ? 1 : -1;
    tdm_vec3 outward = tdm_v3(out[0], out[1], out[2]);
    dem_wall wall = {.primitive = DEM_PLANE,
                     .body = body,
                     .point = tdm_axpy(h[face / 2], outward, center),
                     .normal = tdm_scale(-1, outward)};
    if (face == lid)
      box.lid = list->count;
    append(list, wall, o->err);
  }
  append_box(list, box, o->err);
}

void dem_shape_read(json_t *json, const char *path, int body, dem_wall_list *list, tdm_error *err) {
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
  read[shape](&o, body, list);
  tdm_object_close(&o);
}

dem_wall_place dem_wall_put(const dem_wall *wall, const tdm_pose *pose) {
  dem_wall_place place;
  place.axes = tdm_quat_to_matrix(pose->orientation);
  place.point = tdm_add(pose->position, tdm_m3_mul(place.axes, wall->point));
  place.normal = tdm_m3_mul(place.axes, wall->normal);
  return place;
}
