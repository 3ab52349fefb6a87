/* The analytic cases that the granular test set of LAMMPS checks, from their parameters: against closed forms, and
 * against the numbers that are printed there. To add a case: a function, and a row of the table at the end.
 *
 * Where the engine's arm of friction at a plane is R - delta, and LAMMPS's R - delta/2, closed forms take ours; what is
 * printed is then met to delta/R.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/contact/law/theory.h"
#include "dem/step/step.h"
#include "scenarios/dem_physics/impact.h"
#include "scenarios/dem_physics/rig.h"
#include "scenarios/table.h"

#include <math.h>
#include <stdio.h>

static double ball_mass(double radius, double density) {
  return 4.0 / 3 * M_PI * radius * radius * radius * density;
}

/* overlap of a ball that rests under `force` [m] */
static double rest_overlap(double force, double radius, double e_star) {
  return pow(force / (4.0 / 3 * e_star * sqrt(radius)), 2.0 / 3);
}

/* ---- oblique impact on a wall ---- */

static const double d5 = 0.0025, alloy_density = 2700, alloy_young = 70e9, alloy_poisson = 0.33;

/* What is printed for the contact that sticks, with the three forms of the tangential spring that impact.c knows and
 * the arm R: the total form, which can make energy, is the one. */
static void other_forms(cpl_verify *v, const scn_law *law, double normal, double across, const double printed[3]) {
  static const char *const forms[] = {[SCN_SPRING_RESCALED] = "rescaled form",
                                      [SCN_SPRING_INCREMENTAL] = "incremental form",
                                      [SCN_SPRING_TOTAL] = "total form"};
  for (int form = 0; form < 3; form++) {
    scn_law other = *law;
    other.spring = (scn_spring)form, other.full_arm = true;
    scn_outcome o = scn_solve_impact(&other, normal, across, 0);
    cpl_limit_kind kind = form == SCN_SPRING_TOTAL ? CPL_AT_MOST : CPL_NO_LIMIT;
    cpl_verify_measure(v, "reference_v_x", forms[form], o.v / printed[0] - 1, kind, 5e-3);
    cpl_verify_measure(v, "reference_spin", forms[form], -o.w / d5 / printed[2] - 1, kind, 5e-3);
  }
}

static tdm_status oblique(cpl_verify *v, double across, const double printed[3], bool slides, tdm_error *err) {
  const double normal = 2.9876, e = 0.98, mu = 0.092, mass = ball_mass(d5, alloy_density);
  const double e_star = alloy_young / (2 * (1 - alloy_poisson * alloy_poisson));
  const double shear = alloy_young / (4 * (1 + alloy_poisson) * (2 - alloy_poisson));
  const double time = dem_contact_time(mass, d5, e_star, normal);
  scn_rig rig;
  scn_impact impact = {.velocity = {{NAN, NAN, NAN}}, .spin = {{NAN, NAN, NAN}}};
  if (scn_rig_open(&rig, v, time / 4000, err,
                   "{'gravity':[0,0,0],'materials':[{'name':'a','density':%.17g,'young_modulus':%.17g,"
                   "'poisson_ratio':%.17g}],'pairs':[{'materials':['a','a'],'restitution':%.17g,'friction':%.17g}],"
                   "'bodies':[{'name':'wall','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
                   "'particles':[{'type':'list','material':'a','radius':%.17g,'positions':[[0,0,%.17g]],"
                   "'velocity':[%.17g,0,%.17g]}]}",
                   alloy_density, alloy_young, alloy_poisson, e, mu, d5, d5, across, -normal) == TDM_OK)
    scn_rig_impact(&rig, 80000, &impact, NULL, NULL, err);
  scn_rig_close(&rig);
  const double vx = impact.velocity[0].x, vz = impact.velocity[0].z, spin = impact.spin[0].y;
  scn_law law = scn_law_hertz(mass, d5, e_star, shear, scn_beta(e), mu);
  scn_outcome own = scn_solve_impact(&law, normal, across, 0);
  char name[64];
  snprintf(name, sizeof name, "oblique, v_x=%g", across);
  cpl_verify_measure(v, "e_error", name, vz / (e * normal) - 1, CPL_AT_MOST, 1e-4);
  cpl_verify_measure(v, "law_speed_error", name, vx / own.v - 1, CPL_AT_MOST, 1e-4);
  cpl_verify_measure(v, "law_spin_error", name, spin * d5 / -own.w - 1, CPL_AT_MOST, 1e-4);
  if (slides)
    cpl_verify_measure(v, "sliding_speed_error", name, vx / (across - mu * (1 + e) * normal) - 1, CPL_AT_MOST, 1e-4);
  cpl_verify_measure(v, "printed_v_z_error", name, vz / printed[1] - 1, CPL_AT_MOST, 1e-4);
  cpl_verify_measure(v, "printed_v_x_error", name, vx / printed[0] - 1, CPL_AT_MOST, slides ? 1e-4 : 2e-2);
  cpl_verify_measure(v, "printed_spin_error", name, spin / printed[2] - 1, CPL_AT_MOST,
                     slides ? own.overlap / d5 : 5e-2);
  if (!slides)
    other_forms(v, &law, normal, across, printed);
  return err->status;
}

