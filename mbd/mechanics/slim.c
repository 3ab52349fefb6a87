/* Slim bodies: see slim.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/mechanics/slim.h"

#include "mbd/mechanics/state.h"

#include <math.h>

/* Does a joint or a driver resist a turn of body b about its axis alone? */
static bool held(const mbd_model *model, mbd_data *data, int b) {
  const double share = 1e-9, least = 1e-12 * fmax(1e-9, mbd_model_extent(model)); /* what is more than rounding */
  const tdm_vec3 axis = tdm_m3_mul(data->kin[b + 1].A, model->body[b].axis);
  for (int i = 0; i < model->npart; i++) {
    const mbd_rows *rows = mbd_part_at(model, data, i, false);
    for (int k = 0; k < rows->n; k++)
      for (int side = 0; side < 2; side++) {
        tdm_vec3 about = mbd_get3(rows->G[k] + 6 * side + 3);
        double turn = fabs(tdm_dot(about, axis));
        if (rows->body[side] == b && turn > share * tdm_norm(about) && turn > least)
          return true;
      }
  }
  return false;
}

/* J (1 - share a a^T), a the axis */
static tdm_mat3 inertia_of(double J, tdm_vec3 a, double share) {
  const double v[3] = {a.x, a.y, a.z};
  tdm_mat3 m;
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      m.m[i][k] = J * ((i == k) - share * v[i] * v[k]);
  return m;
}

tdm_status mbd_slim_settle(mbd_model *model, tdm_error *err) {
  bool any = false;
  for (int b = 0; b < model->nbody; b++)
    any = any || model->body[b].slim;
  if (!any)
    return TDM_OK;
  mbd_data *data = mbd_data_create(model);
  if (!data)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for %d bodies", model->nbody);
  mbd_kinematics(model, data, 0, data->y);
  for (int b = 0; b < model->nbody; b++) {
    mbd_body *body = &model->body[b];
    if (!body->slim)
      continue;
    const tdm_mat3 *given = &body->inertia;
    const double J = 0.5 * (given->m[0][0] + given->m[1][1] + given->m[2][2]);
    body->spins = !held(model, data, b);
    body->inertia = inertia_of(J, body->axis, body->spins ? 0 : 1);
    body->inverse_inertia = tdm_m3_inverse(inertia_of(J, body->axis, 0)); /* of what stands for it where one is asked */
    tdm_vec3 axis = tdm_m3_mul(data->kin[b + 1].A, body->axis), *w = &body->start.twist.angular;
    if (body->spins)
      *w = tdm_axpy(-tdm_dot(axis, *w), axis, *w);
  }
  mbd_data_destroy(&data);
  return TDM_OK;
}
