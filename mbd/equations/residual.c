/* The equations of motion as a residual F(t, y, ydot) = 0: see residual.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/equations/residual.h"

#include "mbd/mechanics/normal.h"

#include <string.h>

/* Add one half of a pair's 12 numbers to a body's 6; the ground takes nothing. */
static void scatter(double *to, const int body[2], const double pair[MBD_PAIR]) {
  for (int side = 0; side < 2; side++) {
    if (body[side] == MBD_GROUND)
      continue;
    for (int k = 0; k < 6; k++)
      to[6 * body[side] + k] += pair[6 * side + k];
  }
}

void mbd_generalised_forces(const mbd_model *model, mbd_data *data, double t, double *Q) {
  for (int b = 0; b < model->nbody; b++) {
    const mbd_kin *k = &data->kin[b + 1];
    const mbd_body *body = &model->body[b];
    mbd_set3(Q + 6 * b, tdm_scale(body->mass, model->gravity));
    mbd_set3(Q + 6 * b + 3, tdm_cross(mbd_inertia_mul(body, k, k->w), k->w));
  }
  for (int i = 0; i < model->ncoupled && data->nload > 0; i++) {
    tdm_wrench w = mbd_load_at(data, i, t);
    mbd_put3(Q + 6 * model->coupled[i], 1, w.force);
    mbd_put3(Q + 6 * model->coupled[i] + 3, 1, w.moment);
  }
  for (int i = 0; i < model->nforce; i++)
    scatter(Q, model->force[i].body, mbd_force_at(model, data, i, false)->Q);
}

/* Rows of joints and drivers: g and G V + g_t into the residual, G^T lambda off the forces, G^T mu into the shift. */
static void constraints(const mbd_model *model, mbd_data *data, const double *y, double *out) {
  const double *lambda = y + mbd_index_lambda(model, 0), *mu = y + mbd_index_mu(model, 0);
  memset(out + mbd_index_lambda(model, 0), 0, 2 * (size_t)model->nrow * sizeof(double));
  for (int i = 0; i < model->npart; i++) {
    const mbd_rows *rows = mbd_part_at(model, data, i, false);
    double twist[MBD_PAIR], reaction[MBD_PAIR] = {0}, shift[MBD_PAIR] = {0};
    mbd_pair_twist(&data->kin[rows->body[0] + 1], &data->kin[rows->body[1] + 1], twist);
    for (int k = 0; k < rows->n; k++) {
      int row = rows->first + k;
      if (data->dependent[row])
        continue;
      double rate = rows->g_t[k];
      for (int c = 0; c < MBD_PAIR; c++) {
        rate += rows->G[k][c] * twist[c];
        reaction[c] -= rows->G[k][c] * lambda[row];
        shift[c] += rows->G[k][c] * mu[row];
      }
      out[mbd_index_lambda(model, row)] += rate;
      out[mbd_index_mu(model, row)] += rows->g[k];
    }
    scatter(data->wrench, rows->body, reaction);
    scatter(data->shift, rows->body, shift);
  }
}

/* The 14 equations of one body:
 *   rdot - v + (G^T mu)_r;  pdot - 1/2 (0, w - (G^T mu)_theta) o p - p eta;  m vdot - f;  J wdot - (T - w x J w);
 *   p.p - 1 */
static void body_residual(const mbd_model *model, const mbd_data *data, int b, const double *y, const double *yp,
                          double *out) {
  const int at = MBD_BODY_UNKNOWNS * b;
  const mbd_kin *k = &data->kin[b + 1];
  const double *f = data->wrench + 6 * b, *shift = data->shift + 6 * b;
  tdm_quat p = mbd_quat_of(y, b);
  tdm_vec3 spin = tdm_sub(k->w, mbd_get3(shift + 3));
  tdm_quat turn = tdm_quat_mul((tdm_quat){0, spin.x, spin.y, spin.z}, p);
  double eta = y[mbd_index_eta(model, b)];
  double *u = out + at;
  mbd_set3(u + MBD_R, tdm_add(tdm_sub(mbd_get3(yp + at + MBD_R), k->v), mbd_get3(shift)));
  u[MBD_P] = yp[at + MBD_P] - 0.5 * turn.w - eta * p.w;
  u[MBD_P + 1] = yp[at + MBD_P + 1] - 0.5 * turn.x - eta * p.x;
  u[MBD_P + 2] = yp[at + MBD_P + 2] - 0.5 * turn.y - eta * p.y;
  u[MBD_P + 3] = yp[at + MBD_P + 3] - 0.5 * turn.z - eta * p.z;
  tdm_vec3 inertial = tdm_scale(model->body[b].mass, mbd_get3(yp + at + MBD_V));
  mbd_set3(u + MBD_V, tdm_sub(inertial, mbd_get3(f)));
  inertial = mbd_inertia_mul(&model->body[b], k, mbd_get3(yp + at + MBD_W));
  mbd_set3(u + MBD_W, tdm_sub(inertial, mbd_get3(f + 3)));
  out[mbd_index_eta(model, b)] = p.w * p.w + p.x * p.x + p.y * p.y + p.z * p.z - 1;
}

void mbd_residual(const mbd_model *model, mbd_data *data, double t, const double *y, const double *yp, double *out) {
  mbd_kinematics(model, data, t, y);
  mbd_normals(model, data, y + mbd_index_lambda(model, 0));
  mbd_generalised_forces(model, data, t, data->wrench);
  memset(data->shift, 0, 6 * (size_t)model->nbody * sizeof(double));
  constraints(model, data, y, out);
  for (int i = 0; i < model->nrow; i++) {
    int row_lambda = mbd_index_lambda(model, i), row_mu = mbd_index_mu(model, i);
    if (data->dependent[i]) /* no equation, so no multipliers */
      out[row_lambda] = y[row_lambda], out[row_mu] = y[row_mu];
    else if (data->index3) /* no velocity constraint, so no mu */
      out[row_lambda] = y[row_mu];
  }
  for (int b = 0; b < model->nbody; b++)
    body_residual(model, data, b, y, yp, out);
  data->stats.residuals++;
}