static tdm_status oblique_impacts(cpl_verify *v, tdm_error *err) {
  static const double sliding[] = {1.96265, 2.92784, 544.254}, sticking[] = {0.344379, 2.92784, 155.621};
  return oblique(v, 2.5069, sliding, true, err) == TDM_OK ? oblique(v, 0.5, sticking, false, err) : err->status;
}

/* ---- slide to roll ---- */

/* A ball at 1 m/s on a plane, mu = 0.4, g = 1 m/s2: with the arm a R it rolls at 2.5 a^2/(1 + 2.5 a^2) from 2/(7 mu g)
 * on, if a = 1. */
static tdm_status slide_to_roll(cpl_verify *v, double young, tdm_error *err) {
  const double g = 1, mu = 0.4, v0 = 1, dt = 1e-5, t = 0.75, late = 1.5, mass = ball_mass(d5, alloy_density);
  const double overlap = rest_overlap(mass * g, d5, young / (2 * (1 - alloy_poisson * alloy_poisson)));
  const double a = 1 - overlap / d5, share = 2.5 * a * a, rolls = v0 * share / (1 + share);
  double half = NAN, now[2] = {NAN, NAN}, end[2] = {NAN, NAN}; /* speed, spin */
  scn_rig rig;
  if (scn_rig_open(&rig, v, dt, err,
                   "{'gravity':[0,0,%.17g],'materials':[{'name':'a','density':%.17g,'young_modulus':%.17g,"
                   "'poisson_ratio':%.17g}],'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':%.17g}],"
                   "'bodies':[{'name':'floor','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
                   "'particles':[{'type':'list','material':'a','radius':%.17g,'positions':[[0,0,%.17g]],"
                   "'velocity':[%.17g,0,0]}]}",
                   -g, alloy_density, young, alloy_poisson, mu, d5, d5 - overlap, v0) == TDM_OK &&
      scn_rig_steps(&rig, lround(0.3 / dt), err) == TDM_OK) {
    half = rig.data->state.pace[0].velocity.x;
    if (scn_rig_steps(&rig, lround((t - 0.3) / dt), err) == TDM_OK)
      now[0] = rig.data->state.pace[0].velocity.x, now[1] = rig.data->state.pace[0].spin.y;
    if (scn_rig_steps(&rig, lround((late - t) / dt), err) == TDM_OK)
      end[0] = rig.data->state.pace[0].velocity.x, end[1] = rig.data->state.pace[0].spin.y;
  }
  scn_rig_close(&rig);
  char name[64];
  snprintf(name, sizeof name, "slide to roll, E=%g Pa", young);
  cpl_verify_measure(v, "sliding_speed_error", name, half / (v0 - mu * g * 0.3) - 1, CPL_AT_MOST, 1e-6);
  cpl_verify_measure(v, "rolling_speed_error", name, end[0] / rolls - 1, CPL_AT_MOST, 1e-6);
  cpl_verify_measure(v, "rolling_spin_error", name, end[1] * a * d5 / rolls - 1, CPL_AT_MOST, 1e-6);
  cpl_verify_measure(v, "printed_speed_error", name, now[0] / 0.71426 - 1, CPL_AT_MOST, overlap / d5);
  cpl_verify_measure(v, "printed_spin_error", name, now[1] / 285.74 - 1, CPL_AT_MOST, overlap / d5);
  return err->status;
}

