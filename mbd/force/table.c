/* The force types. To add one: a file that defines its ops, its name below, and a line in ../CMakeLists.txt and in
 * ../README.md. tests/unit/test_mbd_jacobian.c picks it up from here when it has a scene there.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/force/force.h"

extern const mbd_force_ops mbd_force_spring_damper, mbd_force_torsional_spring_damper, mbd_force_bushing,
    mbd_force_cable, mbd_force_friction, mbd_force_stop, mbd_force_bump, mbd_force_wrench;

const mbd_force_ops *const mbd_force_table[] = {&mbd_force_spring_damper, &mbd_force_torsional_spring_damper,
                                                &mbd_force_bushing,       &mbd_force_cable,
                                                &mbd_force_friction,      &mbd_force_stop,
                                                &mbd_force_bump,          &mbd_force_wrench};
const int mbd_force_ntype = sizeof mbd_force_table / sizeof mbd_force_table[0];

void mbd_force_clear(mbd_force *force) {
  tdm_spline_destroy(&force->spring);
  tdm_spline_destroy(&force->damper);
  tdm_motion_clear(&force->factor);
}
