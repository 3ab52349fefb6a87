/* Normal law hooke: [A07] Eq. 2.36, F = k delta + c delta', c = c_p + 2 zeta sqrt(k m*), k = k_p + q m*.
 *
 * Stiffness k_p, or contact time (q = (pi^2 + ln^2 e)/t_c^2); damping c_p, or zeta from e (Eq. 2.24) or critical
 * (zeta = 1, Eq. 2.40). The attractive end of a damped contact is kept, or cut at 0 (pair.floor is -inf or 0).
 *
 * The pattern of a normal law: coefficients of a pair, kernel, loops; then, once and not for each instruction set, the
 * reader, the closed forms and the row.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/contact/law/contact.h"
#include "dem/contact/law/law.h"
#include "dem/contact/law/restitution.h"

/* of pair.normal; pair.stiffness is k_p, pair.viscosity c_p, pair.normal_damping 2 zeta */
enum { STIFFNESS_PER_MASS }; /* q [1/s2] */

DEM_KERNEL void kernel(dem_contact *c, vd *history) {
  (void)history;
  vd mass = vd_set(1) / c->inverse_mass;
  c->stiffness = DEM_OF(c, stiffness) + DEM_OF(c, normal[STIFFNESS_PER_MASS]) * mass;
  c->damping = vd_sqrt(c->stiffness * mass);
  vd elastic = c->stiffness * c->overlap;
  vd damped = (DEM_OF(c, viscosity) + DEM_OF(c, normal_damping) * c->damping) * c->rate;
  c->force = vd_max(elastic + damped, DEM_OF(c, floor));
  c->elastic = vd_set(0.5) * elastic * c->overlap;
}

#define DEM_LAW hooke
#define DEM_LAW_KERNEL kernel
#include "dem/contact/loop/loops.h"

#if DEM_SIMD == 0

static tdm_status damp(const dem_model *m, dem_pair *p) {
  p->normal_damping = 2 * dem_linear_ratio(p->restitution, m->clip);
  return TDM_OK;
}

static void read(const dem_model *m, tdm_object *o, dem_pair *p) {
  bool stiffness = dem_one_of(o, "stiffness", "contact_time", "hooke");
  bool restitution = dem_one_of(o, "restitution", "damping", "hooke");
  if (stiffness)
    p->stiffness = dem_need(o, "stiffness", "normal", "hooke", TDM_POSITIVE);
  if (restitution) {
    dem_read_restitution(m, o, p);
  } else if (!stiffness) {
    tdm_object_fail(o, "damping", "goes with \"stiffness\"; a contact_time needs \"restitution\"");
  } else if (json_is_string(json_object_get(o->json, "damping"))) {
    static const char *const critical[] = {"critical"};
    tdm_get_choice(o, "damping", critical, 1, 0);
    p->normal_damping = 2;
  } else {
    p->viscosity = tdm_get_number(o, "damping", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  }
  if (!stiffness) {
    double time = tdm_get_number(o, "contact_time", TDM_REQUIRED, TDM_POSITIVE);
    p->normal[STIFFNESS_PER_MASS] = pow(dem_linear_time(0.5 * p->normal_damping, m->clip) / time, 2);
  }
}

/* ---- closed forms ---- */

/* largest x of dem_linear_time's impact */
static double linear_overlap(double zeta) {
  if (zeta < 1)
    return exp(-zeta * acos(zeta) / sqrt(1 - zeta * zeta));
  double b = acosh(zeta);
  return exp(b > 0 ? -zeta * b / sinh(b) : -1);
}

typedef struct {
  double frequency, zeta; /* undamped [1/s] */
} linear;

static linear linear_of(const dem_pair *p, dem_impact i) {
  double k = p->stiffness + p->normal[STIFFNESS_PER_MASS] * i.mass, root = sqrt(k * i.mass);
  return (linear){sqrt(k / i.mass), 0.5 * (p->viscosity / root + p->normal_damping)};
}

static double time_of(const dem_model *m, const dem_pair *p, dem_impact i) {
  linear l = linear_of(p, i);
  return dem_linear_time(l.zeta, m->clip) / l.frequency;
}

static double overlap_of(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m;
  linear l = linear_of(p, i);
  return i.speed / l.frequency * linear_overlap(l.zeta);
}

static double restitution_of(const dem_model *m, const dem_pair *p, dem_impact i) {
  return dem_linear_restitution(linear_of(p, i).zeta, m->clip);
}

static double force_of(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  (void)m;
  return (p->stiffness + p->normal[STIFFNESS_PER_MASS] * i.mass) * overlap;
}

static double stiffness_of(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  return force_of(m, p, i, overlap) / overlap;
}

static double elastic_of(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  return force_of(m, p, i, overlap) * overlap / 2;
}

/* half an undamped period where damping keeps the two together */
static double step_time_of(const dem_model *m, const dem_pair *p, dem_impact i) {
  double time = time_of(m, p, i);
  return isfinite(time) ? time : M_PI * sqrt(i.mass / stiffness_of(m, p, i, i.radius));
}

const dem_normal_law dem_normal_hooke = {
    .head = {.name = "hooke",
             .keys = {{.name = "stiffness", .example = 1e4}, {.name = "contact_time"}, {.name = "damping"}}},
    .tangential = "spring",
    .read = read,
    .damp = damp,
    .time = time_of,
    .step_time = step_time_of,
    .overlap = overlap_of,
    .restitution = restitution_of,
    .force = force_of,
    .stiffness = stiffness_of,
    .elastic = elastic_of,
    .loops = DEM_LAW_LOOPS,
};
#endif
