/* Reading a body of a scene: see body.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/scene/body.h"

#include "mbd/model/read.h"
#include "mbd/shape/inertia.h"
#include "protocol/wire/participant.h"

#include <gsl/gsl_eigen.h>
#include <stdlib.h>
#include <string.h>

/* Principal moments (ascending) and axes (columns). false: out of memory. */
static bool principal(const tdm_mat3 *inertia, double e[3], tdm_mat3 *axes) {
  double a[9];
  memcpy(a, inertia->m, sizeof a);
  gsl_matrix_view matrix = gsl_matrix_view_array(a, 3, 3), vectors = gsl_matrix_view_array(axes->m[0], 3, 3);
  gsl_vector_view value = gsl_vector_view_array(e, 3);
  gsl_eigen_symmv_workspace *work = gsl_eigen_symmv_alloc(3);
  if (!work)
    return false;
  gsl_eigen_symmv(&matrix.matrix, &value.vector, &vectors.matrix, work);
  gsl_eigen_symmv_free(work);
  gsl_eigen_symmv_sort(&value.vector, &vectors.matrix, GSL_EIGEN_SORT_VAL_ASC);
  return true;
}

/* Principal moments must not be negative and fulfil the triangle inequality: no rigid body violates them. One may be
 * zero: a thin rod's about its own axis. */
static void check_inertia(tdm_object *o, const char *key, mbd_body *b) {
  double e[3];
  tdm_mat3 axes;
  if (!principal(&b->inertia, e, &axes)) {
    tdm_fail(o->err, TDM_ERR_MEMORY, o->path, "no memory to check \"%s\"", key);
    return;
  }
  b->slim = fabs(e[0]) <= 1e-14 * e[2] && e[1] > 0;
  b->axis = tdm_v3(axes.m[0][0], axes.m[1][0], axes.m[2][0]);
  if (e[0] == 0 && e[2] == 0)
    tdm_object_fail(
        o, key,
        "gives no inertia: body \"%s\" would be a point, whose rotation has no equation; give it the inertia of a "
        "small sphere, 2/5 m r^2, or a \"shape\"",
        b->name);
  else if (!(e[0] > 0) && !b->slim)
    tdm_object_fail(
        o, key,
        "the principal moments of inertia of body \"%s\" are %g, %g, %g kg m2: none may be negative, and one "
        "alone zero, that of a thin rod about its axis",
        b->name, e[0], e[1], e[2]);
  else if (2 * e[2] > (e[0] + e[1] + e[2]) * (1 + 1e-9))
    tdm_object_fail(
        o, key,
        "the principal moments of inertia of body \"%s\" are %g, %g, %g kg m2: no rigid body has one larger "
        "than the sum of the other two; check the values and their units",
        b->name, e[0], e[1], e[2]);
}

static double read_mass(tdm_object *o, const char *name) {
  double mass = tdm_get_number(o, "mass", TDM_REQUIRED, TDM_ANY);
  if (!o->err->status && !(mass > 0))
    tdm_object_fail(o, "mass",
                    "body \"%s\" has the mass %g kg, which must be greater than 0; join what has no mass to a "
                    "body, or use a massless joint such as a rod",
                    name, mass);
  return mass;
}

/* Given mass and inertia. */
static void read_inertia(tdm_object *o, mbd_body *b) {
  double i[6] = {0};
  b->mass = read_mass(o, b->name);
  json_t *array = tdm_get_array(o, "inertia", true);
  bool full = json_array_size(array) == 6;
  tdm_get_numbers(o, "inertia", i, full ? 6 : 3, true);
  b->inertia = (tdm_mat3){{{i[0], i[3], i[4]}, {i[3], i[1], i[5]}, {i[4], i[5], i[2]}}};
  if (!o->err->status)
    check_inertia(o, "inertia", b);
}

/* Mass and inertia of a shape, and the file of a mesh. */
static void read_shape(tdm_object *o, mbd_body *b) {
  mbd_shape shape = mbd_shape_read(o);
  if (tdm_has(o, "inertia"))
    tdm_object_fail(o, "inertia", "stands beside \"shape\"; keep one of the two");
  if (shape.density > 0 && tdm_has(o, "mass"))
    tdm_object_fail(o, "mass", "stands beside the density of \"shape\"; keep one of the two");
  else if (shape.density > 0)
    b->mass = shape.density * shape.volume;
  else if (!o->err->status && !tdm_has(o, "mass"))
    tdm_object_fail(o, "mass", "is missing; give it, or a \"density\" in \"shape\"");
  else
    b->mass = read_mass(o, b->name);
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      b->inertia.m[i][k] = b->mass * shape.gyration.m[i][k];
  if (!o->err->status && !(isfinite(b->mass) && tdm_finite(b->inertia.m[0], 9)))
    tdm_object_fail(o, "shape", "gives body \"%s\" the mass %g kg and no finite inertia; check its size and density",
                    b->name, b->mass);
  if (!o->err->status)
    check_inertia(o, "shape", b);
  b->outline = shape.outline;
  if (o->err->status || !shape.file)
    return;
  b->mesh = strdup(shape.file);
  if (!b->mesh)
    tdm_fail(o->err, TDM_ERR_MEMORY, o->path, "no memory for the name of the mesh");
  b->scale = shape.scale;
  b->origin = tdm_scale(-1, shape.centre);
}

