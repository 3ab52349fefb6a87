/* Normal forces: stateless kernels.
 *
 * Hertz with the damping of Tsuji et al. (1992) as in EDEM, [L18] Section 2.1:
 *   F_n = 4/3 E* sqrt(R*) delta^1.5 + c_n delta',   c_n = 2 sqrt(5/6) beta sqrt(m* S_n),   S_n = 2 E* sqrt(R* delta)
 * delta' > 0 while approaching; F_n > 0 repels.
 */
#ifndef DEM_CONTACT_NORMAL_H
#define DEM_CONTACT_NORMAL_H

#include "dem/model.h"

#include <math.h>

typedef struct {
  double circle; /* contact radius a = sqrt(R* delta) [m] */
  double force;  /* [N], before the tail */
  double root;   /* sqrt(m* S_n) [kg/s], for the damping of other families */
} dem_normal;

/* overlap delta [m], rate delta' [m/s], effective radius R* [m] and mass m* [kg] */
DEM_KERNEL dem_normal dem_normal_hertz(const dem_pair *pair, double overlap, double rate, double radius, double mass) {
  dem_normal out;
  out.circle = sqrt(radius * overlap);
  out.root = sqrt(mass * 2 * pair->young * out.circle);
  out.force = 4.0 / 3.0 * pair->young * out.circle * overlap + pair->normal_damping * out.root * rate;
  return out;
}

/* The attractive tail at the end of a damped contact, kept: restitution is exact with beta = -ln e / sqrt(ln^2 e +
 * pi^2) (Antypov & Elliott 2011). */
DEM_KERNEL double dem_tail_keep(double force) {
  return force;
}

/* The tail clipped: dry particles do not stick. beta is solved so that e is met (restitution.h). */
DEM_KERNEL double dem_tail_clip(double force) {
  return force > 0 ? force : 0;
}

#endif
