/* Cohesion: attraction besides, or in place of, the normal law's force; in the loops with `all_terms` only.
 *
 * sjkr: -k A with the contact area A = 2 pi R* delta (of the circle in which two spheres of equal overlap cross).
 * Friction is limited by the normal law's force alone.
 *
 * dmt: Derjaguin, Muller & Toporov (1975): Hertz's force less 2 pi w R*, as long as they touch. For stiff and small
 * spheres, jkr for soft and large ones. Friction is limited by the normal law's force alone, F + 2 pi w R*.
 *
 * jkr: Johnson, Kendall & Roberts (1971) in place of Hertz's force, work of adhesion w:
 *   F = 4 E* a^3/(3 R*) - sqrt(8 pi w E* a^3),   delta = a^2/R* - sqrt(2 pi w a/E*)
 * The contact begins at delta = 0 and then holds, with its circle, over a gap until d(delta)/da = 0, which is
 * delta = -3/4 (pi w/E*)^(2/3) R*^(1/3). The largest pull is 3/2 pi w R*. Friction is limited by F plus twice that
 * (Thornton & Yin 1991). History: 1 while the contact holds.
 *   With a = L s^2, L^3 = pi w R*^2 / E*: delta = (s^4 - sqrt2 s) L^2 / R*, F = pi w R* (4/3 s^6 - sqrt8 s^3), and the
 * energy pi w L^2 (8/15 s^10 - 4 sqrt2/3 s^7 + s^4). s = 1/sqrt2 + e, where e^2 (3 + 2 sqrt2 e + e^2) is
 * delta R* / L^2 + 3/4.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_COHESION_H
#define DEM_CONTACT_COHESION_H

#include "dem/contact/contact.h"

DEM_KERNEL void dem_cohesion_none(dem_contact *c, vd *history) {
  (void)c, (void)history;
}

DEM_KERNEL void dem_cohesion_sjkr(dem_contact *c, vd *history) {
  (void)history;
  vd slope = vd_set(2 * M_PI) * DEM_OF(c, cohesion_density) * c->radius;
  c->pull = -(slope * c->overlap);
  c->elastic = c->elastic + vd_set(0.5) * c->pull * c->overlap;
}

DEM_KERNEL void dem_cohesion_dmt(dem_contact *c, vd *history) {
  (void)history;
  c->pull = -(vd_set(2 * M_PI) * DEM_OF(c, adhesion_energy) * c->radius);
  c->elastic = c->elastic + c->pull * c->overlap;
}

/* e of the head of this file, from above: Newton's steps then never pass it */
DEM_KERNEL vd dem_jkr_root(vd sum) {
  const vd root8 = vd_set(2 * M_SQRT2);
  vd e = vd_min(vd_sqrt(sum * vd_set(1.0 / 3)), vd_sqrt(vd_sqrt(sum)));
  for (int k = 0; k < 7; k++) {
    vd value = e * e * (vd_set(3) + root8 * e + e * e) - sum;
    vd slope = e * (vd_set(6) + vd_set(3) * root8 * e + vd_set(4) * e * e);
    e = e - value / vd_max(slope, vd_set(1e-200));
  }
  return e;
}

DEM_KERNEL vd dem_cube_root(vd x) {
  double lane[DEM_W];
  vd_store(lane, x);
  for (int l = 0; l < DEM_W; l++)
    lane[l] = cbrt(lane[l]);
  return vd_load(lane);
}

DEM_KERNEL void dem_cohesion_jkr(dem_contact *c, vd *history) {
  vd root = dem_cube_root(c->radius), length = DEM_OF(c, adhesion_length) * root * root; /* L */
  vd depth = length * length / c->radius, young = DEM_OF(c, effective_young);
  vd sum = c->overlap / depth + vd_set(0.75);
  vm holds = vm_and(vm_less(vd_set(0), history[0]), vm_less(vd_set(0), sum));
  c->touching = vm_and(c->touching, vm_or(vm_less(vd_set(0), c->overlap), holds));
  history[0] = vd_set(1);

  vd s = vd_set(M_SQRT1_2) + dem_jkr_root(vd_max(sum, vd_set(0))), s3 = s * s * s, s4 = s3 * s;
  vd unit = vd_set(M_PI) * DEM_OF(c, adhesion_energy) * c->radius;
  c->circle = length * s * s;
  c->stiffness = (young + young) * c->circle;
  c->damping = vd_sqrt(c->stiffness / c->inverse_mass);
  vd damped = (DEM_OF(c, normal_damping) * c->damping + DEM_OF(c, viscosity) * c->circle) * c->rate;
  c->pull = vd_set(-3) * unit; /* twice the largest pull, which friction adds */
  c->force = unit * s3 * (vd_set(4.0 / 3) * s3 - vd_set(2 * M_SQRT2)) + damped - c->pull;
  c->elastic = unit * depth * s4 * (vd_set(8.0 / 15) * s3 * s3 - vd_set(4 * M_SQRT2 / 3) * s3 + vd_set(1));
}

#endif
