/* Couples: rolling and twisting resistance; in the loops with `all_terms` only. F_n is that of friction.
 *
 * rolling, with the relative spin w in the tangent plane:
 * constant-torque: mu_r R* F_n against w (model A of Ai et al. 2011); at rest as coulomb
 * spring-dashpot: model C of Ai et al. (2011), EPSD:
 *   M = M_el - c_r w,   k_r = 2.25 k_n (mu_r R*)^2,   |M_el| <= mu_r R* F_n,   c_r = 2 eta_r sqrt(I_r k_r) below the
 *   limit, 0 at it;   1/I_r = sum of 1/(I + m R^2)
 * History: M_el in the middle of the coming step; it turns with the contact, is grown and clipped as a tangential
 * spring is.
 * twisting: constant-torque: mu_t R* F_n against the relative spin about the normal
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_ROLLING_H
#define DEM_CONTACT_ROLLING_H

#include "dem/contact/contact.h"

typedef struct {
  vd3 couple; /* on the particle; the partner gets the opposite [N m] */
  vd elastic; /* [J] */
} dem_couple;

DEM_KERNEL vd dem_couple_limit(const dem_contact *c, vd coefficient) {
  return coefficient * c->radius * vd_max(c->force, vd_set(0));
}

/* sum of 1/I: I + m R^2 = 3.5 I */
DEM_KERNEL vd dem_per_inertia(const dem_contact *c) {
  return vd_set(3.5) * c->inverse_inertia;
}

DEM_KERNEL dem_couple dem_rolling_none(const dem_contact *c, vd3 roll, vd *history) {
  (void)c, (void)roll, (void)history;
  return (dem_couple){{vd_set(0), vd_set(0), vd_set(0)}, vd_set(0)};
}

DEM_KERNEL dem_couple dem_rolling_constant_torque(const dem_contact *c, vd3 roll, vd *history) {
  (void)history;
  return (dem_couple){dem_against(c, roll, dem_couple_limit(c, DEM_OF(c, rolling_friction)), dem_per_inertia(c)),
                      vd_set(0)};
}

DEM_KERNEL dem_couple dem_rolling_spring_dashpot(const dem_contact *c, vd3 roll, vd *history) {
  vd arm = DEM_OF(c, rolling_friction) * c->radius, limit = dem_couple_limit(c, DEM_OF(c, rolling_friction));
  vd stiffness = vd_set(2.25) * c->stiffness * arm * arm;
  vd3 grow = vd3_scale(-(stiffness * vd_set(0.5 * c->dt)), roll);
  vd3 m = vd3_add(dem_turn_history(c, (vd3){history[0], history[1], history[2]}), grow);
  vd m2 = vd3_dot(m, m);
  vm rolls = vm_and(vm_less(limit * limit, m2), c->touching);
  m = dem_clip(m, m2, limit, rolls);
  vd3 next = vd3_add(m, grow);
  history[0] = next.x, history[1] = next.y, history[2] = next.z;
  vd damping = vd_set(2) * DEM_OF(c, rolling_damping) * vd_sqrt(stiffness / c->inverse_inertia);
  vd3 sum = vd3_axpy(-vd_pick(rolls, vd_set(0), damping), roll, m);
  vm springs = vm_less(vd_set(0), stiffness);
  return (dem_couple){sum, vd_only(springs, vd_set(0.5) * vd3_dot(m, m) / stiffness)};
}

DEM_KERNEL dem_couple dem_twisting_none(const dem_contact *c, vd3 twist) {
  (void)c, (void)twist;
  return (dem_couple){{vd_set(0), vd_set(0), vd_set(0)}, vd_set(0)};
}

DEM_KERNEL dem_couple dem_twisting_constant_torque(const dem_contact *c, vd3 twist) {
  return (dem_couple){dem_against(c, twist, dem_couple_limit(c, DEM_OF(c, twisting_friction)), dem_per_inertia(c)),
                      vd_set(0)};
}

#endif
