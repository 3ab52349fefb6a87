/* Order of convergence of each integrator on contacts that never open and have no damping.
 *
 * hooke: a sphere on a floor, pulled by gravity: an oscillator, z = z_0 + A cos(omega t), so the error is known.
 * hertz: a sphere on a sphere on a floor: the order from the differences between dt, dt/2 and dt/4.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/dem_physics/rig.h"
#include "scenarios/table.h"

#include <math.h>
#include <stdio.h>

static const struct {
  const char *name, *keys;
} integrators[] = {
    {"verlet", "'integrator':'verlet'"},
    {"leap-frog", "'integrator':'leap-frog'"},
    {"stormer-verlet", "'integrator':'stormer-verlet'"},
    /* fast are the contacts of an effective mass below `mass`: the upper sphere's, and hooke's only one */
    {"multi-step", "'integrator':'multi-step','multi_step':{'substeps':4,'mass':1}"},
};
enum { NINTEGRATOR = sizeof integrators / sizeof integrators[0], LEVELS = 4 };

/* ---- hooke: against the exact solution ---- */

static tdm_status hooke(cpl_verify *v, int k, double *error, double dt, long steps, tdm_error *err) {
  const double radius = 0.05, mass = 0.5, stiffness = 1e5, gravity = 500; /* overlap at rest 2.5 mm */
  double omega = sqrt(stiffness / mass), rest = radius - mass * gravity / stiffness, a = 1e-3;
  scn_rig rig;
  *error = 0;
  if (scn_rig_open(&rig, v, dt, err,
                   "{'gravity':[0,0,%.17g],'contact':{'normal':'hooke','tangential':'none'},"
                   "'materials':[{'name':'a','density':1000}],"
                   "'pairs':[{'materials':['a','a'],'stiffness':%.17g,'damping':0}],"
                   "'bodies':[{'name':'floor','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
                   "'particles':[{'type':'list','material':'a','radius':%.17g,'mass':%.17g,'positions':[[0,0,%.17g]]}],"
                   "%s}",
                   -gravity, stiffness, radius, mass, rest + a, integrators[k].keys) == TDM_OK)
    for (long s = 1; s <= steps && scn_rig_steps(&rig, 1, err) == TDM_OK; s++)
      scn_worst(error, (rig.data->state.sphere[0].position.z - rest - a * cos(omega * (double)s * dt)) / a);
  scn_rig_close(&rig);
  return err->status;
}

/* ---- hertz: from differences ---- */

static tdm_status hertz(cpl_verify *v, int k, double z[2], double dt, long steps, tdm_error *err) {
  scn_rig rig;
  if (scn_rig_open(&rig, v, dt, err,
                   "{'gravity':[0,0,-500],'contact':{'tangential':'none'},"
                   "'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],"
                   "'pairs':[{'materials':['a','a'],'restitution':1}],"
                   "'bodies':[{'name':'floor','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
                   "'particles':[{'type':'list','material':'a','radius':0.1,'positions':[[0,0,0.098]]},"
                   "{'type':'list','material':'a','radius':0.05,'positions':[[0,0,0.245]]}],%s}",
                   integrators[k].keys) == TDM_OK &&
      scn_rig_steps(&rig, steps, err) == TDM_OK) {
    z[0] = rig.data->state.sphere[0].position.z, z[1] = rig.data->state.sphere[1].position.z;
    if (rig.data->state.ncontact != 2)
      tdm_fail(err, TDM_ERR_NUMERIC, NULL, "the column of two spheres has come apart");
  }
  scn_rig_close(&rig);
  return err->status;
}

static tdm_status orders(cpl_verify *v, int k, FILE *f, tdm_error *err) {
  const double coarse = 4e-5;
  double error[LEVELS], z[LEVELS][2], off = 0;
  char name[64];
  for (int level = 0; level < LEVELS; level++) {
    double dt = coarse / (double)(1 << level);
    if (hooke(v, k, &error[level], dt, 200L << level, err) != TDM_OK ||
        hertz(v, k, z[level], dt, 200L << level, err) != TDM_OK)
      return err->status;
    fprintf(f, "%.9g,%.9g,%d\n", dt, error[level], k);
  }
  fputs("\n\n", f);
  snprintf(name, sizeof name, "%s hooke", integrators[k].name);
  cpl_verify_measure(v, "error_at_4e-5s", name, error[0], CPL_NO_LIMIT, 0);
  for (int level = 0; level + 1 < LEVELS; level++)
    scn_worst(&off, log2(error[level] / error[level + 1]) - 2);
  cpl_verify_measure(v, "order_off_2", name, off, CPL_AT_MOST, 0.01);
  snprintf(name, sizeof name, "%s hertz", integrators[k].name);
  for (int i = 0; i < 2; i++) {
    off = 0;
    for (int level = 0; level + 2 < LEVELS; level++)
      scn_worst(&off, log2(fabs((z[level][i] - z[level + 1][i]) / (z[level + 1][i] - z[level + 2][i]))) - 2);
    cpl_verify_measure(v, i ? "order_off_2_upper" : "order_off_2_lower", name, off, CPL_AT_MOST, 0.05);
  }
  return TDM_OK;
}

tdm_status scn_convergence(cpl_verify *v, tdm_error *err) {
  FILE *f = scn_curve(v, "error.csv", err);
  if (!f)
    return err->status;
  fputs("dt [s],error,integrator\n", f);
  for (int k = 0; k < NINTEGRATOR && err->status == TDM_OK; k++)
    orders(v, k, f, err);
  fclose(f);
  if (err->status != TDM_OK)
    return err->status;
  static const tdm_curve curves[] = {{"error.csv", "1:($3==0?$2:1/0)", "verlet", "points pt 6 ps 2"},
                                     {"error.csv", "1:($3==1?$2:1/0)", "leap-frog", "points pt 2 ps 1.5"},
                                     {"error.csv", "1:($3==2?$2:1/0)", "stormer-verlet", "points pt 1 ps 1.5"},
                                     {"error.csv", "1:($3==3?$2:1/0)", "multi-step, 4 substeps", "points pt 4 ps 1.5"},
                                     {"error.csv", "1:(0.05*($1/4e-5)**2)", "order 2", "lines dt 2 lc rgb 'black'"}};
  const tdm_plot plot = {
      .title = "Undamped linear contact: largest error of the position",
      .xlabel = "dt [s]",
      .ylabel = "error/amplitude",
      .setup = "set logscale xy\nset format '%g'\nset key bottom right\n",
      .ncurve = 5,
      .curve = curves,
  };
  cpl_verify_plot(v, "error", 1, &plot);
  return TDM_OK;
}
