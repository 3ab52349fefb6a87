/* A sphere that meets a rigid plane: see plane_impact.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/dem_physics/plane_impact.h"

#include <math.h>

const scn_elastic scn_materials[] = {
    [SCN_GLASS] = {"glass", 4.8e10, 0.20, 2800},
    [SCN_LIMESTONE] = {"limestone", 2.0e10, 0.25, 2500},
    [SCN_MG_ALLOY] = {"magnesium alloy", 4.0e10, 0.35, 1800},
    [SCN_AL_ALLOY_2] = {"aluminium alloy", 7.0e10, 0.30, 2699}, /* as test 2 has it */
    [SCN_OXIDE] = {"aluminium oxide", 3.8e11, 0.23, 4000},
    [SCN_IRON] = {"cast iron", 1.0e11, 0.25, 7000},
    [SCN_AL_ALLOY] = {"aluminium alloy", 7.0e10, 0.33, 2700},
    [SCN_STEEL] = {"steel", 2.08e11, 0.30, 7850},
    [SCN_POLYETHYLENE] = {"polyethylene", 1e9, 0.30, 1400},
    [SCN_NYLON] = {"nylon", 2.5e9, 0.40, 1000},
    [SCN_COPPER] = {"copper", 1.2e11, 0.35, 8900},
};

static const double rigid = 1e10; /* how much stiffer a rigid plane is */

double scn_sphere_mass(scn_material k, double radius) {
  return 4.0 / 3 * M_PI * radius * radius * radius * scn_materials[k].density;
}

double scn_plate_modulus(scn_material k) {
  double nu = scn_materials[k].poisson;
  return scn_materials[k].young / (1 - nu * nu);
}

double scn_hertz_time(double mass, double radius, double e_star, double speed) {
  return 2.8682656992 * pow(mass * mass / (radius * e_star * e_star * speed), 0.2);
}

double scn_plane_time(const scn_plane_impact *c) {
  return scn_hertz_time(scn_sphere_mass(c->of, c->radius), c->radius, scn_plate_modulus(c->of), c->normal);
}

tdm_status scn_plane_run(cpl_verify *v, const scn_plane_impact *c, scn_impact *impact, scn_impact_watch *watch,
                         void *context, tdm_error *err) {
  scn_rig rig;
  double young = scn_materials[c->of].young, nu = scn_materials[c->of].poisson;
  if (scn_rig_open(&rig, v, scn_plane_time(c) / (double)SCN_IMPACT_STEPS, err,
                   "{'gravity':[0,0,0],'contact':{'tail':'%s'},'materials':["
                   "{'name':'a','density':%.17g,'young_modulus':%.17g,'poisson_ratio':%.17g},"
                   "{'name':'w','density':1000,'young_modulus':%.17g,'poisson_ratio':%.17g}],"
                   "'pairs':[{'materials':['a','w'],'restitution':%.17g,'friction':%.17g}],"
                   "'bodies':[{'name':'wall','material':'w','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
                   "'particles':[{'type':'list','material':'a','radius':%.17g,'positions':[[0,0,%.17g]],"
                   "'velocity':[%.17g,0,%.17g],'spin':[0,%.17g,0]}]}",
                   c->clip ? "clip" : "keep", scn_materials[c->of].density, young, nu, rigid * young, nu, c->e, c->mu,
                   c->radius, c->radius, c->across, -c->normal, -c->spin) == TDM_OK)
    scn_rig_impact(&rig, 20 * SCN_IMPACT_STEPS, impact, watch, context, err);
  scn_rig_close(&rig);
  return err->status;
}

tdm_status scn_plane_simulate(cpl_verify *v, const scn_plane_impact *c, scn_rebound *out, tdm_error *err) {
  *out = (scn_rebound){NAN, NAN, NAN, NAN};
  scn_impact impact;
  if (scn_plane_run(v, c, &impact, NULL, NULL, err) == TDM_OK) {
    *out = (scn_rebound){impact.velocity[0].z, impact.velocity[0].x, -impact.spin[0].y, 0};
    out->slip = out->across + c->radius * out->spin;
  }
  return err->status;
}

scn_law scn_plane_law(const scn_plane_impact *c) {
  double nu = scn_materials[c->of].poisson, shear = scn_materials[c->of].young / (2 * (1 + nu)) / (2 - nu);
  double beta = c->clip ? scn_beta_clipped(c->e) : scn_beta(c->e);
  scn_law law =
      scn_law_hertz(scn_sphere_mass(c->of, c->radius), c->radius, scn_plate_modulus(c->of), shear, beta, c->mu);
  law.clip = c->clip;
  return law;
}

scn_rebound scn_plane_solve_with(const scn_plane_impact *c, const scn_law *law) {
  scn_outcome o = scn_solve_impact(law, c->normal, c->across, c->radius * c->spin);
  return (scn_rebound){o.normal, o.v, o.w / c->radius, o.v + o.w};
}

scn_rebound scn_plane_solve(const scn_plane_impact *c) {
  scn_law law = scn_plane_law(c);
  return scn_plane_solve_with(c, &law);
}

scn_rebound scn_plane_solve_form(const scn_plane_impact *c, scn_spring spring) {
  scn_law law = scn_plane_law(c);
  law.spring = spring, law.full_arm = true, law.d = 0;
  return scn_plane_solve_with(c, &law);
}
