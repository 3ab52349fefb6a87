#include "mbd/assemble.h"

#include "mbd/residual.h"

#include <gsl/gsl_linalg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct mbd_kkt {
  int nv, n;       /* 6 nbody, 6 nbody + nrow */
  double *matrix;  /* (n x n) row-major, factored in place */
  double *rhs, *x; /* (n) */
  double *g;       /* (nrow) violation, or rate, or Gdot V */
  gsl_permutation *permutation;
};

enum { ITERATIONS_MAX = 50 };

mbd_kkt *mbd_kkt_create(const mbd_model *model) {
  mbd_kkt *k = calloc(1, sizeof *k);
  if (!k)
    return NULL;
  k->nv = 6 * model->nbody;
  k->n = k->nv + model->nrow;
  size_t n = (size_t)k->n;
  k->matrix = calloc(n * n + 1, sizeof(double));
  k->rhs = calloc(n + 1, sizeof(double));
  k->x = calloc(n + 1, sizeof(double));
  k->g = calloc((size_t)model->nrow + 1, sizeof(double));
  k->permutation = gsl_permutation_alloc(n);
  if (!k->matrix || !k->rhs || !k->x || !k->g || !k->permutation)
    mbd_kkt_destroy(&k);
  return k;
}

void mbd_kkt_destroy(mbd_kkt **kkt) {
  mbd_kkt *k = kkt ? *kkt : NULL;
  if (!k)
    return;
  free(k->matrix);
  free(k->rhs);
  free(k->x);
  free(k->g);
  if (k->permutation)
    gsl_permutation_free(k->permutation);
  free(k);
  *kkt = NULL;
}

/* ---- the linear system ---- */

/* what the right-hand side of the constraint rows holds */
typedef enum { POSITION, VELOCITY, ACCELERATION } level;

/* Rows of one joint or driver into the matrix, and -g, -G V - g_t or -V^T H V - g_tt into kkt->g. */
static void constraint_block(mbd_kkt *kkt, const mbd_model *model, mbd_data *data, int index, level of) {
  const mbd_rows *rows = mbd_part_at(model, data, index, of == ACCELERATION);
  double twist[MBD_PAIR];
  mbd_pair_twist(&data->kin[rows->body[0] + 1], &data->kin[rows->body[1] + 1], twist);
  for (int k = 0; k < rows->n; k++) {
    int row = kkt->nv + rows->first + k;
    double sum = of == POSITION ? rows->g[k] : of == VELOCITY ? rows->g_t[k] : rows->g_tt[k];
    for (int i = 0; i < MBD_PAIR && of != POSITION; i++) {
      double rate = 0;
      for (int l = 0; l < MBD_PAIR && of == ACCELERATION; l++)
        rate += rows->H[k][i][l] * twist[l];
      sum += twist[i] * (of == VELOCITY ? rows->G[k][i] : rate);
    }
    kkt->g[rows->first + k] -= sum;
    for (int side = 0; side < 2; side++)
      for (int i = 0; i < 6 && rows->body[side] != MBD_GROUND; i++) {
        int col = 6 * rows->body[side] + i;
        kkt->matrix[row * kkt->n + col] += rows->G[k][6 * side + i];
        kkt->matrix[col * kkt->n + row] = kkt->matrix[row * kkt->n + col];
      }
  }
}

/* Fill the matrix at data->kin and kkt->g. */
static void fill(mbd_kkt *kkt, const mbd_model *model, mbd_data *data, level of) {
  memset(kkt->matrix, 0, (size_t)kkt->n * (size_t)kkt->n * sizeof(double));
  memset(kkt->g, 0, (size_t)model->nrow * sizeof(double));
  for (int b = 0; b < model->nbody; b++) {
    tdm_mat3 J = mbd_inertia_world(&model->body[b], &data->kin[b + 1]);
    for (int i = 0; i < 3; i++) {
      int row = 6 * b + i;
      kkt->matrix[row * kkt->n + row] = model->body[b].mass;
      for (int k = 0; k < 3; k++)
        kkt->matrix[(row + 3) * kkt->n + 6 * b + 3 + k] = J.m[i][k];
    }
  }
  for (int i = 0; i < model->npart; i++)
    constraint_block(kkt, model, data, i, of);
}

