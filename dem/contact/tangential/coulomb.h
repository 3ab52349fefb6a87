/* Tangential law coulomb: [A07] Eq. 2.54, mu_d F_n against the slip; none at slip 0.
 *
 * Where the force would turn the slip round within a step it only stops it (1/m of two spheres that slip is 3.5/m*), so
 * a contact at rest creeps, by what other forces give it in a step.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_TANGENTIAL_COULOMB_H
#define DEM_CONTACT_TANGENTIAL_COULOMB_H

enum { dem_tangential_columns_coulomb = 0, dem_tangential_circle_coulomb = false };

#ifdef DEM_SIMD
#include "dem/contact/law/contact.h"

DEM_KERNEL dem_tangential dem_tangential_coulomb(dem_contact *c, vd *history) {
  (void)history;
  vd limit = DEM_OF(c, friction) * vd_max(c->force, vd_set(0));
  return (dem_tangential){dem_against(c, c->slip, limit, vd_set(3.5) * c->inverse_mass), vd_set(0)};
}
#endif

#ifdef DEM_LAW_ROWS
#include "dem/contact/law/law.h"

static const dem_tangential_law dem_tangential_row_coulomb = {.head = {.name = "coulomb"}, .friction = true};
#endif

#endif
