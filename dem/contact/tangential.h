/* Tangential forces: kernels with their columns of history.
 *
 * mindlin: no-slip stiffness with Coulomb's limit (Mindlin & Deresiewicz 1953, in the form of Tsuji et al. 1992):
 *   S_t = 8 G* a,   F_t = F_el - c_t v_t,   c_t = 2 sqrt(5/6) beta sqrt(m* S_t),   |F_t| <= mu F_n
 *
 * The history is the elastic force F_el in the middle of the coming step (columns 0-2) and the contact radius a of the
 * step before (column 3). In a step F_el
 *   1. turns with the contact: about the normal, then into the current tangent plane at its length;
 *   2. is scaled by a/a_before when the contact unloads (a falls). When it loads, it stays. So a contact returns no
 *      more elastic energy than it was given: with F = S_t(delta) xi at any time a spring loaded at small a and
 * released at large a would create energy (Walton 1993; Thornton, Cummins & Cleary 2013);
 *   3. grows by -S_t v_t dt/2 up to now, which is the force, and by as much again for the next step: the trapezoidal
 *      rule with the velocity at the end of the step, second order as velocity Verlet is;
 *   4. is clipped to the limit when the contact slides. The sum with the damping is clipped as well.
 * An attracting contact (the tail) has no friction.
 */
#ifndef DEM_CONTACT_TANGENTIAL_H
#define DEM_CONTACT_TANGENTIAL_H

#include "dem/contact/contact.h"

/* What a tangential law gives. */
typedef struct {
  vd3 force;             /* on the particle; the partner gets the opposite [N] */
  vd elastic, dissipate; /* energy stored [J], power lost [W] */
} dem_tangential;

DEM_KERNEL dem_tangential dem_tangential_none(const dem_contact *c, vd *history) {
  (void)c, (void)history;
  return (dem_tangential){{vd_set(0), vd_set(0), vd_set(0)}, vd_set(0), vd_set(0)};
}

/* Turn a history vector with the contact: by the mean spin about the normal, then into the tangent plane at the same
 * length. The correction of the length is small: float precision of it is double precision of the result. */
DEM_KERNEL vd3 dem_turn_history(const dem_contact *c, vd3 f) {
  vd before = vd3_dot(f, f);
  f = vd3_axpy(c->turn * vd_set(c->dt), vd3_cross(c->normal, f), f);
  f = vd3_axpy(-vd3_dot(f, c->normal), c->normal, f);
  vd after = vd3_dot(f, f);
  vd change = vd_only(vm_less(vd_set(1e-36), after), vd_ratio_single(before - after, after));
  return vd3_scale(vd_set(1) + vd_set(0.5) * vd_min(change, vd_set(1)), f);
}

/* f no longer than the limit: f or its direction times the limit */
DEM_KERNEL vd3 dem_clip(vd3 f, vd length2, vd limit, vm over) {
  vd scale = vd_pick(over, limit / vd_sqrt(vd_pick(over, length2, vd_set(1))), vd_set(1));
  return vd3_scale(scale, f);
}

DEM_KERNEL dem_tangential dem_tangential_mindlin(const dem_contact *c, vd *history) {
  vd3 f = dem_turn_history(c, (vd3){history[0], history[1], history[2]});
  vd before = history[3];
  vd unload = vd_pick(vm_less(c->circle, before), c->circle / before, vd_set(1));
  vd stiffness = vd_set(8) * DEM_OF(c, shear) * c->circle;
  vd3 grow = vd3_scale(-(stiffness * vd_set(0.5 * c->dt)), c->slip);
  f = vd3_add(vd3_scale(unload, f), grow);
  vd limit = DEM_OF(c, friction) * vd_max(c->force, vd_set(0)), limit2 = limit * limit;
  vd f2 = vd3_dot(f, f);
  vm slides = vm_and(vm_less(limit2, f2), c->touching);
  if (vm_any(slides))
    f = dem_clip(f, f2, limit, slides);

  vd3 next = vd3_add(f, grow);
  history[0] = next.x, history[1] = next.y, history[2] = next.z, history[3] = c->circle;

  vd3 sum = vd3_axpy(-(DEM_OF(c, tangential_damping) * c->damping), c->slip, f);
  vd sum2 = vd3_dot(sum, sum);
  vm over = vm_and(vm_less(limit2, sum2), c->touching);
  if (vm_any(over))
    sum = dem_clip(sum, sum2, limit, over);
  return (dem_tangential){sum, vd_set(0), vd_set(0)};
}

#endif
