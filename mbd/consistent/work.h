/* Work done on the mechanism, and turned into heat. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_CONSISTENT_WORK_H
#define MBD_CONSISTENT_WORK_H

#include "mbd/consistent/kkt.h"

/* Hands out the unknowns at time t inside the last step; NULL: none. */
typedef const double *(*mbd_unknowns_fn)(void *context, double t);

/* Sum of two works. */
mbd_work mbd_work_add(mbd_work a, mbd_work b);

/* Work from time `from` to `to` inside the last step, by Gauss' rule: three points, six for a load of more than a
 * parabola (exact along a cubic velocity); nothing is evaluated where nothing can do work. The reactions of drivers and
 * in joints that rub come from the acceleration level: loads jump between windows, and multipliers that are
 * interpolated over a jump are wrong. Changes data->kin, and with drivers what mbd_accelerations changes. */
mbd_work mbd_work_over(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double from, double to,
                       mbd_unknowns_fn unknowns, void *context);

#endif
