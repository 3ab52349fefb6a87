/* Mass, centre of mass and inertia of shapes of one density: see inertia.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/shape/inertia.h"

#include "protocol/surface/surface.h"

#include <stdlib.h>
#include <string.h>

/* ---- primitives ---- */

static mbd_shape diagonal(double volume, double xx, double yy, double zz) {
  return (mbd_shape){.volume = volume, .gyration = {{{xx, 0, 0}, {0, yy, 0}, {0, 0, zz}}}};
}

/* the same shape, which is drawn by these sizes */
static mbd_shape drawn(mbd_shape shape, double x, double y, double z) {
  shape.outline = (mbd_outline){.size = {x, y, z}};
  return shape;
}

static double length(tdm_object *o, const char *key) {
  return tdm_get_number(o, key, TDM_REQUIRED, TDM_POSITIVE);
}

static mbd_shape sphere(tdm_object *o) {
  double r = length(o, "radius"), i = 0.4 * r * r;
  return drawn(diagonal(4.0 / 3 * M_PI * r * r * r, i, i, i), r, 0, 0);
}

static mbd_shape box(tdm_object *o) {
  double s[3] = {1, 1, 1};
  tdm_get_numbers(o, "size", s, 3, true);
  if (!o->err->status && !(s[0] > 0 && s[1] > 0 && s[2] > 0))
    tdm_object_fail(o, "size", "is %g, %g, %g m; all three must be positive", s[0], s[1], s[2]);
  double x = s[0] * s[0] / 12, y = s[1] * s[1] / 12, z = s[2] * s[2] / 12;
  return drawn(diagonal(s[0] * s[1] * s[2], y + z, x + z, x + y), s[0], s[1], s[2]);
}

/* between two radii */
static mbd_shape round_bar(double outer, double inner, double l) {
  double r2 = outer * outer + inner * inner, across = (3 * r2 + l * l) / 12;
  return drawn(diagonal(M_PI * (outer * outer - inner * inner) * l, across, across, 0.5 * r2), outer, inner, l);
}

static mbd_shape cylinder(tdm_object *o) {
  double r = length(o, "radius"), l = length(o, "length");
  return round_bar(r, 0, l);
}

static mbd_shape tube(tdm_object *o) {
  double r = length(o, "radius"), inner = length(o, "inner_radius"), l = length(o, "length");
  if (!o->err->status && !(inner < r))
    tdm_object_fail(o, "inner_radius", "is %g m, not below \"radius\", %g m", inner, r);
  return round_bar(r, inner, l);
}

static mbd_shape cone(tdm_object *o) {
  double r = length(o, "radius"), l = length(o, "length"), across = 3.0 / 80 * (4 * r * r + l * l);
  return drawn(diagonal(M_PI / 3 * r * r * l, across, across, 0.3 * r * r), r, 0, l);
}

/* a cylinder of that length between two half spheres */
static mbd_shape capsule(tdm_object *o) {
  double r = length(o, "radius"), l = length(o, "length");
  double bar = M_PI * r * r * l, ends = 4.0 / 3 * M_PI * r * r * r, all = bar + ends;
  double across = bar * (3 * r * r + l * l) / 12 + ends * (0.4 * r * r + 0.25 * l * l + 0.375 * l * r);
  return drawn(diagonal(all, across / all, across / all, (0.5 * bar + 0.4 * ends) * r * r / all), r, 0, l);
}

/* ---- meshes ---- */

static tdm_status check_surface(const tdm_surface *s, const char *file, const char *path, tdm_error *err) {
  if (!s->closed)
    return tdm_fail(err, TDM_ERR_SCENE, path,
                    "\"%s\" is open: %d of its %d edges belong to an odd number of triangles, mostly to one alone, so "
                    "that it has no inside; export a closed part",
                    file, s->open, s->edges);
  if (!s->oriented)
    return tdm_fail(err, TDM_ERR_SCENE, path,
                    "\"%s\" has triangles that are turned inside out: at %d of its %d edges two of them run the same "
                    "way; export the part with one orientation",
                    file, s->turned, s->edges);
  if (s->inverted > 0 && s->inverted < s->parts)
    return tdm_fail(err, TDM_ERR_SCENE, path,
                    "\"%s\" has %d parts, and %d of them are inside out (one has a corner at [%g, %g, %g] m): their "
                    "triangles have their outer sides inside; turn those round",
                    file, s->parts, s->inverted, s->bad.x, s->bad.y, s->bad.z);
  if (s->nested > 0)
    return tdm_fail(err, TDM_ERR_SCENE, path,
                    "\"%s\" has %d parts, and %d of them lie inside another one (one has a corner at [%g, %g, %g] m), "
                    "so that their mass would count twice; turn their triangles round if they are cavities, else "
                    "remove them",
                    file, s->parts, s->nested, s->bad.x, s->bad.y, s->bad.z);
  if (!(s->volume > 0))
    return tdm_fail(err, TDM_ERR_SCENE, path,
                    "\"%s\" has the volume %g m3: its triangles have their outer sides inside; turn them round", file,
                    s->volume);
  return TDM_OK;
}

