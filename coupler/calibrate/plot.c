/* Pictures of a calibration: the path of the search, the best run beside what was measured, and the misfit over each
 * parameter. See calibration.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/calibrate/calibration.h"

#include "protocol/app/plot.h"

#include <stdlib.h>
#include <string.h>

enum { PANELS = CPL_TARGETS > CPL_PARAMETERS ? CPL_TARGETS + 1 : CPL_PARAMETERS + 1 };

/* Panels under way. */
typedef struct {
  int n;
  tdm_plot plot[PANELS];
  tdm_plot_data data[PANELS];
  tdm_curve curve[PANELS][3];
  char ylabel[PANELS][TDM_PATH_MAX];
} panels;

/* A new panel with room for nrow rows, all NaN; NULL without memory. */
static double *add_panel(panels *p, int nrow, int ncolumn, tdm_error *err) {
  const int i = p->n;
  p->data[i] = (tdm_plot_data){malloc((size_t)nrow * (size_t)ncolumn * sizeof(double) + 8), nrow, ncolumn};
  if (!p->data[i].value) {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    return NULL;
  }
  for (int k = 0; k < nrow * ncolumn; k++)
    p->data[i].value[k] = NAN;
  p->n++;
  return p->data[i].value;
}

static void write_panels(panels *p, const char *out, const char *name, tdm_error *err) {
  if (err->status == TDM_OK && p->n > 0)
    tdm_plot_write_data(out, name, p->n, p->plot, p->data, err);
  for (int i = 0; i < p->n; i++)
    free(p->data[i].value);
  free(p);
}

/* ---- the path ---- */

/* Columns: try; misfit and the best so far, or the value. Tries beside the best come last and are left out. */
static void plot_path(const cpl_calibration *c, tdm_error *err) {
  panels *p = calloc(1, sizeof *p);
  double *row = p ? add_panel(p, c->ntry, 3, err) : NULL;
  double best = NAN;
  for (int i = 0; row && i < c->ntry && !c->tried[i].aside; i++, row += 3) {
    best = fmin(best, c->tried[i].misfit);
    row[0] = i + 1;
    row[1] = c->tried[i].misfit;
    row[2] = best;
  }
  if (!row) {
    free(p);
    return;
  }
  p->curve[0][0] = (tdm_curve){NULL, "1:2", "tries", "points pt 7 lc 1"};
  p->curve[0][1] = (tdm_curve){NULL, "1:3", "the best so far", "steps lw 2 lc 7"};
  p->plot[0] = (tdm_plot){.title = "misfit of the tries",
                          .xlabel = "",
                          .ylabel = "misfit",
                          .setup = best > 0 ? "set key above\nset logscale y\n" : "set key above\n",
                          .ncurve = 2,
                          .curve = p->curve[0]};
  for (int k = 0; k < c->nparameter && err->status == TDM_OK; k++) {
    const int n = p->n;
    row = add_panel(p, c->ntry, 2, err);
    for (int i = 0; row && i < c->ntry && !c->tried[i].aside; i++, row += 2) {
      row[0] = i + 1;
      row[1] = c->tried[i].value[k];
    }
    p->curve[n][0] = (tdm_curve){NULL, "1:2", "", "linespoints pt 7 lc 1"};
    p->plot[n] =
        (tdm_plot){.title = "",
                   .xlabel = k + 1 == c->nparameter ? "try" : "",
                   .ylabel = c->parameter[k].path,
                   .setup = c->parameter[k].log ? "unset key\nset logscale y\n" : "unset key\nunset logscale\n",
                   .ncurve = 1,
                   .curve = p->curve[n]};
  }
  write_panels(p, c->o->out, "path", err);
}

/* ---- the best run ---- */

/* Rows of the target, then of the run, a row of NaN before its way back; columns: x, measured, run. */
static void add_fit(panels *p, const cpl_target *t, const double *x, const double *y, int n, int back, tdm_error *err) {
  const int i = p->n;
  double *row = add_panel(p, t->n + n + 1, 3, err);
  if (!row)
    return;
  for (int k = 0; k < t->n; k++, row += 3) {
    row[0] = t->x[k];
    row[1] = t->y[k];
  }
  for (int k = 0; k < n; k++, row += 3) {
    row += k == back ? 3 : 0;
    row[0] = x[k];
    row[2] = y[k];
  }
  p->curve[i][0] = (tdm_curve){NULL, "1:3", "the best run", "lines lw 2 lc 1"};
  p->curve[i][1] = (tdm_curve){NULL, "1:2", "measured", "points pt 6 lc 'black'"};
  p->plot[i] = (tdm_plot){.title = t->name,
                          .xlabel = t->column[0],
                          .ylabel = t->column[1],
                          .setup = "set key above\nunset logscale\n",
                          .ncurve = 2,
                          .curve = p->curve[i]};
}

/* A measure over the one parameter: a row a try, then the target as a line; columns: parameter, mean, its standard
 * error, target. */
