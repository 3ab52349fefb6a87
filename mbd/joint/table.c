/* The joint types. To add one: a file that defines its ops (fixed.c is the shortest), its name below, and a line in
 * ../CMakeLists.txt and in ../README.md. tests/unit/test_mbd_jacobian.c picks it up from here when it has a scene
 * there.
 */
#include "mbd/joint/joint.h"
#include "mbd/model.h"

extern const mbd_joint_ops mbd_joint_fixed, mbd_joint_revolute, mbd_joint_prismatic, mbd_joint_spherical;

const mbd_joint_ops *const mbd_joint_table[] = {&mbd_joint_fixed, &mbd_joint_revolute, &mbd_joint_prismatic,
                                                &mbd_joint_spherical};
const int mbd_joint_ntype = sizeof mbd_joint_table / sizeof mbd_joint_table[0];

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

/* The smallest rotation that turns the unit vector `from` into `to`. */
static tdm_mat3 turn(tdm_vec3 from, tdm_vec3 to) {
  tdm_vec3 n = tdm_cross(from, to);
  double s = tdm_norm(n), angle = atan2(s, tdm_dot(from, to));
  if (s < 1e-12) /* equal or opposite: any perpendicular axis will do */
    n = tdm_cross(from, fabs(from.x) < 0.7 ? tdm_v3(1, 0, 0) : tdm_v3(0, 1, 0));
  return tdm_quat_to_matrix(tdm_quat_from_rotvec(tdm_scale(angle, tdm_unit(n))));
}

void mbd_joint_load_frame(mbd_joint *joint, tdm_object *o, const mbd_model *model, bool with_axis) {
  tdm_vec3 point[2], axis[2] = {{0, 0, 1}, {0, 0, 1}};
  mbd_load_pair(o, "point", "points", point);
  if (with_axis)
    mbd_load_pair(o, "axis", "axes", axis);
  if (o->err->status)
    return;
  for (int side = 0; side < 2; side++) {
    if (tdm_norm(axis[side]) < 1e-12) {
      tdm_object_fail(o, tdm_has(o, "axes") ? "axes" : "axis", "is zero; give the direction of the joint axis");
      return;
    }
    axis[side] = tdm_unit(axis[side]);
  }
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
