/* Velocities that loads on the coupled bodies have given, in closed form: see impulse.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/integrate/impulse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct mbd_impulse {
  int nv;        /* 6 nbody */
  bool begun;    /* a window has */
  double t0, t1; /* of it [s] */
  int n;         /* coefficients of X */
  double *X;     /* (TDM_LOAD_MAX x nv) */
  double *P;     /* (nv) at t0 */
  double *load;  /* (nv) W_j */
};

mbd_impulse *mbd_impulse_create(const mbd_model *model) {
  mbd_impulse *p = calloc(1, sizeof *p);
  if (!p)
    return NULL;
  p->nv = 6 * model->nbody;
  p->X = calloc(TDM_LOAD_MAX * (size_t)p->nv + 1, sizeof *p->X);
  p->P = calloc((size_t)p->nv + 1, sizeof *p->P);
  p->load = calloc((size_t)p->nv + 1, sizeof *p->load);
  if (!p->X || !p->P || !p->load)
    mbd_impulse_destroy(&p);
  return p;
}

void mbd_impulse_destroy(mbd_impulse **impulse) {
  if (!*impulse)
    return;
  free((*impulse)->X);
  free((*impulse)->P);
  free((*impulse)->load);
  free(*impulse);
  *impulse = NULL;
}

/* The integral of velocity k's X from the window's start to t */
static double given(const mbd_impulse *p, int k, double t) {
  const double s = (t - p->t0) / (p->t1 - p->t0);
  double sum = 0;
  for (int j = p->n - 1; j >= 0; j--)
    sum = s * (sum + p->X[j * p->nv + k] / (j + 1));
  return (p->t1 - p->t0) * sum;
}

static double rate(const mbd_impulse *p, int k, double t) {
  const double s = (t - p->t0) / (p->t1 - p->t0);
  double sum = 0;
  for (int j = p->n - 1; j >= 0; j--)
    sum = s * sum + p->X[j * p->nv + k];
  return sum;
}

void mbd_impulse_reset(mbd_impulse *p) {
  p->begun = false;
  p->n = 0;
  memset(p->P, 0, (size_t)p->nv * sizeof *p->P);
}

/* X of data's load at data->kin; false: the position is singular. */
static bool respond(mbd_impulse *p, const mbd_model *model, mbd_data *data, mbd_kkt *kkt) {
  if (!mbd_kkt_fill(kkt, model, data, MBD_POSITION))
    return false;
  memset(mbd_kkt_b(kkt), 0, (size_t)model->nrow * sizeof(double));
  for (int j = 0; j < data->nload; j++) {
    memset(p->load, 0, (size_t)p->nv * sizeof(double));
    for (int c = 0; c < model->ncoupled; c++)
      memcpy(p->load + 6 * model->coupled[c], &data->load[c * data->nload + j], sizeof(tdm_wrench));
    const double *x = mbd_kkt_solve(kkt, p->load);
    if (!x || !tdm_finite(x, p->nv))
      return false;
    memcpy(p->X + j * p->nv, x, (size_t)p->nv * sizeof(double));
  }
  return true;
}

void mbd_impulse_begin(mbd_impulse *p, const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t,
                       const double *y) {
  if (p->begun && p->t0 == data->load_t0 && p->t1 == data->load_t1)
    return;
  for (int k = 0; k < p->nv && p->begun; k++)
    p->P[k] += given(p, k, p->t1);
  p->begun = true;
  p->t0 = data->load_t0;
  p->t1 = data->load_t1;
  p->n = model->ncoupled > 0 && p->t1 > p->t0 ? data->nload : 0;
  if (p->n == 0)
    return;
  mbd_kinematics(model, data, t, y);
  if (!respond(p, model, data, kkt))
    p->n = 0;
}

void mbd_impulse_zero_at(mbd_impulse *p, double t) {
  for (int k = 0; k < p->nv; k++)
    p->P[k] = -given(p, k, t);
}

void mbd_impulse_add(const mbd_impulse *p, double t, double sign, double *y, double *yp) {
  for (int k = 0; k < p->nv; k++) {
    const int at = MBD_BODY_UNKNOWNS * (k / 6) + MBD_V + k % 6;
    y[at] += sign * (p->P[k] + given(p, k, t));
    if (yp)
      yp[at] += sign * rate(p, k, t);
  }
}

double mbd_impulse_size(const mbd_impulse *p, double t) {
  double most = 0;
  for (int k = 0; k < p->nv; k++)
    most = fmax(most, fabs(p->P[k] + given(p, k, t)));
  return most;
}