static tdm_status slides_to_roll(cpl_verify *v, tdm_error *err) {
  return slide_to_roll(v, 1e4, err) == TDM_OK ? slide_to_roll(v, 1e7, err) : err->status;
}

/* ---- adhesion: what it takes to pull two spheres apart ---- */

/* the force on the first of two spheres that overlap so, without damping; positive: apart */
static double force_at(scn_rig *rig, double radius, double overlap, tdm_error *err) {
  rig->data->state.sphere[0].position.x = -2 * radius + overlap;
  dem_forces_now(rig->data, false, err);
  return -rig->data->state.push[0].force.x;
}

static tdm_status pull_off(cpl_verify *v, const char *law, tdm_error *err) {
  const double radius = 0.005, w = 0.5, young = 1e7, half = radius / 2;
  const double jkr = dem_jkr_pull(half, w), pull = law[0] == 'j' ? jkr : 2 * M_PI * w * half;
  const double reach = law[0] == 'j' ? dem_jkr_reach(half, young / 2, w) : 0;
  const int n = 10000;
  double touch = NAN, most = 0, inside = NAN, open = NAN;
  scn_rig rig;
  if (scn_rig_open(&rig, v, 1e-6, err,
                   "{'gravity':[0,0,0],'contact':{'tangential':'none','cohesion':'%s'},'skin':1e-3,"
                   "'materials':[{'name':'a','density':2500,'young_modulus':%.17g,'poisson_ratio':0}],"
                   "'pairs':[{'materials':['a','a'],'restitution':1,'adhesion_energy':%.17g}],"
                   "'particles':[{'type':'list','material':'a','radius':%.17g,'positions':[[%.17g,0,0],[0,0,0]]}]}",
                   law, young, w, radius, -2 * radius + 1e-6) == TDM_OK) {
    inside = force_at(&rig, radius, 1e-4, err); /* far inside: Hertz's force less the pull */
    for (int k = n; k > 0; k--)                 /* out until they touch in a point, and, held, on to the reach */
      most = fmax(most, -force_at(&rig, radius, 2e-5 * k / n, err));
    touch = force_at(&rig, radius, 1e-15, err);
    for (int k = 0; k < n && reach > 0; k++)
      most = fmax(most, -force_at(&rig, radius, -reach * k / n, err));
    most = fmax(most, -touch);
    open = force_at(&rig, radius, -1.001 * reach - 1e-12, err);
  }
  scn_rig_close(&rig);
  const double hertz = 4.0 / 3 * (young / 2) * sqrt(half) * pow(1e-4, 1.5);
  cpl_verify_measure(v, "pull_off_error", law, most / pull - 1, CPL_AT_MOST, 1e-6);
  cpl_verify_measure(v, "zero_overlap_over_jkr_pull", law, -touch / jkr, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "zero_overlap_error", law, -touch / pull - (law[0] == 'j' ? 8.0 / 9 : 1), CPL_AT_MOST, 1e-6);
  cpl_verify_measure(v, "open_N", law, open, CPL_AT_MOST, 0);
  if (law[0] == 'd')
    cpl_verify_measure(v, "inside_error", law, inside / (hertz - pull) - 1, CPL_AT_MOST, 1e-9);
  return err->status;
}

