/* The equations of motion linearised at a state, in twist coordinates.
 *
 * With the residual r(q, V, Vdot, lambda) = M Vdot - Q + G^T lambda (residual.h) these are
 *   M = dr/dVdot,  C = dr/dV = -dQ/dV with the gyroscopic moment,
 *   K = dr/dq = d(M Vdot)/dq - dQ/dq + sum_i lambda_i H_i, the geometric part of the reactions in it.
 * dq is a twist in world axes: positions change by dr, orientations are turned by dtheta from the left, V stays as it
 * is. A load on a coupled body is a wrench about its centre of mass in world axes: it does not depend on q and adds
 * nothing.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_EQUATIONS_TANGENT_H
#define MBD_EQUATIONS_TANGENT_H

#include "mbd/mechanics/state.h"

/* entry (row, col) += value */
typedef void (*mbd_entry_fn)(void *context, int row, int col, double value);

/* a sum of the three matrices */
typedef struct {
  double mass, damping, stiffness; /* factors of M, C, K */
} mbd_weights;

/* The weighted sum of M, C and K (6 nbody x 6 nbody) at data->kin and data->now, entry by entry; entries come more than
 * once. acceleration (6 nbody) and lambda (nrow) matter for K alone. */
void mbd_tangent(const mbd_model *model, mbd_data *data, const double *acceleration, const double *lambda,
                 mbd_weights weights, mbd_entry_fn add, void *context);

/* The derivatives of J wdot + w x J w of a body: by wdot times `by_acceleration` plus by w times `by_rate`, and by the
 * orientation. */
typedef struct {
  tdm_mat3 motion, rotation;
} mbd_spin_tangent;

mbd_spin_tangent mbd_spin_at(const mbd_body *body, const mbd_kin *kin, tdm_vec3 acceleration, double by_acceleration,
                             double by_rate);

#endif
