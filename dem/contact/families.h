/* The laws of the families whose kernels all loops hold, in the order of their tables: an #include and a name each. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_FAMILIES_H
#define DEM_CONTACT_FAMILIES_H

#include "dem/contact/none.h"

#include "dem/contact/tangential/coulomb.h"
#include "dem/contact/tangential/mindlin.h"
#include "dem/contact/tangential/spring.h"
#include "dem/contact/tangential/viscous.h"
#define DEM_TANGENTIALS(X) X(none) X(coulomb) X(viscous) X(spring) X(mindlin)

#include "dem/contact/rolling/constant_torque.h"
#include "dem/contact/rolling/spring_dashpot.h"
#define DEM_ROLLINGS(X) X(none) X(constant_torque) X(spring_dashpot)

#include "dem/contact/twisting/constant_torque.h"
#define DEM_TWISTINGS(X) X(none) X(constant_torque)

#include "dem/contact/cohesion/dmt.h"
#include "dem/contact/cohesion/jkr.h"
#include "dem/contact/cohesion/sjkr.h"
#define DEM_COHESIONS(X) X(none) X(sjkr) X(jkr) X(dmt)

#endif
