/* Linear motor: the translation of a joint along its axis since the start configuration follows a motion law, and the
 * force that this takes is its output; a positive one pushes the second body forward and the first back. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/driver/driver.h"

static void read(mbd_driver *driver, tdm_object *o, const mbd_model *model) {
  driver->joint = mbd_read_joint(o, "joint", model, MBD_HAS_TRANSLATION, "");
}

extern const mbd_driver_ops mbd_driver_linear_motor;
const mbd_driver_ops mbd_driver_linear_motor = {.name = "linear_motor", .coordinate = MBD_TRANSLATION, .read = read};
