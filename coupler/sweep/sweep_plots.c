/* Plots of a sweep: error against run time, the price of a window, heat maps. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/sweep/sweep.h"

#include "coupler/sweep/sweep_rows.h"
#include "protocol/app/plot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* One curve a scheme of sweep.csv, each with its symbol and colour: what gnuplot calls x and y, of the rows that have a
 * scheme's name. Returns how many. */
typedef struct {
  char using[CPL_SCHEMES_MAX][256], style[CPL_SCHEMES_MAX][48];
  tdm_curve curve[CPL_SCHEMES_MAX + 4];
} scheme_curves;

static int curves_by_scheme(scheme_curves *out, const cpl_cell *cell, int ncell, const char *key, const char *x,
                            const char *y) {
  const char *scheme[CPL_SCHEMES_MAX];
  int n = cpl_distinct_schemes(cell, ncell, NULL, key, scheme);
  for (int i = 0; i < n; i++) {
    snprintf(out->using[i], sizeof out->using[i], "(strcol(3) eq '%.32s' ? %s : NaN):(%s)", scheme[i], x, y);
    snprintf(out->style[i], sizeof out->style[i], "points pt %d lc %d ps 1.4", 2 * i + 5, i + 1);
    out->curve[i] = (tdm_curve){"sweep.csv", out->using[i], scheme[i], out -> style[i]};
  }
  return n;
}

/* the estimate of a cell's error is in this column of sweep.csv: drawn beside the true one, joined with it by a line */
static void plot_cost(const cpl_sweep_options *o, const cpl_cell *cell, int ncell, int estimate, tdm_error *err) {
  static const char error[] = "$6 > 10 ? 10 : $6";
  char hollow[64], line[128];
  scheme_curves c;
  int n = curves_by_scheme(&c, cell, ncell, "wall_s", "$5", error);
  snprintf(hollow, sizeof hollow, "5:($%d > 10 ? 10 : $%d)", estimate, estimate);
  snprintf(line, sizeof line, "5:($6 > 10 ? 10 : $6):(0):(($%d > 10 ? 10 : $%d) - ($6 > 10 ? 10 : $6))", estimate,
           estimate);
  c.curve[n++] = (tdm_curve){"sweep.csv", line, "", "vectors nohead lw 0.6 lc 'grey'"};
  c.curve[n++] = (tdm_curve){"sweep.csv", hollow, "estimate of the run", "points pt 2 ps 1.3 lw 1.5 lc 'black'"};
  c.curve[n++] = (tdm_curve){"sweep.csv", "($7 == 1 ? $5 : NaN):($6 > 10 ? 10 : $6)", "Pareto front",
                             "points pt 6 ps 2.4 lw 2 lc 'black'"};
  c.curve[n++] = (tdm_curve){"sweep.csv", "($7 == 1 ? $5 : NaN):($6 > 10 ? 10 : $6):(sprintf('%.0e n=%g', $1, $2))", "",
                             "labels left rotate by 50 offset 0.6,0.8 font ',8'"};
  const tdm_plot plot = {
      .title = "Error against run time (above 10: drawn at 10). Pareto front: no cell is both cheaper and better",
      .xlabel = "wall time [s]",
      .ylabel = "largest 1 - nse of the states",
      .setup = "set logscale xy\nset format '%g'\nset key outside right top\n"
               "set offsets graph 0.05, graph 0.2, graph 0.4, graph 0.05\n",
      .ncurve = n,
      .curve = c.curve,
  };
  tdm_plot_write(o->out, "cost", 1, &plot, err);
}

/* `before` columns of sweep.csv stand in front of the price */
static void plot_price(const cpl_sweep_options *o, const cpl_cell *cell, int ncell, int before, tdm_error *err) {
  char price[32];
  scheme_curves c;
  snprintf(price, sizeof price, "1e6*$%d", before + 1);
  int n = curves_by_scheme(&c, cell, ncell, "window_s", "$2", price);
  const tdm_plot plot = {
      .title = "Price of a window: the loop's time without DEM's own work",
      .xlabel = "n",
      .ylabel = "price of a window [us]",
      .setup = "set logscale xy\nset format '%g'\nset key outside right top\n"
               "set offsets graph 0.1, graph 0.1, graph 0.1, graph 0.1\n",
      .ncurve = n,
      .curve = c.curve,
  };
  if (n > 0)
    tdm_plot_write(o->out, "price", 1, &plot, err);
}

/* ---- heat maps ---- */

/* Values of a number in all rows, without repeats, in order of appearance. */
static int distinct(const cpl_cell *cell, int ncell, const char *key, double *out, int most) {
  int n = 0;
  for (int k = 0; k < ncell; k++) {
    double x = cpl_row_number(cell[k].row, NULL, key);
    int i = 0;
    while (i < n && out[i] != x)
      i++;
    if (i == n && n < most && !isnan(x))
      out[n++] = x;
  }
  return n;
}

/* Do two cells differ in nothing but dt, n and scheme? */
static bool same_others(const cpl_sweep_options *o, const json_t *a, const json_t *b) {
  for (int i = 0; i < o->naxis; i++) {
    const char *path = o->axis[i].path;
    if (strcmp(path, "time.dt") == 0 || strcmp(path, "coupling.n") == 0 || strcmp(path, "coupling.scheme") == 0)
      continue;
    if (!json_equal(json_object_get(json_object_get(a, "settings"), path),
                    json_object_get(json_object_get(b, "settings"), path)))
      return false;
  }
  return true;
}

/* A number of the rows as a map, and how it is coloured. */
typedef struct {
  const char *group, *key; /* where it stands in a row; group NULL: in the row itself */
  const char *name, *title;
  const char *colour; /* gnuplot commands */
  const char *drawn;  /* its value as a colour, gnuplot */
} map;

