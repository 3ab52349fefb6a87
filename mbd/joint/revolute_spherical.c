/* Revolute-spherical link: a massless link of constant length that turns about an axis of the first body at one end and
 * ends in a ball on the second. The vector from the first point to the second keeps its length and its share along the
 * axis. Two rows. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/joint.h"

typedef struct {
  double length; /* of the link [m] */
  double offset; /* of its points along the axis [m] */
} swing;

static const char *const equation[] = {"distance", "offset"};

static void read(mbd_joint *joint, tdm_object *o, const mbd_model *model) {
  swing *own = joint->own;
  tdm_vec3 point[2];
  mbd_read_points(o, model, NULL, "points", point);
  tdm_vec3 axis = mbd_read_direction(o, model, "axis"), link = tdm_sub(point[1], point[0]);
  double start = tdm_norm(link), along = tdm_dot(axis, link);
  if (!o->err->status && !(start > 1e-9))
    tdm_object_fail(o, "points", "coincide, so that the link has no direction; move one, or use a spherical joint");
  else if (!o->err->status && !(tdm_norm(tdm_cross(axis, link)) > 1e-6 * start))
    tdm_object_fail(o, "axis", "is parallel to the link, which then cannot swing about it; give the hinge's axis");
  own->length = tdm_get_number(o, "length", start, TDM_POSITIVE);
  if (!o->err->status && !(own->length > fabs(along)))
    tdm_object_fail(o, "length", "is %g m, but the points are %g m apart along the axis already", own->length,
                    fabs(along));
  if (o->err->status)
    return;
  mbd_joint_set_frame(joint, model, point[0], axis);
  joint->arm[1] = mbd_model_arm(model, joint->body[1], point[1]);
  own->offset = along;
}

static void eval(const mbd_joint *j, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows) {
  const swing *own = j->own;
  tdm_vec3 arm_a = mbd_joint_arm(j, 0, a), arm_b = mbd_joint_arm(j, 1, b), axis = mbd_joint_axis(j, 0, 2, a);
  mbd_rows_distance(rows, a, b, arm_a, arm_b, own->length);
  mbd_rows_plane(rows, a, b, axis, tdm_axpy(own->offset, axis, arm_a), arm_b);
}

extern const mbd_joint_ops mbd_joint_revolute_spherical;
const mbd_joint_ops mbd_joint_revolute_spherical = {
    .name = "revolute_spherical",
    .size = sizeof(swing),
    .nrow = 2,
    .equation = equation,
    .read = read,
    .eval = eval,
};
