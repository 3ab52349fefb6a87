/* Slim bodies: thin rods without inertia about their own axis.
 *
 * Joints and drivers may hold such a body about its axis, by points beside it or by an axis of their own: then the
 * inertia about it is zero, and the equations of motion are regular all the same. Where all points lie on the axis, a
 * turn about it moves nothing and nothing but a torque about it changes it. Then the body takes the inertia of a ball,
 * (J, J, J), and starts without spin: w x J w = 0 and J wdot = T keep w across the axis for ever while T is, and the
 * axis moves as that of the rod. A torque about the axis is an error (balance.h).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_MECHANICS_SLIM_H
#define MBD_MECHANICS_SLIM_H

#include "mbd/model/model.h"

/* Give every slim body of a model that was just read its inertia. */
tdm_status mbd_slim_settle(mbd_model *model, tdm_error *err);

#endif
