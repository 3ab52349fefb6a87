/* Two spheres collide centrally, once for each normal law and way to give its damping: restitution, duration of the
 * contact and largest overlap against theory. To add a case: a row of `cases`.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/dem_physics/impact.h"
#include "scenarios/dem_physics/rig.h"
#include "scenarios/table.h"

#include <math.h>

/* the spheres of [A07] Eq. 2.25-2.31: glass balls of 0.0383 g and 0.09 g */
static const double radii[2] = {1.5e-3, 2e-3}, masses[2] = {3.83e-5, 9e-5}, speed = 0.1;
static const double young = 1e7, poisson = 0.25; /* of the laws that need them */
static const long steps = 20000;                 /* a contact */
static const double limit = 2e-4;                /* relative */

static double effective_mass(void) {
  return masses[0] * masses[1] / (masses[0] + masses[1]);
}

static double effective_radius(void) {
  return radii[0] * radii[1] / (radii[0] + radii[1]);
}

/* ---- theory: F = k delta^p + c delta^q delta' ---- */

typedef struct {
  double e, time, overlap; /* expected; NaN: not compared */
} expected;

static expected solved(const scn_law *law, double e) {
  scn_outcome o = scn_solve_impact(law, speed, 0, 0);
  return (expected){isnan(e) ? o.normal / speed : e, o.time, o.overlap};
}

/* zeta of a linear contact that ends with its force: e = exp(-zeta (pi - 2 asin zeta)/sqrt(1 - zeta^2)) */
static double clipped_ratio(double e) {
  double low = 0, high = 1;
  for (int i = 0; i < 60; i++) {
    double z = 0.5 * (low + high);
    *(exp(-z * (M_PI - 2 * asin(z)) / sqrt(1 - z * z)) > e ? &low : &high) = z;
  }
  return low;
}

static double star(void) {
  return young / (2 * (1 - poisson * poisson));
}

static scn_law linear(double k, double zeta, bool clip) {
  double m = effective_mass();
  return (scn_law){.mass = m, .k = k, .p = 1, .c = 2 * zeta * sqrt(k * m), .clip = clip, .radius = effective_radius()};
}

/* value: stiffness; e: restitution */
static expected hooke(double k, double e) {
  scn_law law = linear(k, scn_beta(e), false);
  return solved(&law, e);
}

static expected hooke_clip(double k, double e) {
  scn_law law = linear(k, clipped_ratio(e), true);
  return solved(&law, e);
}

/* value: contact time */
static expected hooke_time(double time, double e) {
  scn_law law = linear(effective_mass() * (M_PI * M_PI + log(e) * log(e)) / (time * time), scn_beta(e), false);
  expected x = solved(&law, e);
  x.time = time;
  return x;
}

/* [A07] Eq. 2.36 with k and c; value: c */
static expected hooke_damping(double c, double unused) {
  (void)unused;
  double k = 7.36, m = effective_mass(), eta = c / (2 * m), omega = sqrt(k / m - eta * eta);
  scn_law law = linear(k, eta / sqrt(k / m), false);
  expected x = solved(&law, exp(-M_PI * eta / omega));
  x.time = M_PI / omega;
  return x;
}

/* zeta = 1 ends, clipped, at t = 2/omega with e = exp(-2); the overlap is v/(e omega) */
static expected hooke_critical(double k, double unused) {
  (void)unused;
  double omega = sqrt(k / effective_mass());
  return (expected){exp(-2), 2 / omega, speed / omega * exp(-1)};
}

static expected hertz(double unused, double e) {
  (void)unused;
  scn_law law = scn_law_hertz(effective_mass(), effective_radius(), star(), 0, scn_beta(e), 0);
  return solved(&law, e);
}

static expected hertz_clip(double unused, double e) {
  (void)unused;
  scn_law law = scn_law_hertz(effective_mass(), effective_radius(), star(), 0, scn_beta_clipped(e), 0);
  law.clip = true;
  return solved(&law, e);
}