/* Over the tetrahedra from `base` to each triangle (a, b, c), d = a . (b x c): volume d/6, first moment d/24 (a + b +
 * c), second moment d/120 (s s^T + a a^T + b b^T + c c^T), s = a + b + c. */
static void integrate(const tdm_stl *stl, const bool *left_out, tdm_vec3 base, double *volume, double first[3],
                      double second[3][3]) {
  for (int t = 0; t < stl->count; t++) {
    if (left_out[t])
      continue;
    tdm_vec3 p[3], s = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
      p[k] = tdm_sub(stl->corner[3 * t + k], base);
      s = tdm_add(s, p[k]);
    }
    double d = tdm_dot(p[0], tdm_cross(p[1], p[2]));
    const double v[4][3] = {
        {s.x, s.y, s.z}, {p[0].x, p[0].y, p[0].z}, {p[1].x, p[1].y, p[1].z}, {p[2].x, p[2].y, p[2].z}};
    *volume += d / 6;
    for (int i = 0; i < 3; i++) {
      first[i] += d / 24 * v[0][i];
      for (int j = 0; j < 3; j++)
        for (int k = 0; k < 4; k++)
          second[i][j] += d / 120 * v[k][i] * v[k][j];
    }
  }
}

tdm_status mbd_shape_of_mesh(mbd_shape *shape, const tdm_stl *stl, const char *file, const char *path, tdm_error *err) {
  double volume = 0, first[3] = {0}, second[3][3] = {{0}}, trace = 0;
  *shape = (mbd_shape){0};
  tdm_surface surface;
  if (tdm_surface_look(&surface, stl, path, err) == TDM_OK)
    check_surface(&surface, file, path, err);
  tdm_vec3 base = stl->count > 0 ? stl->corner[0] : tdm_v3(0, 0, 0);
  if (!err->status)
    integrate(stl, surface.left_out, base, &volume, first, second);
  tdm_surface_destroy(&surface);
  if (err->status)
    return err->status;
  for (int i = 0; i < 3; i++)
    trace += second[i][i] / volume - first[i] * first[i] / (volume * volume);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      shape->gyration.m[i][j] = (i == j) * trace - (second[i][j] / volume - first[i] * first[j] / (volume * volume));
  shape->volume = volume;
  shape->centre = tdm_axpy(1 / volume, tdm_v3(first[0], first[1], first[2]), base);
  return TDM_OK;
}

static mbd_shape mesh(tdm_object *o) {
  mbd_shape shape = {0};
  tdm_stl stl = {0};
  char path[TDM_PATH_MAX];
  const char *file = tdm_get_string(o, "file", NULL);
  double scale = tdm_get_number(o, "scale", 1, TDM_POSITIVE);
  if (o->err->status)
    return shape;
  tdm_path(path, o, "file", -1);
  if (tdm_stl_read(&stl, file, scale, path, o->err) == TDM_OK)
    mbd_shape_of_mesh(&shape, &stl, file, path, o->err);
  tdm_stl_destroy(&stl);
  shape.file = file;
  shape.scale = scale;
  return shape;
}

/* ---- all ---- */

static const struct {
  const char *name;
  mbd_shape (*load)(tdm_object *o);
  tdm_status (*draw)(const mbd_outline *outline, int body, tdm_scenery *scenery, tdm_error *err); /* NULL: a mesh */
} table[] = {
    {.name = "sphere", .load = sphere, .draw = mbd_outline_sphere},
    {.name = "box", .load = box, .draw = mbd_outline_box},
    {.name = "cylinder", .load = cylinder, .draw = mbd_outline_cylinder},
    {.name = "tube", .load = tube, .draw = mbd_outline_tube},
    {.name = "cone", .load = cone, .draw = mbd_outline_cone},
    {.name = "capsule", .load = capsule, .draw = mbd_outline_capsule},
    {.name = "mesh", .load = mesh},
};
enum { SHAPES = sizeof table / sizeof table[0] };

mbd_shape mbd_shape_read(tdm_object *owner) {
  tdm_object o = tdm_get_object(owner, "shape", true);
  const char *names[SHAPES];
  for (int i = 0; i < SHAPES; i++)
    names[i] = table[i].name;
  int type = tdm_get_choice(&o, "type", names, SHAPES, -1);
  if (o.err->status)
    return (mbd_shape){0};
  double density = tdm_has(&o, "density") ? tdm_get_number(&o, "density", TDM_REQUIRED, TDM_POSITIVE) : 0;
  mbd_shape shape = table[type].load(&o);
  shape.density = density;
  shape.outline.draw = table[type].draw;
  tdm_object_close(&o);
  return shape;
}
