/* A tangential spring that sticks, or slides at the limit of friction. An attracting contact has no friction.
 *
 * The history is the elastic force F_el in the middle of the coming step (three columns). In a step F_el
 *   1. turns with the contact: about the normal, then into the current tangent plane at its length;
 *   2. grows by -k_t v_t dt/2 up to now, which is the force, and by as much again for the next step: the trapezoidal
 *      rule with the velocity at the end of the step, second order as velocity Verlet is;
 *   3. is clipped to mu_d F_n when the contact slides. The sum with the damping is clipped as well.
 * A contact sticks until F_el passes mu_s F_n; it then slides as long as F_el, clipped and grown on, passes mu_d F_n.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LAW_STICKING_H
#define DEM_CONTACT_LAW_STICKING_H

#include "dem/contact/law/contact.h"

/* Steps 2 and 3 with a spring and a damper; f: after step 1 and what the law does besides. Leaves the history's force
 * in history[0..2]. */
DEM_KERNEL dem_tangential dem_stick_or_slide(dem_contact *c, vd3 f, vd stiffness, vd damping, vd *history) {
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

#endif
