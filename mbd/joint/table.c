/* The joint types. To add one: a file that defines its ops (fixed.c is the shortest), its name below, and a line in
 * ../CMakeLists.txt and in docs/mbd.md. tests/unit/test_mbd_jacobian.c picks it up from here when it has a scene
 * there.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/table.h"

#include <string.h>

extern const mbd_joint_ops mbd_joint_fixed, mbd_joint_revolute, mbd_joint_prismatic, mbd_joint_spherical,
    mbd_joint_universal, mbd_joint_planar, mbd_joint_point_on_line, mbd_joint_rod, mbd_joint_screw, mbd_joint_gear,
    mbd_joint_rack_and_pinion, mbd_joint_revolute_spherical, mbd_joint_point_in_plane, mbd_joint_cylindrical;

const mbd_joint_ops *mbd_joint_table[MBD_JOINT_TYPES_MAX] = {
    &mbd_joint_fixed,
    &mbd_joint_revolute,
    &mbd_joint_prismatic,
    &mbd_joint_cylindrical,
    &mbd_joint_spherical,
    &mbd_joint_universal,
    &mbd_joint_planar,
    &mbd_joint_point_on_line,
    &mbd_joint_rod,
    &mbd_joint_screw,
    &mbd_joint_gear,
    &mbd_joint_rack_and_pinion,
    &mbd_joint_revolute_spherical,
    &mbd_joint_point_in_plane,
};
int mbd_joint_ntype = 14;

bool mbd_joint_register(const mbd_joint_ops *ops) {
  for (int i = 0; i < mbd_joint_ntype; i++)
    if (strcmp(mbd_joint_table[i]->name, ops->name) == 0)
      return false;
  if (mbd_joint_ntype == MBD_JOINT_TYPES_MAX)
    return false;
  mbd_joint_table[mbd_joint_ntype++] = ops;
  return true;
}
