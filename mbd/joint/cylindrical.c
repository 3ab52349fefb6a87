/* Cylindrical joint: rotation about one axis and translation along it. Four rows. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/joint.h"

static const char *const equation[] = {"offset 1", "offset 2", "tilt 1", "tilt 2"};

static void read(mbd_joint *joint, tdm_object *o, const mbd_model *model) {
  mbd_joint_read_frame(joint, o, model, true);
}

static void eval(const mbd_joint *j, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows) {
  tdm_vec3 arm_a = mbd_joint_arm(j, 0, a), arm_b = mbd_joint_arm(j, 1, b), axis = mbd_joint_axis(j, 1, 2, b);
  tdm_vec3 e1 = mbd_joint_axis(j, 0, 0, a), e2 = mbd_joint_axis(j, 0, 1, a);
  mbd_rows_plane(rows, a, b, e1, arm_a, arm_b);
  mbd_rows_plane(rows, a, b, e2, arm_a, arm_b);
  mbd_rows_perpendicular(rows, e1, axis);
  mbd_rows_perpendicular(rows, e2, axis);
}

extern const mbd_joint_ops mbd_joint_cylindrical;
const mbd_joint_ops mbd_joint_cylindrical = {
    .name = "cylindrical",
    .nrow = 4,
    .equation = equation,
    .read = read,
    .eval = eval,
    .coordinates = MBD_HAS_ANGLE | MBD_HAS_TRANSLATION,
    .guides = true,
};
