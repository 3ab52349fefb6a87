/* The force types. To add one: a file that defines its ops, its name below, and a line in ../CMakeLists.txt and in
 * docs/mbd.md. tests/unit/test_mbd_jacobian.c picks it up from here when it has a scene there.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/force/table.h"

#include <string.h>

extern const mbd_force_ops mbd_force_spring_damper, mbd_force_torsional_spring_damper, mbd_force_bushing,
    mbd_force_cable, mbd_force_friction, mbd_force_stop, mbd_force_bump, mbd_force_wrench;

const mbd_force_ops *mbd_force_table[MBD_FORCE_TYPES_MAX] = {
    &mbd_force_spring_damper, &mbd_force_torsional_spring_damper,
    &mbd_force_bushing,       &mbd_force_cable,
    &mbd_force_friction,      &mbd_force_stop,
    &mbd_force_bump,          &mbd_force_wrench,
};
int mbd_force_ntype = 8;

bool mbd_force_register(const mbd_force_ops *ops) {
  for (int i = 0; i < mbd_force_ntype; i++)
    if (strcmp(mbd_force_table[i]->name, ops->name) == 0)
      return false;
  if (mbd_force_ntype == MBD_FORCE_TYPES_MAX)
    return false;
  mbd_force_table[mbd_force_ntype++] = ops;
  return true;
}
