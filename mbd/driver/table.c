/* The driver types. To add one: a file that defines its ops, its name below, and a line in ../CMakeLists.txt and in
 * ../README.md. tests/unit/test_mbd_jacobian.c picks it up from here when it has a scene there.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/driver/driver.h"

extern const mbd_driver_ops mbd_driver_rotational_motor, mbd_driver_linear_motor, mbd_driver_point_motion,
    mbd_driver_orientation_motion;

const mbd_driver_ops *const mbd_driver_table[] = {&mbd_driver_rotational_motor, &mbd_driver_linear_motor,
                                                  &mbd_driver_point_motion, &mbd_driver_orientation_motion};
const int mbd_driver_ntype = sizeof mbd_driver_table / sizeof mbd_driver_table[0];
