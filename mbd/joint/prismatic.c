/* Prismatic joint (slider): translation along one axis, no rotation. Five rows. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/joint.h"

static const char *const equation[] = {"offset 1", "offset 2", "rotation 3", "rotation 1", "rotation 2"};

static void read(mbd_joint *joint, tdm_object *o, const mbd_model *model) {
  mbd_joint_read_frame(joint, o, model, true);
}

static void eval(const mbd_joint *j, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows) {
  tdm_vec3 arm_a = mbd_joint_arm(j, 0, a), arm_b = mbd_joint_arm(j, 1, b);
  mbd_rows_plane(rows, a, b, mbd_joint_axis(j, 0, 0, a), arm_a, arm_b);
  mbd_rows_plane(rows, a, b, mbd_joint_axis(j, 0, 1, a), arm_a, arm_b);
  mbd_rows_perpendicular(rows, mbd_joint_axis(j, 0, 0, a), mbd_joint_axis(j, 1, 1, b));
  mbd_rows_perpendicular(rows, mbd_joint_axis(j, 0, 1, a), mbd_joint_axis(j, 1, 2, b));
  mbd_rows_perpendicular(rows, mbd_joint_axis(j, 0, 2, a), mbd_joint_axis(j, 1, 0, b));
}

extern const mbd_joint_ops mbd_joint_prismatic;
const mbd_joint_ops mbd_joint_prismatic = {
    .name = "prismatic",
    .nrow = 5,
    .equation = equation,
    .read = read,
    .eval = eval,
    .coordinates = MBD_HAS_TRANSLATION,
    .guides = true,
};
