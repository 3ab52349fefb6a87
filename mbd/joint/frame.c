/* The frame of a joint: see frame.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/frame.h"

#include "mbd/joint/rows.h"
#include "mbd/model/read.h"

const mbd_coordinate_words mbd_coordinate_table[] = {
    [MBD_ANGLE] = {.effort = "torque",
                   .effort_unit = "N m",
                   .name = "angle",
                   .unit = "rad",
                   .rate = "rate",
                   .rate_unit = "rad/s"},
    [MBD_TRANSLATION] = {.effort = "force",
                         .effort_unit = "N",
                         .name = "translation",
                         .unit = "m",
                         .rate = "speed",
                         .rate_unit = "m/s"},
};

tdm_mat3 mbd_triad(tdm_vec3 axis) {
  /* e1 from the world axis that is least along e3 */
  tdm_vec3 size = {fabs(axis.x), fabs(axis.y), fabs(axis.z)};
  tdm_vec3 other = size.x <= size.y && size.x <= size.z ? tdm_v3(1, 0, 0)
                   : size.y <= size.z                   ? tdm_v3(0, 1, 0)
                                                        : tdm_v3(0, 0, 1);
  tdm_vec3 e1 = tdm_unit(tdm_cross(other, axis)), e2 = tdm_cross(axis, e1);
  return (tdm_mat3){{{e1.x, e2.x, axis.x}, {e1.y, e2.y, axis.y}, {e1.z, e2.z, axis.z}}};
}

double mbd_joint_angle(const mbd_joint *joint, const mbd_kin *a, const mbd_kin *b, double near) {
  tdm_vec3 a1 = mbd_joint_axis(joint, 0, 0, a), a2 = mbd_joint_axis(joint, 0, 1, a);
  tdm_vec3 b1 = mbd_joint_axis(joint, 1, 0, b), b2 = mbd_joint_axis(joint, 1, 1, b);
  double angle = atan2(tdm_dot(a2, b1) - tdm_dot(a1, b2), tdm_dot(a1, b1) + tdm_dot(a2, b2));
  return angle + 2 * M_PI * round((near - angle) / (2 * M_PI));
}

void mbd_joint_between(mbd_joint *joint) {
  for (int side = 0; side < 2; side++) {
    joint->body[side] = joint->of[side]->body[1];
    joint->arm[side] = joint->of[side]->arm[1];
  }
}

double mbd_joint_read_mesh(mbd_joint *joint, tdm_object *o, const mbd_model *model, const unsigned coordinates[2],
                           const char *key, const char *what) {
  mbd_read_joints(o, model, 2, coordinates, joint->of);
  double ratio = tdm_get_number(o, key, TDM_REQUIRED, TDM_ANY);
  if (o->err->status)
    return ratio;
  if (ratio == 0)
    tdm_object_fail(o, key, "is zero; give %s", what);
  mbd_joint_between(joint);
  return ratio;
}

void mbd_joint_coordinate(const mbd_joint *j, mbd_coordinate which, const mbd_kin *a, const mbd_kin *b, double from,
                          mbd_rows *rows) {
  if (which == MBD_ANGLE) {
    mbd_rows_angle(rows, mbd_joint_axis(j, 0, 0, a), mbd_joint_axis(j, 0, 1, a), mbd_joint_axis(j, 1, 0, b),
                   mbd_joint_axis(j, 1, 1, b), from);
    return;
  }
  mbd_rows_plane(rows, a, b, mbd_joint_axis(j, 0, 2, a), mbd_joint_arm(j, 0, a), mbd_joint_arm(j, 1, b));
  rows->g[rows->n - 1] -= from;
}

/* The smallest rotation that turns the unit vector `from` into `to`. */
static tdm_mat3 turn(tdm_vec3 from, tdm_vec3 to) {
  tdm_vec3 n = tdm_cross(from, to);
  double s = tdm_norm(n), angle = atan2(s, tdm_dot(from, to));
  if (s < 1e-12) /* equal or opposite: any perpendicular axis will do */
    n = tdm_cross(from, fabs(from.x) < 0.7 ? tdm_v3(1, 0, 0) : tdm_v3(0, 1, 0));
  return tdm_quat_to_matrix(tdm_quat_from_rotvec(tdm_scale(angle, tdm_unit(n))));
}

static void set_frame(mbd_joint *joint, const mbd_model *model, const tdm_vec3 point[2], const tdm_vec3 axis[2]) {
  tdm_mat3 triad = mbd_triad(axis[0]);
  for (int side = 0; side < 2; side++) {
    int b = joint->body[side];
    tdm_mat3 A = tdm_quat_to_matrix(mbd_model_pose(model, b).orientation);
    joint->arm[side] = mbd_model_arm(model, b, point[side]);
    if (side == 1)
      triad = tdm_m3_mat(turn(axis[0], axis[1]), triad);
    joint->axes[side] = tdm_m3_mat(tdm_m3_transpose(A), triad);
  }
}

void mbd_joint_read_frame(mbd_joint *joint, tdm_object *o, const mbd_model *model, bool with_axis) {
  tdm_vec3 point[2], axis[2] = {{0, 0, 1}, {0, 0, 1}};
  mbd_read_points(o, model, "point", "points", point);
  if (with_axis)
    mbd_read_directions(o, model, "axis", "axes", axis);
  if (o->err->status)
    return;
  set_frame(joint, model, point, axis);
}

void mbd_joint_set_frame(mbd_joint *joint, const mbd_model *model, tdm_vec3 point, tdm_vec3 axis) {
  set_frame(joint, model, (tdm_vec3[2]){point, point}, (tdm_vec3[2]){axis, axis});
}
