/* The equations of motion linearised at a state, in twist coordinates: see tangent.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/equations/tangent.h"

/* d(J a) = (-[J a] + J [a]) dtheta; w x J w the same with a = w */
mbd_spin_tangent mbd_spin_at(const mbd_body *body, const mbd_kin *kin, tdm_vec3 acceleration, double by_acceleration,
                             double by_rate) {
  tdm_mat3 J = mbd_inertia_world(body, kin), W = tdm_m3_skew(kin->w);
  tdm_mat3 J_acc = tdm_m3_mat(J, tdm_m3_skew(acceleration)), JW = tdm_m3_mat(J, W), WJ = tdm_m3_mat(W, J), inner;
  tdm_mat3 sJacc = tdm_m3_skew(tdm_m3_mul(J, acceleration)), sJw = tdm_m3_skew(tdm_m3_mul(J, kin->w));
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      inner.m[i][j] = JW.m[i][j] - sJw.m[i][j];
  tdm_mat3 gyro = tdm_m3_mat(W, inner);
  mbd_spin_tangent s;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      s.motion.m[i][j] = by_acceleration * J.m[i][j] + by_rate * WJ.m[i][j] - by_rate * sJw.m[i][j];
      s.rotation.m[i][j] = J_acc.m[i][j] - sJacc.m[i][j] + gyro.m[i][j];
    }
  return s;
}

static void body_block(const mbd_model *model, const mbd_data *data, int b, const double *acceleration, mbd_weights w,
                       mbd_entry_fn add, void *context) {
  const int at = 6 * b;
  mbd_spin_tangent s =
      mbd_spin_at(&model->body[b], &data->kin[b + 1], mbd_get3(acceleration + at + 3), w.mass, w.damping);
  for (int i = 0; i < 3; i++) {
    add(context, at + i, at + i, w.mass * model->body[b].mass);
    for (int j = 0; j < 3; j++)
      add(context, at + 3 + i, at + 3 + j, s.motion.m[i][j] + w.stiffness * s.rotation.m[i][j]);
  }
}

/* Scatter a block of a pair of bodies. */
static void pair_block(const int body[2], double block[MBD_PAIR][MBD_PAIR], mbd_entry_fn add, void *context) {
  for (int i = 0; i < MBD_PAIR; i++)
    for (int j = 0; j < MBD_PAIR; j++)
      if (body[i / 6] != MBD_GROUND && body[j / 6] != MBD_GROUND && block[i][j] != 0)
        add(context, 6 * body[i / 6] + i % 6, 6 * body[j / 6] + j % 6, block[i][j]);
}

void mbd_tangent(const mbd_model *model, mbd_data *data, const double *acceleration, const double *lambda,
                 mbd_weights w, mbd_entry_fn add, void *context) {
  for (int b = 0; b < model->nbody; b++)
    body_block(model, data, b, acceleration, w, add, context);
  for (int i = 0; i < model->npart && w.stiffness != 0; i++) {
    const mbd_rows *rows = mbd_part_at(model, data, i, true);
    double block[MBD_PAIR][MBD_PAIR] = {{0}};
    for (int k = 0; k < rows->n; k++)
      for (int a = 0; a < MBD_PAIR; a++)
        for (int c = 0; c < MBD_PAIR; c++)
          block[a][c] += w.stiffness * lambda[rows->first + k] * rows->H[k][a][c];
    pair_block(rows->body, block, add, context);
  }
  for (int i = 0; i < model->nforce && (w.stiffness != 0 || w.damping != 0); i++) {
    const mbd_force_value *value = mbd_force_at(model, data, i, true);
    double block[MBD_PAIR][MBD_PAIR];
    for (int a = 0; a < MBD_PAIR; a++)
      for (int c = 0; c < MBD_PAIR; c++)
        block[a][c] = -w.stiffness * value->K[a][c] - w.damping * value->C[a][c];
    pair_block(model->force[i].body, block, add, context);
  }
}
