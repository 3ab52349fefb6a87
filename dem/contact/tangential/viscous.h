/* Tangential law viscous: [A07] Eq. 2.56, -c_t v_t, without a limit. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_TANGENTIAL_VISCOUS_H
#define DEM_CONTACT_TANGENTIAL_VISCOUS_H

enum { dem_tangential_columns_viscous = 0, dem_tangential_circle_viscous = false };

/* coefficients of a pair */
enum { DEM_VISCOUS_DAMPING }; /* c_t [kg/s] */

#ifdef DEM_SIMD
#include "dem/contact/law/contact.h"

DEM_KERNEL dem_tangential dem_tangential_viscous(dem_contact *c, vd *history) {
  (void)history;
  return (dem_tangential){vd3_scale(-DEM_OF(c, tangential[DEM_VISCOUS_DAMPING]), c->slip), vd_set(0)};
}
#endif

#ifdef DEM_LAW_ROWS
#include "dem/contact/law/law.h"

static void read_viscous(const dem_model *m, tdm_object *o, dem_pair *p) {
  (void)m;
  p->tangential[DEM_VISCOUS_DAMPING] = dem_need(o, "tangential_damping", "tangential", "viscous", TDM_NOT_NEGATIVE);
}

static const dem_tangential_law dem_tangential_row_viscous = {
    .head = {.name = "viscous", .keys = {{.name = "tangential_damping", .example = 0.1}}}, .read = read_viscous};
#endif

#endif
