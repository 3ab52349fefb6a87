/* Revolute joint (hinge): rotation about one axis. Five rows. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/joint.h"

static const char *const equation[] = {"point x", "point y", "point z", "tilt 1", "tilt 2"};

static void read(mbd_joint *joint, tdm_object *o, const mbd_model *model) {
  mbd_joint_read_frame(joint, o, model, true);
}

static void eval(const mbd_joint *j, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows) {
  tdm_vec3 axis = mbd_joint_axis(j, 1, 2, b);
  mbd_rows_point(rows, a, b, mbd_joint_arm(j, 0, a), mbd_joint_arm(j, 1, b));
  mbd_rows_perpendicular(rows, mbd_joint_axis(j, 0, 0, a), axis);
  mbd_rows_perpendicular(rows, mbd_joint_axis(j, 0, 1, a), axis);
}

extern const mbd_joint_ops mbd_joint_revolute;
const mbd_joint_ops mbd_joint_revolute = {
    .name = "revolute",
    .nrow = 5,
    .equation = equation,
    .read = read,
    .eval = eval,
    .coordinates = MBD_HAS_ANGLE,
};
