/* Consistent states: positions and velocities on the constraints, accelerations and reactions that fit. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_CONSISTENT_CONSISTENT_H
#define MBD_CONSISTENT_CONSISTENT_H

#include "mbd/consistent/kkt.h"

/* Move the pose of a body in y by `scale` times the twist x (6). */
void mbd_move_body(double *y, int body, const double *x, double scale);

/* The largest way that a driver's law prescribes at time t [m], and whether one prescribes anything but zero. */
double mbd_prescribed_way(const mbd_model *model, double t, bool *any);

/* Newton on g(q) = 0, all rows. Stops at 1e-14 or, near it, where rounding ends the progress. Returns the last |g|. */
double mbd_project_positions(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, double *y);

/* Velocities onto the joints' rows; the coordinates of drivers keep their rates, or take the prescribed ones. */
bool mbd_project_velocities(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, double *y, bool drive);

/* Put a state that is nearly consistent at time t onto the constraints, positions and velocities; no messages. false:
 * failed. */
bool mbd_project(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, double *y);

/* Accelerations and lambda (zero for dependent rows: see mbd_kkt_share) at the state y and time t, into
 * data->acceleration and data->lambda; data->kin is the kinematics of y then. false: the system is singular. */
bool mbd_accelerations(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, const double *y);

/* Multipliers and derivatives that make (t, y, yp) consistent; positions and velocities of y must be. */
bool mbd_consistent(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, double *y, double *yp);

#endif