static tdm_status pulls_off(cpl_verify *v, tdm_error *err) {
  return pull_off(v, "jkr", err) == TDM_OK ? pull_off(v, "dmt", err) : err->status;
}

/* ---- twisting and rolling decay ---- */

static const double stone = 0.01, stone_density = 2500, stone_g = 10, sunk = 1e-6;

/* A ball that lies on a plane, 1e-4 of its radius deep, with friction 0.5 and these laws. */
static tdm_status lay(scn_rig *rig, cpl_verify *v, double dt, const char *contact, const char *pair, double speed,
                      double spin_y, double spin_z, tdm_error *err) {
  const double e_star = ball_mass(stone, stone_density) * stone_g / (4.0 / 3 * sqrt(stone) * pow(sunk, 1.5));
  return scn_rig_open(rig, v, dt, err,
                      "{'gravity':[0,0,%.17g],'contact':{%s},'materials':[{'name':'a','density':%.17g,"
                      "'young_modulus':%.17g,'poisson_ratio':0}],'pairs':[{'materials':['a','a'],'restitution':0.5,"
                      "'friction':0.5,%s}],"
                      "'bodies':[{'name':'floor','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
                      "'particles':[{'type':'list','material':'a','radius':%.17g,'positions':[[0,0,%.17g]],"
                      "'velocity':[%.17g,0,0],'spin':[0,%.17g,%.17g]}]}",
                      -stone_g, contact, stone_density, 2 * e_star, pair, stone, stone - sunk, speed, spin_y, spin_z);
}

/* w = w0 - 5/2 mu_t g t/R, then rest */
static tdm_status twisting(cpl_verify *v, tdm_error *err) {
  const double mu = 0.02, w0 = 20, rate = 2.5 * mu * stone_g / stone, stops = w0 / rate, dt = 1e-5;
  double half = NAN, end = NAN;
  scn_rig rig;
  if (lay(&rig, v, dt, "'twisting':'constant-torque'", "'twisting_friction':0.02", 0, 0, w0, err) == TDM_OK &&
      scn_rig_steps(&rig, lround(0.5 * stops / dt), err) == TDM_OK) {
    half = rig.data->state.pace[0].spin.z;
    if (scn_rig_steps(&rig, lround(0.6 * stops / dt), err) == TDM_OK)
      end = rig.data->state.pace[0].spin.z;
  }
  scn_rig_close(&rig);
  cpl_verify_measure(v, "spin_error", "twisting decay", half / (0.5 * w0) - 1, CPL_AT_MOST, 1e-6);
  cpl_verify_measure(v, "rest_spin", "twisting decay", end / w0, CPL_AT_MOST, 1e-12);
  return err->status;
}

/* v = v0 - 5/7 mu_r g t while it rolls (with the arm a R: mu_r g a/(0.4 + a^2)), then rest */
static tdm_status rolling(cpl_verify *v, tdm_error *err) {
  const double mu = 0.02, v0 = 0.1, a = 1 - sunk / stone, rate = mu * stone_g * a / (0.4 + a * a), dt = 1e-5;
  const double stops = v0 / rate;
  double half = NAN, end = NAN;
  scn_rig rig;
  if (lay(&rig, v, dt, "'rolling':'constant-torque'", "'rolling_friction':0.02", v0, v0 / (a * stone), 0, err) ==
          TDM_OK &&
      scn_rig_steps(&rig, lround(0.5 * stops / dt), err) == TDM_OK) {
    half = rig.data->state.pace[0].velocity.x;
    if (scn_rig_steps(&rig, lround(0.6 * stops / dt), err) == TDM_OK)
      end = rig.data->state.pace[0].velocity.x;
  }
  scn_rig_close(&rig);
  cpl_verify_measure(v, "speed_error", "rolling decay", half / (0.5 * v0) - 1, CPL_AT_MOST, 1e-3);
  cpl_verify_measure(v, "rest_speed", "rolling decay", end / v0, CPL_AT_MOST, 1e-3);
  return err->status;
}