/* A marker with channels: their names must not be cut off. */
static void name_channels(mbd_marker *m, const mbd_body *b, tdm_object *o) {
  const size_t most = sizeof(((tdm_channel *)NULL)->name) - sizeof "marker...alphaz";
  snprintf(m->channel, sizeof m->channel, "%s.%s", b->name, m->name);
  if (!o->err->status && strlen(b->name) + strlen(m->name) > most)
    tdm_object_fail(o, "output",
                    "the names of body \"%s\" and marker \"%s\" are too long for channels, %zu letters; use %zu",
                    b->name, m->name, strlen(b->name) + strlen(m->name), most);
}

/* Points and axes of the body, given from its centre of mass in its axes or in the world at the start. */
static void read_marker(mbd_body *b, json_t *json, const char *path, tdm_error *err) {
  static const char *const frames[] = {"body", "world"};
  const tdm_vec3 zero = {0, 0, 0};
  tdm_object o = tdm_object_open(json, path, err);
  mbd_marker *m = &b->marker[b->nmarker];
  mbd_read_name(&o, m->name);
  bool world = tdm_get_choice(&o, "frame", frames, 2, 0) == 1;
  m->pose.position = tdm_get_vec3(&o, "point", world ? NULL : &zero);
  m->pose.orientation = tdm_get_orientation(&o, "orientation");
  m->output = tdm_get_bool(&o, "output", false);
  if (m->output)
    name_channels(m, b, &o);
  tdm_object_close(&o);
  if (world) {
    tdm_quat back = tdm_quat_conj(b->start.pose.orientation);
    m->pose.position = tdm_quat_rotate(back, tdm_sub(m->pose.position, b->start.pose.position));
    m->pose.orientation = tdm_quat_mul(back, m->pose.orientation);
  }
  for (int i = 0; i < b->nmarker; i++)
    if (strcmp(b->marker[i].name, m->name) == 0)
      tdm_object_fail(&o, "name", "a second marker of body \"%s\" is called \"%s\"; give each its own name", b->name,
                      m->name);
  b->nmarker++;
}

static void read_markers(mbd_body *b, tdm_object *o) {
  json_t *array = tdm_get_array(o, "markers", false);
  size_t n = json_array_size(array);
  b->marker = calloc(n + 1, sizeof *b->marker);
  if (!b->marker)
    tdm_object_fail(o, "markers", "no memory for %zu markers", n);
  for (size_t i = 0; i < n && !o->err->status; i++) {
    char path[TDM_PATH_MAX];
    read_marker(b, json_array_get(array, i), tdm_path(path, o, "markers", (int)i), o->err);
  }
}

void mbd_body_read(mbd_model *model, json_t *json, const char *path, tdm_error *err) {
  tdm_object o = tdm_object_open(json, path, err);
  mbd_body *b = &model->body[model->nbody];
  const tdm_vec3 zero = {0, 0, 0};
  mbd_read_name(&o, b->name);
  if (tdm_has(&o, "shape"))
    read_shape(&o, b);
  else
    read_inertia(&o, b);
  if (!err->status && !b->slim)
    b->inverse_inertia = tdm_m3_inverse(b->inertia);
  b->start.pose.orientation = tdm_get_orientation(&o, "orientation");
  /* a mesh stands where its coordinates put it */
  tdm_vec3 centre = tdm_quat_rotate(b->start.pose.orientation, tdm_scale(-1, b->origin));
  b->start.pose.position = tdm_get_vec3(&o, "position", b->mesh ? &centre : NULL);
  b->start.twist.velocity = tdm_get_vec3(&o, "velocity", &zero);
  b->start.twist.angular = tdm_get_vec3(&o, "angular_velocity", &zero);
  if (!err->status && mbd_model_find_body(model, b->name) == MBD_GROUND)
    tdm_object_fail(&o, "name", "\"ground\" is the name of the fixed world; give the body another name");
  else if (!err->status && mbd_model_find_body(model, b->name) != -2)
    tdm_object_fail(&o, "name", "a second body is called \"%s\"; give every body its own name", b->name);
  model->nbody++;
  read_markers(b, &o);
  tdm_object_close(&o);
}
