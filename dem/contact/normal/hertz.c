/* Normal law hertz: with the damping of Tsuji et al. (1992) as in EDEM, [L18] Section 2.1:
 *   F = 4/3 E* sqrt(R*) delta^1.5 + c_n delta',   c_n = 2 sqrt(5/6) beta sqrt(m* S_n),   S_n = 2 E* sqrt(R* delta),
 * or with the constant viscosity of [G21] Eq. 3: c_n = eta sqrt(R* delta).
 *
 * The attractive end of a damped contact is kept, or cut at 0 (pair.floor is -inf or 0): see restitution.h.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/contact/normal/hertz.h"

#include "dem/contact/law/law.h"
#include "dem/contact/law/restitution.h"
#include "dem/contact/law/theory.h"

DEM_KERNEL void kernel(dem_contact *c, vd *history) {
  (void)history;
  vd elastic = dem_hertz_elastic(c, c->overlap);
  dem_hertz_damp(c, elastic);
  c->elastic = vd_set(0.4) * elastic * c->overlap;
}

#define DEM_LAW hertz
#define DEM_LAW_KERNEL kernel
#define DEM_LAW_CIRCLE true
#include "dem/contact/loop/loops.h"

#if DEM_SIMD == 0

static tdm_status damp(const dem_model *m, dem_pair *p) {
  tdm_status status = m->clip ? dem_beta_clip(p->restitution, &p->beta) : TDM_OK;
  p->normal_damping = 2 * sqrt(5.0 / 6) * p->beta;
  return status;
}

static void read(const dem_model *m, tdm_object *o, dem_pair *p) {
  if (dem_one_of(o, "restitution", "viscosity", "hertz"))
    dem_read_restitution(m, o, p);
  else
    p->viscosity = tdm_get_number(o, "viscosity", TDM_REQUIRED, TDM_NOT_NEGATIVE);
}

static bool is_viscous(const dem_pair *p) {
  return p->viscosity > 0;
}

/* ---- closed forms ---- */

static double time_of(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m;
  return dem_contact_time(i.mass, i.radius, p->effective_young, i.speed);
}

static double overlap_of(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m;
  return pow(15 * i.mass * i.speed * i.speed / (16 * p->effective_young * sqrt(i.radius)), 0.4);
}

static double restitution_of(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m, (void)i;
  return p->viscosity > 0 ? NAN : p->restitution;
}

static double force_of(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  (void)m;
  return 4.0 / 3 * p->effective_young * sqrt(i.radius * overlap) * overlap;
}

static double stiffness_of(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  return 1.5 * force_of(m, p, i, overlap) / overlap;
}

static double elastic_of(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  return force_of(m, p, i, overlap) * overlap / 2.5;
}

const dem_normal_law dem_normal_hertz = {
    .head = {.name = "hertz", .needs_young = true, .keys = {{.name = "viscosity"}}},
    .circle = true,
    .hertzian = true,
    .tangential = "mindlin",
    .read = read,
    .damp = damp,
    .needs_all_terms = is_viscous,
    .time = time_of,
    .overlap = overlap_of,
    .restitution = restitution_of,
    .force = force_of,
    .stiffness = stiffness_of,
    .elastic = elastic_of,
    .loops = DEM_LAW_LOOPS,
};
#endif
