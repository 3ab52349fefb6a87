/* A sphere on a plane: sliding to rolling, slopes, a bouncing ball, and two published runs of another code. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/state/data.h"
#include "scenarios/dem_physics/rig.h"
#include "scenarios/table.h"

#include <math.h>
#include <stdio.h>

static const double radius = 0.01, density = 2500, young = 1e10, poisson = 0.3, mu = 0.2, g = 10;

/* A sphere that lies on the plane z = 0 as deep as it is pressed, gravity along (x, z). */
static tdm_status lay(scn_rig *rig, cpl_verify *v, double dt, double gx, double gz, double speed, tdm_error *err) {
  double mass = 4.0 / 3 * M_PI * pow(radius, 3) * density, e_star = young / (2 * (1 - poisson * poisson));
  double overlap = pow(mass * gz / (4.0 / 3 * e_star * sqrt(radius)), 2.0 / 3);
  return scn_rig_open(rig, v, dt, err,
                      "{'gravity':[%.17g,0,%.17g],"
                      "'materials':[{'name':'a','density':%.17g,'young_modulus':%.17g,'poisson_ratio':%.17g}],"
                      "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':%.17g}],"
                      "'bodies':[{'name':'floor','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
                      "'particles':[{'type':'list','material':'a','radius':%.17g,'positions':[[0,0,%.17g]],"
                      "'velocity':[%.17g,0,0]}]}",
                      gx, -gz, density, young, poisson, mu, radius, radius - overlap, speed);
}

/* ---- sliding to rolling: v = 5/7 v0 after t = 2 v0/(7 mu g) and x = 12 v0^2/(49 mu g) ---- */

static tdm_status sliding_to_rolling(cpl_verify *v, tdm_error *err) {
  const double v0 = 0.1, t = 2 * v0 / (7 * mu * g);
  const long n = 10000;
  scn_rig rig;
  double x = NAN, half = NAN, end = NAN, spin = NAN;
  if (lay(&rig, v, t / (double)n, 0, g, v0, err) == TDM_OK && scn_rig_steps(&rig, n / 2, err) == TDM_OK) {
    half = rig.data->state.pace[0].velocity.x;
    if (scn_rig_steps(&rig, n / 2, err) == TDM_OK) {
      x = rig.data->state.sphere[0].position.x;
      scn_rig_steps(&rig, n, err);
      end = rig.data->state.pace[0].velocity.x, spin = rig.data->state.pace[0].spin.y;
    }
  }
  scn_rig_close(&rig);
  cpl_verify_measure(v, "speed_half_way_error", "sliding to rolling", half / (v0 - 0.5 * mu * g * t) - 1, CPL_AT_MOST,
                     1e-6);
  cpl_verify_measure(v, "distance_error", "sliding to rolling", x / (12 * v0 * v0 / (49 * mu * g)) - 1, CPL_AT_MOST,
                     1e-6);
  cpl_verify_measure(v, "speed_error", "sliding to rolling", end / (5.0 / 7 * v0) - 1, CPL_AT_MOST, 1e-4);
  cpl_verify_measure(v, "spin_error", "sliding to rolling", spin * radius / (5.0 / 7 * v0) - 1, CPL_AT_MOST, 1e-4);
  return err->status;
}

/* ---- slopes: a sphere rolls while tan <= 3.5 mu, a = 5/7 g sin; else it slides, a = g (sin - mu cos) ---- */

static tdm_status slope(cpl_verify *v, double tangent, tdm_error *err) {
  const double dt = 2e-6, t = 0.02, a = atan(tangent);
  const long n = (long)(t / dt);
  double begin = 0, end = 0;
  scn_rig rig;
  char name[64];
  if (lay(&rig, v, dt, g * sin(a), g * cos(a), 0, err) == TDM_OK && scn_rig_steps(&rig, n, err) == TDM_OK) {
    begin = rig.data->state.pace[0].velocity.x;
    scn_rig_steps(&rig, n, err);
    end = rig.data->state.pace[0].velocity.x;
  }
  scn_rig_close(&rig);
  double theory = tangent <= 3.5 * mu ? 5.0 / 7 * g * sin(a) : g * (sin(a) - mu * cos(a));
  snprintf(name, sizeof name, "slope %g, %s", tangent, tangent <= 3.5 * mu ? "rolls" : "slides");
  cpl_verify_measure(v, "acceleration_error", name, (end - begin) / t / theory - 1, CPL_AT_MOST, 1e-4);
  return err->status;
}