/* the constant viscosity of [G21] Eq. 3 */
static expected hertz_viscous(double eta, double unused) {
  (void)unused;
  scn_law law = scn_law_hertz(effective_mass(), effective_radius(), star(), 0, 0, 0);
  law.c = eta * sqrt(effective_radius());
  law.q = 0.5;
  return solved(&law, NAN);
}

/* value: X = lambda v_0; X - ln(1+X) = -e X - ln(1 - e X) */
static expected hunt_power(double x, double e, double k, double p) {
  scn_law law = {.mass = effective_mass(), .k = k, .p = p, .c = k * x / speed, .q = p, .radius = effective_radius()};
  return solved(&law, e);
}

static expected hunt(double x, double e) {
  return hunt_power(x, e, 4.0 / 3 * star() * sqrt(effective_radius()), 1.5);
}

static expected hunt_linear(double x, double e) {
  return hunt_power(x, e, 1000, 1);
}

/* [A07] Eq. 2.41-2.45; value: k_un/k_l, k_l = 1000 N/m. Duration: without adhesion */
static expected hysteretic(double ratio, double e) {
  double m = effective_mass(), k = 1000;
  return (expected){e, M_PI / 2 * (sqrt(m / k) + sqrt(m / (ratio * k))), speed * sqrt(m / k)};
}

static expected hysteretic_adhesive(double ratio, double e) {
  expected x = hysteretic(ratio, e);
  x.time = NAN;
  return x;
}

/* ---- cases ---- */

#define HERTZ_PAIR(e) "'restitution':" e
#define HOOKE_PAIR(e) "'stiffness':1000,'restitution':" e

static const struct {
  const char *name, *contact, *pair;
  expected (*theory)(double value, double e);
  double value, e;
  bool by_force; /* the contact ends with its force, not with its overlap */
} cases[] = {
    {"hooke e=0.9", "'normal':'hooke'", HOOKE_PAIR("0.9"), hooke, 1000, 0.9, false},
    {"hooke e=0.3", "'normal':'hooke'", HOOKE_PAIR("0.3"), hooke, 1000, 0.3, false},
    {"hooke e=0.3 clip", "'normal':'hooke','tail':'clip'", HOOKE_PAIR("0.3"), hooke_clip, 1000, 0.3, true},
    {"hooke t_c=1ms e=0.5", "'normal':'hooke'", "'contact_time':1e-3,'restitution':0.5", hooke_time, 1e-3, 0.5, false},
    {"hooke critical clip", "'normal':'hooke','tail':'clip'", "'stiffness':1000,'damping':'critical'", hooke_critical,
     1000, NAN, true},
    {"hooke [A07] glass balls", "'normal':'hooke'", "'stiffness':7.36,'damping':8.96e-4", hooke_damping, 8.96e-4, NAN,
     false},
    {"hertz e=1", "'normal':'hertz'", HERTZ_PAIR("1"), hertz, 0, 1, false},
    {"hertz e=0.9", "'normal':'hertz'", HERTZ_PAIR("0.9"), hertz, 0, 0.9, false},
    {"hertz e=0.5", "'normal':'hertz'", HERTZ_PAIR("0.5"), hertz, 0, 0.5, false},
    {"hertz e=0.1", "'normal':'hertz'", HERTZ_PAIR("0.1"), hertz, 0, 0.1, false},
    {"hertz e=0.5 clip", "'normal':'hertz','tail':'clip'", HERTZ_PAIR("0.5"), hertz_clip, 0, 0.5, true},
    {"hertz eta=200", "'normal':'hertz'", "'viscosity':200", hertz_viscous, 200, NAN, false},
    {"hunt-crossley e=0.8", "'normal':'hunt-crossley'", HERTZ_PAIR("0.8"), hunt, 0.37315, 0.8, false},
    {"hunt-crossley e=0.5", "'normal':'hunt-crossley'", HERTZ_PAIR("0.5"), hunt, 1.43275, 0.5, false},
    {"hunt-crossley e=0.2", "'normal':'hunt-crossley'", HERTZ_PAIR("0.2"), hunt, 4.9192, 0.2, false},
    {"hunt-crossley p=1 e=0.5", "'normal':'hunt-crossley','exponent':1", HOOKE_PAIR("0.5"), hunt_linear, 1.43275, 0.5,
     false},
    {"hunt-crossley printed", "'normal':'hunt-crossley','lambda':'printed'", HERTZ_PAIR("0.5"), hunt, 0.5625, NAN,
     false},
    {"hysteretic e=0.5", "'normal':'hysteretic'", HOOKE_PAIR("0.5"), hysteretic, 4, 0.5, true},
    {"hysteretic k_ad=0.1k_l", "'normal':'hysteretic'",
     "'stiffness':1000,'unloading_stiffness':4000,'adhesion_stiffness':100", hysteretic_adhesive, 4, 0.44173, false},
    {"hysteretic k_ad=0.2k_l", "'normal':'hysteretic'",
     "'stiffness':1000,'unloading_stiffness':4000,'adhesion_stiffness':200", hysteretic_adhesive, 4, 0.37796, false},
};
enum { NCASE = sizeof cases / sizeof cases[0] };