/* Below its limit the rolling spring swings: W^2 = k_r/(7/5 m R^2), k_r = 2.25 k_n (mu_r R)^2, damping ratio eta. The
 * tangential spring in series with it, k_r/(k_t R^2) as stiff, slows it by half of that share. */
static tdm_status rocking(cpl_verify *v, tdm_error *err) {
  const double mu = 0.02, eta = 0.1, mass = ball_mass(stone, stone_density), k_n = 1.5 * mass * stone_g / sunk;
  const double k_r = 2.25 * k_n * mu * mu * stone * stone, W = sqrt(k_r / (1.4 * mass * stone * stone));
  const double w0 = 0.6 * W * mu * stone * mass * stone_g / k_r, swings = W * sqrt(1 - eta * eta), dt = 1e-5;
  double worst = 0;
  scn_rig rig;
  lay(&rig, v, dt, "'rolling':'spring-dashpot'", "'rolling_friction':0.02,'rolling_damping':0.1", w0 * stone, w0, 0,
      err);
  for (int k = 1; k <= 20 && err->status == TDM_OK; k++)
    if (scn_rig_steps(&rig, lround(0.1 * M_PI / W / dt), err) == TDM_OK) {
      double t = rig.time, x = swings * t;
      double w = w0 * exp(-eta * W * t) * (cos(x) - eta / sqrt(1 - eta * eta) * sin(x));
      scn_worst(&worst, (rig.data->state.pace[0].spin.y - w) / w0);
    }
  scn_rig_close(&rig);
  cpl_verify_measure(v, "spin_error", "rocking", worst, CPL_AT_MOST, 5e-3);
  return err->status;
}

static tdm_status decays(cpl_verify *v, tdm_error *err) {
  return twisting(v, err) == TDM_OK && rolling(v, err) == TDM_OK ? rocking(v, err) : err->status;
}

/* ---- size ratio 20: a small sphere that static friction holds between, and on, two frozen large ones ---- */

static const double big = 5e-3, small = 0.25e-3, k_n = 1e4, k_t = 8235, grain_g = 9.81;

/* the small one at (0, y) between large ones at +-x, axes x and gravity's -y; friction mu */
static tdm_status perch(scn_rig *rig, cpl_verify *v, double dt, double x, double y, double mu, tdm_error *err) {
  return scn_rig_open(rig, v, dt, err,
                      "{'gravity':[0,%.17g,0],'contact':{'normal':'hooke','tangential':'spring'},"
                      "'materials':[{'name':'a','density':2500}],'pairs':[{'materials':['a','a'],'restitution':0.5,"
                      "'stiffness':%.17g,'tangential_stiffness':%.17g,'friction':%.17g}],'particles':["
                      "{'type':'list','material':'a','radius':%.17g,'positions':[[0,%.17g,0]]},"
                      "{'type':'list','material':'a','radius':%.17g,'positions':[[%.17g,0,0],[%.17g,0,0]],"
                      "'fixed':true}]}",
                      -grain_g, k_n, k_t, mu, small, y, big, -x, x);
}

/* Pinched between the two by 1 nm each: the weight hangs on the tangential springs, m g/(2 k_t) deep, and stays there.
 * The load that is there at once costs the springs (W dt)^2/4 of that, W^2 = 2 k_t/m. */
