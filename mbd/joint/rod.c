/* Rod: the distance between two points is constant; a massless link with a ball at each end. One row. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/joint.h"

typedef struct {
  double length; /* between the points [m] */
} rod;

static const char *const equation[] = {"distance"};

static void read(mbd_joint *joint, tdm_object *o, const mbd_model *model) {
  rod *own = joint->own;
  tdm_vec3 point[2];
  mbd_read_points(o, model, NULL, "points", point);
  double start = tdm_norm(tdm_sub(point[1], point[0]));
  if (!o->err->status && !(start > 1e-9))
    tdm_object_fail(o, "points", "coincide, so that the rod has no direction; move one, or use a spherical joint");
  own->length = tdm_get_number(o, "length", start, TDM_POSITIVE);
  for (int side = 0; side < 2; side++) {
    joint->arm[side] = mbd_model_arm(model, joint->body[side], point[side]);
    joint->axes[side] = tdm_m3_identity();
  }
}

static void eval(const mbd_joint *j, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows) {
  const rod *own = j->own;
  mbd_rows_distance(rows, a, b, mbd_joint_arm(j, 0, a), mbd_joint_arm(j, 1, b), own->length);
}

extern const mbd_joint_ops mbd_joint_rod;
const mbd_joint_ops mbd_joint_rod = {
    .name = "rod",
    .size = sizeof(rod),
    .nrow = 1,
    .equation = equation,
    .read = read,
    .eval = eval,
};
