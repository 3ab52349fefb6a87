/* Outflow of a square bin with a flat bottom through round outlets, against Beverloo, Leniger & van de Velde (1961):
 *
 *   W = C rho_b sqrt(g) (D - k d)^(5/2)
 *
 * C and k from a straight line through W^(2/5) over D; the exponent from log W over log(D - 1.4 d).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/step/step.h"
#include "scenarios/dem_physics/rig.h"
#include "scenarios/table.h"

#include <math.h>
#include <stdio.h>

static const double d = 0.005, spread = 0.1; /* mean diameter [m]; uniform radii, +- share */
static const double side = 16, height = 13;  /* of the bin and of the bed, in d */
static const double gravity = 9.81, dt = 8e-5;
static const double begin = 0.12, longest = 0.6; /* where the flow is measured [s] */
static const double emptied = 0.3;               /* share of the bed that may flow out */
enum { count = 3800 };

static const double outlets[] = {5, 6, 7, 8, 9}; /* D/d */
enum { NOUTLET = sizeof outlets / sizeof outlets[0] };

/* The bin with an outlet in its bottom, a flat ring (a cone that rises by a hair); outlet 0: closed, and settled. */
static tdm_status open_bin(scn_rig *rig, cpl_verify *v, double outlet, tdm_error *err) {
  double half = 0.5 * side * d, r = 0.5 * d, top = 1.8 * height * d;
  char bottom[256];
  snprintf(bottom, sizeof bottom,
           outlet > 0 ? "{'type':'cone','side':'inside','radii':[%.17g,%.17g],'length':1e-6}"
                      : "{'type':'plane','normal':[0,0,1]}",
           0.5 * outlet * d, 1.5 * half);
  return scn_rig_open(rig, v, dt, err,
                      "{'gravity':[0,0,%.17g],"
                      "'materials':[{'name':'a','density':2500,'young_modulus':2.5e6,'poisson_ratio':0.25}],"
                      "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.5}],"
                      "'bodies':[{'name':'bin','material':'a','shapes':[%s,"
                      "{'type':'box','side':'inside','size':[%.17g,%.17g,1],'open':['-z','+z']}]}],"
                      "'particles':[{'type':'random','material':'a','count':%d,'radius':[%.17g,%.17g],"
                      "'region':{'min':[%.17g,%.17g,0.0001],'max':[%.17g,%.17g,%.17g]}}],"
                      "'sinks':[{'name':'out','type':'plane','point':[0,0,%.17g],'normal':[0,0,1]}]%s}",
                      -gravity, bottom, 2 * half, 2 * half, count, (1 - spread) * r, (1 + spread) * r, -half, -half,
                      half, half, top, -2 * d, outlet > 0 ? "" : ",'settle':{'speed':0.02,'max_time':1}");
}

/* of the bed at rest, away from walls, bottom and surface [kg/m3] */
static double bulk_density(const dem_data *data) {
  const double half = 0.5 * (side - 6) * d, low = 3 * d, high = (height - 4) * d;
  double mass = 0;
  for (int i = 0; i < data->state.nparticle; i++) {
    tdm_vec3 x = data->state.sphere[i].position;
    if (fabs(x.x) < half && fabs(x.y) < half && x.z > low && x.z < high)
      mass += data->state.mass[i];
  }
  return mass / (4 * half * half * (high - low));
}

/* Settle a bed: its density, and where its particles lie, by id (count). */
static tdm_status settle(cpl_verify *v, tdm_vec3 *place, double *density, tdm_error *err) {
  scn_rig rig;
  if (open_bin(&rig, v, 0, err) == TDM_OK) {
    *density = bulk_density(rig.data);
    for (int i = 0; i < rig.data->state.nparticle; i++)
      place[rig.data->state.id[i]] = rig.data->state.sphere[i].position;
  }
  scn_rig_close(&rig);
  return err->status;
}

/* Put the particles of a bin, filled as the bed was, where those of the bed lie; all are at rest. */
static tdm_status put_bed(scn_rig *rig, const tdm_vec3 *place, tdm_error *err) {
  dem_data *to = rig->data;
  for (int i = 0; i < to->state.nparticle; i++)
    to->state.sphere[i].position = place[to->state.id[i]];
  dem_forces_now(to, false, err);
  return err->status;
}

/* slope of a straight line through points given one by one */
typedef struct {
  double n, x, y, xx, xy;
} line;

static void line_add(line *l, double x, double y) {
  l->n++, l->x += x, l->y += y, l->xx += x * x, l->xy += x * y;
}

static double line_slope(const line *l) {
  return (l->n * l->xy - l->x * l->y) / (l->n * l->xx - l->x * l->x);
}

static double line_zero(const line *l) {
  double s = line_slope(l);
  return (s * l->x - l->y) / (s * l->n);
}

