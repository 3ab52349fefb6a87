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
  double force;              /* largest on an outer ball [N] */
  double half_time;          /* until half of the kinetic energy is gone [s] */
  double peak_time;          /* until the overlap is largest [s] */
  double time;               /* until they part [s] */
  double left;               /* kinetic energy then, share of the first */
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

/* the state after a step into what came out so far; `first`: kinetic energy at the start [J] */
static void look(const scn_rig *rig, double first, double *overlap, double *with_others, impact *out) {
  const dem_sphere *s = rig->data->state.sphere;
  *overlap = fmax(0, 2 * radius - tdm_norm(tdm_sub(s[1].position, s[0].position)));
  *with_others = corrected(rig->data, *overlap);
  out->left = scn_rig_kinetic(rig) / first;
  out->force = fmax(out->force, tdm_norm(rig->data->state.push[1].force));
  out->corrected = fmax(out->corrected, *with_others);
  if (*overlap > out->overlap)
    out->overlap = *overlap, out->peak_time = rig->time;
  if (*overlap > 0)
    out->time = rig->time;
  if (out->half_time == 0 && out->left < 0.5)
    out->half_time = rig->time;
}

static tdm_status hit(cpl_verify *v, int material, int balls, int law, FILE *f, impact *out, tdm_error *err) {
  const scn_soft *of = &scn_softs[material];
  const double away = 2 * radius, dt = steps[material] / 10;
  static const char *const more[] = {"", ",{'type':'list','material':'a','radius':0.01,'positions':[[0,-0.02,0]],"
                                         "'velocity':[0,10,0]},{'type':'list','material':'a','radius':0.01,"
                                         "'positions':[[0,0.02,0]],'velocity':[0,-10,0]}"};
  scn_rig rig;
  *out = (impact){0};
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
      double overlap, with_others;
      look(&rig, first, &overlap, &with_others, out);
      if (k % 5 == 0)
        fprintf(f, "%.9g,%.9g,%.9g,%d\n", rig.time, out->left, with_others, law);
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

/* What [G21] says of Figs. 6-9: with both laws forces are larger, the kinetic energy falls faster, the largest overlap
 * comes earlier and the impact is shorter; the largest overlap is that of mc-strain, as corrected, the least that of
 * mc-stress. */
static void measure(cpl_verify *v, const char *name, const impact i[SCN_MULTI_LAWS]) {
  const impact *classical = &i[SCN_CLASSICAL], *strain = &i[SCN_STRAIN], *stress = &i[SCN_STRESS];
  const struct {
    const char *name;
    double value;
    cpl_limit_kind kind;
  } ratios[] = {
      {"force_strain/classical", strain->force / classical->force, CPL_AT_LEAST},
      {"force_stress/classical", stress->force / classical->force, CPL_AT_LEAST},
      {"corrected_strain/classical", strain->corrected / classical->overlap, CPL_AT_LEAST},
      {"overlap_strain/classical", strain->overlap / classical->overlap, CPL_NO_LIMIT},
      {"overlap_stress/classical", stress->overlap / classical->overlap, CPL_AT_MOST},
      {"half_energy_time_strain/classical", strain->half_time / classical->half_time, CPL_AT_MOST},
      {"half_energy_time_stress/classical", stress->half_time / classical->half_time, CPL_AT_MOST},
      {"half_energy_time_strain/stress", strain->half_time / stress->half_time, CPL_NO_LIMIT},
      {"peak_time_strain/classical", strain->peak_time / classical->peak_time, CPL_AT_MOST},
      {"peak_time_stress/classical", stress->peak_time / classical->peak_time, CPL_AT_MOST},
      {"time_strain/classical", strain->time / classical->time, CPL_AT_MOST},
      {"time_stress/classical", stress->time / classical->time, CPL_AT_MOST},
      {"energy_left_strain/classical", strain->left / classical->left, CPL_NO_LIMIT},
      {"energy_left_stress/classical", stress->left / classical->left, CPL_NO_LIMIT},
  };
  cpl_verify_measure(v, "overlap_per_radius", name, classical->overlap / radius, CPL_NO_LIMIT, 0);
  for (size_t k = 0; k < sizeof ratios / sizeof *ratios; k++)
    cpl_verify_measure(v, ratios[k].name, name, ratios[k].value, ratios[k].kind, 1);
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
  measure(v, name, i);
  return TDM_OK;
}

tdm_status scn_multi_impacts(cpl_verify *v, tdm_error *err) {
  for (int material = SCN_HYDROGEL; material <= SCN_RUBBER; material++)
    for (int balls = 3; balls <= 5; balls += 2)
      if (compare(v, material, balls, err) != TDM_OK)
        return err->status;
  return TDM_OK;
}
