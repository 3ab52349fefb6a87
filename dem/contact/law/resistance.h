/* What laws of rolling and twisting share. F_n is that of friction. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LAW_RESISTANCE_H
#define DEM_CONTACT_LAW_RESISTANCE_H

#include "dem/contact/law/contact.h"

/* coefficient R* F_n */
DEM_KERNEL vd dem_couple_limit(const dem_contact *c, vd coefficient) {
  return coefficient * c->radius * vd_max(c->force, vd_set(0));
}

/* A constant couple against a relative spin; at rest as friction of tangential law coulomb. The sum of 1/I: I + m R^2 =
 * 3.5 I. */
DEM_KERNEL dem_couple dem_constant_couple(const dem_contact *c, vd3 spin, vd coefficient) {
  vd per_inertia = vd_set(3.5) * c->inverse_inertia;
  return (dem_couple){dem_against(c, spin, dem_couple_limit(c, coefficient), per_inertia), vd_set(0)};
}

#endif
