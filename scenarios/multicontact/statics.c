/* Forces at rest: [G21]'s rubber sphere between two plates (Fig. 4) against closed forms, and the square lattice that
 * repeats against Eq. 11 (Fig. 10). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/multicontact/cases.h"
#include "scenarios/table.h"

#include <math.h>
#include <stdio.h>

static const double radius = 0.01;

static double hertz(const scn_soft *of, double both, double overlap) {
  return 4.0 / 3 * of->young / (2 * (1 - of->poisson * of->poisson)) * sqrt(both * overlap) * overlap;
}

/* ---- between plates ---- */

enum { DEPTHS = 40 };

/* The force on a plate when both rigid plates are at `overlap`. */
static tdm_status press(cpl_verify *v, int law, double factor, double overlap, double *force, tdm_error *err) {
  const scn_soft *of = &scn_softs[SCN_RUBBER];
  double gap = 2 * (radius - overlap);
  scn_rig rig;
  if (scn_rig_open(&rig, v, 1e-7, err,
                   "{'gravity':[0,0,0],'materials':[{'name':'a','density':%.17g,'young_modulus':%.17g,"
                   "'poisson_ratio':%.17g},{'name':'w','density':1e4,'young_modulus':1e30,'poisson_ratio':0}],"
                   "'pairs':[{'materials':['a','w'],'restitution':1%s}],'contact':{'tangential':'none'%s%s},'bodies':["
                   "{'name':'below','material':'w','shapes':[{'type':'plane','normal':[0,0,1]}]},{'name':'above',"
                   "'material':'w','shapes':[{'type':'plane','normal':[0,0,-1],'point':[0,0,%.17g]}]}],'particles':["
                   "{'type':'list','material':'a','radius':0.01,'positions':[[0,0,%.17g]]}]}",
                   of->density, of->young, of->poisson, scn_multi_pair(law, factor), scn_multi_contact(law),
                   law == SCN_STRAIN ? ",'first_forces':'hertz','tolerance':1e-14,'iterations':1000" : "", gap,
                   gap / 2) == TDM_OK)
    *force = fabs(rig.data->state.body_load[1].force.z);
  scn_rig_close(&rig);
  return err->status;
}

/* mc-strain between two opposite contacts: f = f_H(overlap + gamma (1+nu)(3-2nu) f/(2 pi E d)) */
static double closed_form(const scn_soft *of, double factor, double overlap) {
  double per = factor * (1 + of->poisson) * (3 - 2 * of->poisson) / (2 * M_PI * of->young * 2 * (radius - overlap));
  double f = 0;
  for (int k = 0; k < 2000; k++)
    f = 2 * hertz(of, radius, overlap + per * f); /* rigid plates: E* is twice that of two spheres */
  return f;
}

/* The approach of a rigid plate to the centre of a sphere that another one holds on the far side, at a force: Hertz's,
 * less what the far contact moves the surface here on a circle of radius a. Tatara (1989), J. Eng. Mater. Technol. 111,
 * 163-168. */
static double tatara_approach(const scn_soft *of, double force) {
  const double plane = 1 - of->poisson * of->poisson, a = cbrt(3 * plane * force * radius / (4 * of->young));
  const double far = a * a + 4 * radius * radius;
  const double moved = 2 * (1 + of->poisson) * radius * radius / (far * sqrt(far)) + plane / sqrt(far);
  return 3 * plane * force / (4 * of->young * a) - moved * force / (M_PI * of->young);
}

/* the force at an approach, by bisection: the approach rises with the force up to far beyond 0.4 radius */
static double tatara(const scn_soft *of, double overlap) {
  double low = 0, high = 4 * hertz(of, radius, overlap); /* rigid: twice what hertz gives for two spheres */
  for (int k = 0; k < 200; k++) {
    double middle = 0.5 * (low + high);
    if (tatara_approach(of, middle) < overlap)
      low = middle;
    else
      high = middle;
  }
  return low;
}