/* Factor and solve with the right-hand side (f, kkt->g); f NULL: zero. The solution is in kkt->x. */
static bool solve(mbd_kkt *kkt, const double *f) {
  const size_t n = (size_t)kkt->n;
  gsl_matrix_view matrix = gsl_matrix_view_array(kkt->matrix, n, n);
  gsl_vector_view rhs = gsl_vector_view_array(kkt->rhs, n), x = gsl_vector_view_array(kkt->x, n);
  int sign;
  for (int i = 0; i < kkt->nv; i++)
    kkt->rhs[i] = f ? f[i] : 0;
  memcpy(kkt->rhs + kkt->nv, kkt->g, (n - (size_t)kkt->nv) * sizeof(double));
  gsl_linalg_LU_decomp(&matrix.matrix, kkt->permutation, &sign);
  for (int i = 0; i < kkt->n; i++)
    if (!(fabs(kkt->matrix[i * kkt->n + i]) > 1e-300)) /* singular, or not a number */
      return false;
  gsl_linalg_LU_solve(&matrix.matrix, kkt->permutation, &rhs.vector, &x.vector);
  return tdm_finite(kkt->x, kkt->n);
}

/* ---- positions and velocities ---- */

static double largest(const double *x, int n, int *index) {
  double most = 0;
  for (int i = 0; i < n; i++)
    if (!(fabs(x[i]) <= most)) {
      most = fabs(x[i]);
      if (index)
        *index = i;
    }
  return most;
}

/* Move the poses in y by the twist x. */
static void move(const mbd_model *model, double *y, const double *x) {
  for (int b = 0; b < model->nbody; b++) {
    tdm_state s = mbd_body_state(y, b);
    s.pose.position = tdm_add(s.pose.position, mbd_get3(x + 6 * b));
    tdm_quat turn = tdm_quat_from_rotvec(mbd_get3(x + 6 * b + 3));
    s.pose.orientation = tdm_quat_unit(tdm_quat_mul(turn, s.pose.orientation));
    mbd_set_body_state(y, b, &s);
  }
}

/* Newton on g(q) = 0. Stops at 1e-13 or, near it, where rounding ends the progress. Returns the last |g|; *row is its
 * row. */
static double project_positions(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, double *y, int *row) {
  double last = INFINITY;
  for (int i = 0; i < ITERATIONS_MAX; i++) {
    mbd_kinematics(model, data, t, y);
    fill(kkt, model, data, POSITION);
    double g = largest(kkt->g, model->nrow, row);
    if (g < 1e-14 || (g < 1e-11 && g >= 0.5 * last))
      return g;
    last = g;
    if (!solve(kkt, NULL))
      return INFINITY;
    /* not more than half a radian or a metre at once: Newton's linear model ends there */
    double most = largest(kkt->x, kkt->nv, NULL);
    for (int k = 0; k < kkt->nv && most > 0.5; k++)
      kkt->x[k] *= 0.5 / most;
    move(model, y, kkt->x);
  }
  return last;
}

/* Velocities onto the joints' rows; the coordinates of drivers keep their rates, or take the prescribed ones. */
static bool project_velocities(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, double *y, bool drive) {
  mbd_kinematics(model, data, t, y);
  fill(kkt, model, data, VELOCITY);
  for (int i = model->njointrow; i < model->nrow && !drive; i++)
    kkt->g[i] = 0;
  if (!solve(kkt, NULL))
    return false;
  for (int b = 0; b < model->nbody; b++)
    for (int i = 0; i < 6; i++)
      y[MBD_BODY_UNKNOWNS * b + MBD_V + i] += kkt->x[6 * b + i];
  return true;
}

bool mbd_project(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, double *y) {
  int row = 0;
  return project_positions(model, data, kkt, t, y, &row) < 1e-9 && project_velocities(model, data, kkt, t, y, true);
}

