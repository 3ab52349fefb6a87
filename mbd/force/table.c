/* The force types. To add one: a file that defines its ops, its name below, and a line in ../CMakeLists.txt and in
 * ../README.md.
 */
#include "mbd/force/force.h"

extern const mbd_force_ops mbd_force_spring_damper, mbd_force_torsional_spring_damper;

const mbd_force_ops *const mbd_force_table[] = {&mbd_force_spring_damper, &mbd_force_torsional_spring_damper};
const int mbd_force_ntype = sizeof mbd_force_table / sizeof mbd_force_table[0];
