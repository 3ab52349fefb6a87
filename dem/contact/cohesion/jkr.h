/* Cohesion jkr: Johnson, Kendall & Roberts (1971) in place of Hertz's force, work of adhesion w:
 *   F = 4 E* a^3/(3 R*) - sqrt(8 pi w E* a^3),   delta = a^2/R* - sqrt(2 pi w a/E*)
 * The contact begins at delta = 0 and then holds, with its circle, over a gap until d(delta)/da = 0, which is
 * delta = -3/4 (pi w/E*)^(2/3) R*^(1/3). The largest pull is 3/2 pi w R*. Friction is limited by F plus twice that
 * (Thornton & Yin 1991). History: 1 while the contact holds.
 *   With a = L s^2, L^3 = pi w R*^2 / E*: delta = (s^4 - sqrt2 s) L^2 / R*, F = pi w R* (4/3 s^6 - sqrt8 s^3), and the
 * energy pi w L^2 (8/15 s^10 - 4 sqrt2/3 s^7 + s^4). s = 1/sqrt2 + e, where e^2 (3 + 2 sqrt2 e + e^2) is
 * delta R* / L^2 + 3/4.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_COHESION_JKR_H
#define DEM_CONTACT_COHESION_JKR_H

/* coefficients of a pair */
enum { DEM_JKR_ENERGY, DEM_JKR_LENGTH }; /* w [J/m2]; (pi w/E*)^(1/3) [m^(1/3)] */

#ifdef DEM_SIMD
#include "dem/contact/law/contact.h"

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
  vd root = dem_cube_root(c->radius), length = DEM_OF(c, cohesion[DEM_JKR_LENGTH]) * root * root; /* L */
  vd depth = length * length / c->radius, young = DEM_OF(c, effective_young);
  vd sum = c->overlap / depth + vd_set(0.75);
  vm holds = vm_and(vm_less(vd_set(0), history[0]), vm_less(vd_set(0), sum));
  c->touching = vm_and(c->touching, vm_or(vm_less(vd_set(0), c->overlap), holds));
  history[0] = vd_set(1);

  vd s = vd_set(M_SQRT1_2) + dem_jkr_root(vd_max(sum, vd_set(0))), s3 = s * s * s, s4 = s3 * s;
  vd unit = vd_set(M_PI) * DEM_OF(c, cohesion[DEM_JKR_ENERGY]) * c->radius;
  c->circle = length * s * s;
  c->stiffness = (young + young) * c->circle;
  c->damping = vd_sqrt(c->stiffness / c->inverse_mass);
  vd damped = (DEM_OF(c, normal_damping) * c->damping + DEM_OF(c, viscosity) * c->circle) * c->rate;
  c->pull = vd_set(-3) * unit; /* twice the largest pull, which friction adds */
  c->force = unit * s3 * (vd_set(4.0 / 3) * s3 - vd_set(2 * M_SQRT2)) + damped - c->pull;
  c->elastic = unit * depth * s4 * (vd_set(8.0 / 15) * s3 * s3 - vd_set(4 * M_SQRT2 / 3) * s3 + vd_set(1));
}
#endif

#ifdef DEM_LAW_ROWS
#include "dem/contact/law/law.h"
#include "dem/contact/law/theory.h"

static void check_jkr(const dem_model *m, tdm_object *o) {
  const dem_normal_law *law = m->normal->hertzian ? m->wall_normal : m->normal;
  if (!law->hertzian)
    tdm_object_fail(o, "cohesion",
                    "\"jkr\" changes the contact circle of Hertz's force, not of normal \"%s\"; use \"sjkr\"",
                    law->head.name);
  if (m->clip)
    tdm_object_fail(o, "tail", "\"clip\" cuts the attraction that cohesion \"jkr\" is there for; use \"keep\"");
}

/* an energy of 0 would have no length of its own: so little that no contact feels it */
static void read_jkr(const dem_model *m, tdm_object *o, dem_pair *p) {
  (void)m;
  double energy = fmax(dem_need(o, "adhesion_energy", "cohesion", "jkr", TDM_NOT_NEGATIVE), 1e-18);
  p->cohesion[DEM_JKR_ENERGY] = energy;
  p->cohesion[DEM_JKR_LENGTH] = cbrt(M_PI * energy / p->effective_young);
}

double dem_jkr_reach(double radius, double young, double adhesion) {
  double share = M_PI * adhesion / young;
  return 0.75 * cbrt(share * share * radius);
}

double dem_jkr_pull(double radius, double adhesion) {
  return 1.5 * M_PI * adhesion * radius;
}

static double reach_of_pair(const dem_pair *p, double radius) {
  return dem_jkr_reach(radius, p->effective_young, p->cohesion[DEM_JKR_ENERGY]);
}

static const dem_cohesion_law dem_cohesion_row_jkr = {
    .head = {.name = "jkr", .ncolumn = 1, .keys = {{.name = "adhesion_energy", .example = 0.1}}},
    .check = check_jkr,
    .read = read_jkr,
    .reach = reach_of_pair,
};
#endif

#endif