/* ---- start ---- */

/* where a row comes from, for messages */
typedef struct {
  char path[TDM_PATH_MAX];
  const char *kind, *name, *equation; /* "joint" or "driver" */
} origin;

static origin origin_of(const mbd_model *model, int row) {
  origin o;
  if (row >= model->njointrow) {
    const mbd_driver *d = &model->driver[row - model->njointrow]; /* one row each */
    snprintf(o.path, sizeof o.path, "mbd.drivers[%d]", (int)(d - model->driver));
    o.kind = "driver", o.name = d->name, o.equation = mbd_coordinate_table[d->ops->coordinate].name;
    return o;
  }
  const mbd_joint *j = model->joint;
  while (row >= j->row + j->ops->nrow)
    j++;
  snprintf(o.path, sizeof o.path, "mbd.joints[%d]", (int)(j - model->joint));
  o.kind = "joint", o.name = j->name, o.equation = j->ops->equation[row - j->row];
  return o;
}

/* Gram-Schmidt on the rows of G, each against the rows before it: a row that leaves nothing is redundant. */
static tdm_status check_rank(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, tdm_error *err) {
  mbd_kinematics(model, data, data->t, data->y);
  fill(kkt, model, data, POSITION);
  for (int i = 0; i < model->nrow; i++) {
    double *row = kkt->matrix + (kkt->nv + i) * kkt->n, before = 0, after = 0;
    for (int k = 0; k < kkt->nv; k++)
      before += row[k] * row[k];
    for (int pass = 0; pass < 2; pass++) /* twice is enough (Parlett) */
      for (int j = 0; j < i; j++) {
        const double *other = kkt->matrix + (kkt->nv + j) * kkt->n;
        double dot = 0;
        for (int k = 0; k < kkt->nv; k++)
          dot += row[k] * other[k];
        for (int k = 0; k < kkt->nv; k++)
          row[k] -= dot * other[k];
      }
    for (int k = 0; k < kkt->nv; k++)
      after += row[k] * row[k];
    if (!(sqrt(after) > 1e-9 * sqrt(before))) {
      origin o = origin_of(model, i);
      bool driver = i >= model->njointrow;
      return tdm_fail(err, TDM_ERR_SCENE, o.path,
                      "the equation \"%s\" of %s \"%s\" is redundant: the joints%s before it fix that motion already "
                      "(or the start is a singular position); %s, or start elsewhere",
                      o.equation, o.kind, o.name, driver ? " and the drivers" : "",
                      driver ? "remove the driver" : "use a joint with more freedom there");
    }
    for (int k = 0; k < kkt->nv; k++)
      row[k] /= sqrt(after);
  }
  return TDM_OK;
}

/* Note the largest differences between the scene's start and y. */
static void compare(const mbd_model *model, const double *y, mbd_assembly *a) {
  for (int b = 0; b < model->nbody; b++) {
    tdm_state now = mbd_body_state(y, b), start = model->body[b].start;
    double moved = tdm_norm(tdm_sub(now.pose.position, start.pose.position));
    tdm_quat turn = tdm_quat_mul(now.pose.orientation, tdm_quat_conj(start.pose.orientation));
    double turned = tdm_norm(tdm_quat_to_rotvec(turn));
    double dv = tdm_norm(tdm_sub(now.twist.velocity, start.twist.velocity));
    double dw = tdm_norm(tdm_sub(now.twist.angular, start.twist.angular));
    if (fmax(moved, turned) > fmax(a->translation, a->rotation))
      a->body = b;
    if (fmax(dv, dw) > fmax(a->velocity, a->angular))
      a->body_velocity = b;
    a->translation = fmax(a->translation, moved);
    a->rotation = fmax(a->rotation, turned);
    a->velocity = fmax(a->velocity, dv);
    a->angular = fmax(a->angular, dw);
  }
}

/* Note the driver whose coordinate has a rate in the velocities y that is not the prescribed one. A coordinate at rest
 * contradicts nothing: that is what a scene without velocities gives. */
