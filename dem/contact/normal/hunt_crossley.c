/* Normal law hunt-crossley: [A07] Eq. 2.39 with the exponent of the elastic law in the damping as well,
 *   F = k delta^p (1 + X delta'/v_0),   X - ln(1+X) = -e X - ln(1 - e X)   (or X = 3/4 (1 - e^2) as printed).
 *
 * History: v_0, the largest normal speed of the contact so far, not less than a floor. In an impact of two that is the
 * speed at which it began; a contact that began slowly and is then hit by others is not damped without bound.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/contact/law/contact.h"
#include "dem/contact/law/law.h"
#include "dem/contact/law/restitution.h"

/* of model.normal_setting: p; 1: X as printed */
enum { EXPONENT, PRINTED };

/* of pair.normal; pair.normal_damping is X */
enum {
  STIFFNESS,  /* k [N/m^p] */
  HERTZIAN,   /* after Hertz: k = this * sqrt(R*), 4/3 E* [Pa] */
  SPEED_FLOOR /* least v_0 [m/s] */
};

/* x^p, x > 0 in the lanes that matter; the common exponents without pow */
DEM_KERNEL vd power(vd x, double p) {
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

DEM_KERNEL void kernel(dem_contact *c, vd *history) {
  const double p = c->model->normal_setting[EXPONENT];
  history[0] = vd_max(vd_max(history[0], vd_abs(c->rate)), DEM_OF(c, normal[SPEED_FLOOR]));
  c->circle = vd_sqrt(c->radius * c->overlap);
  vd k = DEM_OF(c, normal[STIFFNESS]) + DEM_OF(c, normal[HERTZIAN]) * vd_sqrt(c->radius);
  vd elastic = k * power(c->overlap, p);
  c->stiffness = vd_set(p) * elastic / c->overlap;
  c->damping = vd_sqrt(c->stiffness / c->inverse_mass);
  vd damped = elastic * DEM_OF(c, normal_damping) * (c->rate / history[0]);
  c->force = vd_max(elastic + damped, DEM_OF(c, floor));
  c->elastic = vd_set(1 / (p + 1)) * elastic * c->overlap;
}

#define DEM_LAW hunt_crossley
#define DEM_LAW_KERNEL kernel
#define DEM_LAW_COLUMNS 1
#define DEM_LAW_CIRCLE true
#include "dem/contact/loop/loops.h"

#if DEM_SIMD == 0

static void read_settings(dem_model *m, tdm_object *o) {
  static const char *const lambdas[] = {"exact", "printed"};
  double *of = m->normal_setting;
  of[EXPONENT] = tdm_get_number(o, "exponent", 1.5, TDM_POSITIVE);
  of[PRINTED] = tdm_get_choice(o, "lambda", lambdas, 2, 0) == 1;
  if (m->tangential->needs_circle && of[EXPONENT] != 1.5)
    tdm_object_fail(o, "tangential",
                    "\"%s\" needs the contact circle of Hertz's force, but the exponent is %g; use 1.5, or \"spring\"",
                    m->tangential->head.name, of[EXPONENT]);
}

static tdm_status damp(const dem_model *m, dem_pair *p) {
  double e = p->restitution;
  p->normal_damping = m->normal_setting[PRINTED] != 0 ? 0.75 * (1 - e * e) : dem_hunt_damping(e);
  return TDM_OK;
}

static void read(const dem_model *m, tdm_object *o, dem_pair *p) {
  if (tdm_has(o, "stiffness") && m->tangential->needs_circle)
    tdm_object_fail(o, "stiffness",
                    "is not Hertz's, and tangential \"%s\" needs his contact circle; remove it, or use \"spring\"",
                    m->tangential->head.name);
  else if (tdm_has(o, "stiffness") || !(p->effective_young > 0) || m->normal_setting[EXPONENT] != 1.5)
    p->normal[STIFFNESS] =
        dem_need(o, "stiffness", "without elastic constants and exponent 1.5, normal", "hunt-crossley", TDM_POSITIVE);
  else
    p->normal[HERTZIAN] = 4.0 / 3 * p->effective_young;
  p->normal[SPEED_FLOOR] = tdm_get_number(o, "speed_floor", 1e-3, TDM_POSITIVE);
  dem_read_restitution(m, o, p);
}

/* ---- closed forms ---- */

static double slope_of(const dem_pair *p, dem_impact i) {
  return p->normal[STIFFNESS] + p->normal[HERTZIAN] * sqrt(i.radius);
}

/* without damping: 2 sqrt(pi) Gamma(1 + 1/q)/Gamma(1/2 + 1/q) delta_max/v, q = p + 1 */
static double time_of(const dem_model *m, const dem_pair *p, dem_impact i) {
  double q = m->normal_setting[EXPONENT] + 1;
  double overlap = pow(q * i.mass * i.speed * i.speed / (2 * slope_of(p, i)), 1 / q);
  return 2 * sqrt(M_PI) * tgamma(1 + 1 / q) / tgamma(0.5 + 1 / q) * overlap / i.speed;
}

/* X = lambda v_0 of an impact: of an impact slower than the floor less */
static double share_of(const dem_pair *p, dem_impact i) {
  return p->normal_damping * fmin(1, i.speed / p->normal[SPEED_FLOOR]);
}

static double overlap_of(const dem_model *m, const dem_pair *p, dem_impact i) {
  double q = m->normal_setting[EXPONENT] + 1, x = share_of(p, i);
  double energy = x > 1e-4 ? (x - log1p(x)) / (x * x) : 0.5 - x / 3;
  return pow(q * i.mass * i.speed * i.speed * energy / slope_of(p, i), 1 / q);
}

static double restitution_of(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m;
  return dem_hunt_restitution(share_of(p, i));
}

static double force_of(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  return slope_of(p, i) * pow(overlap, m->normal_setting[EXPONENT]);
}

static double stiffness_of(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  return m->normal_setting[EXPONENT] * force_of(m, p, i, overlap) / overlap;
}

static double elastic_of(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  return force_of(m, p, i, overlap) * overlap / (m->normal_setting[EXPONENT] + 1);
}

const dem_normal_law dem_normal_hunt_crossley = {
    .head = {.name = "hunt-crossley",
             .ncolumn = DEM_LAW_COLUMNS,
             .keys = {{.name = "stiffness"}, {.name = "speed_floor"}}},
    .circle = true,
    .tangential = "mindlin",
    .why_not_clip = "whose force ends at 0 and does not attract before",
    .setting_keys = {"exponent", "lambda"},
    .read_settings = read_settings,
    .read = read,
    .damp = damp,
    .time = time_of,
    .overlap = overlap_of,
    .restitution = restitution_of,
    .force = force_of,
    .stiffness = stiffness_of,
    .elastic = elastic_of,
    .loops = DEM_LAW_LOOPS,
};
#endif
