/* Parallel axes: an axis of the second body stays parallel to one of the first; the points are free, and so is the
 * rotation about the axis. Two rows. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/joint.h"

static const char *const equation[] = {"tilt 1", "tilt 2"};

static void read(mbd_joint *joint, tdm_object *o, const mbd_model *model) {
  mbd_joint_read_frame(joint, o, model, true);
}

static void eval(const mbd_joint *j, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows) {
  tdm_vec3 axis = mbd_joint_axis(j, 1, 2, b);
  mbd_rows_perpendicular(rows, mbd_joint_axis(j, 0, 0, a), axis);
  mbd_rows_perpendicular(rows, mbd_joint_axis(j, 0, 1, a), axis);
}

extern const mbd_joint_ops mbd_joint_parallel_axes;
const mbd_joint_ops mbd_joint_parallel_axes = {
    .name = "parallel_axes",
    .nrow = 2,
    .equation = equation,
    .read = read,
    .eval = eval,
};
