/* The joint types. To add one: a file here that defines its operations, mbd_joint_NAME (fixed.c is the shortest), and
 * its row below; its keys in scenarios/scene.schema.json. tests/unit/test_mbd_jacobian.c asks for a scene with it.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/table.h"

#define MBD_JOINT_LIST(X) \
  X(fixed)                \
  X(revolute)             \
  X(prismatic)            \
  X(cylindrical)          \
  X(spherical)            \
  X(universal)            \
  X(planar)               \
  X(point_on_line)        \
  X(rod)                  \
  X(screw)                \
  X(gear)                 \
  X(rack_and_pinion)      \
  X(coupler)              \
  X(revolute_spherical)   \
  X(point_in_plane)       \
  X(parallel_axes)

#define X(name) extern const mbd_joint_ops mbd_joint_##name;
MBD_JOINT_LIST(X)
#undef X

#define X(name) &mbd_joint_##name,
tdm_types mbd_joint_types = {{MBD_JOINT_LIST(X)}};
#undef X

tdm_status mbd_joint_add(const mbd_joint_ops *ops, tdm_error *err) {
  return tdm_type_add(&mbd_joint_types, ops, err);
}
