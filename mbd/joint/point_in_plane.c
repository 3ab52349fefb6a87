/* Point in plane: the second body's point stays in a plane of the first, through the first's point; everything else is
 * free. One row. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/joint.h"

static const char *const equation[] = {"offset"};

static void read(mbd_joint *joint, tdm_object *o, const mbd_model *model) {
  mbd_joint_read_frame(joint, o, model, true);
}

static void eval(const mbd_joint *j, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows) {
  mbd_rows_plane(rows, a, b, mbd_joint_axis(j, 0, 2, a), mbd_joint_arm(j, 0, a), mbd_joint_arm(j, 1, b));
}

extern const mbd_joint_ops mbd_joint_point_in_plane;
const mbd_joint_ops mbd_joint_point_in_plane = {
    .name = "point_in_plane",
    .nrow = 1,
    .equation = equation,
    .read = read,
    .eval = eval,
};