/* Mass rate through one outlet [kg/s], which opens at the start */
static tdm_status discharge(cpl_verify *v, const tdm_vec3 *bed, double outlet, double *rate, FILE *curves,
                            tdm_error *err) {
  scn_rig rig;
  line flow = {0};
  if (open_bin(&rig, v, outlet, err) == TDM_OK && put_bed(&rig, bed, err) == TDM_OK) {
    const dem_sink_state *sink = &rig.data->state.sink[0];
    for (double t = 0; t < longest && (double)sink->removed < emptied * count; t += 20 * dt) {
      if (scn_rig_steps(&rig, 20, err) != TDM_OK)
        break;
      fprintf(curves, "%.9g,%.9g,%g\n", t + 20 * dt, sink->mass, outlet);
      if (t > begin)
        line_add(&flow, t, sink->mass);
    }
  }
  scn_rig_close(&rig);
  *rate = line_slope(&flow);
  return err->status;
}

static void plot(cpl_verify *v) {
  static const tdm_curve rate[] = {{"rates.csv", "1:3", "engine", "points pt 7"},
                                   {"rates.csv", "1:4", "fit", "lines lw 2"},
                                   {"rates.csv", "1:5", "C = 0.58, k = 1.4", "lines dt 2 lc rgb 'black'"}};
  static const tdm_curve mass[] = {{"mass.csv", "1:2:3", "", "points pt 7 ps 0.3 palette"}};
  const tdm_plot plots[] = {
      {
          .title = "Discharge",
          .xlabel = "outlet D/d",
          .ylabel = "(W [kg/s])^(2/5)",
          .setup = "set key top left\n",
          .ncurve = 3,
          .curve = rate,
      },
      {
          .title = "Mass that has flowed out, by D/d",
          .xlabel = "time [s]",
          .ylabel = "[kg]",
          .setup = "unset key\n",
          .ncurve = 1,
          .curve = mass,
      },
  };
  cpl_verify_plot(v, "discharge", 2, plots);
}

static tdm_status compare(cpl_verify *v, const double *rate, double density, tdm_error *err) {
  line fit = {0}, powers = {0};
  for (int i = 0; i < NOUTLET; i++) {
    line_add(&fit, outlets[i] * d, pow(rate[i], 0.4));
    line_add(&powers, log((outlets[i] - 1.4) * d), log(rate[i]));
  }
  double k = line_zero(&fit) / d, size = density * sqrt(gravity), c = pow(line_slope(&fit), 2.5) / size, off = 0;
  FILE *f = scn_curve(v, "rates.csv", err);
  if (!f)
    return err->status;
  fputs("D/d,W [kg/s],W^(2/5),fit,C=0.58 k=1.4\n", f);
  for (int i = 0; i < NOUTLET; i++) {
    double law = c * size * pow((outlets[i] - k) * d, 2.5), usual = 0.58 * size * pow((outlets[i] - 1.4) * d, 2.5);
    scn_worst(&off, rate[i] / law - 1);
    fprintf(f, "%g,%.9g,%.9g,%.9g,%.9g\n", outlets[i], rate[i], pow(rate[i], 0.4), pow(law, 0.4), pow(usual, 0.4));
  }
  fclose(f);
  cpl_verify_measure(v, "bulk_density_kg/m3", "all outlets", density, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "exponent_off_5/2", "all outlets", line_slope(&powers) - 2.5, CPL_AT_MOST, 0.1);
  cpl_verify_measure(v, "C", "all outlets", c, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "C_off_0.58", "all outlets", c / 0.58 - 1, CPL_AT_MOST, 0.15);
  cpl_verify_measure(v, "k", "all outlets", k, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "k_off_1.5", "all outlets", k - 1.5, CPL_AT_MOST, 0.3);
  cpl_verify_measure(v, "rate_off_fit", "all outlets", off, CPL_AT_MOST, 0.05);
  plot(v);
  return TDM_OK;
}

tdm_status scn_discharge(cpl_verify *v, tdm_error *err) {
  double rate[NOUTLET], density = NAN;
  static tdm_vec3 bed[count];
  FILE *curves = scn_curve(v, "mass.csv", err);
  if (!curves)
    return err->status;
  fputs("time [s],mass [kg],D/d\n", curves);
  settle(v, bed, &density, err);
  for (int i = 0; i < NOUTLET && err->status == TDM_OK; i++) {
    char name[32];
    if (discharge(v, bed, outlets[i], &rate[i], curves, err) != TDM_OK)
      break;
    snprintf(name, sizeof name, "D=%gd", outlets[i]);
    cpl_verify_measure(v, "rate_kg/s", name, rate[i], CPL_NO_LIMIT, 0);
  }
  fclose(curves);
  return err->status == TDM_OK ? compare(v, rate, density, err) : err->status;
}
