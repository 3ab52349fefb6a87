/* What a sweep leaves: the table, the JSON, heat maps, error against run time. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/sweep/sweep.h"

#include "coupler/report/html.h"
#include "coupler/scheme/schemes.h"
#include "coupler/verify/table.h"
#include "protocol/version.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double good_r2 = 0.99;   /* [L18] marks cells above it */
static const double good_nse = 0.999; /* of the cells among which the cheapest is named */
enum { SCHEMES_MAX = 8 };

static const char *text_of(const json_t *row, const char *key) {
  const char *text = json_string_value(json_object_get(row, key));
  return text ? text : "";
}

static double number_of(const json_t *row, const char *group, const char *key) {
  const json_t *value = json_object_get(group ? json_object_get(row, group) : row, key);
  return json_is_number(value) ? json_number_value(value) : NAN;
}

/* The names of the numbers that rows have: from any row, they are the same in all. */
typedef struct {
  const char *name[8]; /* of r2: states, load, load_20ms */
  int nname;
  const char *state[4]; /* of nse */
  int nstate;
} columns;

static columns find_columns(const cpl_cell *cell, int ncell) {
  columns c = {0};
  const char *key;
  json_t *value;
  for (int i = 0; i < ncell && c.nname == 0; i++) {
    json_object_foreach(json_object_get(cell[i].row, "r2"), key, value) if (c.nname < 8) c.name[c.nname++] = key;
    json_object_foreach(json_object_get(cell[i].row, "nse"), key, value) if (c.nstate < 4) c.state[c.nstate++] = key;
  }
  return c;
}

/* ---- what the paper has for the same cells ---- */

/* published.csv beside the scene: dt, n, and r2_<name> columns; zeroed when there is none. */
static cpl_table read_published(const cpl_sweep_options *o) {
  static const char *const axes[] = {"time.dt", "coupling.n", "coupling.scheme"};
  char file[4200];
  cpl_table t = {0};
  for (int a = 0; a < o->naxis; a++) /* with anything else changed it is not the paper's run */
    if (strcmp(o->axis[a].path, axes[0]) && strcmp(o->axis[a].path, axes[1]) && strcmp(o->axis[a].path, axes[2]))
      return t;
  const char *slash = strrchr(o->scene, '/');
  snprintf(file, sizeof file, "%.*spublished.csv", slash ? (int)(slash - o->scene) + 1 : 0, o->scene);
  if (access(file, R_OK) == 0)
    cpl_table_read(&t, file, NULL);
  return t;
}

static bool is_in_paper(const char *scheme) {
  for (int k = 0; cpl_schemes[k]; k++)
    if (strcmp(cpl_schemes[k]->name, scheme) == 0)
      return cpl_schemes[k]->in_paper;
  return false;
}

/* The paper's own value for a cell; NaN where it has none. */
static double published(const cpl_table *t, const json_t *row, const char *name) {
  char column[64];
  if (!is_in_paper(text_of(row, "scheme")))
    return NAN;
  snprintf(column, sizeof column, "r2_%s", name);
  const double *dt = cpl_table_column(t, "dt", NULL), *n = cpl_table_column(t, "n", NULL);
  const double *value = cpl_table_column(t, column, NULL);
  for (int i = 0; dt && n && value && i < t->nrow; i++)
    if (fabs(dt[i] / number_of(row, NULL, "dt") - 1) < 1e-9 && n[i] == number_of(row, NULL, "n"))
      return value[i];
  return NAN;
}

/* ---- cells against each other ---- */

/* The largest 1 - nse of a row's states; NaN without numbers. */
static double error_of(const json_t *row, const columns *c) {
  double error = c->nstate ? 0 : NAN;
  for (int i = 0; i < c->nstate; i++)
    error = isnan(error) ? NAN : fmax(error, 1 - number_of(row, "nse", c->state[i]));
  for (int i = 0; i < c->nstate; i++)
    if (isnan(number_of(row, "nse", c->state[i])))
      error = NAN;
  return error;
}

