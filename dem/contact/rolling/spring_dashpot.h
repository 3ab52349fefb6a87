/* Rolling law spring-dashpot: model C of Ai et al. (2011), EPSD, with the relative spin w in the tangent plane:
 *   M = M_el - c_r w,   k_r = 2.25 k_n (mu_r R*)^2,   |M_el| <= mu_r R* F_n,   c_r = 2 eta_r sqrt(I_r k_r) below the
 *   limit, 0 at it;   1/I_r = sum of 1/(I + m R^2)
 * History: M_el in the middle of the coming step; it turns with the contact, is grown and clipped as a tangential
 * spring is (law/sticking.h).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_ROLLING_SPRING_DASHPOT_H
#define DEM_CONTACT_ROLLING_SPRING_DASHPOT_H

/* coefficients of a pair */
enum { DEM_EPSD_FRICTION, DEM_EPSD_DAMPING }; /* mu_r; eta_r, share of the critical damping */

#ifdef DEM_SIMD
#include "dem/contact/law/resistance.h"

DEM_KERNEL dem_couple dem_rolling_spring_dashpot(const dem_contact *c, vd3 roll, vd *history) {
  vd friction = DEM_OF(c, rolling[DEM_EPSD_FRICTION]), arm = friction * c->radius,
     limit = dem_couple_limit(c, friction);
  vd stiffness = vd_set(2.25) * c->stiffness * arm * arm;
  vd3 grow = vd3_scale(-(stiffness * vd_set(0.5 * c->dt)), roll);
  vd3 m = vd3_add(dem_turn_history(c, (vd3){history[0], history[1], history[2]}), grow);
  vd m2 = vd3_dot(m, m);
  vm rolls = vm_and(vm_less(limit * limit, m2), c->touching);
  m = dem_clip(m, m2, limit, rolls);
  vd3 next = vd3_add(m, grow);
  history[0] = next.x, history[1] = next.y, history[2] = next.z;
  vd damping = vd_set(2) * DEM_OF(c, rolling[DEM_EPSD_DAMPING]) * vd_sqrt(stiffness / c->inverse_inertia);
  vd3 sum = vd3_axpy(-vd_pick(rolls, vd_set(0), damping), roll, m);
  vm springs = vm_less(vd_set(0), stiffness);
  return (dem_couple){sum, vd_only(springs, vd_set(0.5) * vd3_dot(m, m) / stiffness)};
}
#endif

#ifdef DEM_LAW_ROWS
#include "dem/contact/law/law.h"
#include "dem/contact/law/theory.h"

static void read_spring_dashpot(const dem_model *m, tdm_object *o, dem_pair *p) {
  (void)m;
  p->rolling[DEM_EPSD_FRICTION] = dem_need(o, "rolling_friction", "rolling", "spring-dashpot", TDM_NOT_NEGATIVE);
  p->rolling[DEM_EPSD_DAMPING] = tdm_get_number(o, "rolling_damping", 0.3, TDM_NOT_NEGATIVE);
}

static double rolling_stiffness(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  double arm = p->rolling[DEM_EPSD_FRICTION] * i.radius;
  return 2.25 * dem_normal_stiffness(m, p, i, overlap) * arm * arm;
}

static const dem_rolling_law dem_rolling_row_spring_dashpot = {
    .head = {.name = "spring-dashpot",
             .ncolumn = 3,
             .vectors = 7,
             .keys = {{.name = "rolling_friction", .example = 0.1}, {.name = "rolling_damping"}}},
    .read = read_spring_dashpot,
    .stiffness = rolling_stiffness,
};
#endif

#endif
