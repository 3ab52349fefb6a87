/* A run against its reference: see compare.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/results/compare.h"

#include "coupler/results/table.h"
#include "protocol/app/plot.h"
#include "protocol/results/mark.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

tdm_status cpl_comparison_init(cpl_comparison *c, int nrow, const double *time, tdm_error *err) {
  *c = (cpl_comparison){.nrow = nrow};
  c->time = malloc((size_t)nrow * sizeof *c->time + 8);
  if (!c->time)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  memcpy(c->time, time, (size_t)nrow * sizeof *c->time);
  c->interval = nrow > 1 ? time[1] - time[0] : 1;
  return TDM_OK;
}

void cpl_comparison_free(cpl_comparison *c) {
  for (int i = 0; i < c->ncurve; i++) {
    free(c->curve[i].simulation);
    free(c->curve[i].reference);
  }
  free(c->time);
  json_decref(c->notes);
  *c = (cpl_comparison){0};
}

cpl_compared *cpl_comparison_add(cpl_comparison *c, const char *name, const char *unit, cpl_curve_kind kind,
                                 const char *title, tdm_error *err) {
  if (c->ncurve == CPL_CURVES_MAX) {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "a comparison has at most %d curves", CPL_CURVES_MAX);
    return NULL;
  }
  cpl_compared *curve = &c->curve[c->ncurve];
  snprintf(curve->name, sizeof curve->name, "%s", name);
  snprintf(curve->unit, sizeof curve->unit, "%s", unit);
  snprintf(curve->title, sizeof curve->title, "%s", title);
  curve->kind = kind;
  curve->simulation = calloc((size_t)c->nrow + 1, sizeof(double));
  curve->reference = calloc((size_t)c->nrow + 1, sizeof(double));
  c->ncurve++;
  if (curve->simulation && curve->reference)
    return curve;
  tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  return NULL;
}

double cpl_comparison_nse(const cpl_comparison *c, const cpl_compared *curve) {
  return cpl_nse(curve->simulation + c->first, curve->reference + c->first, c->nrow - c->first);
}

double cpl_comparison_r2(const cpl_comparison *c, const cpl_compared *curve) {
  return cpl_r2(curve->simulation + c->first, curve->reference + c->first, c->nrow - c->first);
}

double cpl_comparison_r2_mean(const cpl_comparison *c, const cpl_compared *curve, double span) {
  int many = (int)fmax(1, round(span / c->interval)), n = (c->nrow - c->first - 1) / many;
  double *simulation = calloc(2 * (size_t)(n > 0 ? n : 1), sizeof *simulation);
  if (!simulation)
    return NAN;
  double *reference = simulation + (n > 0 ? n : 1);
  for (int i = 0; i < n; i++)
    for (int k = 0; k < many; k++) {
      int row = c->first + 1 + i * many + k; /* row 0 is an instant, the others are means of their interval */
      simulation[i] += curve->simulation[row] / many;
      reference[i] += curve->reference[row] / many;
    }
  double r2 = cpl_r2(simulation, reference, n);
  free(simulation);
  return r2;
}

tdm_status cpl_comparison_write(const cpl_comparison *c, const char *dir, tdm_error *err) {
  char file[4096];
  snprintf(file, sizeof file, "%s/comparison.csv", dir);
  tdm_mark_add_in(dir, "comparison.csv");
  FILE *f = fopen(file, "w");
  if (!f)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno));
  fputs("time [s]", f);
  for (int i = 0; i < c->ncurve; i++)
    fprintf(f, ",%s [%s],%s.reference [%s]", c->curve[i].name, c->curve[i].unit, c->curve[i].name, c->curve[i].unit);
  fputc('\n', f);
  for (int row = 0; row < c->nrow; row++) {
    fprintf(f, "%.12g", c->time[row]);
    for (int i = 0; i < c->ncurve; i++)
      fprintf(f, ",%.9g,%.9g", c->curve[i].simulation[row], c->curve[i].reference[row]);
    fputc('\n', f);
  }
  if (fclose(f) != 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno));
  return TDM_OK;
}

tdm_status cpl_comparison_plot(const cpl_comparison *c, const char *dir, tdm_error *err) {
  tdm_plot plots[CPL_CURVES_MAX];
  tdm_curve curves[CPL_CURVES_MAX][2];
  char labels[CPL_CURVES_MAX][48], using[CPL_CURVES_MAX][2][24];
  for (int i = 0; i < c->ncurve; i++) {
    snprintf(labels[i], sizeof labels[i], "%s [%s]", c->curve[i].name, c->curve[i].unit);
    for (int k = 0; k < 2; k++)
      snprintf(using[i][k], sizeof using[i][k], "1:%d", 2 + 2 * i + k);
    bool state = c->curve[i].kind == CPL_STATE;
    curves[i][0] = (tdm_curve){"comparison.csv", using[i][0], "co-simulation", state ? "lines lw 3" : "lines lw 1"};
    curves[i][1] = (tdm_curve){"comparison.csv", using[i][1], "reference", "lines dt 2 lw 1.5 lc rgb 'black'"};
    plots[i] = (tdm_plot){
        .title = c->curve[i].title,
        .xlabel = "time [s]",
        .ylabel = labels[i],
        .ncurve = 2,
        .curve = curves[i],
    };
  }
  return tdm_plot_write(dir, "comparison", c->ncurve, plots, err);
}
