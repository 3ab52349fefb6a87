/* Closed forms of normal impacts: see theory.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/contact/theory.h"

#include "dem/contact/restitution.h"

#include <math.h>

/* ---- linear ---- */

/* x'' + 2 zeta x' + x = 0, x(0) = 0, x'(0) = 1. Kept, it ends at x = 0; clipped, at x'' = 0, where with zeta = sin a
 * the phase is pi - 2a and the speed exp(-zeta t). */
double dem_linear_time(double zeta, bool clip) {
  if (zeta < 1)
    return (clip ? M_PI - 2 * asin(zeta) : M_PI) / sqrt(1 - zeta * zeta);
  if (!clip)
    return INFINITY;
  double b = acosh(zeta);
  return b > 0 ? 2 * b / sinh(b) : 2;
}

double dem_linear_restitution(double zeta, bool clip) {
  return exp(-zeta * dem_linear_time(zeta, clip));
}

/* largest x of the same */
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
  double k = p->stiffness + p->stiffness_per_mass * i.mass, root = sqrt(k * i.mass);
  return (linear){sqrt(k / i.mass), 0.5 * (p->viscosity / root + p->normal_damping)};
}

static double hooke_time(const dem_model *m, const dem_pair *p, dem_impact i) {
  linear l = linear_of(p, i);
  return dem_linear_time(l.zeta, m->clip) / l.frequency;
}

static double hooke_overlap(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m;
  linear l = linear_of(p, i);
  return i.speed / l.frequency * linear_overlap(l.zeta);
}

static double hooke_restitution(const dem_model *m, const dem_pair *p, dem_impact i) {
  return dem_linear_restitution(linear_of(p, i).zeta, m->clip);
}

/* elastic force at an overlap; slope is its exponent times this by the overlap */
static double hooke_force(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  (void)m;
  return (p->stiffness + p->stiffness_per_mass * i.mass) * overlap;
}

/* ---- Hertz ---- */

double dem_contact_time(double mass, double radius, double young, double speed) {
  /* 4 sqrt(pi) Gamma(2/5) / (5 Gamma(9/10)) (15/16)^(2/5) */
  return 2.8682656992 * pow(mass * mass / (radius * young * young * speed), 0.2);
}

static double hertz_time(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m;
  return dem_contact_time(i.mass, i.radius, p->effective_young, i.speed);
}

static double hertz_overlap(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m;
  return pow(15 * i.mass * i.speed * i.speed / (16 * p->effective_young * sqrt(i.radius)), 0.4);
}

static double hertz_restitution(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m, (void)i;
  return p->viscosity > 0 ? NAN : p->restitution;
}

static double hertz_force(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  (void)m;
  return 4.0 / 3 * p->effective_young * sqrt(i.radius * overlap) * overlap;
}

/* ---- Hunt and Crossley ---- */

static double hunt_slope(const dem_pair *p, dem_impact i) {
  return p->stiffness + p->hertzian * sqrt(i.radius);
}

/* without damping: 2 sqrt(pi) Gamma(1 + 1/q)/Gamma(1/2 + 1/q) delta_max/v, q = p + 1 */
static double hunt_time(const dem_model *m, const dem_pair *p, dem_impact i) {
  double q = m->exponent + 1;
  double overlap = pow(q * i.mass * i.speed * i.speed / (2 * hunt_slope(p, i)), 1 / q);
  return 2 * sqrt(M_PI) * tgamma(1 + 1 / q) / tgamma(0.5 + 1 / q) * overlap / i.speed;
}

/* X = lambda v_0 of an impact: of an impact slower than the floor less */
static double hunt_share(const dem_pair *p, dem_impact i) {
  return p->normal_damping * fmin(1, i.speed / p->speed_floor);
}

static double hunt_overlap(const dem_model *m, const dem_pair *p, dem_impact i) {
  double q = m->exponent + 1, x = hunt_share(p, i);
  double energy = x > 1e-4 ? (x - log1p(x)) / (x * x) : 0.5 - x / 3;
  return pow(q * i.mass * i.speed * i.speed * energy / hunt_slope(p, i), 1 / q);
}

