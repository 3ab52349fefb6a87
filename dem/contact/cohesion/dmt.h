/* Cohesion dmt: Derjaguin, Muller & Toporov (1975): Hertz's force less 2 pi w R*, as long as they touch.
 *
 * For stiff and small spheres, jkr for soft and large ones. Friction is limited by the normal law's force alone,
 * F + 2 pi w R*.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_COHESION_DMT_H
#define DEM_CONTACT_COHESION_DMT_H

/* coefficients of a pair */
enum { DEM_DMT_ENERGY }; /* work of adhesion w [J/m2] */

#ifdef DEM_SIMD
#include "dem/contact/law/contact.h"

DEM_KERNEL void dem_cohesion_dmt(dem_contact *c, vd *history) {
  (void)history;
  c->pull = -(vd_set(2 * M_PI) * DEM_OF(c, cohesion[DEM_DMT_ENERGY]) * c->radius);
  c->elastic = c->elastic + c->pull * c->overlap;
}
#endif

#ifdef DEM_LAW_ROWS
#include "dem/contact/law/law.h"

static void check_dmt(const dem_model *m, tdm_object *o) {
  const dem_normal_law *law = m->normal->hertzian ? m->wall_normal : m->normal;
  if (!law->hertzian)
    tdm_object_fail(o, "cohesion",
                    "\"dmt\" is Hertz's force with a constant pull, not with normal \"%s\"; use \"sjkr\"",
                    law->head.name);
}

static void read_dmt(const dem_model *m, tdm_object *o, dem_pair *p) {
  (void)m;
  p->cohesion[DEM_DMT_ENERGY] = dem_need(o, "adhesion_energy", "cohesion", "dmt", TDM_NOT_NEGATIVE);
}

static const dem_cohesion_law dem_cohesion_row_dmt = {
    .head = {.name = "dmt", .keys = {{.name = "adhesion_energy", .example = 0.1}}},
    .check = check_dmt,
    .read = read_dmt};
#endif

#endif