static tdm_status pinched(cpl_verify *v, double dt, long steps, tdm_error *err) {
  const double pinch = 1e-9, mass = ball_mass(small, 2500), lost = 2 * k_t / mass * dt * dt / 4;
  double middle = NAN, end = NAN, spin = NAN;
  scn_rig rig;
  if (perch(&rig, v, dt, big + small - pinch, 0, 0.5, err) == TDM_OK && scn_rig_steps(&rig, steps, err) == TDM_OK) {
    middle = rig.data->state.sphere[0].position.y;
    if (scn_rig_steps(&rig, steps, err) == TDM_OK)
      end = rig.data->state.sphere[0].position.y, spin = tdm_norm(rig.data->state.pace[0].spin);
  }
  scn_rig_close(&rig);
  char name[64];
  snprintf(name, sizeof name, "pinched, dt=%g s", dt);
  cpl_verify_measure(v, "sag_error", name, end / (-mass * grain_g / (2 * k_t)) - 1, CPL_AT_MOST, 1.1 * lost);
  cpl_verify_measure(v, "creep_m", name, end - middle, CPL_AT_MOST, 1e-18);
  cpl_verify_measure(v, "spin", name, spin, CPL_AT_MOST, 1e-12);
  return err->status;
}

/* With a tenth of that friction, mu k_n delta is less than half of the weight: once it slides it falls with g less the
 * friction. */
static tdm_status slips(cpl_verify *v, tdm_error *err) {
  const double pinch = 1e-9, mu = 0.05, mass = ball_mass(small, 2500), a = grain_g - 2 * mu * k_n * pinch / mass;
  double begin = NAN, end = NAN, dt = 1e-7;
  scn_rig rig;
  if (perch(&rig, v, dt, big + small - pinch, 0, mu, err) == TDM_OK && scn_rig_steps(&rig, 500, err) == TDM_OK) {
    begin = rig.data->state.pace[0].velocity.y;
    if (scn_rig_steps(&rig, 1500, err) == TDM_OK)
      end = rig.data->state.pace[0].velocity.y;
  }
  scn_rig_close(&rig);
  cpl_verify_measure(v, "fall_error", "pinched, mu=0.05", (begin - end) / (1500 * dt) / a - 1, CPL_AT_MOST, 5e-3);
  return err->status;
}

/* In the saddle of the two, which touch: it is laid there and stays. */
static tdm_status in_the_saddle(cpl_verify *v, tdm_error *err) {
  const double both = big + small, y = sqrt(both * both - big * big);
  double middle = NAN, end = NAN, speed = NAN;
  scn_rig rig;
  if (perch(&rig, v, 1e-6, big, y, 0.5, err) == TDM_OK && scn_rig_steps(&rig, 50000, err) == TDM_OK) {
    middle = rig.data->state.sphere[0].position.y;
    if (scn_rig_steps(&rig, 50000, err) == TDM_OK)
      end = rig.data->state.sphere[0].position.y, speed = tdm_norm(rig.data->state.pace[0].velocity);
  }
  scn_rig_close(&rig);
  cpl_verify_measure(v, "sag_m", "in the saddle", end - y, CPL_AT_MOST, 1e-9);
  cpl_verify_measure(v, "creep_m", "in the saddle", end - middle, CPL_AT_MOST, 1e-18);
  cpl_verify_measure(v, "speed", "in the saddle", speed, CPL_AT_MOST, 1e-12);
  return err->status;
}

static tdm_status size_ratio(cpl_verify *v, tdm_error *err) {
  if (pinched(v, 1e-6, 50000, err) == TDM_OK && pinched(v, 1e-7, 20000, err) == TDM_OK && slips(v, err) == TDM_OK)
    in_the_saddle(v, err);
  return err->status;
}

tdm_status scn_lammps(cpl_verify *v, tdm_error *err) {
  static tdm_status (*const cases[])(cpl_verify *, tdm_error *) = {oblique_impacts, slides_to_roll, pulls_off, decays,
                                                                   size_ratio};
  for (size_t k = 0; k < sizeof cases / sizeof cases[0] && err->status == TDM_OK; k++)
    cases[k](v, err);
  return err->status;
}
