/* The analytic Jacobian dF/dy + cj dF/dydot of the residual, entry by entry: see jacobian.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/equations/jacobian.h"

#include "mbd/equations/tangent.h"
#include "mbd/mechanics/normal.h"

#include <string.h>

/* T of dtheta = T dp */
static void quaternion_map(tdm_quat p, double T[3][4]) {
  double s = 2 / (p.w * p.w + p.x * p.x + p.y * p.y + p.z * p.z);
  const double map[3][4] = {{-p.x, p.w, -p.z, p.y}, {-p.y, p.z, p.w, -p.x}, {-p.z, -p.y, p.x, p.w}};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 4; j++)
      T[i][j] = s * map[i][j];
}

/* row += c . (dr, dtheta) of one body; c has 6 entries */
static void add_position(mbd_sparse *matrix, const mbd_data *data, int row, int body, const double *c) {
  const double(*T)[4] = data->quaternion[body];
  int col = MBD_BODY_UNKNOWNS * body;
  for (int i = 0; i < 3; i++)
    mbd_sparse_add(matrix, row, col + MBD_R + i, c[i]);
  for (int j = 0; j < 4; j++)
    mbd_sparse_add(matrix, row, col + MBD_P + j, c[3] * T[0][j] + c[4] * T[1][j] + c[5] * T[2][j]);
}

/* row += c . (dv, dw) of one body */
static void add_twist(mbd_sparse *matrix, int row, int body, const double *c) {
  int col = MBD_BODY_UNKNOWNS * body + MBD_V;
  for (int i = 0; i < 6; i++)
    mbd_sparse_add(matrix, row, col + i, c[i]);
}

static void add_pair_position(mbd_sparse *matrix, const mbd_data *data, int row, const int body[2], const double *c) {
  for (int side = 0; side < 2; side++)
    if (body[side] != MBD_GROUND)
      add_position(matrix, data, row, body[side], c + 6 * side);
}

static void add_pair_twist(mbd_sparse *matrix, int row, const int body[2], const double *c) {
  for (int side = 0; side < 2; side++)
    if (body[side] != MBD_GROUND)
      add_twist(matrix, row, body[side], c + 6 * side);
}

/* 1/2 Q with (0, a) o p = Q a: rows w x y z */
static void half_product(tdm_quat p, double Q[4][3]) {
  const double q[4][3] = {{-p.x, -p.y, -p.z}, {p.w, p.z, -p.y}, {-p.z, p.w, p.x}, {p.y, -p.x, p.w}};
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 3; j++)
      Q[i][j] = 0.5 * q[i][j];
}

/* ---- bodies ---- */

static void kinematic_rows(const mbd_model *model, const mbd_data *data, int b, double cj, const double *y,
                           mbd_sparse *matrix) {
  const int at = MBD_BODY_UNKNOWNS * b, col_eta = mbd_index_eta(model, b);
  tdm_quat p = mbd_quat_of(y, b);
  const double pv[4] = {p.w, p.x, p.y, p.z};
  tdm_vec3 a = tdm_sub(data->kin[b + 1].w, mbd_get3(data->shift + 6 * b + 3));
  const double turn[4][4] = {{0, -a.x, -a.y, -a.z}, {a.x, 0, -a.z, a.y}, {a.y, a.z, 0, -a.x}, {a.z, -a.y, a.x, 0}};
  double Q[4][3], eta = y[col_eta];
  half_product(p, Q);
  for (int i = 0; i < 3; i++) {
    mbd_sparse_add(matrix, at + MBD_R + i, at + MBD_R + i, cj);
    mbd_sparse_add(matrix, at + MBD_R + i, at + MBD_V + i, -1);
  }
  for (int i = 0; i < 4; i++) {
    for (int j = 0; j < 4; j++)
      mbd_sparse_add(matrix, at + MBD_P + i, at + MBD_P + j, (i == j ? cj - eta : 0) - 0.5 * turn[i][j]);
    for (int j = 0; j < 3; j++)
      mbd_sparse_add(matrix, at + MBD_P + i, at + MBD_W + j, -Q[i][j]);
    mbd_sparse_add(matrix, at + MBD_P + i, col_eta, -pv[i]);
    mbd_sparse_add(matrix, col_eta, at + MBD_P + i, 2 * pv[i]);
  }
}

