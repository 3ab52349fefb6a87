/* Planar joint: the second body's point stays in a plane of the first and the body turns about its normal alone. Three
 * rows. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/joint.h"

static const char *const equation[] = {"offset", "tilt 1", "tilt 2"};

static void read(mbd_joint *joint, tdm_object *o, const mbd_model *model) {
  mbd_joint_read_frame(joint, o, model, true);
}

static void eval(const mbd_joint *j, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows) {
  tdm_vec3 normal = mbd_joint_axis(j, 1, 2, b);
  mbd_rows_plane(rows, a, b, mbd_joint_axis(j, 0, 2, a), mbd_joint_arm(j, 0, a), mbd_joint_arm(j, 1, b));
  mbd_rows_perpendicular(rows, mbd_joint_axis(j, 0, 0, a), normal);
  mbd_rows_perpendicular(rows, mbd_joint_axis(j, 0, 1, a), normal);
}

extern const mbd_joint_ops mbd_joint_planar;
const mbd_joint_ops mbd_joint_planar = {
    .name = "planar",
    .nrow = 3,
    .equation = equation,
    .read = read,
    .eval = eval,
};