static tdm_status plates(cpl_verify *v, tdm_error *err) {
  const scn_soft *of = &scn_softs[SCN_RUBBER];
  double worst = 0, stress_worst = 0, f[SCN_MULTI_LAWS] = {0}, at_a_tenth = 0;
  FILE *file = scn_curve(v, "plates.csv", err);
  if (!file)
    return err->status;
  fputs("overlap/radius,classical [N],mc-strain [N],mc-stress [N],Tatara [N]\n", file);
  for (int k = 1; k <= DEPTHS && err->status == TDM_OK; k++) {
    const double overlap = 0.4 * radius * k / DEPTHS, factor[] = {0, 0.55, 1.71};
    for (int law = 0; law < SCN_MULTI_LAWS && err->status == TDM_OK; law++)
      press(v, law, factor[law], overlap, &f[law], err);
    fprintf(file, "%.9g,%.9g,%.9g,%.9g,%.9g\n", overlap / radius, f[0], f[1], f[2], tatara(of, overlap));
    double expected = closed_form(of, factor[SCN_STRAIN], overlap), alone = 2 * hertz(of, radius, overlap);
    double trace = 2 * alone * radius / (4.0 / 3 * M_PI * pow(radius, 3));
    double raised = alone + 1.71 * of->poisson * M_PI * radius * overlap * trace;
    scn_worst(&worst, f[SCN_STRAIN] / expected - 1);
    scn_worst(&stress_worst, f[SCN_STRESS] / raised - 1);
    if (k == DEPTHS / 4)
      at_a_tenth = f[SCN_STRAIN] / f[SCN_CLASSICAL];
  }
  fclose(file);
  if (err->status != TDM_OK)
    return err->status;
  cpl_verify_measure(v, "strain_off_closed_form", "plates", worst, CPL_AT_MOST, 1e-9);
  cpl_verify_measure(v, "stress_off_closed_form", "plates", stress_worst, CPL_AT_MOST, 1e-12);
  cpl_verify_measure(v, "strain/hertz at 0.1", "plates", at_a_tenth, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "strain/hertz at 0.4", "plates", f[SCN_STRAIN] / f[SCN_CLASSICAL], CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "stress/hertz at 0.4", "plates", f[SCN_STRESS] / f[SCN_CLASSICAL], CPL_NO_LIMIT, 0);
  const double theory = tatara(of, 0.4 * radius);
  cpl_verify_measure(v, "strain_off_tatara at 0.4", "plates", f[SCN_STRAIN] / theory - 1, CPL_AT_MOST, 0.05);
  cpl_verify_measure(v, "stress_off_tatara at 0.4", "plates", f[SCN_STRESS] / theory - 1, CPL_NO_LIMIT, 0);
  static const tdm_curve curves[] = {{"plates.csv", "1:2", "Hertz", "lines lw 2"},
                                     {"plates.csv", "1:3", "mc-strain, 0.55", "lines lw 2"},
                                     {"plates.csv", "1:4", "mc-stress, 1.71", "lines lw 2"},
                                     {"plates.csv", "1:5", "Tatara (1989)", "points pt 6"}};
  const tdm_plot plot = {.title = "A rubber sphere of 1 cm between rigid plates",
                         .xlabel = "overlap of a plate / radius",
                         .ylabel = "force [N]",
                         .ncurve = 4,
                         .curve = curves};
  cpl_verify_plot(v, "plates", 1, &plot);
  return TDM_OK;
}

/* ---- lattice ---- */

enum { SIDE = 4 };

/* The force of a contact of the lattice, from the power that straining the box along x puts in. */
static tdm_status in_lattice(cpl_verify *v, double beta, double overlap, double *force, tdm_error *err) {
  const scn_soft *of = &scn_softs[SCN_RUBBER];
  const double spacing = 2 * radius - overlap, rate = -1e-3;
  char positions[SIDE * SIDE * 80];
  size_t at = 0;
  for (int k = 0; k < SIDE * SIDE; k++)
    at += (size_t)snprintf(positions + at, sizeof positions - at, "%s[%.17g,%.17g,0]", k > 0 ? "," : "",
                           spacing * (k % SIDE), spacing * (k / SIDE));
  scn_rig rig;
  if (scn_rig_open(&rig, v, 1e-9, err,
                   "{'gravity':[0,0,0],'energy':true,'materials':[{'name':'a','density':%.17g,'young_modulus':%.17g,"
                   "'poisson_ratio':%.17g}],'pairs':[{'materials':['a','a'],'restitution':1%s}],"
                   "'contact':{'tangential':'none'%s},'domain':{'min':[0,0,-1],'max':[%.17g,%.17g,1],'x':'periodic',"
                   "'y':'periodic','strain_rate':[%.17g,0,0]},'particles':[{'type':'list','material':'a',"
                   "'radius':0.01,'positions':[%s]}]}",
                   of->density, of->young, of->poisson, scn_multi_pair(SCN_STRESS, beta), scn_multi_contact(SCN_STRESS),
                   SIDE * spacing, SIDE * spacing, rate, positions) == TDM_OK)
    *force = fabs(rig.data->state.energy.now.box_power / (SIDE * rate * SIDE * spacing));
  scn_rig_close(&rig);
  return err->status;
}

static tdm_status lattice(cpl_verify *v, tdm_error *err) {
  const scn_soft *of = &scn_softs[SCN_RUBBER];
  const double beta = 1.71, volume = 4.0 / 3 * M_PI * pow(radius, 3);
  double worst = 0;
  FILE *file = scn_curve(v, "lattice.csv", err);
  if (!file)
    return err->status;
  fputs("strain,classical [N],mc-stress [N],Eq. 11 [N]\n", file);
  for (int k = 1; k <= 20 && err->status == TDM_OK; k++) {
    double overlap = k / 20.0 * 2 * radius / 6, force = 0; /* the box from 0.06 m to 0.05 m */
    in_lattice(v, beta, overlap, &force, err);
    double alone = hertz(of, radius / 2, overlap), area = M_PI * radius / 2 * overlap;
    double expected = alone * (1 + 4 * 2 * radius * beta * of->poisson * area / volume);
    fprintf(file, "%.9g,%.9g,%.9g,%.9g\n", overlap / (2 * radius), alone, force, expected);
    scn_worst(&worst, force / expected - 1);
  }
  fclose(file);
  if (err->status != TDM_OK)
    return err->status;
  cpl_verify_measure(v, "off_eq_11", "lattice", worst, CPL_AT_MOST, 1e-10);
  static const tdm_curve curves[] = {{"lattice.csv", "1:2", "classical", "lines lw 2"},
                                     {"lattice.csv", "1:4", "[G21] Eq. 11", "lines lw 2"},
                                     {"lattice.csv", "1:3", "mc-stress", "points pt 6"}};
  const tdm_plot plot = {.title = "A square lattice of rubber spheres that repeats",
                         .xlabel = "strain",
                         .ylabel = "force of a contact [N]",
                         .ncurve = 3,
                         .curve = curves};
  cpl_verify_plot(v, "lattice", 1, &plot);
  return TDM_OK;
}

tdm_status scn_multi_statics(cpl_verify *v, tdm_error *err) {
  return plates(v, err) == TDM_OK ? lattice(v, err) : err->status;
}
