/* Cohesion sjkr: a pull k A with the contact area A = 2 pi R* delta (of the circle in which two spheres of equal
 * overlap cross). Friction is limited by the normal law's force alone.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_COHESION_SJKR_H
#define DEM_CONTACT_COHESION_SJKR_H

/* coefficients of a pair */
enum { DEM_SJKR_DENSITY }; /* k, energy density [J/m3] */

#ifdef DEM_SIMD
#include "dem/contact/law/contact.h"

DEM_KERNEL void dem_cohesion_sjkr(dem_contact *c, vd *history) {
  (void)history;
  vd slope = vd_set(2 * M_PI) * DEM_OF(c, cohesion[DEM_SJKR_DENSITY]) * c->radius;
  c->pull = -(slope * c->overlap);
  c->elastic = c->elastic + vd_set(0.5) * c->pull * c->overlap;
}
#endif

#ifdef DEM_LAW_ROWS
#include "dem/contact/law/law.h"

static void read_sjkr(const dem_model *m, tdm_object *o, dem_pair *p) {
  (void)m;
  p->cohesion[DEM_SJKR_DENSITY] = dem_need(o, "cohesion_density", "cohesion", "sjkr", TDM_NOT_NEGATIVE);
}

static const dem_cohesion_law dem_cohesion_row_sjkr = {
    .head = {.name = "sjkr", .keys = {{.name = "cohesion_density", .example = 1e3}}}, .read = read_sjkr};
#endif

#endif
