/* Mobility of a body: what loads do to it, and the effective mass of a contact with it.
 *
 * Y is symmetric and positive semidefinite, world axes: (acceleration of the centre of mass, angular acceleration) =
 * Y (force, moment about the centre of mass). At a point with the lever r from the centre of mass, along a unit
 * vector n:
 *   n Y_c n = n Y_vv n + 2 a Y_wv n + a Y_ww a,   a = r x n
 * and a contact of a particle there has the effective mass m*, 1/m* = 1/m_p + n Y_c n.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_BASE_MOBILITY_H
#define DEM_BASE_MOBILITY_H

#include "protocol/math/vec3.h"

#include <stdbool.h>

typedef struct {
  double per_mass;     /* 1/mass of the body [1/kg]; 0: it cannot be moved */
  bool full;           /* the matrix is there; else per_mass stands for it, in all directions and at all points */
  tdm_mat3 vv, wv, ww; /* acceleration by force [1/kg], angular acceleration by force [1/(kg m)] and by moment
                          [1/(kg m2)] */
} dem_mobility;

/* n Y_c n [1/kg] */
static inline double dem_mobility_along(const dem_mobility *y, tdm_vec3 lever, tdm_vec3 n) {
  if (!y->full)
    return y->per_mass;
  tdm_vec3 a = tdm_cross(lever, n), turned = tdm_add(tdm_scale(2, tdm_m3_mul(y->wv, n)), tdm_m3_mul(y->ww, a));
  double along = tdm_dot(n, tdm_m3_mul(y->vv, n)) + tdm_dot(a, turned);
  return along > 0 ? along : 0; /* below: round-off */
}

/* 1/m* [1/kg] of a particle (inverse_mass, 0: fixed) and a body. Where a joint keeps the body from giving way to a
 * fixed particle m* would be infinite: at most a thousand masses of the body are taken. */
static inline double dem_per_effective_mass(const dem_mobility *y, double inverse_mass, tdm_vec3 lever, tdm_vec3 n) {
  double along = dem_mobility_along(y, lever, n);
  return inverse_mass > 0 ? inverse_mass + along : fmax(along, 1e-3 * y->per_mass);
}

#endif