/* ---- bouncing ball: rebound k reaches e^(2k) h0 at sqrt(2 h0/g) (1 + 2 e + ... + 2 e^(k-1) + e^k) ---- */

/* The step is long in free flight, where velocity Verlet is exact, and short near the floor. */
static tdm_status bouncing(cpl_verify *v, double e, tdm_error *err) {
  enum { BOUNCES = 5 };
  const double h0 = 0.1, flight = 2e-5, contact = 2e-8;
  double height = 0, time = 0, sum = 1, before = 0;
  int bounces = 0;
  char name[64];
  scn_rig rig;
  scn_rig_open(&rig, v, flight, err,
               "{'gravity':[0,0,%.17g],'materials':[{'name':'a','density':2500,'young_modulus':1e13,"
               "'poisson_ratio':0.3}],'pairs':[{'materials':['a','a'],'restitution':%.17g}],"
               "'contact':{'tangential':'none'},"
               "'bodies':[{'name':'floor','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
               "'particles':[{'type':'list','material':'a','radius':%.17g,'positions':[[0,0,%.17g]]}]}",
               -g, e, radius, radius + h0);
  while (err->status == TDM_OK && bounces < BOUNCES + 1 && scn_rig_steps(&rig, 1, err) == TDM_OK) {
    double w = rig.data->state.pace[0].velocity.z, z = rig.data->state.sphere[0].position.z - radius;
    if (w > 0 && before <= 0) { /* turned in the contact */
      bounces++;
      sum += pow(e, bounces) + (bounces > 1 ? pow(e, bounces - 1) : 0);
    } else if (w <= 0 && before > 0) { /* the top was w/g ago */
      scn_worst(&height, (z + 0.5 * w * w / g) / (h0 * pow(e, 2.0 * bounces)) - 1);
      scn_worst(&time, (rig.time + w / g) / (sqrt(2 * h0 / g) * sum) - 1);
      if (bounces == BOUNCES)
        break;
    }
    before = w;
    rig.dt = z > 2 * flight * (fabs(w) + g * flight) ? flight : contact;
  }
  scn_rig_close(&rig);
  snprintf(name, sizeof name, "%d bounces, e=%g", BOUNCES, e);
  cpl_verify_measure(v, "height_error", name, bounces == BOUNCES ? height : NAN, CPL_AT_MOST, 2e-3);
  cpl_verify_measure(v, "time_error", name, bounces == BOUNCES ? time : NAN, CPL_AT_MOST, 2e-3);
  return err->status;
}

/* ---- MercuryDPM's self tests OSHertz and OSMindlin: materials M1 and steel of Thornton, Cummins & Cleary (2013) ----
 */