/* The cell of least wall time among those whose states all have an nse of at least good_nse; -1: none. */
static int cheapest(const cpl_cell *cell, int ncell, const columns *c) {
  int best = -1;
  for (int k = 0; k < ncell; k++) {
    bool good = strcmp(text_of(cell[k].row, "status"), "ok") == 0 && error_of(cell[k].row, c) <= 1 - good_nse;
    double wall = number_of(cell[k].row, NULL, "wall_s");
    if (good && (best < 0 || wall < number_of(cell[best].row, NULL, "wall_s")))
      best = k;
  }
  return best;
}

/* Schemes of the rows that have a number, without repeats, in order of appearance. */
static int distinct_schemes(const cpl_cell *cell, int ncell, const char *group, const char *key, const char **out) {
  int n = 0;
  for (int k = 0; k < ncell; k++) {
    const char *scheme = text_of(cell[k].row, "scheme");
    int i = 0;
    while (i < n && strcmp(out[i], scheme) != 0)
      i++;
    if (i == n && n < SCHEMES_MAX && !isnan(number_of(cell[k].row, group, key)))
      out[n++] = scheme;
  }
  return n;
}

static int by_size(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* The price of a window of a scheme [s]: median of its cells. */
static double price_of(const cpl_cell *cell, int ncell, const char *scheme) {
  double *price = calloc((size_t)ncell + 1, sizeof *price);
  int n = 0;
  for (int k = 0; price && k < ncell; k++) {
    double x = number_of(cell[k].row, NULL, "window_s");
    if (strcmp(text_of(cell[k].row, "scheme"), scheme) == 0 && !isnan(x))
      price[n++] = x;
  }
  if (price)
    qsort(price, (size_t)n, sizeof *price, by_size);
  double median = n > 0 ? 0.5 * (price[(n - 1) / 2] + price[n / 2]) : NAN;
  free(price);
  return median;
}

/* ---- tables ---- */

static void print_number(double x, bool colour, bool judged) {
  char text[16] = "-";
  if (!isnan(x))
    snprintf(text, sizeof text, x > -10 ? "%.5f" : "%.1e", x);
  bool good = judged && x > good_r2;
  printf(" %s%10s%s", colour && good ? "\033[32m" : "", text, colour && good ? "\033[0m" : "");
}

static void print_small(double x, const char *format) {
  char text[24] = "-";
  if (!isnan(x))
    snprintf(text, sizeof text, format, x);
  printf(" %10s", text);
}

static void print_table(const cpl_cell *cell, int ncell, const columns *c, const cpl_table *paper) {
  bool colour = isatty(1);
  printf("%-44s %-8s %8s %10s %10s", "cell", "status", "wall", "window", "energy");
  for (int i = 0; i < c->nstate; i++)
    printf(" %6s%-4s", "nse_", c->state[i]);
  for (int i = 0; i < c->nname; i++)
    printf(" %4s%-6s", "r2_", c->name[i]);
  for (int i = 0; paper->nrow && i < c->nname; i++)
    if (strstr(c->name[i], "_20ms") == NULL)
      printf(" [L18]r2_%-2s", c->name[i]);
  puts("");
  for (int k = 0; k < ncell; k++) {
    const json_t *row = cell[k].row;
    if (!row)
      continue;
    printf("%-44s %-8s %6.1f s", cell[k].name, text_of(row, "status"), fmax(0, number_of(row, NULL, "wall_s")));
    print_small(1e6 * number_of(row, NULL, "window_s"), "%.1f us");
    print_small(number_of(row, NULL, "energy_residual"), "%.1e");
    for (int i = 0; i < c->nstate; i++)
      print_number(number_of(row, "nse", c->state[i]), colour, true);
    for (int i = 0; i < c->nname; i++)
      print_number(number_of(row, "r2", c->name[i]), colour, true);
    for (int i = 0; i < c->nname; i++)
      if (!isnan(published(paper, row, c->name[i])))
        print_number(published(paper, row, c->name[i]), colour, true);
    printf("  %s\n", text_of(row, "reason"));
  }
}

static void html_number(FILE *f, double x) {
  if (isnan(x))
    fputs("<td>–</td>", f);
  else
    fprintf(f, "<td%s>%.5f</td>", x > good_r2 ? " class=\"good\"" : "", x);
}

static void html_small(FILE *f, double x, const char *format) {
  fputs("<td>", f);
  if (isnan(x))
    fputs("–", f);
  else
    fprintf(f, format, x);
  fputs("</td>", f);
}

static tdm_status open_file(const cpl_sweep_options *o, const char *name, FILE **f, tdm_error *err) {
  char file[4352];
  snprintf(file, sizeof file, "%s/%s", o->out, name);
  *f = fopen(file, "w");
  return *f ? TDM_OK : tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno));
}

