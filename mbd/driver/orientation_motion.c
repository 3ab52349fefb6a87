/* Orientation motion: the rotation of the second body against the first about an axis follows the law, whatever tilt
 * there is beside it.
 *
 * The angle is the twist about the axis: 2 atan(u.e/w) with the quaternion (w, u) of the rotation. Those about three
 * perpendicular axes are twice the arc tangents of Rodrigues' parameters, so three drivers prescribe any orientation
 * within half a turn. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/driver/driver.h"

static void read(mbd_driver *driver, tdm_object *o, const mbd_model *model) {
  driver->joint = &driver->frame;
  mbd_read_bodies(o, model, driver->frame.body);
  mbd_joint_set_frame(&driver->frame, model, tdm_v3(0, 0, 0), mbd_read_direction(o, model, "axis"));
}

extern const mbd_driver_ops mbd_driver_orientation_motion;
const mbd_driver_ops mbd_driver_orientation_motion = {
    .name = "orientation_motion", .coordinate = MBD_ANGLE, .read = read};
