/* What a sweep leaves: the table, the JSON. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/sweep/sweep.h"

#include "coupler/results/html.h"
#include "coupler/results/table.h"
#include "coupler/scheme/schemes.h"
#include "coupler/sweep/sweep_rows.h"
#include "protocol/version.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const double good_r2 = 0.99; /* [L18] marks cells above it */

tdm_status cpl_sweep_file(const cpl_sweep_options *o, const char *name, FILE **f, tdm_error *err) {
  char file[4352];
  snprintf(file, sizeof file, "%s/%s", o->out, name);
  *f = fopen(file, "w");
  return *f ? TDM_OK : tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno));
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
  if (!is_in_paper(cpl_row_text(row, "scheme")))
    return NAN;
  snprintf(column, sizeof column, "r2_%s", name);
  const double *dt = cpl_table_column(t, "dt", NULL), *n = cpl_table_column(t, "n", NULL);
  const double *value = cpl_table_column(t, column, NULL);
  for (int i = 0; dt && n && value && i < t->nrow; i++)
    if (fabs(dt[i] / cpl_row_number(row, NULL, "dt") - 1) < 1e-9 && n[i] == cpl_row_number(row, NULL, "n"))
      return value[i];
  return NAN;
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

static void print_table(const cpl_cell *cell, int ncell, const cpl_columns *c, const cpl_table *paper) {
  bool colour = isatty(1);
  printf("%-44s %-8s %8s %10s %10s %10s", "cell", "status", "wall", "window", "energy", "estimate");
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
    printf("%-44s %-8s %6.1f s", cell[k].name, cpl_row_text(row, "status"),
           fmax(0, cpl_row_number(row, NULL, "wall_s")));
    print_small(1e6 * cpl_row_number(row, NULL, "window_s"), "%.1f us");
    print_small(cpl_row_number(row, NULL, "energy_residual"), "%.1e");
    print_small(cpl_row_number(row, NULL, "estimate"), "%.1e");
    for (int i = 0; i < c->nstate; i++)
      print_number(cpl_row_number(row, "nse", c->state[i]), colour, true);
    for (int i = 0; i < c->nname; i++)
      print_number(cpl_row_number(row, "r2", c->name[i]), colour, true);
    for (int i = 0; i < c->nname; i++)
      if (!isnan(published(paper, row, c->name[i])))
        print_number(published(paper, row, c->name[i]), colour, true);
    printf("  %s\n", cpl_row_text(row, "reason"));
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

static void html_prices(FILE *f, const cpl_cell *cell, int ncell, const cpl_columns *c) {
  const char *scheme[CPL_SCHEMES_MAX];
  int n = cpl_distinct_schemes(cell, ncell, NULL, "window_s", scheme), best = cpl_cheapest(cell, ncell, c);
  if (best >= 0) {
    fprintf(f, "<p>Cheapest with all nse at least %g: ", cpl_good_nse);
    cpl_html_text(f, cell[best].name);
    fprintf(f, ", %.2f s</p>\n", cpl_row_number(cell[best].row, NULL, "wall_s"));
  }
  fputs("<table>\n<tr><th>scheme</th><th>price of a window [µs], median</th></tr>\n", f);
  for (int i = 0; i < n; i++) {
    fputs("<tr><td>", f);
    cpl_html_text(f, scheme[i]);
    fputs("</td>", f);
    html_small(f, 1e6 * cpl_price(cell, ncell, scheme[i]), "%.1f");
    fputs("</tr>\n", f);
  }
  fputs("</table>\n", f);
}

static void print_prices(const cpl_cell *cell, int ncell, const cpl_columns *c) {
  const char *scheme[CPL_SCHEMES_MAX];
  int n = cpl_distinct_schemes(cell, ncell, NULL, "window_s", scheme), best = cpl_cheapest(cell, ncell, c);
  for (int i = 0; i < n; i++)
    printf("price of a window, %-10s %8.1f us (median)\n", scheme[i], 1e6 * cpl_price(cell, ncell, scheme[i]));
  if (best >= 0)
    printf("cheapest with all nse >= %g: %s, %.2f s\n", cpl_good_nse, cell[best].name,
           cpl_row_number(cell[best].row, NULL, "wall_s"));
  else if (c->nstate > 0)
    printf("no cell has all nse >= %g\n", cpl_good_nse);
}

static tdm_status write_html(const cpl_sweep_options *o, const cpl_cell *cell, int ncell, const cpl_columns *c,
                             const cpl_table *paper, tdm_error *err) {
  FILE *f;
  if (cpl_sweep_file(o, "table.html", &f, err) != TDM_OK)
    return err->status;
  cpl_html_head(f, "tandem sweep");
  fputs("<p>Marked: above 0.99.</p>\n<table>\n<tr><th>cell</th><th>status</th><th>wall [s]</th>"
        "<th>window [µs]</th><th>energy residual</th><th>1 − nse, estimated</th>",
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
    fprintf(f, "%s</td><td>%s</td><td>%.1f</td>", curves ? "</a>" : "", cpl_row_text(row, "status"),
            fmax(0, cpl_row_number(row, NULL, "wall_s")));
    html_small(f, 1e6 * cpl_row_number(row, NULL, "window_s"), "%.1f");
    html_small(f, cpl_row_number(row, NULL, "energy_residual"), "%.1e");
    html_small(f, cpl_row_number(row, NULL, "estimate"), "%.1e");
    for (int i = 0; i < c->nstate; i++)
      html_number(f, cpl_row_number(row, "nse", c->state[i]));
    for (int i = 0; i < c->nname; i++)
      html_number(f, cpl_row_number(row, "r2", c->name[i]));
    for (int i = 0; paper->nrow && i < c->nname; i++)
      html_number(f, published(paper, row, c->name[i]));
    fputs("<td>", f);
    cpl_html_text(f, cpl_row_text(row, "reason"));
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

static tdm_status write_json(const cpl_sweep_options *o, const cpl_cell *cell, int ncell, const cpl_columns *c,
                             tdm_error *err) {
  char file[4352];
  json_t *rows = json_array();
  for (int k = 0; k < ncell; k++)
    if (cell[k].row)
      json_array_append(rows, cell[k].row);
  int k = cpl_cheapest(cell, ncell, c);
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

static tdm_status write_csv(const cpl_sweep_options *o, const cpl_cell *cell, int ncell, const cpl_columns *c,
                            tdm_error *err) {
  FILE *f;
  if (cpl_sweep_file(o, "sweep.csv", &f, err) != TDM_OK)
    return err->status;
  fputs("dt [s],n [1],scheme,status,wall [s],error [1],pareto [1]", f);
  for (int i = 0; i < c->nstate; i++)
    fprintf(f, ",nse_%s [1]", c->state[i]);
  for (int i = 0; i < c->nname; i++)
    fprintf(f, ",r2_%s [1]", c->name[i]);
  fputs(",energy_residual [1],window [s],estimate [1]\n", f);
  for (int k = 0; k < ncell; k++) {
    const json_t *row = cell[k].row;
    if (!row)
      continue;
    fprintf(f, "%g,%g,%s,%s,%.4g,%.6g,%d", cpl_row_number(row, NULL, "dt"), cpl_row_number(row, NULL, "n"),
            cpl_name_fits_file(cpl_row_text(row, "scheme")) ? cpl_row_text(row, "scheme") : "?",
            cpl_row_text(row, "status"), cpl_row_number(row, NULL, "wall_s"), cpl_row_error(row, c),
            cpl_on_front(cell, ncell, k, c));
    for (int i = 0; i < c->nstate; i++)
      fprintf(f, ",%.8g", cpl_row_number(row, "nse", c->state[i]));
    for (int i = 0; i < c->nname; i++)
      fprintf(f, ",%.8g", cpl_row_number(row, "r2", c->name[i]));
    fprintf(f, ",%.6g,%.6g,%.6g\n", cpl_row_number(row, NULL, "energy_residual"), cpl_row_number(row, NULL, "window_s"),
            cpl_row_number(row, NULL, "estimate"));
  }
  fclose(f);
  return TDM_OK;
}

tdm_status cpl_sweep_report(const cpl_sweep_options *o, const cpl_cell *cell, int ncell, tdm_error *err) {
  cpl_columns c = cpl_columns_find(cell, ncell);
  cpl_table paper = read_published(o);
  tdm_error plot = {0};
  print_table(cell, ncell, &c, &paper);
  print_prices(cell, ncell, &c);
  tdm_error html = {0};
  write_csv(o, cell, ncell, &c, err);
  write_html(o, cell, ncell, &c, &paper, &html);
  if (html.status != TDM_OK)
    tdm_fail(err, html.status, NULL, "%s", html.message);
  cpl_sweep_plots(o, cell, ncell, &c, &plot);
  if (plot.status != TDM_OK)
    fprintf(stderr, "tandem: notice: %s\n", plot.message);
  tdm_error json = {0};
  if (write_json(o, cell, ncell, &c, &json) != TDM_OK)
    tdm_fail(err, json.status, NULL, "%s", json.message);
  cpl_table_free(&paper);
  printf("table, JSON, plots and the cells' curves in %s (table.html shows them)\n", o->out);
  return err->status;
}
