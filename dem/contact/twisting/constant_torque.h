/* Twisting law constant-torque: mu_t R* F_n against the relative spin about the normal. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_TWISTING_CONSTANT_TORQUE_H
#define DEM_CONTACT_TWISTING_CONSTANT_TORQUE_H

/* coefficients of a pair */
enum { DEM_TWISTING_CONSTANT_FRICTION }; /* mu_t */

#ifdef DEM_SIMD
#include "dem/contact/law/resistance.h"

DEM_KERNEL dem_couple dem_twisting_constant_torque(const dem_contact *c, vd3 twist, vd *history) {
  (void)history;
  return dem_constant_couple(c, twist, DEM_OF(c, twisting[DEM_TWISTING_CONSTANT_FRICTION]));
}
#endif

#ifdef DEM_LAW_ROWS
#include "dem/contact/law/law.h"

static void read_constant_twisting(const dem_model *m, tdm_object *o, dem_pair *p) {
  (void)m;
  p->twisting[DEM_TWISTING_CONSTANT_FRICTION] =
      dem_need(o, "twisting_friction", "twisting", "constant-torque", TDM_NOT_NEGATIVE);
}

static const dem_twisting_law dem_twisting_row_constant_torque = {
    .head = {.name = "constant-torque", .keys = {{.name = "twisting_friction", .example = 0.1}}},
    .read = read_constant_twisting};
#endif

#endif
