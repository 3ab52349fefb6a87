/* Point motion: a point of the second body moves along a direction that is fixed in the first, by the law's value from
 * its place in the start configuration; across the direction it is free. Three of them prescribe its path. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/driver/driver.h"

static void read(mbd_driver *driver, tdm_object *o, const mbd_model *model) {
  driver->joint = &driver->frame;
  mbd_read_bodies(o, model, driver->frame.body);
  mbd_joint_set_frame(&driver->frame, model, mbd_read_point(o, model, "point"),
                      mbd_read_direction(o, model, "direction"));
}

extern const mbd_driver_ops mbd_driver_point_motion;
const mbd_driver_ops mbd_driver_point_motion = {.name = "point_motion", .coordinate = MBD_TRANSLATION, .read = read};
