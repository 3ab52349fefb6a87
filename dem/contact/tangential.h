/* Tangential forces: kernels with their columns of history. An attracting contact has no friction.
 *
 * coulomb: [A07] Eq. 2.54, mu_d F_n against the slip; none at slip 0. Where it would turn the slip round within a step
 * it only stops it (1/m of two spheres that slip is 3.5/m*), so a contact at rest creeps, by what other forces give it
 * in a step. viscous: [A07] Eq. 2.56, -c_t v_t, without a limit.
 *
 * spring: [A07] Eq. 2.57-2.59 with Coulomb's limit over the whole: F_t = F_el - c_t v_t, |F_t| <= mu F_n, F_el from
 *   k_t, c_t = c_p + 2 zeta_t sqrt(k_t m*)
 * mindlin: no-slip stiffness (Mindlin & Deresiewicz 1953, in the form of Tsuji et al. 1992):
 *   S_t = 8 G* a,   c_t = 2 sqrt(5/6) beta sqrt(m* S_t)
 *
 * The history is the elastic force F_el in the middle of the coming step (columns 0-2) and, with mindlin, the contact
 * radius a of the step before (column 3). In a step F_el
 *   1. turns with the contact: about the normal, then into the current tangent plane at its length;
 *   2. (mindlin) is scaled by a/a_before when the contact unloads (a falls). When it loads, it stays. So a contact
 * returns no more elastic energy than it was given: with F = S_t(delta) xi at any time a spring loaded at small a and
 * released at large a would create energy (Walton 1993; Thornton, Cummins & Cleary 2013);
 *   3. grows by -k_t v_t dt/2 up to now, which is the force, and by as much again for the next step: the trapezoidal
 *      rule with the velocity at the end of the step, second order as velocity Verlet is;
 *   4. is clipped to mu_d F_n when the contact slides. The sum with the damping is clipped as well.
 * A contact sticks until F_el passes mu_s F_n; it then slides as long as F_el, clipped and grown on, passes mu_d F_n.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_TANGENTIAL_H
#define DEM_CONTACT_TANGENTIAL_H

#include "dem/contact/contact.h"

/* What a tangential law gives. */
typedef struct {
  vd3 force;  /* on the particle; the partner gets the opposite [N] */
  vd elastic; /* energy stored [J] */
} dem_tangential;

DEM_KERNEL dem_tangential dem_tangential_none(dem_contact *c, vd *history) {
  (void)c, (void)history;
  return (dem_tangential){{vd_set(0), vd_set(0), vd_set(0)}, vd_set(0)};
}

DEM_KERNEL dem_tangential dem_tangential_coulomb(dem_contact *c, vd *history) {
  (void)history;
  vd limit = DEM_OF(c, friction) * vd_max(c->force, vd_set(0));
  return (dem_tangential){dem_against(c, c->slip, limit, vd_set(3.5) * c->inverse_mass), vd_set(0)};
}

DEM_KERNEL dem_tangential dem_tangential_viscous(dem_contact *c, vd *history) {
  (void)history;
  return (dem_tangential){vd3_scale(-DEM_OF(c, tangential_viscosity), c->slip), vd_set(0)};
}

/* Steps 3 and 4 with a spring and a damper; f: after steps 1 and 2. Leaves the history's force in history[0..2]. */
DEM_KERNEL dem_tangential dem_spring(dem_contact *c, vd3 f, vd stiffness, vd damping, vd *history) {
  vd3 grow = vd3_scale(-(stiffness * vd_set(0.5 * c->dt)), c->slip);
  f = vd3_add(f, grow);
  vd press = vd_max(c->force, vd_set(0)), limit = DEM_OF(c, friction) * press, limit2 = limit * limit;
  vd f2 = vd3_dot(f, f), passed2 = limit2;
  if (c->all_terms && c->model->columns.sliding >= 0) {
    vd hold = DEM_OF(c, static_friction) * press;
    passed2 = vd_pick(vm_less(vd_set(0), c->sliding), limit2, hold * hold);
  }
  vm slides = vm_and(vm_less(passed2, f2), c->touching);
  if (vm_any(slides))
    f = dem_clip(f, f2, limit, slides);

  vd3 next = vd3_add(f, grow);
  history[0] = next.x, history[1] = next.y, history[2] = next.z;

  vd3 sum = vd3_axpy(-damping, c->slip, f);
  vd sum2 = vd3_dot(sum, sum);
  if (c->all_terms && c->model->columns.sliding >= 0) {
    limit = vd_pick(slides, limit, DEM_OF(c, static_friction) * press);
    limit2 = limit * limit;
    c->sliding = vd_only(slides, vd_set(1));
  }
  vm over = vm_and(vm_less(limit2, sum2), c->touching);
  if (vm_any(over))
    sum = dem_clip(sum, sum2, limit, over);
  return (dem_tangential){sum, vd_set(0.5) * vd3_dot(f, f) / stiffness};
}

DEM_KERNEL dem_tangential dem_tangential_spring(dem_contact *c, vd *history) {
  vd3 f = dem_turn_history(c, (vd3){history[0], history[1], history[2]});
  vd damping = DEM_OF(c, tangential_viscosity) + DEM_OF(c, tangential_damping) / vd_sqrt(c->inverse_mass);
  return dem_spring(c, f, DEM_OF(c, tangential_stiffness), damping, history);
}

DEM_KERNEL dem_tangential dem_tangential_mindlin(dem_contact *c, vd *history) {
  vd3 f = dem_turn_history(c, (vd3){history[0], history[1], history[2]});
  vd before = history[3];
  vd unload = vd_pick(vm_less(c->circle, before), c->circle / before, vd_set(1));
  vd stiffness = vd_set(8) * DEM_OF(c, effective_shear) * c->circle;
  history[3] = c->circle;
  return dem_spring(c, vd3_scale(unload, f), stiffness, DEM_OF(c, tangential_damping) * c->damping, history);
}

#endif
