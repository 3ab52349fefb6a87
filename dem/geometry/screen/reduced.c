/* The reduced hole: see screen.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/screen/screen.h"

#include "dem/geometry/frustum.h"

#include <math.h>

double dem_screen_passage(const dem_screen *s, double radius) {
  if (!(radius < s->half))
    return 0;
  double own = s->by_radius ? radius : 0, clearance = s->clearance >= 0 ? s->clearance : s->zeta * (s->half - own);
  return s->half - own - clearance;
}

/* distance from the middle of the nearest hole, along one axis */
static double from_middle(const dem_screen *s, double x) {
  double pitch = dem_screen_pitch(s);
  return x - pitch * fmax(-s->aisles, fmin(nearbyint(x / pitch), s->aisles));
}

/* Distance from the nearest column of half width a, negative in it, and the unit normal into it. */
static double column_gap(const dem_screen *s, tdm_vec3 x, double a, tdm_vec3 *into) {
  double u = from_middle(s, x.x), v = from_middle(s, x.y), du = fabs(u) - a, dv = fabs(v) - a;
  if (du > 0 && dv > 0) { /* by the corner */
    double from = hypot(du, dv);
    *into = tdm_v3(-copysign(du / from, u), -copysign(dv / from, v), 0);
    return from;
  }
  *into = du > dv ? tdm_v3(-copysign(1, u), 0, 0) : tdm_v3(0, -copysign(1, v), 0);
  return fmax(du, dv);
}

bool dem_screen_over_hole(const dem_screen *s, tdm_vec3 x, double radius) {
  const double a = dem_screen_passage(s, radius), from = hypot(x.x, x.y);
  return a > 0 && from <= s->radius && from >= s->inner && fabs(from_middle(s, x.x)) <= a &&
         fabs(from_middle(s, x.y)) <= a;
}

double dem_screen_reduced_gap(const dem_screen *s, tdm_vec3 x, double radius, tdm_vec3 *normal) {
  double from = dem_ring_gap(s->inner, s->radius, x, normal), passage = dem_screen_passage(s, radius);
  if (s->passing != DEM_PASSING_FALL || !(passage > 0))
    return from;
  tdm_vec3 into;
  double column = column_gap(s, x, passage, &into);
  if (from - radius >= -column)
    return from;
  *normal = into;
  return radius - column;
}
