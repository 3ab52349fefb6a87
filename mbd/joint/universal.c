/* Universal joint (Hooke, Cardan): the points coincide, and an axis of the first body stays perpendicular to one of the
 * second. Four rows. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/joint.h"

static const char *const equation[] = {"point x", "point y", "point z", "cross"};

static void read(mbd_joint *joint, tdm_object *o, const mbd_model *model) {
  mbd_joint_read_frame(joint, o, model, true);
  if (o->err->status)
    return;
  tdm_vec3 axis[2];
  for (int side = 0; side < 2; side++) {
    mbd_kin start = {.A = tdm_quat_to_matrix(mbd_model_pose(model, joint->body[side]).orientation)};
    axis[side] = mbd_joint_axis(joint, side, 2, &start);
  }
  double dot = tdm_dot(axis[0], axis[1]);
  if (fabs(dot) > 1e-6)
    tdm_object_fail(o, tdm_has(o, "axes") ? "axes" : "axis",
                    "the two axes of a universal joint must be perpendicular, but stand at %.6g degrees; give \"axes\" "
                    "with one for each body, the arms of the cross",
                    tdm_degrees(acos(fmin(1, fmax(-1, dot)))));
}

static void eval(const mbd_joint *j, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows) {
  mbd_rows_point(rows, a, b, mbd_joint_arm(j, 0, a), mbd_joint_arm(j, 1, b));
  mbd_rows_perpendicular(rows, mbd_joint_axis(j, 0, 2, a), mbd_joint_axis(j, 1, 2, b));
}

extern const mbd_joint_ops mbd_joint_universal;
const mbd_joint_ops mbd_joint_universal = {
    .name = "universal",
    .nrow = 4,
    .equation = equation,
    .read = read,
    .eval = eval,
};
