/* Spherical joint (ball): the points coincide, rotation is free. Three rows. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/joint.h"

static const char *const equation[] = {"point x", "point y", "point z"};

static void read(mbd_joint *joint, tdm_object *o, const mbd_model *model) {
  mbd_joint_read_frame(joint, o, model, false);
}

static void eval(const mbd_joint *j, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows) {
  mbd_rows_point(rows, a, b, mbd_joint_arm(j, 0, a), mbd_joint_arm(j, 1, b));
}

extern const mbd_joint_ops mbd_joint_spherical;
const mbd_joint_ops mbd_joint_spherical = {
    .name = "spherical",
    .nrow = 3,
    .equation = equation,
    .read = read,
    .eval = eval,
};