static void add_number(panels *p, const cpl_calibration *c, int k, int first, tdm_error *err) {
  const int i = p->n;
  const cpl_parameter *of = &c->parameter[0];
  double *row = add_panel(p, c->ntry + 2, 4, err);
  if (!row)
    return;
  for (int t = 0; t < c->ntry; t++, row += 4) {
    row[0] = c->tried[t].value[0];
    row[1] = c->tried[t].row ? c->tried[t].row[first] : NAN;
    row[2] = c->tried[t].variance ? sqrt(c->tried[t].variance[first]) : NAN;
  }
  for (int end = 0; end < 2; end++, row += 4) {
    row[0] = end == 0 ? of->from : of->to;
    row[3] = c->target[k].y[0];
  }
  const bool seeds = c->nseed > 1;
  p->curve[i][0] = (tdm_curve){NULL, "1:4", "target", "lines lw 2 lc 7"};
  p->curve[i][1] = (tdm_curve){NULL, seeds ? "1:2:3" : "1:2", seeds ? "tries, mean and its standard error" : "tries",
                               seeds ? "yerrorbars pt 7 lc 1" : "points pt 7 lc 1"};
  p->plot[i] = (tdm_plot){.title = "",
                          .xlabel = of->path,
                          .ylabel = c->target[k].name,
                          .setup = of->log ? "set key above\nset logscale x\n" : "set key above\nunset logscale\n",
                          .ncurve = 2,
                          .curve = p->curve[i]};
}

/* Curves are those of the first seed. */
static void plot_fit(cpl_calibration *c, tdm_error *err) {
  cpl_study study = {0};
  panels *p = calloc(1, sizeof *p);
  if (p && cpl_try_again(c, c->best, &study, err) == TDM_OK)
    for (int k = 0, first = 0; k < c->ntarget && err->status == TDM_OK; first += c->target[k++].n) {
      double *x, *y;
      int back = 0;
      if (!c->target[k].file && c->nparameter == 1)
        add_number(p, c, k, first, err);
      if (!c->target[k].file)
        continue;
      const int n = cpl_target_curve(&c->target[k], k, &study, cpl_study_run_of(&study, 0, 0), &x, &y, &back, err);
      if (n > 0)
        add_fit(p, &c->target[k], x, y, n, back, err);
      free(x);
      free(y);
    }
  cpl_study_free(&study);
  if (p)
    write_panels(p, c->o->out, "fit", err);
}

/* ---- the sensitivity ---- */

/* Columns: value, misfit of the search's tries, misfit of those beside the best along this parameter. */
static void add_sensitivity(panels *p, const cpl_calibration *c, int k, tdm_error *err) {
  const int i = p->n;
  const cpl_try *best = &c->tried[c->best], *low = NULL, *high = NULL;
  double *row = add_panel(p, c->ntry + 3, 3, err);
  for (int t = 0; row && t < c->ntry; t++) {
    const cpl_try *one = &c->tried[t];
    bool along = one->place[k] != best->place[k];
    for (int o = 0; o < c->nparameter; o++)
      along = along && (o == k || one->value[o] == best->value[o]);
    low = one->aside && along && one->place[k] < best->place[k] ? one : low;
    high = one->aside && along && one->place[k] > best->place[k] ? one : high;
    if (one->aside)
      continue;
    row[0] = one->value[k];
    row[1] = one->misfit;
    row += 3;
  }
  const cpl_try *const beside[] = {low, best, high};
  for (int t = 0; row && t < 3; t++)
    if (beside[t]) {
      row[0] = beside[t]->value[k];
      row[2] = beside[t]->misfit;
      row += 3;
    }
  p->curve[i][0] = (tdm_curve){NULL, "1:2", "tries of the search", "points pt 6 lc 'gray40'"};
  p->curve[i][1] = (tdm_curve){NULL, "1:3", "beside the best, the others fixed", "linespoints lw 2 pt 7 lc 1"};
  p->plot[i] =
      (tdm_plot){.title = k == 0 ? "sensitivity" : "",
                 .xlabel = c->parameter[k].path,
                 .ylabel = "misfit",
                 .setup = c->parameter[k].log ? "set key above\nset logscale x\n" : "set key above\nunset logscale\n",
                 .ncurve = 2,
                 .curve = p->curve[i]};
}

static void plot_sensitivity(const cpl_calibration *c, tdm_error *err) {
  panels *p = calloc(1, sizeof *p);
  for (int k = 0; p && k < c->nparameter && err->status == TDM_OK; k++)
    add_sensitivity(p, c, k, err);
  if (p)
    write_panels(p, c->o->out, "sensitivity", err);
}

tdm_status cpl_calibration_plot(cpl_calibration *c, tdm_error *err) {
  plot_path(c, err);
  if (err->status == TDM_OK)
    plot_fit(c, err);
  if (err->status == TDM_OK)
    plot_sensitivity(c, err);
  return err->status;
}
