/* Multi-contact law mc-stress: [G21] Eq. 9-10 with the conventions of its errata 1 and 2.
 *   F = F_H + beta A (nu_i tr sigma_i + nu_j tr sigma_j) + damping,   A = pi R* delta,   tr sigma_i = r_i sum F_H / V_i
 * F_H: Hertz's force at the overlap delta; the sum goes over all contacts of the particle, walls included, whose branch
 * vectors are r_i long; compression is positive and a wall has no stress. With one material this is Eq. 10 and 11. The
 * sum contains the contact's own force unless the scene excludes it. pressure "mean": a sixth of it.
 *
 * The contact's circle, and with it damping and tangential stiffness, are those of delta: the law adds a force, not an
 * overlap. Friction is limited by the whole force.
 *
 * Stored: 2/5 F_H delta + 2/7 (F - F_H) delta, which is the work while all overlaps of the particles grow alike. Along
 * other ways the work differs, as the force has no potential.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/contact/law/law.h"
#include "dem/contact/law/theory.h"
#include "dem/contact/normal/hertz.h"
#include "dem/state/data.h"

/* of pair.multi */
enum { BETA, OWN, OTHER }; /* 3 nu / (4 pi) of the particle and of its partner: tr sigma = this sum F_H / r^2 */
/* of model.multi_setting */
enum { EXCLUDES, SHARE }; /* 1: the contact's own force is no part of the sums; P is this times the sum of traces */

DEM_KERNEL void sum_force(const dem_contact *c, vd sum[]) {
  dem_contact copy = *c;
  sum[0] = dem_hertz_elastic(&copy, c->overlap);
}

DEM_KERNEL void kernel(dem_contact *c, vd *history) {
  (void)history;
  vd hertz = dem_hertz_elastic(c, c->overlap), own = c->own_sums[0], other = c->other_sums[0];
  if (c->model->multi_setting[EXCLUDES] != 0)
    own = own - hertz, other = other - hertz;
  vd pressure = DEM_OF(c, multi[OWN]) * own / (c->radii[0] * c->radii[0]) +
                DEM_OF(c, multi[OTHER]) * other / (c->radii[1] * c->radii[1]);
  vd area = vd_set(M_PI) * c->radius * c->overlap, more = DEM_OF(c, multi[BETA]) * area * pressure;
  dem_hertz_damp(c, hertz + more);
  c->elastic = (vd_set(0.4) * hertz + vd_set(2.0 / 7) * more) * c->overlap;
}

#define DEM_LAW mc_stress
#define DEM_LAW_KERNEL kernel
#define DEM_LAW_CIRCLE true
#define DEM_LAW_PLANES 1
#define DEM_LAW_SUMS 1
#define DEM_LAW_SUMS_KERNEL sum_force
#include "dem/contact/loop/loops.h"

#if DEM_SIMD == 0

static void read_settings(dem_model *m, tdm_object *o) {
  static const char *const own[] = {"include", "exclude"}, *const pressures[] = {"sum", "mean"};
  m->multi_setting[EXCLUDES] = tdm_get_choice(o, "self_contribution", own, 2, 0) == 1;
  m->multi_setting[SHARE] = tdm_get_choice(o, "pressure", pressures, 2, 0) == 1 ? 1.0 / 6 : 1;
}

static void read(const dem_model *m, tdm_object *o, const dem_material *a, const dem_material *b, dem_pair *p) {
  p->multi[BETA] = m->multi_setting[SHARE] * dem_need(o, "beta", "multi_contact", "mc-stress", TDM_NOT_NEGATIVE);
  p->multi[OWN] = 3 * a->poisson / (4 * M_PI);
  p->multi[OTHER] = 3 * b->poisson / (4 * M_PI);
}

/* ---- a contact among others ---- */

typedef struct {
  double hertz, more; /* [N] */
} forces;

/* nu tr sigma of a particle [Pa] */
static double stress_of(const dem_data *d, int i, double coefficient, double without) {
  double r = d->state.sphere[i].radius;
  return coefficient * (d->work.contact_sum[i] - without) / (r * r);
}

static forces forces_of(const dem_data *d, const dem_among *c) {
  const dem_pair *p = c->pair;
  forces f = {.hertz = dem_normal_force(d->model, p, c->at, c->overlap)};
  if (!d->work.among)
    return f;
  double without = d->model->multi_setting[EXCLUDES] != 0 ? f.hertz : 0;
  double pressure = stress_of(d, c->particle, p->multi[OWN], without);
  if (c->other >= 0)
    pressure += stress_of(d, c->other, p->multi[OTHER], without);
  f.more = p->multi[BETA] * M_PI * c->at.radius * c->overlap * pressure;
  return f;
}

static double stiffness_of(const dem_data *d, const dem_among *c) {
  forces f = forces_of(d, c);
  return (1.5 * f.hertz + 2.5 * f.more) / c->overlap;
}

static double elastic_of(const dem_data *d, const dem_among *c) {
  forces f = forces_of(d, c);
  return (0.4 * f.hertz + 2.0 / 7 * f.more) * c->overlap;
}

const dem_multi_law dem_multi_mc_stress = {
    .head = {.name = "mc-stress", .needs_young = true, .keys = {{.name = "beta", .example = 1}}},
    .setting_keys = {"self_contribution", "pressure"},
    .read_settings = read_settings,
    .read = read,
    .stiffness = stiffness_of,
    .elastic = elastic_of,
    .loops = DEM_LAW_LOOPS,
};
#endif
