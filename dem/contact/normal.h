/* Normal forces: stateless kernels. F > 0 repels, delta' > 0 while approaching. Closed forms are in theory.h.
 *
 * hooke: [A07] Eq. 2.36, F = k delta + c delta', c = c_p + 2 zeta sqrt(k m*), k = k_p + q m*: stiffness k_p, or contact
 * time (q = (pi^2 + ln^2 e)/t_c^2); damping c_p, or zeta from e (Eq. 2.24) or critical (zeta = 1, Eq. 2.40)
 *
 * hertz: with the damping of Tsuji et al. (1992) as in EDEM, [L18] Section 2.1:
 *   F = 4/3 E* sqrt(R*) delta^1.5 + c_n delta',   c_n = 2 sqrt(5/6) beta sqrt(m* S_n),   S_n = 2 E* sqrt(R* delta),
 * or with the constant viscosity of [G21] Eq. 3: c_n = eta sqrt(R* delta)
 *
 * hunt-crossley: [A07] Eq. 2.39 with the exponent of the elastic law in the damping as well,
 *   F = k delta^p (1 + X delta'/v_0),   X - ln(1+X) = -e X - ln(1 - e X)   (or X = 3/4 (1 - e^2) as printed)
 * History: v_0, the largest normal speed of the contact so far, not less than a floor. In an impact of two that is the
 * speed at which it began; a contact that began slowly and is then hit by others is not damped without bound.
 *
 * hysteretic: [A07] Eq. 2.41-2.49. Loading on slope k_l, unloading and reloading on k_un, down to the adhesive line:
 *   F = max(k_un (delta - delta_0), -k_ad delta),   delta_0 = (1 - k_l/k_un) delta_max
 * History: delta_max. It grows with delta; on the adhesive line it shrinks so that delta_0 = delta (1 + k_ad/k_un), so
 * reloading from there climbs on slope k_un.
 *
 * The attractive end of a damped contact is kept, or cut at 0 (pair.floor is -inf or 0): see restitution.h.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_NORMAL_H
#define DEM_CONTACT_NORMAL_H

#include "dem/contact/contact.h"

DEM_KERNEL void dem_normal_hooke(dem_contact *c, vd *history) {
  (void)history;
  vd mass = vd_set(1) / c->inverse_mass;
  c->stiffness = DEM_OF(c, stiffness) + DEM_OF(c, stiffness_per_mass) * mass;
  c->damping = vd_sqrt(c->stiffness * mass);
  vd elastic = c->stiffness * c->overlap;
  vd damped = (DEM_OF(c, viscosity) + DEM_OF(c, normal_damping) * c->damping) * c->rate;
  c->force = vd_max(elastic + damped, DEM_OF(c, floor));
  c->elastic = vd_set(0.5) * elastic * c->overlap;
}

DEM_KERNEL void dem_normal_hertz(dem_contact *c, vd *history) {
  (void)history;
  vd young = DEM_OF(c, effective_young);
  c->circle = vd_sqrt(c->radius * c->overlap);
  c->stiffness = (young + young) * c->circle; /* S_n */
  c->damping = vd_sqrt(c->stiffness * c->mass);
  vd elastic = vd_set(2.0 / 3.0) * c->stiffness * c->overlap;
  vd damped = DEM_OF(c, normal_damping) * c->damping * c->rate;
  if (c->all_terms)
    damped = damped + DEM_OF(c, viscosity) * c->circle * c->rate;
  c->force = vd_max(elastic + damped, DEM_OF(c, floor));
  c->elastic = vd_set(0.4) * elastic * c->overlap;
}

/* x^p, x > 0 in the lanes that matter; the common exponents without pow */
DEM_KERNEL vd dem_power(vd x, double p) {
  if (p == 1.5)
    return x * vd_sqrt(x);
  if (p == 1)
    return x;
  double lane[DEM_W];
  vd_store(lane, x);
  for (int l = 0; l < DEM_W; l++)
    lane[l] = lane[l] > 0 ? pow(lane[l], p) : 0;
  return vd_load(lane);
}

DEM_KERNEL void dem_normal_hunt_crossley(dem_contact *c, vd *history) {
  const double p = c->model->exponent;
  history[0] = vd_max(vd_max(history[0], vd_abs(c->rate)), DEM_OF(c, speed_floor));
  c->circle = vd_sqrt(c->radius * c->overlap);
  vd k = DEM_OF(c, stiffness) + DEM_OF(c, hertzian) * vd_sqrt(c->radius);
  vd elastic = k * dem_power(c->overlap, p);
  c->stiffness = vd_set(p) * elastic / c->overlap;
  c->damping = vd_sqrt(c->stiffness / c->inverse_mass);
  vd damped = elastic * DEM_OF(c, normal_damping) * (c->rate / history[0]);
  c->force = vd_max(elastic + damped, DEM_OF(c, floor));
  c->elastic = vd_set(1 / (p + 1)) * elastic * c->overlap;
}

DEM_KERNEL void dem_normal_hysteretic(dem_contact *c, vd *history) {
  vd unloading = DEM_OF(c, unloading), line = -DEM_OF(c, adhesion_slope) * c->overlap, plastic = DEM_OF(c, plastic);
  vd deepest = vd_max(history[0], c->overlap);
  vd branch = unloading * (c->overlap - plastic * deepest);
  vm adhesive = vm_less(branch, line);
  history[0] = vd_pick(adhesive, (c->overlap - line / unloading) / plastic, deepest);
  c->force = vd_pick(adhesive, line, branch);
  c->stiffness = unloading;
  c->damping = vd_sqrt(c->stiffness / c->inverse_mass);
  c->elastic = vd_set(0.5) * c->force * c->force / unloading;
}

#endif
