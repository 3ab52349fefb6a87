/* The driver types. To add one: a file here that defines its operations, mbd_driver_NAME, and its row
 * below; its keys in scenarios/scene.schema.json. tests/unit/test_mbd_jacobian.c asks for a scene with it.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/driver/table.h"

#define MBD_DRIVER_LIST(X) \
  X(rotational_motor)      \
  X(linear_motor)          \
  X(point_motion)          \
  X(orientation_motion)

#define X(name) extern const mbd_driver_ops mbd_driver_##name;
MBD_DRIVER_LIST(X)
#undef X

#define X(name) &mbd_driver_##name,
tdm_types mbd_driver_types = {{MBD_DRIVER_LIST(X)}};
#undef X

tdm_status mbd_driver_add(const mbd_driver_ops *ops, tdm_error *err) {
  return tdm_type_add(&mbd_driver_types, ops, err);
}
