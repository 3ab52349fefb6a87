/* The laws of each family, in the order of their tables: a row is a name in C. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_FAMILIES_H
#define DEM_CONTACT_FAMILIES_H

/* made by the build: an #include of each header in tangential/, rolling/, twisting/ and cohesion/ */
#include "dem/contact/law_headers.h"
#include "dem/contact/none.h"

#define DEM_NORMALS(X) X(hooke) X(hertz) X(hunt_crossley) X(hysteretic)
#define DEM_TANGENTIALS(X) X(none) X(coulomb) X(viscous) X(spring) X(mindlin)
#define DEM_ROLLINGS(X) X(none) X(constant_torque) X(spring_dashpot)
#define DEM_TWISTINGS(X) X(none) X(constant_torque)
#define DEM_COHESIONS(X) X(none) X(sjkr) X(jkr) X(dmt)
#define DEM_MULTIS(X) X(none) X(mc_stress) X(mc_strain)

#endif
