/* The force types. To add one: a file here that defines its operations, mbd_force_NAME, and its row
 * below; its keys in scenarios/scene.schema.json. tests/unit/test_mbd_jacobian.c asks for a scene with it.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/force/table.h"

#define MBD_FORCE_LIST(X)    \
  X(spring_damper)           \
  X(torsional_spring_damper) \
  X(bushing)                 \
  X(cable)                   \
  X(friction)                \
  X(stop)                    \
  X(bump)                    \
  X(wrench)

#define X(name) extern const mbd_force_ops mbd_force_##name;
MBD_FORCE_LIST(X)
#undef X

#define X(name) &mbd_force_##name,
tdm_types mbd_force_types = {{MBD_FORCE_LIST(X)}};
#undef X

tdm_status mbd_force_add(const mbd_force_ops *ops, tdm_error *err) {
  return tdm_type_add(&mbd_force_types, ops, err);
}