static tdm_status collide(cpl_verify *v, int i, double time, scn_impact *impact, tdm_error *err) {
  scn_rig rig;
  if (scn_rig_open(&rig, v, time / (double)steps, err,
                   "{'gravity':[0,0,0],'contact':{%s,'tangential':'none'},"
                   "'materials':[{'name':'a','density':2700,'young_modulus':%.17g,'poisson_ratio':%.17g}],"
                   "'pairs':[{'materials':['a','a'],%s}],'particles':["
                   "{'type':'list','material':'a','radius':%.17g,'mass':%.17g,'positions':[[%.17g,0,0]],"
                   "'velocity':[%.17g,0,0]},"
                   "{'type':'list','material':'a','radius':%.17g,'mass':%.17g,'positions':[[%.17g,0,0]]}]}",
                   cases[i].contact, young, poisson, cases[i].pair, radii[0], masses[0], -radii[0], speed, radii[1],
                   masses[1], radii[1]) == TDM_OK)
    scn_rig_impact(&rig, 20 * steps, impact, NULL, NULL, err);
  scn_rig_close(&rig);
  return err->status;
}

static void compare(cpl_verify *v, const char *what, const char *name, double value, double theory) {
  if (!isnan(theory))
    cpl_verify_measure(v, what, name, value / theory - 1, CPL_AT_MOST, limit);
}

/* What [A07] prints for its glass balls, to the digits that it prints: Omega = 522.8 1/s, e_n = 0.905. */
static void glass_balls(cpl_verify *v, const char *name, const scn_impact *impact, double e) {
  cpl_verify_measure(v, "omega_off_printed", name, M_PI / impact->time / 522.8 - 1, CPL_AT_MOST, 1e-3);
  cpl_verify_measure(v, "e_off_printed", name, e - 0.905, CPL_AT_MOST, 5e-4);
}

tdm_status scn_normal_laws(cpl_verify *v, tdm_error *err) {
  for (int i = 0; i < NCASE; i++) {
    expected x = cases[i].theory(cases[i].value, cases[i].e);
    scn_impact impact;
    double scale = isnan(x.time) ? M_PI * sqrt(effective_mass() / 1000) : x.time;
    if (collide(v, i, scale, &impact, err) != TDM_OK)
      return err->status;
    double e = (impact.velocity[1].x - impact.velocity[0].x) / speed;
    compare(v, "restitution_error", cases[i].name, e, x.e);
    compare(v, "contact_time_error", cases[i].name, cases[i].by_force ? impact.push_time : impact.time, x.time);
    compare(v, "overlap_error", cases[i].name, impact.overlap, x.overlap);
    if (cases[i].theory == hooke_damping)
      glass_balls(v, cases[i].name, &impact, e);
  }
  return TDM_OK;
}
