/* Tangential law mindlin: no-slip stiffness (Mindlin & Deresiewicz 1953, in the form of Tsuji et al. 1992):
 *   S_t = 8 G* a,   c_t = 2 sqrt(5/6) beta sqrt(m* S_t), or a constant viscosity ([G21] Eq. 5)
 *
 * History: the elastic force (sticking.h; columns 0-2) and the contact radius a of the step before (column 3). The
 * force is scaled by a/a_before when the contact unloads (a falls). When it loads, it stays. So a contact returns no
 * more elastic energy than it was given: with F = S_t(delta) xi at any time a spring loaded at small a and released at
 * large a would create energy (Walton 1993; Thornton, Cummins & Cleary 2013).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_TANGENTIAL_MINDLIN_H
#define DEM_CONTACT_TANGENTIAL_MINDLIN_H

enum { dem_tangential_columns_mindlin = 4, dem_tangential_circle_mindlin = true };

/* coefficients of a pair */
enum {
  DEM_MINDLIN_DAMPING,  /* 2 sqrt(5/6) beta sqrt(8 G* / 2 E*): c_t = this * sqrt(m* S_n) */
  DEM_MINDLIN_VISCOSITY /* given instead [kg/s] */
};

#ifdef DEM_SIMD
#include "dem/contact/law/sticking.h"

DEM_KERNEL vd dem_mindlin_damping(const dem_contact *c) {
  if (c->all_terms)
    return DEM_OF(c, tangential[DEM_MINDLIN_DAMPING]) * c->damping + DEM_OF(c, tangential[DEM_MINDLIN_VISCOSITY]);
  return DEM_OF(c, tangential[DEM_MINDLIN_DAMPING]) * c->damping;
}

DEM_KERNEL dem_tangential dem_tangential_mindlin(dem_contact *c, vd *history) {
  vd3 f = dem_turn_history(c, (vd3){history[0], history[1], history[2]});
  vd before = history[3];
  vd unload = vd_pick(vm_less(c->circle, before), c->circle / before, vd_set(1));
  vd stiffness = vd_set(8) * DEM_OF(c, effective_shear) * c->circle;
  history[3] = c->circle;
  return dem_stick_or_slide(c, vd3_scale(unload, f), stiffness, dem_mindlin_damping(c), history);
}
#endif

#ifdef DEM_LAW_ROWS
#include "dem/contact/law/law.h"

static void read_mindlin(const dem_model *m, tdm_object *o, dem_pair *p) {
  (void)m;
  p->tangential[DEM_MINDLIN_VISCOSITY] = tdm_get_number(o, "tangential_viscosity", 0, TDM_NOT_NEGATIVE);
}

static bool is_viscous_mindlin(const dem_pair *p) {
  return p->tangential[DEM_MINDLIN_VISCOSITY] > 0;
}

static void damp_mindlin(const dem_model *m, dem_pair *p) {
  (void)m;
  double normal = is_viscous_mindlin(p) ? 0 : 2 * sqrt(5.0 / 6) * p->beta;
  p->tangential[DEM_MINDLIN_DAMPING] = normal * sqrt(8 * p->effective_shear / (2 * p->effective_young));
}

static double mindlin_stiffness(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  (void)m;
  return 8 * p->effective_shear * sqrt(i.radius * overlap);
}

static const dem_tangential_law dem_tangential_row_mindlin = {
    .head = {.name = "mindlin",
             .needs_young = true,
             .ncolumn = dem_tangential_columns_mindlin,
             .vectors = 7,
             .keys = {{.name = "tangential_viscosity"}}},
    .friction = true,
    .sticks = true,
    .needs_circle = true,
    .read = read_mindlin,
    .damp = damp_mindlin,
    .needs_all_terms = is_viscous_mindlin,
    .stiffness = mindlin_stiffness,
};
#endif

#endif
