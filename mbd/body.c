#include "mbd/body.h"

#include "mbd/load.h"

#include <gsl/gsl_eigen.h>
#include <stdlib.h>
#include <string.h>

/* Principal moments must be positive and fulfil the triangle inequality: no rigid body violates them. */
static void check_inertia(tdm_object *o, const tdm_mat3 *inertia) {
  double a[9], e[3];
  memcpy(a, inertia->m, sizeof a);
  gsl_matrix_view matrix = gsl_matrix_view_array(a, 3, 3);
  gsl_vector_view value = gsl_vector_view_array(e, 3);
  gsl_eigen_symm_workspace *work = gsl_eigen_symm_alloc(3);
  gsl_eigen_symm(&matrix.matrix, &value.vector, work);
  gsl_eigen_symm_free(work);
  double least = fmin(e[0], fmin(e[1], e[2])), most = fmax(e[0], fmax(e[1], e[2])), sum = e[0] + e[1] + e[2];
  if (!(least > 0))
    tdm_object_fail(
        o, "inertia",
        "the principal moments of inertia are %g, %g, %g kg m2: they must all be positive (a thin rod needs "
        "a small value about its axis)",
        e[0], e[1], e[2]);
  else if (2 * most > sum * (1 + 1e-9))
    tdm_object_fail(o, "inertia",
                    "the principal moments of inertia are %g, %g, %g kg m2: no rigid body has one larger than the sum "
                    "of the other two; check the values and their units",
                    e[0], e[1], e[2]);
}

static void load_inertia(tdm_object *o, tdm_mat3 *inertia) {
  double i[6] = {0};
  json_t *array = tdm_get_array(o, "inertia", true);
  bool full = json_array_size(array) == 6;
  tdm_get_numbers(o, "inertia", i, full ? 6 : 3, true);
  *inertia = (tdm_mat3){{{i[0], i[3], i[4]}, {i[3], i[1], i[5]}, {i[4], i[5], i[2]}}};
  if (!o->err->status)
    check_inertia(o, inertia);
}

void mbd_body_load(mbd_model *model, json_t *json, const char *path, tdm_error *err) {
  tdm_object o = tdm_object_open(json, path, err);
  mbd_body *b = &model->body[model->nbody];
  const tdm_vec3 zero = {0, 0, 0};
  mbd_load_name(&o, b->name);
  b->mass = tdm_get_number(&o, "mass", TDM_REQUIRED, TDM_POSITIVE);
  load_inertia(&o, &b->inertia);
  b->start.pose.position = tdm_get_vec3(&o, "position", NULL);
  b->start.pose.orientation = tdm_get_orientation(&o, "orientation");
  b->start.twist.velocity = tdm_get_vec3(&o, "velocity", &zero);
  b->start.twist.angular = tdm_get_vec3(&o, "angular_velocity", &zero);
  tdm_object_close(&o);
  if (err->status)
    return;
  if (strcmp(b->name, "ground") == 0)
    tdm_object_fail(&o, "name", "\"ground\" is the name of the fixed world; give the body another name");
  else if (mbd_model_find_body(model, b->name) != -2)
    tdm_object_fail(&o, "name", "a second body is called \"%s\"; give every body its own name", b->name);
  else
    model->nbody++;
}

void mbd_body_clear(mbd_body *body) {
  free(body->marker);
}