static void html_prices(FILE *f, const cpl_cell *cell, int ncell, const columns *c) {
  const char *scheme[SCHEMES_MAX];
  int n = distinct_schemes(cell, ncell, NULL, "window_s", scheme), best = cheapest(cell, ncell, c);
  if (best >= 0) {
    fprintf(f, "<p>Cheapest with all nse at least %g: ", good_nse);
    cpl_html_text(f, cell[best].name);
    fprintf(f, ", %.2f s</p>\n", number_of(cell[best].row, NULL, "wall_s"));
  }
  fputs("<table>\n<tr><th>scheme</th><th>price of a window [µs], median</th></tr>\n", f);
  for (int i = 0; i < n; i++) {
    fputs("<tr><td>", f);
    cpl_html_text(f, scheme[i]);
    fputs("</td>", f);
    html_small(f, 1e6 * price_of(cell, ncell, scheme[i]), "%.1f");
    fputs("</tr>\n", f);
  }
  fputs("</table>\n", f);
}

static void print_prices(const cpl_cell *cell, int ncell, const columns *c) {
  const char *scheme[SCHEMES_MAX];
  int n = distinct_schemes(cell, ncell, NULL, "window_s", scheme), best = cheapest(cell, ncell, c);
  for (int i = 0; i < n; i++)
    printf("price of a window, %-10s %8.1f us (median)\n", scheme[i], 1e6 * price_of(cell, ncell, scheme[i]));
  if (best >= 0)
    printf("cheapest with all nse >= %g: %s, %.2f s\n", good_nse, cell[best].name,
           number_of(cell[best].row, NULL, "wall_s"));
  else if (c->nstate > 0)
    printf("no cell has all nse >= %g\n", good_nse);
}

static tdm_status write_html(const cpl_sweep_options *o, const cpl_cell *cell, int ncell, const columns *c,
                             const cpl_table *paper, tdm_error *err) {
  FILE *f;
  if (open_file(o, "table.html", &f, err) != TDM_OK)
    return err->status;
  cpl_html_head(f, "tandem sweep");
  fputs("<p>Marked: above 0.99.</p>\n<table>\n<tr><th>cell</th><th>status</th><th>wall [s]</th>"
        "<th>window [µs]</th><th>energy residual</th>",
        f);
  for (int i = 0; i < c->nstate; i++)
    fprintf(f, "<th>nse %s</th>", c->state[i]);
  for (int i = 0; i < c->nname; i++)
    fprintf(f, "<th>r2 %s</th>", c->name[i]);
  for (int i = 0; paper->nrow && i < c->nname; i++)
    fprintf(f, "<th>[L18] r2 %s</th>", c->name[i]);
  fputs("<th></th></tr>\n", f);
  for (int k = 0; k < ncell; k++) {
    const json_t *row = cell[k].row;
    if (!row)
      continue;
    char picture[4352];
    snprintf(picture, sizeof picture, "%s/comparison.png", cell[k].dir);
    bool curves = access(picture, R_OK) == 0;
    fputs("<tr><td>", f);
    if (curves) {
      fputs("<a href=\"", f);
      cpl_html_link(f, picture + strlen(o->out) + 1);
      fputs("\">", f);
    }
    cpl_html_text(f, cell[k].name);
    fprintf(f, "%s</td><td>%s</td><td>%.1f</td>", curves ? "</a>" : "", text_of(row, "status"),
            fmax(0, number_of(row, NULL, "wall_s")));
    html_small(f, 1e6 * number_of(row, NULL, "window_s"), "%.1f");
    html_small(f, number_of(row, NULL, "energy_residual"), "%.1e");
    for (int i = 0; i < c->nstate; i++)
      html_number(f, number_of(row, "nse", c->state[i]));
    for (int i = 0; i < c->nname; i++)
      html_number(f, number_of(row, "r2", c->name[i]));
    for (int i = 0; paper->nrow && i < c->nname; i++)
      html_number(f, published(paper, row, c->name[i]));
    fputs("<td>", f);
    cpl_html_text(f, text_of(row, "reason"));
    fputs("</td></tr>\n", f);
  }
  fputs("</table>\n", f);
  html_prices(f, cell, ncell, c);
  if (c->nstate > 0)
    fputs("<img src=\"cost.png\" alt=\"error against run time\">\n", f);
  fputs("<img src=\"price.png\" alt=\"price of a window\">\n<img src=\"heat_energy.png\" alt=\"energy residual\">\n",
        f);
  for (int i = 0; i < c->nstate; i++)
    fprintf(f, "<img src=\"heat_%s.png\" alt=\"nse of %s\">\n", c->state[i], c->state[i]);
  fclose(f);
  return TDM_OK;
}