/* One panel a scheme: a number over n (across) and dt (down), for the first values of all other axes. Cells without a
 * number stay white. */
static tdm_status plot_heat(const cpl_sweep_options *o, const cpl_cell *cell, int ncell, const map *m, tdm_error *err) {
  double dt[CPL_VALUES_MAX], n[CPL_VALUES_MAX];
  const char *scheme[CPL_SCHEMES_MAX];
  int ndt = distinct(cell, ncell, "dt", dt, CPL_VALUES_MAX), nn = distinct(cell, ncell, "n", n, CPL_VALUES_MAX);
  int nscheme = cpl_distinct_schemes(cell, ncell, m->group, m->key, scheme);
  char file[CPL_SCHEMES_MAX][64], title[CPL_SCHEMES_MAX][96], setup[4096] = "", name[64];
  tdm_curve curves[CPL_SCHEMES_MAX][2];
  tdm_plot plots[CPL_SCHEMES_MAX];
  int used = snprintf(setup, sizeof setup, "unset key\n%sset xrange [-0.5:%g]\nset yrange [-0.5:%g]\nset xtics (",
                      m->colour, nn - 0.5, ndt - 0.5);
  for (int i = 0; i < nn; i++)
    used += snprintf(setup + used, sizeof setup - (size_t)used, "%s'%g' %d", i ? ", " : "", n[i], i);
  used += snprintf(setup + used, sizeof setup - (size_t)used, ")\nset ytics (");
  for (int i = 0; i < ndt; i++)
    used += snprintf(setup + used, sizeof setup - (size_t)used, "%s'%g' %d", i ? ", " : "", dt[i], i);
  snprintf(setup + used, sizeof setup - (size_t)used, ")\n");
  for (int s = 0; s < nscheme; s++) {
    FILE *f;
    snprintf(file[s], sizeof file[s], "heat_%s_%.32s.csv", m->name, scheme[s]);
    if (cpl_sweep_file(o, file[s], &f, err) != TDM_OK)
      return err->status;
    fprintf(f, "n,dt,%s\n", m->name);
    for (int k = 0; k < ncell; k++) {
      const json_t *row = cell[k].row;
      double value = cpl_row_number(row, m->group, m->key);
      if (strcmp(cpl_row_text(row, "scheme"), scheme[s]) != 0 || isnan(value) || !same_others(o, cell[0].row, row))
        continue;
      int i = 0, j = 0;
      while (i < nn && n[i] != cpl_row_number(row, NULL, "n"))
        i++;
      while (j < ndt && dt[j] != cpl_row_number(row, NULL, "dt"))
        j++;
      fprintf(f, "%d,%d,%.6g\n", i, j, value);
    }
    fclose(f);
    snprintf(title[s], sizeof title[s], "%s, %s", m->title, scheme[s]);
    curves[s][0] = (tdm_curve){file[s], m->drawn, "", "points pt 5 ps 7 palette"};
    curves[s][1] = (tdm_curve){file[s], "1:2:(sprintf('%.4g', $3))", "", "labels"};
    plots[s] = (tdm_plot){
        .title = title[s],
        .xlabel = "n",
        .ylabel = "dt [s]",
        .setup = setup,
        .ncurve = 2,
        .curve = curves[s],
    };
  }
  snprintf(name, sizeof name, "heat_%s", m->name);
  return nscheme ? tdm_plot_write(o->out, name, nscheme, plots, err) : TDM_OK;
}

static tdm_status plot_heat_of_state(const cpl_sweep_options *o, const cpl_cell *cell, int ncell, const char *state,
                                     tdm_error *err) {
  char title[64];
  snprintf(title, sizeof title, "nse of %.32s", state);
  const map m = {
      .group = "nse",
      .key = state,
      .name = state,
      .title = title,
      .colour = "set cbrange [0.9:1]\nset palette defined (0 '#bb3333', 0.9 '#ffdd88', 1 '#33aa33')\n",
      .drawn = "1:2:($3 < 0.9 ? 0.9 : $3)",
  };
  return plot_heat(o, cell, ncell, &m, err);
}

/* colours by the decade, from 1e-6 to 1 */
static tdm_status plot_heat_of_energy(const cpl_sweep_options *o, const cpl_cell *cell, int ncell, tdm_error *err) {
  static const map m = {
      .key = "energy_residual",
      .name = "energy",
      .title = "energy residual",
      .colour = "set cbrange [-6:0]\nset cblabel 'log10'\n"
                "set palette defined (0 '#33aa33', 0.67 '#ffdd88', 1 '#bb3333')\n",
      .drawn = "1:2:($3 > 1 ? 0 : $3 < 1e-6 ? -6 : log10($3))",
  };
  return plot_heat(o, cell, ncell, &m, err);
}

tdm_status cpl_sweep_plots(const cpl_sweep_options *o, const cpl_cell *cell, int ncell, const cpl_columns *c,
                           tdm_error *err) {
  bool numbers = false;
  for (int k = 0; k < ncell; k++)
    numbers = numbers || !isnan(cpl_row_error(cell[k].row, c)) || !isnan(cpl_row_number(cell[k].row, NULL, "estimate"));
  if (numbers) {
    plot_cost(o, cell, ncell, 10 + c->nstate + c->nname, err);
    for (int i = 0; i < c->nstate && err->status == TDM_OK; i++)
      plot_heat_of_state(o, cell, ncell, c->state[i], err);
  }
  if (err->status == TDM_OK)
    plot_price(o, cell, ncell, 8 + c->nstate + c->nname, err);
  if (err->status == TDM_OK)
    plot_heat_of_energy(o, cell, ncell, err);
  return err->status;
}
