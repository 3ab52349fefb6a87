/* The normal force that a coefficient of friction multiplies, of the joint's own reaction: see normal.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/mechanics/normal.h"

/* a joint's reaction on its second body and its axis, or a change of these */
typedef struct {
  tdm_vec3 force, moment, axis;
} reaction;

/* -G^T lambda of row coefficients on the second body: wrench about its centre of mass into w (6) */
static void add_wrench(double w[6], const double *row, double lambda) {
  for (int c = 0; c < 6; c++)
    w[c] -= row[MBD_RB + c] * lambda;
}

/* The reaction of a wrench w about the centre of mass, at the end of the arm. */
static reaction at_point(const double w[6], tdm_vec3 arm, tdm_vec3 axis) {
  tdm_vec3 force = mbd_get3(w);
  return (reaction){force, tdm_sub(mbd_get3(w + 3), tdm_cross(arm, force)), axis};
}

/* The forces across the axis on both ends of the bearing, or their change by d (NULL: the forces). */
static void ends(const mbd_rubbing *r, const reaction *at, const reaction *d, tdm_vec3 P[2]) {
  const reaction *x = d ? d : at;
  tdm_vec3 across = tdm_axpy(-tdm_dot(at->axis, x->force), at->axis, x->force), lever = {0, 0, 0};
  if (d) {
    across = tdm_axpy(-tdm_dot(d->axis, at->force), at->axis, across);
    across = tdm_axpy(-tdm_dot(at->axis, at->force), d->axis, across);
  }
  if (r->length > 0) {
    lever = tdm_cross(at->axis, x->moment);
    lever = tdm_scale(1 / r->length, d ? tdm_add(lever, tdm_cross(d->axis, at->moment)) : lever);
  }
  P[0] = tdm_add(tdm_scale(0.5, across), lever);
  P[1] = tdm_sub(tdm_scale(0.5, across), lever);
}

static double pressing(const mbd_rubbing *r, const reaction *at) {
  tdm_vec3 P[2];
  ends(r, at, NULL, P);
  return r->across * (tdm_norm(P[0]) + tdm_norm(P[1])) + r->along * fabs(tdm_dot(at->axis, at->force)) +
         r->about * fabs(tdm_dot(at->axis, at->moment));
}

/* the change of `pressing` by the change d */
static double pressing_change(const mbd_rubbing *r, const reaction *at, const reaction *d) {
  tdm_vec3 P[2], dP[2];
  double sum = 0, along = tdm_dot(at->axis, at->force), about = tdm_dot(at->axis, at->moment);
  ends(r, at, NULL, P);
  ends(r, at, d, dP);
  for (int k = 0; k < 2; k++)
    sum += tdm_norm(P[k]) > 0 ? r->across * tdm_dot(tdm_unit(P[k]), dP[k]) : 0;
  sum += copysign(r->along, along) * (tdm_dot(at->axis, d->force) + tdm_dot(d->axis, at->force));
  return sum + copysign(r->about, about) * (tdm_dot(at->axis, d->moment) + tdm_dot(d->axis, at->moment));
}

/* The derivatives of n by the joint's lambda and the pair's pose, the reaction `at` of the wrench w. */
static void differentiate(const mbd_rubbing *r, const mbd_rows *rows, const double *lambda, const reaction *at,
                          tdm_vec3 arm, mbd_normal *n) {
  const tdm_vec3 still = {0, 0, 0};
  for (int k = 0; k < rows->n; k++) {
    double dw[6] = {0};
    add_wrench(dw, rows->G[k], 1);
    reaction d = at_point(dw, arm, still);
    n->by_lambda[k] = pressing_change(r, at, &d);
  }
  for (int l = 0; l < MBD_PAIR; l++) {
    double dw[6] = {0}, turn[3] = {0};
    for (int k = 0; k < rows->n; k++)
      for (int c = 0; c < 6; c++)
        dw[c] -= rows->H[k][MBD_RB + c][l] * lambda[k];
    turn[l % 3] = l % 6 < 3 ? 0 : 1;
    reaction d = at_point(dw, arm, l < MBD_RB ? tdm_cross(mbd_get3(turn), at->axis) : still);
    if (l >= MBD_RB) /* the arm turns with the second body */
      d.moment = tdm_sub(d.moment, tdm_cross(tdm_cross(mbd_get3(turn), arm), at->force));
    n->by_q[l] = pressing_change(r, at, &d);
  }
}

mbd_normal mbd_normal_at(const mbd_model *model, mbd_data *data, const mbd_force *f, const double *lambda,
                         bool second) {
  mbd_normal n = {.normal = f->rubbing->base};
  if (!f->rubbing->reacts)
    return n;
  const mbd_rows *rows = mbd_part_at(model, data, f->rubbing->part, second);
  const double *own = lambda + rows->first;
  tdm_vec3 arm = mbd_joint_arm(f->joint, 1, &data->kin[f->body[1] + 1]);
  double w[6] = {0};
  n.nrow = rows->n;
  for (int k = 0; k < rows->n; k++)
    add_wrench(w, rows->G[k], own[k]);
  reaction at = at_point(w, arm, mbd_joint_axis(f->joint, 0, 2, &data->kin[f->body[0] + 1]));
  n.normal += pressing(f->rubbing, &at);
  if (second)
    differentiate(f->rubbing, rows, own, &at, arm, &n);
  return n;
}

void mbd_normals(const mbd_model *model, mbd_data *data, const double *lambda) {
  for (int k = 0; k < model->nfriction && model->nreacting > 0; k++) {
    const mbd_force *f = &model->force[model->friction[k]];
    data->stick[k].normal = lambda ? mbd_normal_at(model, data, f, lambda, false).normal : f->rubbing->base;
  }
}