static tdm_status write_json(const cpl_sweep_options *o, const cpl_cell *cell, int ncell, const columns *c,
                             tdm_error *err) {
  char file[4352];
  json_t *rows = json_array();
  for (int k = 0; k < ncell; k++)
    if (cell[k].row)
      json_array_append(rows, cell[k].row);
  int k = cheapest(cell, ncell, c);
  json_t *json = json_pack("{s:s, s:o, s:o}", "tandem", TDM_VERSION, "rows", rows, "cheapest",
                           k < 0 ? json_null() : json_string(cell[k].name));
  snprintf(file, sizeof file, "%s/sweep.json", o->out);
  const char *files[] = {file, o->json};
  for (int i = 0; i < 2; i++)
    if (files[i] && json_dump_file(json, files[i], JSON_INDENT(2)) != 0)
      tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", files[i], strerror(errno));
  json_decref(json);
  return err->status;
}

/* ---- error against run time ---- */

/* No other cell is both cheaper and better. */
static bool on_front(const cpl_cell *cell, int ncell, int k, const columns *c) {
  double error = error_of(cell[k].row, c), wall = number_of(cell[k].row, NULL, "wall_s");
  for (int j = 0; j < ncell; j++)
    if (j != k && error_of(cell[j].row, c) < error && number_of(cell[j].row, NULL, "wall_s") < wall)
      return false;
  return !isnan(error);
}

static tdm_status write_csv(const cpl_sweep_options *o, const cpl_cell *cell, int ncell, const columns *c,
                            tdm_error *err) {
  FILE *f;
  if (open_file(o, "sweep.csv", &f, err) != TDM_OK)
    return err->status;
  fputs("dt [s],n [1],scheme,status,wall [s],error [1],pareto [1]", f);
  for (int i = 0; i < c->nstate; i++)
    fprintf(f, ",nse_%s [1]", c->state[i]);
  for (int i = 0; i < c->nname; i++)
    fprintf(f, ",r2_%s [1]", c->name[i]);
  fputs(",energy_residual [1],window [s]\n", f);
  for (int k = 0; k < ncell; k++) {
    const json_t *row = cell[k].row;
    if (!row)
      continue;
    fprintf(f, "%g,%g,%s,%s,%.4g,%.6g,%d", number_of(row, NULL, "dt"), number_of(row, NULL, "n"),
            cpl_name_fits_file(text_of(row, "scheme")) ? text_of(row, "scheme") : "?", text_of(row, "status"),
            number_of(row, NULL, "wall_s"), error_of(row, c), on_front(cell, ncell, k, c));
    for (int i = 0; i < c->nstate; i++)
      fprintf(f, ",%.8g", number_of(row, "nse", c->state[i]));
    for (int i = 0; i < c->nname; i++)
      fprintf(f, ",%.8g", number_of(row, "r2", c->name[i]));
    fprintf(f, ",%.6g,%.6g\n", number_of(row, NULL, "energy_residual"), number_of(row, NULL, "window_s"));
  }
  fclose(f);
  return TDM_OK;
}

/* One curve a scheme of sweep.csv, each with its symbol and colour: what gnuplot calls x and y, of the rows that have a
 * scheme's name. Returns how many. */
