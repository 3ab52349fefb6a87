/* Normal forces: stateless kernels.
 *
 * Hertz with the damping of Tsuji et al. (1992) as in EDEM, [L18] Section 2.1:
 *   F_n = 4/3 E* sqrt(R*) delta^1.5 + c_n delta',   c_n = 2 sqrt(5/6) beta sqrt(m* S_n),   S_n = 2 E* sqrt(R* delta)
 */
#ifndef DEM_CONTACT_NORMAL_H
#define DEM_CONTACT_NORMAL_H

#include "dem/contact/contact.h"

/* The attractive end of a damped contact is kept, or cut at 0 (pair.floor is -inf or 0): see restitution.h. */
DEM_KERNEL void dem_normal_hertz(dem_contact *c, vd *history) {
  (void)history;
  vd young = DEM_OF(c, young);
  c->circle = vd_sqrt(c->radius * c->overlap);
  vd stiffness = (young + young) * c->circle; /* S_n */
  c->damping = vd_sqrt(stiffness * c->mass);
  vd elastic = vd_set(2.0 / 3.0) * stiffness * c->overlap;
  vd damped = DEM_OF(c, normal_damping) * c->damping * c->rate;
  c->force = vd_max(elastic + damped, DEM_OF(c, floor));
  c->elastic = vd_set(0.4) * elastic * c->overlap;
  c->dissipate = (c->force - elastic) * c->rate;
}

#endif
