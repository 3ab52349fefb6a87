/* Bushing: six coordinates x = (u, phi) between two frames, force -(K x + C xdot + preload).
 *
 * u is the way of the second frame's point from the first's, in axes of the first [m]; phi the rotation vector that
 * turns the first frame's axes into the second's, in axes of the first [rad], |phi| < pi. The forces are those that
 * belong to these coordinates, so 1/2 x K x + preload x is the exact potential at any deflection: the moment is the
 * transpose of d(phi)/d(theta) times that of phi, the same at small angles. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/force/force.h"
#include "protocol/motion/spline.h"

#include <gsl/gsl_eigen.h>
#include <stdlib.h>
#include <string.h>

enum { N = 6 };

typedef struct {
  double matrix[2][N][N]; /* stiffness and damping */
  double preload[N];      /* [N, N m] */
} bushing;

/* A symmetric 6 x 6 matrix without negative eigenvalues, in full or its diagonal. */
static void read_matrix(tdm_object *o, const char *key, bool required, double matrix[N][N]) {
  json_t *array = tdm_get_array(o, key, required), *first = json_array_get(array, 0);
  char path[TDM_PATH_MAX];
  if (!array || o->err->status)
    return;
  if (!json_is_array(first)) {
    double diagonal[N] = {0};
    tdm_get_numbers(o, key, diagonal, N, true);
    for (int i = 0; i < N; i++)
      matrix[i][i] = diagonal[i];
  }
  if (json_is_array(first) && json_array_size(array) != N) {
    tdm_object_fail(o, key, "must be 6 numbers, the diagonal, or 6 rows of 6");
    return;
  }
  for (int i = 0; i < N && json_is_array(first); i++) {
    int n = 0;
    double *row = tdm_numbers_from_json(json_array_get(array, (size_t)i), tdm_path(path, o, key, i), &n, o->err);
    if (row && n != N)
      tdm_fail(o->err, TDM_ERR_SCENE, path, "has %d numbers; give 6", n);
    else if (row)
      memcpy(matrix[i], row, sizeof matrix[i]);
    free(row);
  }
}

static void check_matrix(tdm_object *o, const char *key, double matrix[N][N]) {
  double copy[N * N], value[N], most = 0;
  for (int i = 0; i < N; i++)
    for (int j = 0; j < i && !o->err->status; j++)
      if (matrix[i][j] != matrix[j][i])
        tdm_object_fail(o, key, "is not symmetric: element (%d, %d) is %g and (%d, %d) is %g", i + 1, j + 1,
                        matrix[i][j], j + 1, i + 1, matrix[j][i]);
  memcpy(copy, matrix, sizeof copy);
  gsl_matrix_view view = gsl_matrix_view_array(copy, N, N);
  gsl_vector_view values = gsl_vector_view_array(value, N);
  gsl_eigen_symm_workspace *work = gsl_eigen_symm_alloc(N);
  if (!work) {
    tdm_fail(o->err, TDM_ERR_MEMORY, o->path, "no memory to check \"%s\"", key);
    return;
  }
  gsl_eigen_symm(&view.matrix, &values.vector, work);
  gsl_eigen_symm_free(work);
  for (int i = 0; i < N; i++)
    most = fmax(most, fabs(value[i]));
  for (int i = 0; i < N && !o->err->status; i++)
    if (value[i] < -1e-12 * most)
      tdm_object_fail(o, key, "has the negative eigenvalue %g, so that it would drive the motion; check its signs",
                      value[i]);
}

static void read(mbd_force *f, tdm_object *o, const mbd_model *model) {
  bushing *u = f->own;
  tdm_vec3 point[2];
  mbd_read_bodies(o, model, f->body);
  mbd_read_points(o, model, "point", "points", point);
  tdm_mat3 axes = tdm_quat_to_matrix(tdm_get_orientation(o, "orientation"));
  read_matrix(o, "stiffness", true, u->matrix[0]);
  read_matrix(o, "damping", false, u->matrix[1]);
  tdm_get_numbers(o, "preload", u->preload, N, false);
  if (o->err->status)
    return;
  check_matrix(o, "stiffness", u->matrix[0]);
  check_matrix(o, "damping", u->matrix[1]);
  for (int side = 0; side < 2; side++) {
    tdm_mat3 A = tdm_quat_to_matrix(mbd_model_pose(model, f->body[side]).orientation);
    f->frame.arm[side] = mbd_model_arm(model, f->body[side], point[side]);
    f->frame.axes[side] = tdm_m3_mat(tdm_m3_transpose(A), axes);
  }
}

static void eval(const mbd_force *f, const mbd_kin *a, const mbd_kin *b, mbd_force_value *out) {
  const bushing *u = f->own;
  tdm_vec3 arm_a = mbd_joint_arm(&f->frame, 0, a), arm_b = mbd_joint_arm(&f->frame, 1, b);
  for (int k = 0; k < 3; k++)
    mbd_rows_plane(&out->rows, a, b, mbd_joint_axis(&f->frame, 0, k, a), arm_a, arm_b);
  mbd_rows_rotation(&out->rows, tdm_m3_mat(a->A, f->frame.axes[0]), tdm_m3_mat(b->A, f->frame.axes[1]));
  double x[N], rate[N], force[N];
  memcpy(x, out->rows.g, sizeof x);
  mbd_force_rates(out, a, b, rate);
  for (int i = 0; i < N; i++) {
    double elastic = 0, damping = 0;
    for (int j = 0; j < N; j++) {
      elastic += u->matrix[0][i][j] * x[j];
      damping += u->matrix[1][i][j] * rate[j];
    }
    force[i] = elastic + damping + u->preload[i];
    out->potential += (0.5 * elastic + u->preload[i]) * x[i];
    out->dissipated += damping * rate[i];
  }
  mbd_force_apply(out, a, b, force, u->matrix[0][0], u->matrix[1][0]);
  out->value = tdm_norm(mbd_get3(force));
  out->coordinate = tdm_norm(mbd_get3(x));
  out->rotation = tdm_norm(mbd_get3(x + 3));
}

extern const mbd_force_ops mbd_force_bushing;
const mbd_force_ops mbd_force_bushing = {
    .name = "bushing",
    .size = sizeof(bushing),
    .value_unit = "N",
    .coordinate_name = "deflection",
    .coordinate_unit = "m",
    .read = read,
    .eval = eval,
    .spans = true,
    .line = TDM_VIEW_LINE_spring,
    .turns = true,
};