/* m vdot; J wdot + w x J w */
static void dynamic_rows(const mbd_model *model, const mbd_data *data, int b, double cj, const double *yp,
                         mbd_sparse *matrix) {
  const int at = MBD_BODY_UNKNOWNS * b;
  mbd_spin_tangent s = mbd_spin_at(&model->body[b], &data->kin[b + 1], mbd_get3(yp + at + MBD_W), cj, 1);
  for (int i = 0; i < 3; i++) {
    double c[6] = {0};
    mbd_sparse_add(matrix, at + MBD_V + i, at + MBD_V + i, cj * model->body[b].mass);
    for (int j = 0; j < 3; j++) {
      c[3 + j] = s.rotation.m[i][j];
      mbd_sparse_add(matrix, at + MBD_W + i, at + MBD_W + j, s.motion.m[i][j]);
    }
    add_position(matrix, data, at + MBD_W + i, b, c);
  }
}

/* ---- joints and drivers ---- */

/* Rows of the constraints: G dq, and G dV + (V^T H) dq (index 2; the same calls, of zeros, in index 3). */
static void constraint_rows(const mbd_model *model, const mbd_data *data, const mbd_rows *rows, mbd_sparse *matrix) {
  const double hold = data->index3 ? 0 : 1;
  double twist[MBD_PAIR];
  mbd_pair_twist(&data->kin[rows->body[0] + 1], &data->kin[rows->body[1] + 1], twist);
  for (int k = 0; k < rows->n; k++) {
    double by_position[MBD_PAIR] = {0}, by_twist[MBD_PAIR];
    if (data->dependent[rows->first + k])
      continue;
    for (int i = 0; i < MBD_PAIR; i++) {
      by_twist[i] = hold * rows->G[k][i];
      for (int l = 0; l < MBD_PAIR; l++)
        by_position[l] += hold * twist[i] * rows->H[k][i][l];
    }
    add_pair_position(matrix, data, mbd_index_mu(model, rows->first + k), rows->body, rows->G[k]);
    add_pair_twist(matrix, mbd_index_lambda(model, rows->first + k), rows->body, by_twist);
    add_pair_position(matrix, data, mbd_index_lambda(model, rows->first + k), rows->body, by_position);
  }
}

/* Rows of one body (side) of a constraint: G^T lambda in the dynamics, G^T mu in the kinematics. */
static void multiplier_rows(const mbd_model *model, const mbd_data *data, const mbd_rows *rows, int side,
                            const double *y, double L[MBD_PAIR][MBD_PAIR], double U[MBD_PAIR][MBD_PAIR],
                            mbd_sparse *matrix) {
  const int b = rows->body[side], at = MBD_BODY_UNKNOWNS * b, half = 6 * side;
  double Q[4][3];
  half_product(mbd_quat_of(y, b), Q);
  for (int i = 0; i < 6; i++) {
    add_pair_position(matrix, data, at + MBD_V + i, rows->body, L[half + i]);
    for (int k = 0; k < rows->n; k++)
      mbd_sparse_add(matrix, at + MBD_V + i, mbd_index_lambda(model, rows->first + k), rows->G[k][half + i]);
  }
  for (int i = 0; i < 3; i++) {
    add_pair_position(matrix, data, at + MBD_R + i, rows->body, U[half + i]);
    for (int k = 0; k < rows->n; k++)
      mbd_sparse_add(matrix, at + MBD_R + i, mbd_index_mu(model, rows->first + k), rows->G[k][half + i]);
  }
  for (int i = 0; i < 4; i++) {
    double c[MBD_PAIR];
    for (int l = 0; l < MBD_PAIR; l++)
      c[l] = Q[i][0] * U[half + 3][l] + Q[i][1] * U[half + 4][l] + Q[i][2] * U[half + 5][l];
    add_pair_position(matrix, data, at + MBD_P + i, rows->body, c);
    for (int k = 0; k < rows->n; k++) {
      const double *G = rows->G[k] + half + 3;
      mbd_sparse_add(matrix, at + MBD_P + i, mbd_index_mu(model, rows->first + k),
                     Q[i][0] * G[0] + Q[i][1] * G[1] + Q[i][2] * G[2]);
    }
  }
}

static void constraint_block(const mbd_model *model, mbd_data *data, int index, const double *y, mbd_sparse *matrix) {
  const mbd_rows *rows = mbd_part_at(model, data, index, true);
  const double *lambda = y + mbd_index_lambda(model, rows->first), *mu = y + mbd_index_mu(model, rows->first);
  double L[MBD_PAIR][MBD_PAIR] = {{0}}, U[MBD_PAIR][MBD_PAIR] = {{0}}; /* d(G^T lambda)/dq, d(G^T mu)/dq */
  for (int k = 0; k < rows->n; k++)
    for (int i = 0; i < MBD_PAIR; i++)
      for (int l = 0; l < MBD_PAIR; l++) {
        L[i][l] += lambda[k] * rows->H[k][i][l];
        U[i][l] += mu[k] * rows->H[k][i][l];
      }
  constraint_rows(model, data, rows, matrix);
  for (int side = 0; side < 2; side++)
    if (rows->body[side] != MBD_GROUND)
      multiplier_rows(model, data, rows, side, y, L, U, matrix);
}

