/* What no contact may change: energy without damping and friction, momentum and angular momentum always. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/dem_physics/rig.h"
#include "scenarios/table.h"

#include <math.h>
#include <stdio.h>

#define MATERIAL "'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}]"

static const struct {
  const char *name, *keys;
  double round_off; /* relative, after 3000 steps */
} integrators[] = {
    {"verlet", "'integrator':'verlet'", 1e-13},
    {"leap-frog", "'integrator':'leap-frog'", 1e-13},
    /* velocities are differences of positions over dt: each step rounds by 1e-16 x/(v dt) = 1e-12 here */
    {"stormer-verlet", "'integrator':'stormer-verlet'", 5e-12},
    /* contacts of a smaller effective mass are the fast ones */
    {"multi-step", "'integrator':'multi-step','multi_step':{'substeps':4,'mass':0.15}", 1e-13},
};
enum { NINTEGRATOR = sizeof integrators / sizeof integrators[0] };

/* ---- energy: three spheres between six walls, e = 1, no friction; a million steps of 1/500 of the contact ---- */

static tdm_status energy(cpl_verify *v, const char *name, const char *normal, const char *pair, double time,
                         cpl_limit_kind kind, tdm_error *err) {
  const long total = 1000000;
  scn_rig rig;
  double start = 0, worst = 0;
  long impacts = 0, before = 0, instants = 0;
  if (scn_rig_open(&rig, v, time / 500, err,
                   "{'gravity':[0,0,0],'contact':{'normal':'%s','tangential':'none'}," MATERIAL
                   ",'pairs':[{'materials':['a','a'],'restitution':1%s}],"
                   "'bodies':[{'name':'b','material':'a','shapes':[{'type':'box','side':'inside',"
                   "'size':[0.16,0.16,0.16]}]}],"
                   "'particles':[{'type':'list','material':'a','radius':0.02,'positions':[[-0.05,0,0]],"
                   "'velocity':[0.9,0.2,0.1]},{'type':'list','material':'a','radius':0.015,'positions':"
                   "[[0.01,0.005,0]],'velocity':[-0.2,0.5,-0.7]},{'type':'list','material':'a','radius':0.02,"
                   "'positions':[[0.05,0.01,0.04]],'velocity':[0.3,-0.6,0.2]}]}",
                   normal, pair) == TDM_OK)
    start = scn_rig_kinetic(&rig);
  for (long k = 0; k < total && err->status == TDM_OK; k++) {
    scn_rig_steps(&rig, 1, err);
    long now = rig.data->state.ncontact;
    impacts += now > before;
    before = now;
    if (now > 0 || k % 50)
      continue;
    scn_worst(&worst, scn_rig_kinetic(&rig) / start - 1);
    instants++;
  }
  scn_rig_close(&rig);
  cpl_verify_measure(v, "energy_change", name, instants > 1000 ? worst : NAN, kind, 1e-6);
  cpl_verify_measure(v, "impacts", name, (double)impacts, CPL_AT_LEAST, 50);
  return err->status;
}

static tdm_status energies(cpl_verify *v, tdm_error *err) {
  /* the shortest contact: the smallest sphere with a wall at the speed that holds all the energy */
  double mass = 4.0 / 3 * M_PI * pow(0.015, 3) * 1000, e_star = 1e7 / (2 * (1 - 0.0625));
  double hertz = 2.868 * pow(mass * mass / (0.015 * e_star * e_star * 1.5), 0.2), hooke = M_PI * sqrt(mass / 5e4);
  if (energy(v, "hertz", "hertz", "", hertz, CPL_AT_MOST, err) != TDM_OK)
    return err->status;
  /* a linear force begins with a bend: no step of second order that does not look for it is better than (omega dt)^2 =
   * 4e-5 an impact */
  return energy(v, "hooke", "hooke", ",'stiffness':5e4", hooke, CPL_NO_LIMIT, err);
}

/* ---- momentum: 80 spheres that collide in the middle, with friction and damping, far from walls ---- */

typedef struct {
  tdm_vec3 linear, angular;
  double linear_sum, angular_sum; /* of sizes */
} momentum;

static momentum momentum_of(const dem_data *d) {
  momentum p = {0};
  for (int i = 0; i < d->state.nparticle; i++) {
    tdm_vec3 linear = tdm_scale(d->state.mass[i], d->state.pace[i].velocity),
             orbit = tdm_cross(d->state.sphere[i].position, linear);
    tdm_vec3 spin = tdm_scale(0.4 * d->state.mass[i] * d->state.sphere[i].radius * d->state.sphere[i].radius,
                              d->state.pace[i].spin);
    p.linear = tdm_add(p.linear, linear);
    p.angular = tdm_add(p.angular, tdm_add(orbit, spin));
    p.linear_sum += tdm_norm(linear);
    p.angular_sum += tdm_norm(orbit) + tdm_norm(spin);
  }
  return p;
}

static tdm_status momenta(cpl_verify *v, int k, tdm_error *err) {
  scn_rig rig;
  momentum begin = {0}, end = {0};
  long most = 0;
  if (scn_rig_open(&rig, v, 1e-4, err,
                   "{'gravity':[0,0,0]," MATERIAL ",'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.4}],"
                   "'particles':[{'type':'random','material':'a','count':80,'radius':[0.03,0.05],"
                   "'region':{'min':[-0.3,-0.3,-0.3],'max':[0.3,0.3,0.3]}}],%s}",
                   integrators[k].keys) == TDM_OK) {
    dem_data *d = rig.data;
    for (int i = 0; i < d->state.nparticle; i++) {
      d->state.pace[i].velocity = tdm_add(tdm_scale(-5, d->state.sphere[i].position), tdm_v3(0.3, -0.2, 0.1));
      d->state.pace[i].spin = tdm_v3(sin(i), cos(3 * i), 2 * sin(7 * i));
    }
    d->state.restart = true;
    begin = momentum_of(d);
    for (int s = 0; s < 3000 && scn_rig_steps(&rig, 1, err) == TDM_OK; s++)
      most = d->state.ncontact > most ? d->state.ncontact : most;
    end = momentum_of(d);
  }
  scn_rig_close(&rig);
  const char *name = integrators[k].name;
  cpl_verify_measure(v, "momentum_change", name, tdm_norm(tdm_sub(end.linear, begin.linear)) / begin.linear_sum,
                     CPL_AT_MOST, integrators[k].round_off);
  cpl_verify_measure(v, "angular_momentum_change", name,
                     tdm_norm(tdm_sub(end.angular, begin.angular)) / begin.angular_sum, CPL_AT_MOST,
                     integrators[k].round_off);
  cpl_verify_measure(v, "contacts", name, (double)most, CPL_AT_LEAST, 50);
  return err->status;
}

tdm_status scn_conservation(cpl_verify *v, tdm_error *err) {
  for (int k = 0; k < NINTEGRATOR; k++)
    if (momenta(v, k, err) != TDM_OK)
      return err->status;
  return energies(v, err);
}
