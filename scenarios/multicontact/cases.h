/* What the cases of this folder share: materials of [G21] Table 1, laws, viscosities, loads. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_MULTICONTACT_CASES_H
#define SCN_MULTICONTACT_CASES_H

#include "scenarios/dem_physics/rig.h"

typedef struct {
  const char *name;
  double density, young, poisson, restitution, friction;
} scn_soft;

enum { SCN_HYDROGEL, SCN_RUBBER, SCN_GLASS, SCN_SOFTS };
extern const scn_soft scn_softs[SCN_SOFTS];

enum { SCN_CLASSICAL, SCN_STRAIN, SCN_STRESS, SCN_MULTI_LAWS };
extern const char *const scn_multi_names[SCN_MULTI_LAWS];

/* Keys of dem.contact behind others (", …"), and of a pair, for a law with its factor; of static use, until the next
 * call. */
const char *scn_multi_contact(int law);
const char *scn_multi_pair(int law, double factor);

/* The viscosity eta of [G21] Eq. 3 with which two equal spheres of this radius that meet at this relative speed have
 * the material's restitution [Pa s]. */
double scn_viscosity(const scn_soft *material, double radius, double speed);

#endif