/* ---- forces ---- */

static void force_rows(const mbd_model *model, mbd_data *data, int index, mbd_sparse *matrix) {
  const mbd_force *f = &model->force[index];
  const mbd_force_value *value = mbd_force_at(model, data, index, true);
  for (int side = 0; side < 2; side++) {
    if (f->body[side] == MBD_GROUND)
      continue;
    for (int i = 0; i < 6; i++) {
      int row = MBD_BODY_UNKNOWNS * f->body[side] + MBD_V + i;
      double K[MBD_PAIR], C[MBD_PAIR];
      for (int l = 0; l < MBD_PAIR; l++) {
        K[l] = -value->K[6 * side + i][l];
        C[l] = -value->C[6 * side + i][l];
      }
      add_pair_position(matrix, data, row, f->body, K);
      add_pair_twist(matrix, row, f->body, C);
    }
  }
}

/* What the joint's own reaction and the pose change in the normal force of a friction that slides. */
static void normal_rows(const mbd_model *model, mbd_data *data, int index, const double *y, mbd_sparse *matrix) {
  const mbd_force *f = &model->force[index];
  const mbd_stick *stick = &data->stick[f->rubbing->stick];
  if (!f->rubbing->reacts || stick->stuck || stick->way == 0)
    return;
  double slope;
  mbd_normal n = mbd_normal_at(model, data, f, y + mbd_index_lambda(model, 0), true);
  const mbd_force_value *value = mbd_force_at(model, data, index, false);
  const double factor = stick->way * f->ops->level(f, value->rate, &slope);
  const int first = model->part[f->rubbing->part].row;
  for (int i = 0; i < MBD_PAIR; i++) {
    const double by_normal = factor * value->rows.G[0][i];
    double by_q[MBD_PAIR];
    if (f->body[i / 6] == MBD_GROUND)
      continue;
    const int row = MBD_BODY_UNKNOWNS * f->body[i / 6] + MBD_V + i % 6;
    for (int k = 0; k < n.nrow; k++)
      if (!data->dependent[first + k])
        mbd_sparse_add(matrix, row, mbd_index_lambda(model, first + k), by_normal * n.by_lambda[k]);
    for (int l = 0; l < MBD_PAIR; l++)
      by_q[l] = by_normal * n.by_q[l];
    add_pair_position(matrix, data, row, f->body, by_q);
  }
}

/* ---- all ---- */

/* G^T mu of all constraints, as in the residual. */
static void shifts(const mbd_model *model, mbd_data *data, const double *y) {
  memset(data->shift, 0, 6 * (size_t)model->nbody * sizeof(double));
  for (int i = 0; i < model->npart; i++) {
    const mbd_rows *rows = mbd_part_at(model, data, i, false);
    for (int side = 0; side < 2; side++)
      for (int c = 0; c < 6 && rows->body[side] != MBD_GROUND; c++)
        for (int k = 0; k < rows->n; k++)
          data->shift[6 * rows->body[side] + c] += rows->G[k][6 * side + c] * y[mbd_index_mu(model, rows->first + k)];
  }
}

void mbd_jacobian(const mbd_model *model, mbd_data *data, double t, double cj, const double *y, const double *yp,
                  mbd_sparse *matrix) {
  mbd_kinematics(model, data, t, y);
  mbd_normals(model, data, y + mbd_index_lambda(model, 0));
  shifts(model, data, y);
  for (int b = 0; b < model->nbody; b++)
    quaternion_map(mbd_quat_of(y, b), data->quaternion[b]);
  for (int b = 0; b < model->nbody; b++) {
    kinematic_rows(model, data, b, cj, y, matrix);
    dynamic_rows(model, data, b, cj, yp, matrix);
  }
  for (int i = 0; i < model->npart; i++)
    constraint_block(model, data, i, y, matrix);
  for (int i = 0; i < model->nrow; i++) {
    int row_lambda = mbd_index_lambda(model, i), row_mu = mbd_index_mu(model, i);
    bool dependent = data->dependent[i], index3 = data->index3;
    mbd_sparse_add(matrix, row_lambda, row_lambda, dependent ? 1 : 0);
    mbd_sparse_add(matrix, row_mu, row_mu, dependent ? 1 : 0);
    mbd_sparse_add(matrix, row_lambda, row_mu, index3 && !dependent ? 1 : 0);
  }
  for (int i = 0; i < model->nforce; i++)
    force_rows(model, data, i, matrix);
  for (int k = 0; k < model->nfriction; k++)
    normal_rows(model, data, model->friction[k], y, matrix);
  data->stats.jacobians++;
}
