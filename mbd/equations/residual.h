/* The equations of motion as a residual F(t, y, ydot) = 0: stabilised index 2 (Gear, Gupta & Leimkuhler 1985, J.
 * Comput. Appl. Math. 12, 77-90; Hairer & Wanner, Solving ODEs II, VII.1).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_EQUATIONS_RESIDUAL_H
#define MBD_EQUATIONS_RESIDUAL_H

#include "mbd/mechanics/state.h"

/* out (nunknown) = F(t, y, yp). Uses data's load, angles and workspace. */
void mbd_residual(const mbd_model *model, mbd_data *data, double t, const double *y, const double *yp, double *out);

/* Generalised forces at data->kin and time t into Q (6 nbody): gravity, load from outside, forces, and the gyroscopic
 * moment -w x J w; the equations of motion are M Vdot = Q - G^T lambda. */
void mbd_generalised_forces(const mbd_model *model, mbd_data *data, double t, double *Q);

#endif
