/* Consistent states: see consistent.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/consistent/consistent.h"

#include "mbd/consistent/rubbing.h"
#include "mbd/equations/residual.h"
#include "mbd/linear/largest.h"
#include "mbd/mechanics/normal.h"

#include <math.h>
#include <string.h>

enum { ITERATIONS_MAX = 50 };

/* ---- positions and velocities ---- */

void mbd_move_body(double *y, int body, const double *x, double scale) {
  tdm_state s = mbd_body_state(y, body);
  s.pose.position = tdm_axpy(scale, mbd_get3(x), s.pose.position);
  tdm_quat turn = tdm_quat_from_rotvec(tdm_scale(scale, mbd_get3(x + 3)));
  s.pose.orientation = tdm_quat_unit(tdm_quat_mul(turn, s.pose.orientation));
  mbd_set_body_state(y, body, &s);
}

static void move(const mbd_model *model, double *y, const double *x, double scale) {
  for (int b = 0; b < model->nbody; b++)
    mbd_move_body(y, b, x + 6 * b, scale);
}

double mbd_prescribed_way(const mbd_model *model, double t, bool *any) {
  double way = 0;
  *any = false;
  for (int i = 0; i < model->ndriver; i++) {
    double x = fabs(tdm_motion_at(&model->driver[i].motion, t).value);
    *any = *any || x > 1e-9;
    if (model->driver[i].ops->coordinate == MBD_TRANSLATION)
      way = fmax(way, x);
  }
  return way;
}

/* The share of the move x (6 nbody) that Newton's linear model bears: half a radian, half the mechanism's size. */
static double bearable(const mbd_model *model, const double *x, double size) {
  double share = 1;
  for (int b = 0; b < model->nbody; b++) {
    share = fmin(share, 0.5 * size / fmax(0.5 * size, mbd_largest(x + 6 * b, 3)));
    share = fmin(share, 0.5 / fmax(0.5, mbd_largest(x + 6 * b + 3, 3)));
  }
  return share;
}

double mbd_project_positions(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, double *y) {
  bool any;
  double last = INFINITY, size = fmax(1e-9, mbd_model_extent(model) + mbd_prescribed_way(model, t, &any));
  for (int i = 0; i < ITERATIONS_MAX; i++) {
    mbd_kinematics(model, data, t, y);
    if (!mbd_kkt_fill_all(kkt, model, data, MBD_POSITION))
      return INFINITY;
    double g = mbd_largest(mbd_kkt_b(kkt), model->nrow);
    size = i == 0 ? fmax(size, g) : size; /* what is open has to be bridged */
    if (g < 1e-14 || (g < 1e-11 && g >= 0.5 * last))
      return g;
    last = g;
    const double *x = mbd_kkt_solve(kkt, NULL);
    if (!x)
      return INFINITY;
    move(model, y, x, bearable(model, x, size));
  }
  return last;
}

bool mbd_project_velocities(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, double *y, bool drive) {
  mbd_kinematics(model, data, t, y);
  if (!mbd_kkt_fill(kkt, model, data, MBD_VELOCITY))
    return false;
  double *b = mbd_kkt_b(kkt);
  for (int i = model->njointrow; i < model->njointrow + model->ndriver && !drive; i++)
    b[i] = 0;
  const double *x = mbd_kkt_solve(kkt, NULL);
  for (int i = 0; i < model->nbody && x; i++)
    for (int k = 0; k < 6; k++)
      y[MBD_BODY_UNKNOWNS * i + MBD_V + k] += x[6 * i + k];
  return x != NULL;
}

bool mbd_project(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, double *y) {
  return mbd_project_positions(model, data, kkt, t, y) < 1e-9 && mbd_project_velocities(model, data, kkt, t, y, true);
}

/* ---- accelerations ---- */

bool mbd_accelerations(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, const double *y) {
  mbd_kinematics(model, data, t, y);
  mbd_normals(model, data, NULL);
  mbd_generalised_forces(model, data, t, data->wrench);
  const double *x = mbd_kkt_fill(kkt, model, data, MBD_ACCELERATION) ? mbd_kkt_solve(kkt, data->wrench) : NULL;
  if (!x)
    return false;
  memcpy(data->acceleration, x, 6 * (size_t)model->nbody * sizeof(double));
  memcpy(data->lambda, x + 6 * model->nbody, (size_t)model->nrow * sizeof(double));
  return mbd_rubbing_respond(model, data, kkt, t);
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
