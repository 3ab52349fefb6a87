/* Reading the shapes of a scene into walls: see shape.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/shape/shape.h"

#include "dem/geometry/shape/rows.h"

#include <assert.h>
#include <string.h>

enum { SHAPES_MAX = 32 };

/* ended by a NULL */
static const dem_shape *shapes[SHAPES_MAX + 1] = {
#define X(name) &dem_shape_##name,
    DEM_SHAPE_LIST(X)
#undef X
};

tdm_status dem_shape_add(const dem_shape *shape, tdm_error *err) {
  int n = 0;
  assert(shape->type && shape->read);
  for (; shapes[n]; n++)
    if ((shapes[n]->type && strcmp(shapes[n]->type, shape->type) == 0) || shapes[n]->number == shape->number)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "there is a shape with the type \"%s\" or the number %d already",
                      shape->type, shape->number);
  if (n == SHAPES_MAX)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "no place for the shape \"%s\": the table has room for %d shapes",
                    shape->type, SHAPES_MAX);
  shapes[n] = shape;
  return TDM_OK;
}

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
  const char *names[SHAPES_MAX];
  int n = 0;
  for (; shapes[n]; n++)
    names[n] = shapes[n]->type;
  tdm_object o = tdm_object_open(json, path, err);
  int shape = tdm_get_choice(&o, "type", names, n, -1);
  if (shape < 0)
    return;
  int first = list->count;
  shapes[shape]->read(&o, body, list);
  tdm_twist belt = read_surface(&o);
  const int material = tdm_get_choice(&o, "material", list->material, list->nmaterial, list->body_material);
  for (int w = first; w < list->count; w++) {
    list->wall[w].geometry = geometry;
    list->wall[w].material = material < 0 ? 0 : material;
    set_surface(&list->wall[w], belt);
  }
  tdm_object_close(&o);
}