static double hunt_restitution(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m;
  return dem_hunt_restitution(hunt_share(p, i));
}

static double hunt_force(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  return hunt_slope(p, i) * pow(overlap, m->exponent);
}

/* ---- hysteretic ---- */

/* [A07] Eq. 2.45, without adhesion */
static double hysteretic_time(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m;
  return M_PI / 2 * (sqrt(i.mass / p->stiffness) + sqrt(i.mass / p->unloading));
}

static double hysteretic_overlap(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m;
  return i.speed * sqrt(i.mass / p->stiffness);
}

/* what is left after unloading to delta_0, over the tip at delta_ad ([A07] Eq. 2.49) and along the adhesive line */
static double hysteretic_restitution(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m, (void)i;
  double share = p->stiffness / p->unloading, open = 1 - share; /* epsilon^2; delta_0/delta_max */
  double tip = open * p->stiffness / (p->stiffness + share * p->adhesion_slope);
  double left = share - p->adhesion_slope * tip * open / p->stiffness;
  return left > 0 ? sqrt(left) : 0;
}

static double hysteretic_force(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  (void)m;
  double branch = p->unloading * (overlap - p->plastic * fmax(i.deepest, overlap));
  return fmax(branch, -p->adhesion_slope * overlap);
}

/* ---- the table ---- */

typedef double of_impact(const dem_model *, const dem_pair *, dem_impact);

static const struct {
  of_impact *time, *overlap, *restitution;
  double (*force)(const dem_model *, const dem_pair *, dem_impact, double overlap);
} theories[DEM_NORMALS] = {
    [DEM_NORMAL_hooke] = {hooke_time, hooke_overlap, hooke_restitution, hooke_force},
    [DEM_NORMAL_hertz] = {hertz_time, hertz_overlap, hertz_restitution, hertz_force},
    [DEM_NORMAL_hunt_crossley] = {hunt_time, hunt_overlap, hunt_restitution, hunt_force},
    [DEM_NORMAL_hysteretic] = {hysteretic_time, hysteretic_overlap, hysteretic_restitution, hysteretic_force},
};

double dem_normal_contact_time(const dem_model *m, const dem_pair *p, dem_impact i) {
  return theories[m->law->normal].time(m, p, i);
}

double dem_normal_overlap(const dem_model *m, const dem_pair *p, dem_impact i) {
  return theories[m->law->normal].overlap(m, p, i);
}

double dem_normal_restitution(const dem_model *m, const dem_pair *p, dem_impact i) {
  return theories[m->law->normal].restitution(m, p, i);
}

double dem_normal_force(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  return theories[m->law->normal].force(m, p, i, overlap);
}

/* of the elastic force, where it is a power of the overlap */
static double exponent_of(const dem_model *m) {
  return m->law->normal == DEM_NORMAL_hooke ? 1 : m->law->normal == DEM_NORMAL_hertz ? 1.5 : m->exponent;
}

double dem_normal_stiffness(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  if (m->law->normal == DEM_NORMAL_hysteretic)
    return p->unloading;
  return exponent_of(m) * dem_normal_force(m, p, i, overlap) / overlap;
}

double dem_tangential_stiffness(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  switch (m->law->tangential) {
  case DEM_TANGENTIAL_mindlin:
    return 8 * p->effective_shear * sqrt(i.radius * overlap);
  case DEM_TANGENTIAL_spring:
    return p->tangential_stiffness;
  default:
    return 0;
  }
}

double dem_normal_elastic(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  double force = dem_normal_force(m, p, i, overlap);
  if (m->law->normal == DEM_NORMAL_hysteretic)
    return 0.5 * force * force / p->unloading;
  return force * overlap / (exponent_of(m) + 1);
}

/* ---- adhesion ---- */

double dem_jkr_reach(double radius, double young, double adhesion) {
  double share = M_PI * adhesion / young;
  return 0.75 * cbrt(share * share * radius);
}

double dem_jkr_pull(double radius, double adhesion) {
  return 1.5 * M_PI * adhesion * radius;
}
