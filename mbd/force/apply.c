/* Forces along coordinates of a pair: see force.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/force/force.h"

#include <string.h>

void mbd_force_rates(const mbd_force_value *value, const mbd_kin *a, const mbd_kin *b, double *rate) {
  double twist[MBD_PAIR];
  mbd_pair_twist(a, b, twist);
  for (int k = 0; k < value->rows.n; k++) {
    rate[k] = 0;
    for (int i = 0; i < MBD_PAIR; i++)
      rate[k] += value->rows.G[k][i] * twist[i];
  }
}

/* K and C of row k: dQ = -G_k df_k - f_k dG_k, df_k = sum_j by_x dx_j + by_rate dxdot_j, and dxdot_j = G_j dV + V^T H_j
 * dq */
static void derivatives(mbd_force_value *value, const double twist[MBD_PAIR], int k, double f, const double *by_x,
                        const double *by_rate) {
  const mbd_rows *r = &value->rows;
  double by_q[MBD_PAIR] = {0}, by_v[MBD_PAIR] = {0};
  for (int j = 0; j < r->n; j++)
    for (int l = 0; l < MBD_PAIR; l++) {
      by_q[l] += by_x[j] * r->G[j][l];
      by_v[l] += by_rate[j] * r->G[j][l];
      for (int i = 0; i < MBD_PAIR && by_rate[j] != 0; i++)
        by_q[l] += by_rate[j] * twist[i] * r->H[j][i][l];
    }
  for (int i = 0; i < MBD_PAIR; i++)
    for (int l = 0; l < MBD_PAIR; l++) {
      value->K[i][l] -= r->G[k][i] * by_q[l] + f * r->H[k][i][l];
      value->C[i][l] -= r->G[k][i] * by_v[l];
    }
}

void mbd_force_apply(mbd_force_value *value, const mbd_kin *a, const mbd_kin *b, const double *f, const double *by_x,
                     const double *by_rate) {
  const mbd_rows *r = &value->rows;
  double twist[MBD_PAIR];
  mbd_pair_twist(a, b, twist);
  for (int k = 0; k < r->n; k++) {
    for (int i = 0; i < MBD_PAIR; i++)
      value->Q[i] -= f[k] * r->G[k][i];
    if (value->second)
      derivatives(value, twist, k, f[k], by_x + r->n * k, by_rate + r->n * k);
  }
}

void mbd_force_apply_scalar(mbd_force_value *value, const mbd_kin *a, const mbd_kin *b, double x, double rate,
                            const mbd_scalar *law) {
  mbd_force_apply(value, a, b, &law->f, &law->by_x, &law->by_rate);
  value->value = law->f;
  value->coordinate = x;
  value->rate = rate;
  value->potential = law->potential;
  value->dissipated = law->dissipated;
}

double mbd_force_distance(const mbd_force *force, const mbd_kin *a, const mbd_kin *b, mbd_force_value *value,
                          double *rate) {
  mbd_rows_distance(&value->rows, a, b, mbd_joint_arm(&force->frame, 0, a), mbd_joint_arm(&force->frame, 1, b), 0);
  mbd_force_rates(value, a, b, rate);
  return value->rows.g[0];
}

double mbd_force_coordinate(const mbd_force *force, const mbd_kin *a, const mbd_kin *b, mbd_force_value *value,
                            double *rate) {
  double from = force->coordinate == MBD_ANGLE ? value->near : 0;
  mbd_joint_coordinate(force->joint, force->coordinate, a, b, from, &value->rows);
  mbd_force_rates(value, a, b, rate);
  return from + value->rows.g[0];
}

double mbd_force_read_points(mbd_force *f, tdm_object *o, const mbd_model *model, bool must_part) {
  tdm_vec3 point[2];
  mbd_read_bodies(o, model, f->body);
  memcpy(f->frame.body, f->body, sizeof f->body);
  mbd_read_points(o, model, NULL, "points", point);
  double length = tdm_norm(tdm_sub(point[1], point[0]));
  if (!o->err->status && must_part && !(length > mbd_force_no_length))
    tdm_object_fail(o, "points", "coincide, so that the force has no direction; move one of them");
  for (int side = 0; side < 2; side++)
    f->frame.arm[side] = mbd_model_arm(model, f->body[side], point[side]);
  return length;
}
