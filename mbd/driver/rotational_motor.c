/* Rotational motor: the angle of a joint follows a motion law, and the torque that this takes is its output.
 *
 * The angle is the rotation of the second body against the first about the joint axis since the start configuration;
 * a positive torque turns the second body forward and the first back.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/driver/driver.h"

static void read(mbd_driver *driver, tdm_object *o, const mbd_model *model) {
  driver->joint = mbd_read_joint(o, "joint", model, MBD_HAS_ANGLE, "");
}

extern const mbd_driver_ops mbd_driver_rotational_motor;
const mbd_driver_ops mbd_driver_rotational_motor = {.name = "rotational_motor", .coordinate = MBD_ANGLE, .read = read};
