/* The laws of a scene that has none of a family. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_NONE_H
#define DEM_CONTACT_NONE_H

#ifdef DEM_SIMD
#include "dem/contact/law/contact.h"

DEM_KERNEL dem_tangential dem_tangential_none(dem_contact *c, vd *history) {
  (void)c, (void)history;
  return (dem_tangential){{vd_set(0), vd_set(0), vd_set(0)}, vd_set(0)};
}

DEM_KERNEL dem_couple dem_rolling_none(const dem_contact *c, vd3 roll, vd *history) {
  (void)c, (void)roll, (void)history;
  return (dem_couple){{vd_set(0), vd_set(0), vd_set(0)}, vd_set(0)};
}

DEM_KERNEL dem_couple dem_twisting_none(const dem_contact *c, vd3 twist, vd *history) {
  (void)c, (void)twist, (void)history;
  return (dem_couple){{vd_set(0), vd_set(0), vd_set(0)}, vd_set(0)};
}

DEM_KERNEL void dem_cohesion_none(dem_contact *c, vd *history) {
  (void)c, (void)history;
}
#endif

enum { dem_tangential_columns_none = 0, dem_tangential_circle_none = false };

#ifdef DEM_LAW_ROWS
#include "dem/contact/law/law.h"

static const dem_tangential_law dem_tangential_row_none = {.head = {.name = "none", .none = true}};
static const dem_rolling_law dem_rolling_row_none = {.head = {.name = "none", .none = true}};
static const dem_twisting_law dem_twisting_row_none = {.head = {.name = "none", .none = true}};
static const dem_cohesion_law dem_cohesion_row_none = {.head = {.name = "none", .none = true}};
const dem_multi_law dem_multi_none = {.head = {.name = "none", .none = true}};
#endif

#endif
