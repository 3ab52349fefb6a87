/* Tangential law spring: [A07] Eq. 2.57-2.59 with Coulomb's limit over the whole:
 *   F_t = F_el - c_t v_t, |F_t| <= mu F_n, F_el from k_t, c_t = c_p + 2 zeta_t sqrt(k_t m*)
 * How F_el goes on from step to step: sticking.h.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_TANGENTIAL_SPRING_H
#define DEM_CONTACT_TANGENTIAL_SPRING_H

enum { dem_tangential_columns_spring = 3, dem_tangential_circle_spring = false };

/* coefficients of a pair */
enum {
  DEM_SPRING_STIFFNESS, /* k_t [N/m] */
  DEM_SPRING_VISCOSITY, /* c_p [kg/s] */
  DEM_SPRING_DAMPING,   /* 2 zeta_t sqrt(k_t): c_t = c_p + this * sqrt(m*) */
  DEM_SPRING_AS_NORMAL  /* 1 when zeta_t is that of the restitution */
};

#ifdef DEM_SIMD
#include "dem/contact/law/sticking.h"

DEM_KERNEL dem_tangential dem_tangential_spring(dem_contact *c, vd *history) {
  vd3 f = dem_turn_history(c, (vd3){history[0], history[1], history[2]});
  vd damping = DEM_OF(c, tangential[DEM_SPRING_VISCOSITY]) +
               DEM_OF(c, tangential[DEM_SPRING_DAMPING]) / vd_sqrt(c->inverse_mass);
  return dem_stick_or_slide(c, f, DEM_OF(c, tangential[DEM_SPRING_STIFFNESS]), damping, history);
}
#endif

#ifdef DEM_LAW_ROWS
#include "dem/contact/law/law.h"
#include "dem/contact/law/restitution.h"

static void read_spring(const dem_model *m, tdm_object *o, dem_pair *p) {
  double *of = p->tangential;
  (void)m;
  if (p->stiffness > 0)
    of[DEM_SPRING_STIFFNESS] = tdm_get_number(o, "tangential_stiffness", 2.0 / 7 * p->stiffness, TDM_POSITIVE);
  else
    of[DEM_SPRING_STIFFNESS] = dem_need(o, "tangential_stiffness", "tangential", "spring", TDM_POSITIVE);
  of[DEM_SPRING_AS_NORMAL] = !tdm_has(o, "tangential_damping");
  of[DEM_SPRING_VISCOSITY] = tdm_get_number(o, "tangential_damping", 0, TDM_NOT_NEGATIVE);
}

static void damp_spring(const dem_model *m, dem_pair *p) {
  double *of = p->tangential, beta = p->restitution > 0 ? dem_beta_keep(p->restitution) : 0;
  (void)m;
  of[DEM_SPRING_DAMPING] = of[DEM_SPRING_AS_NORMAL] * 2 * beta * sqrt(of[DEM_SPRING_STIFFNESS]);
}

static double spring_stiffness(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  (void)m, (void)i, (void)overlap;
  return p->tangential[DEM_SPRING_STIFFNESS];
}

static const dem_tangential_law dem_tangential_row_spring = {
    .head = {.name = "spring",
             .ncolumn = dem_tangential_columns_spring,
             .vectors = 7,
             .keys = {{.name = "tangential_stiffness", .example = 3e3}, {.name = "tangential_damping"}}},
    .friction = true,
    .sticks = true,
    .read = read_spring,
    .damp = damp_spring,
    .stiffness = spring_stiffness,
};
#endif

#endif
