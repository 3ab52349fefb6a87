/* Point on line: the second body's point stays on a line of the first; rotation is free. Two rows. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/joint.h"

static const char *const equation[] = {"offset 1", "offset 2"};

static void read(mbd_joint *joint, tdm_object *o, const mbd_model *model) {
  mbd_joint_read_frame(joint, o, model, true);
}

static void eval(const mbd_joint *j, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows) {
  tdm_vec3 arm_a = mbd_joint_arm(j, 0, a), arm_b = mbd_joint_arm(j, 1, b);
  mbd_rows_plane(rows, a, b, mbd_joint_axis(j, 0, 0, a), arm_a, arm_b);
  mbd_rows_plane(rows, a, b, mbd_joint_axis(j, 0, 1, a), arm_a, arm_b);
}

extern const mbd_joint_ops mbd_joint_point_on_line;
const mbd_joint_ops mbd_joint_point_on_line = {
    .name = "point_on_line",
    .nrow = 2,
    .equation = equation,
    .read = read,
    .eval = eval,
    .coordinates = MBD_HAS_TRANSLATION,
};
