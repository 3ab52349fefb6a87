/* The driver types. To add one: a file that defines its ops, its name below, and a line in ../CMakeLists.txt and in
 * docs/mbd.md. tests/unit/test_mbd_jacobian.c picks it up from here when it has a scene there.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/driver/table.h"

#include <string.h>

extern const mbd_driver_ops mbd_driver_rotational_motor, mbd_driver_linear_motor, mbd_driver_point_motion,
    mbd_driver_orientation_motion;

const mbd_driver_ops *mbd_driver_table[MBD_DRIVER_TYPES_MAX] = {
    &mbd_driver_rotational_motor,
    &mbd_driver_linear_motor,
    &mbd_driver_point_motion,
    &mbd_driver_orientation_motion,
};
int mbd_driver_ntype = 4;

bool mbd_driver_register(const mbd_driver_ops *ops) {
  for (int i = 0; i < mbd_driver_ntype; i++)
    if (strcmp(mbd_driver_table[i]->name, ops->name) == 0)
      return false;
  if (mbd_driver_ntype == MBD_DRIVER_TYPES_MAX)
    return false;
  mbd_driver_table[mbd_driver_ntype++] = ops;
  return true;
}
