/* Work done on the mechanism: see work.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/consistent/work.h"

#include "mbd/consistent/consistent.h"

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

/* Gauss's points and weights on [-1, 1]. Three are exact for the load of a parabola along a
 * cubic velocity, six for one of degree 8. */
typedef struct {
  int n;
  double place[6], weight[6];
} rule;
static const rule few = {3, {-0.7745966692414834, 0, 0.7745966692414834}, {5 / 9., 8 / 9., 5 / 9.}};
static const rule many = {6,
                          {-0.9324695142031521, -0.6612093864662645, -0.2386191860831969, 0.2386191860831969,
                           0.6612093864662645, 0.9324695142031521},
                          {0.1713244923791704, 0.3607615730481386, 0.4679139345726910, 0.4679139345726910,
                           0.3607615730481386, 0.1713244923791704}};

mbd_work mbd_work_over(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double from, double to,
                       mbd_unknowns_fn unknowns, void *context) {
  const rule *gauss = data->nload > 3 ? &many : &few;
  mbd_work work = {0};
  if (model->nforce == 0 && model->ndriver == 0 && (model->ncoupled == 0 || data->nload == 0))
    return work;
  for (int i = 0; i < gauss->n; i++) {
    const double t = from + 0.5 * (1 + gauss->place[i]) * (to - from), share = 0.5 * gauss->weight[i] * (to - from);
    const double *y = unknowns(context, t);
    mbd_work p = y ? power_at(model, data, kkt, t, y) : work;
    work.supplied += share * p.supplied;
    work.coupled += share * p.coupled;
    work.dissipated += share * p.dissipated;
  }
  return work;
}
