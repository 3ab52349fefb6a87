/* [G21] Section 3.4: a ball that two or four others hit at 10 m/s, hydrogel and rubber (Fig. 6-9). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/multicontact/cases.h"
#include "scenarios/table.h"

#include "dem/contact/law/theory.h"

#include <math.h>
#include <stdio.h>

static const double radius = 0.01, speed = 10;

/* factors of mc-strain and mc-stress; the paper says none for these cases */
static const double factors[2][SCN_MULTI_LAWS] = {{0, 1, 1}, {0, 0.55, 1.71}};
static const double steps[2] = {1e-5, 2e-5}; /* the paper's [s] */

typedef struct {
  double overlap, corrected; /* largest, of the spheres and with what the other contacts shift it [m] */
  double time;               /* until they part [s] */
  double slowest;            /* least kinetic energy, share of the first */
} impact;

/* the overlap of particles 0 and 1 that makes their contact's circle [m]; what [G21]'s figures of mc-strain show */
static double corrected(const dem_data *d, double overlap) {
  const dem_pairs *list = &d->lists.pairs;
  for (int k = list->first[0]; overlap > 0 && k < list->first[1]; k++)
    if (list->other[k] == 1) {
      const dem_among contact = {.pair = &d->model->pair[0],
                                 .at = {.mass = d->state.mass[0] / 2, .radius = radius / 2},
                                 .overlap = overlap,
                                 .particle = 0,
                                 .other = 1,
                                 .place = (size_t)k};
      return dem_overlap_among(d, d->model, &contact);
    }
  return overlap;
}

static tdm_status hit(cpl_verify *v, int material, int balls, int law, FILE *f, impact *out, tdm_error *err) {
  const scn_soft *of = &scn_softs[material];
  const double away = 2 * radius, dt = steps[material] / 10;
  static const char *const more[] = {"", ",{'type':'list','material':'a','radius':0.01,'positions':[[0,-0.02,0]],"
                                         "'velocity':[0,10,0]},{'type':'list','material':'a','radius':0.01,"
                                         "'positions':[[0,0.02,0]],'velocity':[0,-10,0]}"};
  scn_rig rig;
  *out = (impact){.slowest = 1};
  if (scn_rig_open(&rig, v, dt, err,
                   "{'gravity':[0,0,0],'materials':[{'name':'a','density':%.17g,'young_modulus':%.17g,"
                   "'poisson_ratio':%.17g}],'pairs':[{'materials':['a','a'],'viscosity':%.17g,'friction':%.17g%s}],"
                   "'contact':{'normal':'hertz'%s},'particles':[{'type':'list','material':'a','radius':0.01,"
                   "'positions':[[0,0,0]]},{'type':'list','material':'a','radius':0.01,'positions':[[%.17g,0,0]],"
                   "'velocity':[10,0,0]},{'type':'list','material':'a','radius':0.01,'positions':[[%.17g,0,0]],"
                   "'velocity':[-10,0,0]}%s]}",
                   of->density, of->young, of->poisson, scn_viscosity(of, radius, speed), of->friction,
                   scn_multi_pair(law, factors[material][law]), scn_multi_contact(law), -away, away,
                   more[balls == 5]) == TDM_OK) {
    const double first = scn_rig_kinetic(&rig);
    for (long k = 0; k < 20000 && (k < 100 || rig.data->state.ncontact > 0) && scn_rig_steps(&rig, 1, err) == TDM_OK;
         k++) {
      const dem_sphere *s = rig.data->state.sphere;
      double overlap = fmax(0, away - tdm_norm(tdm_sub(s[1].position, s[0].position))),
             kinetic = scn_rig_kinetic(&rig) / first;
      const double with_others = corrected(rig.data, overlap);
      out->overlap = fmax(out->overlap, overlap);
      out->corrected = fmax(out->corrected, with_others);
      out->slowest = fmin(out->slowest, kinetic);
      if (overlap > 0)
        out->time = rig.time;
      if (k % 5 == 0)
        fprintf(f, "%.9g,%.9g,%.9g,%d\n", rig.time, kinetic, with_others, law);
    }
    fputs("\n\n", f);
  }
  scn_rig_close(&rig);
  return err->status;
}

static void plot(cpl_verify *v, const char *file, const char *picture, const char *title) {
  static const char *const using[2][SCN_MULTI_LAWS] = {{"1:($4==0?$2:1/0)", "1:($4==1?$2:1/0)", "1:($4==2?$2:1/0)"},
                                                       {"1:($4==0?$3:1/0)", "1:($4==1?$3:1/0)", "1:($4==2?$3:1/0)"}};
  static const char *const y[] = {"kinetic energy, share", "overlap of the middle one [m]"};
  tdm_curve curves[2][SCN_MULTI_LAWS];
  tdm_plot plots[2];
  for (int p = 0; p < 2; p++) {
    for (int law = 0; law < SCN_MULTI_LAWS; law++)
      curves[p][law] = (tdm_curve){file, using[p][law], scn_multi_names[law], "lines lw 2"};
    plots[p] =
        (tdm_plot){.title = title, .xlabel = "t [s]", .ylabel = y[p], .ncurve = SCN_MULTI_LAWS, .curve = curves[p]};
  }
  cpl_verify_plot(v, picture, 2, plots);
}

static tdm_status compare(cpl_verify *v, int material, int balls, tdm_error *err) {
  char name[64], title[64];
  impact i[SCN_MULTI_LAWS];
  snprintf(name, sizeof name, "%s_%d.csv", scn_softs[material].name, balls);
  FILE *f = scn_curve(v, name, err);
  if (!f)
    return err->status;
  fputs("time [s],kinetic energy,overlap [m],law\n", f);
  for (int law = 0; law < SCN_MULTI_LAWS && err->status == TDM_OK; law++)
    hit(v, material, balls, law, f, &i[law], err);
  fclose(f);
  if (err->status != TDM_OK)
    return err->status;
  snprintf(title, sizeof title, "%d balls of %s", balls, scn_softs[material].name);
  char picture[64];
  snprintf(picture, sizeof picture, "%s_%d", scn_softs[material].name, balls);
  plot(v, name, picture, title);
  snprintf(name, sizeof name, "%d %s", balls, scn_softs[material].name);
  cpl_verify_measure(v, "overlap_per_radius", name, i[SCN_CLASSICAL].overlap / radius, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "overlap_strain/classical", name, i[SCN_STRAIN].overlap / i[SCN_CLASSICAL].overlap,
                     CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "corrected_strain/classical", name, i[SCN_STRAIN].corrected / i[SCN_CLASSICAL].overlap,
                     CPL_AT_LEAST, 1);
  cpl_verify_measure(v, "overlap_stress/classical", name, i[SCN_STRESS].overlap / i[SCN_CLASSICAL].overlap, CPL_AT_MOST,
                     1);
  cpl_verify_measure(v, "time_strain/classical", name, i[SCN_STRAIN].time / i[SCN_CLASSICAL].time, CPL_AT_MOST, 1);
  cpl_verify_measure(v, "time_stress/classical", name, i[SCN_STRESS].time / i[SCN_CLASSICAL].time, CPL_AT_MOST, 1);
  return TDM_OK;
}

tdm_status scn_multi_impacts(cpl_verify *v, tdm_error *err) {
  for (int material = SCN_HYDROGEL; material <= SCN_RUBBER; material++)
    for (int balls = 3; balls <= 5; balls += 2)
      if (compare(v, material, balls, err) != TDM_OK)
        return err->status;
  return TDM_OK;
}
