/* Rolling law constant-torque: mu_r R* F_n against the relative spin in the tangent plane (model A of Ai et al. 2011).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_ROLLING_CONSTANT_TORQUE_H
#define DEM_CONTACT_ROLLING_CONSTANT_TORQUE_H

/* coefficients of a pair */
enum { DEM_ROLLING_CONSTANT_FRICTION }; /* mu_r */

#ifdef DEM_SIMD
#include "dem/contact/law/resistance.h"

DEM_KERNEL dem_couple dem_rolling_constant_torque(const dem_contact *c, vd3 roll, vd *history) {
  (void)history;
  return dem_constant_couple(c, roll, DEM_OF(c, rolling[DEM_ROLLING_CONSTANT_FRICTION]));
}
#endif

#ifdef DEM_LAW_ROWS
#include "dem/contact/law/law.h"

static void read_constant_rolling(const dem_model *m, tdm_object *o, dem_pair *p) {
  (void)m;
  p->rolling[DEM_ROLLING_CONSTANT_FRICTION] =
      dem_need(o, "rolling_friction", "rolling", "constant-torque", TDM_NOT_NEGATIVE);
}

static const dem_rolling_law dem_rolling_row_constant_torque = {
    .head = {.name = "constant-torque", .keys = {{.name = "rolling_friction", .example = 0.1}}},
    .read = read_constant_rolling};
#endif

#endif