/* R 1 mm, 1 m/s, gap 10 um, e = 0.4, E* as there; state at 60.5 us. The code's 58 steps a contact leave e = 0.4011. */
static tdm_status os_hertz(cpl_verify *v, tdm_error *err) {
  const double coarse = 5e-7, e_star = 1036729857.8199053;
  for (int fine = 1; fine <= 100; fine *= 100) {
    scn_rig rig;
    double z = NAN, speed = NAN;
    if (scn_rig_open(&rig, v, coarse / fine, err,
                     "{'gravity':[0,0,0],'materials':["
                     "{'name':'a','density':2500,'young_modulus':%.17g,'poisson_ratio':0},"
                     "{'name':'w','density':2500,'young_modulus':1e22,'poisson_ratio':0}],"
                     "'pairs':[{'materials':['a','w'],'restitution':0.4}],'contact':{'tangential':'none'},"
                     "'bodies':[{'name':'floor','material':'w','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
                     "'particles':[{'type':'list','material':'a','radius':0.001,'positions':[[0,0,0.00101]],"
                     "'velocity':[0,0,-1]}]}",
                     e_star) == TDM_OK &&
        scn_rig_steps(&rig, 121L * fine, err) == TDM_OK)
      z = rig.data->state.sphere[0].position.z, speed = rig.data->state.pace[0].velocity.z;
    scn_rig_close(&rig);
    const char *name = fine > 1 ? "OSHertz dt=5e-9" : "OSHertz dt=5e-7";
    if (fine == 1) {
      cpl_verify_measure(v, "published_z_error", name, z / 0.00100724021886788 - 1, CPL_AT_MOST, 1e-4);
      cpl_verify_measure(v, "published_speed_error", name, speed / 0.40107538074925 - 1, CPL_AT_MOST, 2e-3);
    } else {
      cpl_verify_measure(v, "exact_speed_error", name, speed / 0.4 - 1, CPL_AT_MOST, 1e-4);
    }
  }
  return err->status;
}

/* R 1 mm, g = (5, 0, -5), mu = 0.2: slides, v = 4 t, omega = 2500 t; state at 5.0005 ms. Only friction matters. */
static tdm_status os_mindlin(cpl_verify *v, tdm_error *err) {
  const double dt = 5e-7, t = 5.0005e-3, e_star = 1e12, mass = 4.0 / 3 * M_PI * 1e-9 * 7850;
  double overlap = pow(5 * mass / (4.0 / 3 * e_star * sqrt(1e-3)), 2.0 / 3), speed = NAN, spin = NAN;
  scn_rig rig;
  if (scn_rig_open(&rig, v, dt, err,
                   "{'gravity':[5,0,-5],'materials':["
                   "{'name':'a','density':7850,'young_modulus':1e12,'poisson_ratio':0},"
                   "{'name':'w','density':2500,'young_modulus':1e22,'poisson_ratio':0}],"
                   "'pairs':[{'materials':['a','w'],'restitution':0.4,'friction':0.2}],"
                   "'bodies':[{'name':'floor','material':'w','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
                   "'particles':[{'type':'list','material':'a','radius':0.001,'positions':[[0,0,%.17g]]}]}",
                   0.001 - overlap) == TDM_OK &&
      scn_rig_steps(&rig, lround(t / dt), err) == TDM_OK)
    speed = rig.data->state.pace[0].velocity.x, spin = rig.data->state.pace[0].spin.y;
  scn_rig_close(&rig);
  cpl_verify_measure(v, "exact_speed_error", "OSMindlin", speed / (4 * t) - 1, CPL_AT_MOST, 3e-4);
  cpl_verify_measure(v, "published_speed_error", "OSMindlin", speed / 0.0200031141978808 - 1, CPL_AT_MOST, 1e-4);
  cpl_verify_measure(v, "exact_spin_error", "OSMindlin", spin / (2500 * t) - 1, CPL_AT_MOST, 1e-3);
  cpl_verify_measure(v, "published_spin_error", "OSMindlin", spin / 12.4983210042401 - 1, CPL_AT_MOST, 1e-4);
  return err->status;
}

tdm_status scn_rolling(cpl_verify *v, tdm_error *err) {
  static const double slopes[] = {0.3, 0.65, 0.75, 1};
  sliding_to_rolling(v, err);
  for (size_t i = 0; i < sizeof slopes / sizeof slopes[0] && err->status == TDM_OK; i++)
    slope(v, slopes[i], err);
  for (int i = 0; i < 2 && err->status == TDM_OK; i++)
    bouncing(v, i ? 0.6 : 0.9, err);
  if (err->status == TDM_OK && os_hertz(v, err) == TDM_OK)
    os_mindlin(v, err);
  return err->status;
}
