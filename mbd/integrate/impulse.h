/* The velocities that the loads on the coupled bodies have given since the integrator started, in closed form.
 *
 * Loads come as a polynomial a window, W(s) = sum_j W_j s^j, and jump between windows. The mechanism answers with
 *   [M G^T; G 0] [X_j; l_j] = [W_j; 0]    at the window's start,
 *   P(t) = sum over windows of the integral of X(s) = sum_j X_j s^j,
 * and an integrator that takes V - P(t) for its unknown sees no jump: of the load only what the mechanism's motion
 * within the window makes of it is left in dV/dt - X. A formula that blends the past of dV/dt with its present (BDF)
 * would spread a window's impulse over its neighbours. For a free body V - P has nothing of the load in it, so its
 * momentum is exact, and so is that of any mechanism that nothing holds.
 *
 * Where the response cannot be solved for (a singular position) X is 0 in that window, and the load stays in dV/dt.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_INTEGRATE_IMPULSE_H
#define MBD_INTEGRATE_IMPULSE_H

#include "mbd/consistent/kkt.h"

typedef struct mbd_impulse mbd_impulse;

mbd_impulse *mbd_impulse_create(const mbd_model *model); /* NULL: out of memory */
void mbd_impulse_destroy(mbd_impulse **impulse);

/* Forget all windows: P is 0. */
void mbd_impulse_reset(mbd_impulse *impulse);

/* The window of data's load begins at time t with the state y: P goes on from the window before. Nothing happens when
 * it has begun already. Changes data->kin and kkt's matrix. */
void mbd_impulse_begin(mbd_impulse *impulse, const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t,
                       const double *y);

/* P is 0 at time t of the window that has begun, and goes on from there. */
void mbd_impulse_zero_at(mbd_impulse *impulse, double t);

/* Add `sign` P(t) to the velocities of y (nunknown), and `sign` X(t) to those of yp (NULL: not wanted). */
void mbd_impulse_add(const mbd_impulse *impulse, double t, double sign, double *y, double *yp);

/* Largest |P| at time t of a velocity or angular velocity [m/s], [rad/s]. */
double mbd_impulse_size(const mbd_impulse *impulse, double t);

#endif
