/* Keys that several objects of the section "dem" have: see keys.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/scene/keys.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void *dem_allocate(size_t n, size_t size, tdm_error *err) {
  void *p = calloc(n ? n : 1, size);
  if (!p)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %zu items of the DEM model", n);
  return p;
}

char *dem_copy_text(const char *text, tdm_error *err) {
  char *copy = strdup(text);
  if (!copy)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for a text of the scene");
  return copy;
}

char *dem_read_name(tdm_object *o, size_t most) {
  const char *name = tdm_get_string(o, "name", NULL);
  size_t n = strlen(name);
  bool good = n > 0 && n <= most;
  for (size_t i = 0; i < n && good; i++)
    good = (name[i] >= 'a' && name[i] <= 'z') || (name[i] >= 'A' && name[i] <= 'Z') ||
           (name[i] >= '0' && name[i] <= '9') || name[i] == '_';
  if (!good && !o->err->status)
    tdm_object_fail(o, "name", "\"%s\" must be 1 to %zu letters, digits and underscores: it names output channels",
                    name, most);
  return dem_copy_text(name, o->err);
}

int dem_read_material(const dem_model *m, tdm_object *o) {
  const char *name = tdm_get_string(o, "material", NULL);
  int i = dem_find_material(m, name);
  if (i >= 0 || o->err->status)
    return i >= 0 ? i : 0;
  const char *names[64];
  int n = 0;
  for (; n < m->nmaterial && n < 64; n++)
    names[n] = m->material[n].name;
  const char *near = tdm_nearest(name, names, n);
  tdm_object_fail(o, "material", "\"%s\" is no material of dem.materials; %s%s%s", name,
                  near ? "did you mean \"" : "add it there or use one of them", near ? near : "", near ? "\"?" : "");
  return 0;
}

tdm_vec3 dem_read_vector(tdm_object *o, const char *key, const tdm_vec3 *fallback) {
  tdm_vec3 v = tdm_get_vec3(o, key, fallback);
  if (!o->err->status && !isfinite(tdm_dot(v, v)))
    tdm_object_fail(o, key, "is [%g, %g, %g]: too large to be squared in double precision; give at most 1e150", v.x,
                    v.y, v.z);
  return v;
}

void dem_check_mass(tdm_object *o, const char *key, double mass) {
  if (!o->err->status && !(isnormal(mass * mass) && isnormal(1 / (mass * mass))))
    tdm_object_fail(o, key,
                    "gives a particle of %g kg, which double precision does not hold when squared or inverted; "
                    "give a mass between 1e-150 and 1e150 kg",
                    mass);
}

void dem_check_place(tdm_object *o, const char *key, tdm_vec3 x, double radius) {
  double far = fmax(fabs(x.x), fmax(fabs(x.y), fabs(x.z))), apart = DBL_EPSILON * far;
  if (!o->err->status && !(apart <= 1e-6 * radius))
    tdm_object_fail(o, key,
                    "reaches %g m from the origin, where the numbers of double precision are %.2g m apart, more than "
                    "1e-6 of the radius, %g m; take places nearer to the origin",
                    far, apart, radius);
}

void dem_fail_unknown_body(const dem_model *m, const char *path, const char *name, tdm_error *err) {
  const char **names = calloc((size_t)m->nbody + 1, sizeof *names); /* without memory none is suggested */
  for (int b = 0; names && b < m->nbody; b++)
    names[b] = m->body[b].name;
  const char *near = names ? tdm_nearest(name, names, m->nbody) : NULL;
  if (near)
    tdm_fail(err, TDM_ERR_SCENE, path, "\"%s\" is no body of dem.bodies; did you mean \"%s\"?", name, near);
  else
    tdm_fail(err, TDM_ERR_SCENE, path, "\"%s\" is no body of dem.bodies; add it there%s%s%s", name,
             m->nbody ? " or name one of them, such as \"" : "", m->nbody ? m->body[0].name : "", m->nbody ? "\"" : "");
  free(names);
}

int dem_read_body(const dem_model *m, tdm_object *o, const char *key) {
  const char *name = tdm_get_string(o, key, NULL);
  int b = dem_find_body(m, name);
  char path[TDM_PATH_MAX];
  if (b < 0 && !o->err->status)
    dem_fail_unknown_body(m, tdm_path(path, o, key, -1), name, o->err);
  return b < 0 ? 0 : b;
}

tdm_vec3 dem_zero_angle(tdm_vec3 axis) {
  tdm_vec3 x = tdm_axpy(-axis.x, axis, tdm_v3(1, 0, 0));
  if (tdm_norm(x) < 1e-6)
    x = tdm_axpy(-axis.y, axis, tdm_v3(0, 1, 0));
  return tdm_unit(x);
}
