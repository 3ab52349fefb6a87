/* Work done on the mechanism: see work.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/consistent/work.h"

#include "mbd/consistent/consistent.h"

#include <math.h>

/* Power brought in by drivers, applied forces and the loads on coupled bodies, and turned into heat, at the unknowns y
 * and time t. A driver's row moves at G V = -g_t under the reaction -G^T lambda: it brings in lambda g_t. */
static mbd_work power_at(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, const double *y) {
  mbd_work p = {0};
  const double *lambda = y + mbd_index_lambda(model, 0);
  if ((model->ndriver > 0 || model->nreacting > 0) && mbd_accelerations(model, data, kkt, t, y))
    lambda = data->lambda;
  else
    mbd_kinematics(model, data, t, y);
  for (int i = 0; i < model->nforce; i++) {
    const mbd_force_value *f = mbd_force_at(model, data, i, false);
    p.supplied += f->supplied;
    p.dissipated += f->dissipated;
  }
  for (int i = model->njointpart; i < model->njointpart + model->ndriver; i++) {
    const mbd_rows *rows = mbd_part_at(model, data, i, false);
    p.supplied += lambda[rows->first] * rows->g_t[0];
  }
  for (int i = 0; i < model->ncoupled && data->nload > 0; i++) {
    const mbd_kin *k = &data->kin[model->coupled[i] + 1];
    tdm_wrench load = mbd_load_at(data, i, t);
    p.coupled += tdm_dot(load.force, k->v) + tdm_dot(load.moment, k->w);
  }
  p.supplied += p.coupled;
  return p;
}

mbd_work mbd_work_add(mbd_work a, mbd_work b) {
  return (mbd_work){a.supplied + b.supplied, a.coupled + b.coupled, a.dissipated + b.dissipated};
}

mbd_work mbd_work_over(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double from, double to,
                       mbd_unknowns_fn unknowns, void *context) {
  const double place[] = {0.5 - 0.5 * sqrt(0.6), 0.5, 0.5 + 0.5 * sqrt(0.6)}, weight[] = {5 / 18.0, 8 / 18.0, 5 / 18.0};
  mbd_work work = {0};
  if (model->nforce == 0 && model->ndriver == 0 && (model->ncoupled == 0 || data->nload == 0))
    return work;
  for (int i = 0; i < 3; i++) {
    double t = from + place[i] * (to - from);
    const double *y = unknowns(context, t);
    mbd_work p = y ? power_at(model, data, kkt, t, y) : work;
    work.supplied += weight[i] * (to - from) * p.supplied;
    work.coupled += weight[i] * (to - from) * p.coupled;
    work.dissipated += weight[i] * (to - from) * p.dissipated;
  }
  return work;
}