typedef struct {
  char using[SCHEMES_MAX][256], style[SCHEMES_MAX][48];
  tdm_curve curve[SCHEMES_MAX + 2];
} scheme_curves;

static int curves_by_scheme(scheme_curves *out, const cpl_cell *cell, int ncell, const char *key, const char *x,
                            const char *y) {
  const char *scheme[SCHEMES_MAX];
  int n = distinct_schemes(cell, ncell, NULL, key, scheme);
  for (int i = 0; i < n; i++) {
    snprintf(out->using[i], sizeof out->using[i], "(strcol(3) eq '%.32s' ? %s : NaN):(%s)", scheme[i], x, y);
    snprintf(out->style[i], sizeof out->style[i], "points pt %d lc %d ps 1.4", 2 * i + 5, i + 1);
    out->curve[i] = (tdm_curve){"sweep.csv", out->using[i], scheme[i], out -> style[i]};
  }
  return n;
}

static void plot_cost(const cpl_sweep_options *o, const cpl_cell *cell, int ncell, tdm_error *err) {
  static const char error[] = "$6 > 10 ? 10 : $6";
  scheme_curves c;
  int n = curves_by_scheme(&c, cell, ncell, "wall_s", "$5", error);
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
    double x = number_of(cell[k].row, NULL, key);
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
  const char *scheme[SCHEMES_MAX];
  int ndt = distinct(cell, ncell, "dt", dt, CPL_VALUES_MAX), nn = distinct(cell, ncell, "n", n, CPL_VALUES_MAX);
  int nscheme = distinct_schemes(cell, ncell, m->group, m->key, scheme);
  char file[SCHEMES_MAX][64], title[SCHEMES_MAX][96], setup[4096] = "", name[64];
  tdm_curve curves[SCHEMES_MAX][2];
  tdm_plot plots[SCHEMES_MAX];
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
    if (open_file(o, file[s], &f, err) != TDM_OK)
      return err->status;
    fprintf(f, "n,dt,%s\n", m->name);
    for (int k = 0; k < ncell; k++) {
      const json_t *row = cell[k].row;
      double value = number_of(row, m->group, m->key);
      if (strcmp(text_of(row, "scheme"), scheme[s]) != 0 || isnan(value) || !same_others(o, cell[0].row, row))
        continue;
      int i = 0, j = 0;
      while (i < nn && n[i] != number_of(row, NULL, "n"))
        i++;
      while (j < ndt && dt[j] != number_of(row, NULL, "dt"))
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

tdm_status cpl_sweep_report(const cpl_sweep_options *o, const cpl_cell *cell, int ncell, tdm_error *err) {
  columns c = find_columns(cell, ncell);
  cpl_table paper = read_published(o);
  tdm_error plot = {0};
  print_table(cell, ncell, &c, &paper);
  print_prices(cell, ncell, &c);
  tdm_error html = {0};
  write_csv(o, cell, ncell, &c, err);
  write_html(o, cell, ncell, &c, &paper, &html);
  if (html.status != TDM_OK)
    tdm_fail(err, html.status, NULL, "%s", html.message);
  bool numbers = false;
  for (int k = 0; k < ncell; k++)
    numbers = numbers || !isnan(error_of(cell[k].row, &c));
  if (numbers) {
    plot_cost(o, cell, ncell, &plot);
    for (int i = 0; i < c.nstate && plot.status == TDM_OK; i++)
      plot_heat_of_state(o, cell, ncell, c.state[i], &plot);
  }
  if (plot.status == TDM_OK)
    plot_price(o, cell, ncell, 8 + c.nstate + c.nname, &plot);
  if (plot.status == TDM_OK)
    plot_heat_of_energy(o, cell, ncell, &plot);
  if (plot.status != TDM_OK)
    fprintf(stderr, "tandem: notice: %s\n", plot.message);
  tdm_error json = {0};
  if (write_json(o, cell, ncell, &c, &json) != TDM_OK)
    tdm_fail(err, json.status, NULL, "%s", json.message);
  cpl_table_free(&paper);
  printf("table, JSON, plots and the cells' curves in %s (table.html shows them)\n", o->out);
  return err->status;
}
