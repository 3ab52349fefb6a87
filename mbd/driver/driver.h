/* What a driver's file includes, and the row of a driver. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_DRIVER_DRIVER_H
#define MBD_DRIVER_DRIVER_H

#include "mbd/joint/frame.h"
#include "mbd/model/read.h"

/* Append the row coordinate - x. The effort on the second body is -lambda. */
static inline void mbd_driver_row(const mbd_driver *driver, double x, const mbd_kin *a, const mbd_kin *b,
                                  mbd_rows *rows) {
  mbd_joint_coordinate(driver->joint, driver->ops->coordinate, a, b, x, rows);
}

#endif