static void compare_drivers(const mbd_model *model, mbd_data *data, const double *y, mbd_assembly *a) {
  mbd_kinematics(model, data, data->t, y);
  for (int i = 0; i < model->ndriver; i++) {
    const mbd_rows *rows = mbd_part_at(model, data, model->npart - model->ndriver + i, false);
    double twist[MBD_PAIR], given = 0, prescribed = -rows->g_t[0];
    mbd_pair_twist(&data->kin[rows->body[0] + 1], &data->kin[rows->body[1] + 1], twist);
    for (int k = 0; k < MBD_PAIR; k++)
      given += rows->G[0][k] * twist[k];
    double apart = fabs(given - prescribed);
    if (fabs(given) > 1e-6 && apart > 1e-6 && apart > fabs(a->given - a->prescribed)) {
      a->driver = i;
      a->given = given;
      a->prescribed = prescribed;
    }
  }
}

tdm_status mbd_assemble(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, mbd_assembly *assembly, tdm_error *err) {
  *assembly = (mbd_assembly){.body = -1, .body_velocity = -1, .freedom = kkt->nv - model->nrow, .driver = -1};
  if (check_rank(model, data, kkt, err))
    return err->status;
  int row = 0;
  double g = project_positions(model, data, kkt, data->t, data->y, &row);
  if (!(g < 1e-9)) {
    origin o = origin_of(model, row);
    return tdm_fail(err, TDM_ERR_SCENE, o.path,
                    "the mechanism cannot be assembled: %s \"%s\" stays open (\"%s\", %.3g); check points, axes and "
                    "the bodies' positions",
                    o.kind, o.name, o.equation, g);
  }
  bool good = project_velocities(model, data, kkt, data->t, data->y, false);
  compare(model, data->y, assembly);
  if (model->ndriver > 0) {
    compare_drivers(model, data, data->y, assembly);
    good = good && project_velocities(model, data, kkt, data->t, data->y, true);
  }
  if (!good)
    return tdm_fail(err, TDM_ERR_SCENE, "mbd.joints",
                    "no velocities satisfy the joints at the start: it is a singular position; start elsewhere");
  mbd_accept(model, data, data->t, data->y);
  return TDM_OK;
}

/* ---- accelerations ---- */

bool mbd_accelerations(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, const double *y) {
  mbd_kinematics(model, data, t, y);
  mbd_generalised_forces(model, data, t, data->wrench);
  fill(kkt, model, data, ACCELERATION);
  if (!solve(kkt, data->wrench))
    return false;
  memcpy(data->acceleration, kkt->x, (size_t)kkt->nv * sizeof(double));
  memcpy(data->lambda, kkt->x + kkt->nv, (size_t)model->nrow * sizeof(double));
  return true;
}

bool mbd_consistent(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, double *y, double *yp) {
  if (!mbd_accelerations(model, data, kkt, t, y))
    return false;
  memset(yp, 0, (size_t)mbd_nunknown(model) * sizeof(double));
  for (int b = 0; b < model->nbody; b++) {
    double *u = yp + MBD_BODY_UNKNOWNS * b;
    const mbd_kin *k = &data->kin[b + 1];
    tdm_quat turn = tdm_quat_mul((tdm_quat){0, k->w.x, k->w.y, k->w.z}, mbd_quat_of(y, b));
    mbd_set3(u + MBD_R, k->v);
    u[MBD_P] = 0.5 * turn.w;
    u[MBD_P + 1] = 0.5 * turn.x;
    u[MBD_P + 2] = 0.5 * turn.y;
    u[MBD_P + 3] = 0.5 * turn.z;
    memcpy(u + MBD_V, data->acceleration + 6 * b, 6 * sizeof(double));
    y[mbd_index_eta(model, b)] = 0;
  }
  memcpy(y + mbd_index_lambda(model, 0), data->lambda, (size_t)model->nrow * sizeof(double));
  memset(y + mbd_index_mu(model, 0), 0, (size_t)model->nrow * sizeof(double));
  return true;
}
