/* The mechanism as its coupled bodies feel it: mobility, and the motion linearised in independent coordinates.
 *
 * Of the bodies (nbody), those take part that joints, drivers or forces tie to a coupled one, directly or through
 * others; the ground ties nothing. The coupled bodies never feel the rest.
 *
 * With the columns of N (6 nbody x f) spanning the motions that joints and drivers leave, G N = 0, twists are
 *   V = N u' + V_t,   N^T M V_t = 0,
 * u' the independent velocities, V_t what drivers prescribe. N moves along with N^T M dN/dt = 0, which keeps the
 * directions of motion as steady as G lets it: the column of a hinge turns with its arm, a free body's columns stay.
 * N^T times the equations of motion then is
 *   M_r u'' = N^T (Q + J^T W) + ...,   M_r = N^T M N,
 * and its first-order change by u, u' and the load W at fixed time is
 *   du'' = B dW - A_c du' - A_k du,
 *   B = M_r^-1 J_r^T,   A_c = M_r^-1 N^T C N,   A_k = M_r^-1 N^T (K N + C D),
 * with J_r the rows of N of the coupled bodies, D = d(V)/du at fixed u' (G D = -V^T H N, N^T M D = 0), and K, C of
 * tangent.h, K taken for the accelerations and reactions without their part b, nu that u' and the drivers alone cause
 * (G b = -V^T H V - g_tt, M b + G^T nu = 0): that part follows N, and does no work on it. K has the geometric part of
 * the reactions, so gravity's pendulum stiffness is in A_k. Y = J_r B is the mobility: symmetric, positive
 * semidefinite, zero in directions that are blocked or driven.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_REDUCED_REDUCED_H
#define MBD_REDUCED_REDUCED_H

#include "mbd/consistent/consistent.h"

typedef struct mbd_reduced mbd_reduced;

/* For an assembled state (data->dependent); NULL: out of memory. */
mbd_reduced *mbd_reduced_create(const mbd_model *model, const mbd_data *data);
void mbd_reduced_destroy(mbd_reduced **reduced);

/* The reduced model at the state y, time t and data's load; *out points into `reduced`. Accelerations of all bodies are
 * in data->acceleration then. With more than TDM_FREE_MAX degrees of freedom Y is all there is, solved for with the
 * sparse factors of the accelerations. false: the accelerations cannot be solved for. */
bool mbd_reduced_at(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, mbd_reduced *reduced, double t,
                    const double *y, tdm_mobility *out);

/* Degrees of freedom of the bodies that take part. */
int mbd_reduced_freedom(const mbd_reduced *reduced);

/* N, row-major (6 nbody x *nfree, nbody those that take part), of the last evaluation that had more than Y. */
const double *mbd_reduced_basis(const mbd_reduced *reduced, int *nfree);

#endif
