/* The sum of forces on every body: what accelerations and reactions leave of it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_ASSEMBLY_BALANCE_H
#define MBD_ASSEMBLY_BALANCE_H

#include "mbd/mechanics/state.h"

/* Check Q - M Vdot - G^T lambda = 0 with data->acceleration and data->lambda at data->kin and data->now, each force and
 * each row by itself. TDM_ERR_NUMERIC, with the body named, where more than 1e-6 of the largest force (or moment) on it
 * is left, or where a torque turns a slim body about the axis about
 * which it has no inertia. */
tdm_status mbd_check_balance(const mbd_model *model, mbd_data *data, tdm_error *err);

#endif
