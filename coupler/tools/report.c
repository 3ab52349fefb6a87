/* `tandem report DIR`: see report.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/tools/report.h"

#include "coupler/observe/observers.h"
#include "coupler/tools/html.h"
#include "coupler/tools/table.h"
#include "protocol/app/thin.h"
#include "protocol/base/input.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PANELS_MAX = 64, CURVES_MAX = 256, PICTURES_MAX = 64 };

typedef struct {
  const char *dir;
  char picture[PICTURES_MAX][128]; /* names without ending */
  int npicture;
  const json_t *summary;
} report;

static void add_picture(report *r, const char *name) {
  if (r->npicture < PICTURES_MAX)
    snprintf(r->picture[r->npicture++], sizeof r->picture[0], "%s", name);
}

/* ---- time histories ---- */

/* What columns of one panel share: the name without its last part's x, y, z or w, and the unit. "joint.guide.fx [N]"
 * and "joint.guide.fy [N]" give "joint.guide.f"; "energy.kinetic [J]" and "energy.potential [J]" give "energy". */
static void panel_key(const char *name, char *key, size_t size) {
  snprintf(key, size, "%s", name);
  char *last = strrchr(key, '.');
  last = last ? last + 1 : key;
  size_t n = strlen(last);
  if (n > 0 && n <= 2 && strchr("xyzw", last[n - 1]))
    last[n - 1] = 0;
  else if (last > key)
    *last = 0;
  n = strlen(key);
  if (n > 0 && key[n - 1] == '.')
    key[n - 1] = 0;
}

/* The panels of one CSV file, in the order of its columns. */
typedef struct {
  tdm_plot plot[PANELS_MAX];
  tdm_plot_data data[PANELS_MAX];
  tdm_curve curve[CURVES_MAX];
  char key[PANELS_MAX][96], unit[PANELS_MAX][48], name[CURVES_MAX][96], using[CURVES_MAX][16];
  int column[CURVES_MAX]; /* of the table, behind the time */
  int nplot, ncurve;
} panels;

static void add_column(panels *p, const char *head, int column) {
  char name[96], key[96];
  const char *unit = strchr(head, '[');
  snprintf(name, sizeof name, "%.*s", (int)strcspn(head, " "), head);
  panel_key(name, key, sizeof key);
  int i = p->nplot - 1; /* columns that belong together stand together */
  if (i < 0 || strcmp(p->key[i], key) != 0 || strcmp(p->unit[i], unit ? unit : "") != 0) {
    if (p->nplot == PANELS_MAX)
      return;
    i = p->nplot++;
    snprintf(p->key[i], sizeof p->key[i], "%s", key);
    snprintf(p->unit[i], sizeof p->unit[i], "%s", unit ? unit : "");
    p->plot[i] = (tdm_plot){.title = p->key[i], .xlabel = "time [s]", .ylabel = p->unit[i]};
    p->plot[i].curve = &p->curve[p->ncurve];
  }
  if (p->ncurve == CURVES_MAX)
    return;
  int c = p->ncurve++;
  snprintf(p->name[c], sizeof p->name[c], "%s", name);
  snprintf(p->using[c], sizeof p->using[c], "1:%d", p->plot[i].ncurve + 2);
  p->curve[c] = (tdm_curve){NULL, p->using[c], p -> name[c], "lines"};
  p->column[c] = column;
  p->plot[i].ncurve++;
}

/* gnuplot refuses a panel without a single number, such as an energy that nobody could look at */
static bool has_numbers(const cpl_table *table, int column) {
  bool some = false;
  for (int i = 0; column < table->ncolumn && i < table->nrow; i++)
    some = some || isfinite(table->data[(size_t)column * (size_t)table->nrow + (size_t)i]);
  return some;
}

/* The panels with their data, thinned, as one picture. */
static tdm_status plot_panels(const report *r, panels *p, const cpl_table *table, const char *picture, tdm_error *err) {
  tdm_thin thin;
  const int ncolumn = table->ncolumn - 1, nrow = table->nrow;
  double *values = calloc((size_t)ncolumn + 1, sizeof *values);
  bool good = tdm_thin_begin(&thin, ncolumn) && values;
  for (int i = 0; i < nrow && good; i++) {
    for (int c = 0; c < ncolumn; c++)
      values[c] = table->data[(size_t)(c + 1) * (size_t)nrow + (size_t)i];
    tdm_thin_add(&thin, table->data[i], values);
  }
  for (int i = 0; i < p->nplot && good; i++) {
    const tdm_plot *plot = &p->plot[i];
    double *rows = tdm_thin_table(&thin, p->column + (plot->curve - p->curve), plot->ncurve);
    p->data[i] = (tdm_plot_data){rows, tdm_thin_rows(&thin), plot->ncurve + 1};
    good = rows != NULL;
  }
  if (good)
    tdm_plot_write_data(r->dir, picture, p->nplot, p->plot, p->data, err);
  else
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int i = 0; i < p->nplot; i++)
    free(p->data[i].value);
  free(values);
  tdm_thin_free(&thin);
  return err->status;
}

static tdm_status plot_history(report *r, const char *path, tdm_error *err) {
  const char *file = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
  char picture[128], *line = NULL;
  cpl_table table = {0};
  size_t size = 0;
  snprintf(picture, sizeof picture, "%.*s", (int)(strlen(file) - strlen(".csv")), file);
  const char *why;
  FILE *f = tdm_open_input(path, false, &why);
  panels *p = calloc(1, sizeof *p);
  if (!f || !p || getline(&line, &size, f) <= 0)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be read: %s", path, f ? "it is empty" : why);
  if (f)
    fclose(f);
  if (err->status == TDM_OK && cpl_table_read(&table, path, err) == TDM_OK) {
    int column = 0;
    for (char *rest = line, *cell; (cell = strsep(&rest, ",")) != NULL;) {
      cell[strcspn(cell, "\r\n")] = 0;
      if (++column > 1 && has_numbers(&table, column - 1))
        add_column(p, cell, column - 2);
    }
    tdm_error plot = {0};
    if (p->nplot > 0 && plot_panels(r, p, &table, picture, &plot) == TDM_OK)
      add_picture(r, picture);
    else if (p->nplot > 0 && !tdm_plot_interrupted())
      fprintf(stderr, "tandem: notice: %s\n", plot.message);
  }
  cpl_table_free(&table);
  free(line);
  free(p);
  return err->status;
}

/* A history that the run may have written; one that is not there is none. */
static tdm_status plot_one(report *r, const char *name, tdm_error *err) {
  char path[4352];
  snprintf(path, sizeof path, "%s/%s", r->dir, name);
  return access(path, F_OK) == 0 ? plot_history(r, path, err) : err->status;
}

/* The files that this scene's run writes, by their names. */
static tdm_status plot_histories(report *r, const json_t *scene, tdm_error *err) {
  static const char *const files[] = {"ledger.csv", "mbd.csv", "dem.csv"};
  size_t i;
  json_t *body;
  json_array_foreach(json_object_get(json_object_get(scene, "coupling"), "bodies"), i, body) {
    char name[256];
    const char *mbd = json_string_value(json_object_get(body, cpl_role_names[CPL_MBD]));
    if (mbd && cpl_name_fits_file(mbd) && plot_one(r, cpl_record_body_file(mbd, name, sizeof name), err) != TDM_OK)
      return err->status;
  }
  for (int k = 0; k < 3; k++)
    plot_one(r, files[k], err);
  return err->status;
}

/* ---- where the time went ---- */

static double wall(const report *r, const char *part) {
  return json_number_value(json_object_get(json_object_get(r->summary, "wall_s"), part));
}

static tdm_status plot_time(report *r, tdm_error *err) {
  char path[4352];
  if (!json_object_get(r->summary, "wall_s"))
    return err->status; /* a run that did not come to its end */
  snprintf(path, sizeof path, "%s/time.csv", r->dir);
  tdm_mark_add_in(r->dir, "time.csv");
  FILE *f = fopen(path, "w");
  if (!f)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", path, strerror(errno));
  double exchange = wall(r, "dem_exchange") + wall(r, "mbd_exchange");
  fprintf(f, "part,time [s]\nstart,%g\nDEM,%g\nMBD,%g\nexchange,%g\nserver,%g\n", wall(r, "setup"), wall(r, "dem"),
          wall(r, "mbd"), exchange, wall(r, "coupling") - exchange);
  if (fclose(f) != 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", path, strerror(errno));
  static const tdm_curve bars = {"time.csv", "2:xtic(1)", "", "boxes"};
  static const tdm_plot plot = {"Where the time went",
                                "",
                                "wall time [s]",
                                "set style fill solid 0.6\nset boxwidth 0.6\nset yrange [0:*]\n",
                                1,
                                &bars};
  if (tdm_plot_write(r->dir, "time", 1, &plot, err) == TDM_OK)
    add_picture(r, "time");
  return err->status;
}

/* ---- agreement with the reference ---- */

static void print_agreement(FILE *page, const cpl_comparison *c) {
  fputs("<table><tr><th>curve</th><th>nse</th><th>r2</th><th>r2 of 20 ms means</th></tr>\n", page);
  printf("%-8s %12s %12s %18s\n", "curve", "nse", "r2", "r2, 20 ms means");
  for (int i = 0; i < c->ncurve; i++) {
    const cpl_compared *curve = &c->curve[i];
    double nse = cpl_comparison_nse(c, curve), r2 = cpl_comparison_r2(c, curve);
    double mean = cpl_comparison_r2_mean(c, curve, 0.02);
    printf("%-8s %12.6f %12.6f %18.6f\n", curve->name, nse, r2, mean);
    fputs("<tr><td>", page);
    cpl_html_text(page, curve->name);
    fprintf(page, "</td><td>%.6f</td><td>%.6f</td><td>%.6f</td></tr>\n", nse, r2, mean);
  }
  fputs("</table>\n", page);
  const char *key;
  json_t *value;
  json_object_foreach(c->notes, key, value) {
    printf("%s: %.6g\n", key, json_number_value(value));
    fputs("<p>", page);
    cpl_html_text(page, key);
    fprintf(page, ": %.6g</p>\n", json_number_value(value));
  }
}

/* A comparison that cannot be made (a run that was cut short, other parameters) is a notice: the rest is still worth
 * it. */
static void compare(report *r, const cpl_scenario *scenario, FILE *page) {
  cpl_comparison c = {0};
  tdm_error err = {0};
  if (scenario && scenario->compare && scenario->compare(r->dir, &c, &err) == TDM_OK &&
      cpl_comparison_write(&c, r->dir, &err) == TDM_OK) {
    print_agreement(page, &c);
    if (cpl_comparison_plot(&c, r->dir, &err) == TDM_OK)
      add_picture(r, "comparison");
  }
  if (err.status != TDM_OK && err.status != TDM_ERR_INTERRUPTED)
    fprintf(stderr, "tandem: notice: no comparison: %s\n", err.message);
  cpl_comparison_free(&c);
}

/* ---- the page ---- */

static void write_head(FILE *page, const report *r) {
  static const char *const keys[] = {"scene", "status", "error"};
  cpl_html_head(page, "tandem report");
  for (int i = 0; i < 3; i++) {
    const char *value = json_string_value(json_object_get(r->summary, keys[i]));
    if (!value)
      continue;
    fprintf(page, "<p>%s: ", keys[i]);
    cpl_html_text(page, value);
    fputs("</p>\n", page);
  }
  fprintf(page, "<p>simulated: %g s in %lld windows, %.2f s wall</p>\n",
          json_number_value(json_object_get(r->summary, "simulated_s")),
          (long long)json_integer_value(json_object_get(r->summary, "windows")), wall(r, "all"));
}

static void write_picture(FILE *page, const char *name) {
  fputs("<h2>", page);
  cpl_html_text(page, name);
  fputs("</h2>\n<a href=\"", page);
  cpl_html_link(page, name);
  fputs(".svg\"><img src=\"", page);
  cpl_html_link(page, name);
  fputs(".png\" alt=\"", page);
  cpl_html_text(page, name);
  fputs("\"></a>\n", page);
}

/* Warnings and notices of the run, on the page and on the terminal. */
static void write_remarks(FILE *page, const report *r) {
  static const char *const lists[] = {"warnings", "notices"}, *const names[] = {"warning", "notice"};
  for (int l = 0; l < 2; l++) {
    size_t i;
    json_t *entry, *list = json_object_get(r->summary, lists[l]);
    if (json_array_size(list) == 0)
      continue;
    fprintf(page, "<h2>%s</h2>\n<ul>\n", lists[l]);
    json_array_foreach(list, i, entry) {
      char text[2048];
      const char *from = json_string_value(json_object_get(entry, "from"));
      const char *path = json_string_value(json_object_get(entry, "path"));
      const char *message = json_string_value(json_object_get(entry, "message"));
      const long long count = json_integer_value(json_object_get(entry, "count"));
      int n = snprintf(text, sizeof text, "%s%s%s%s%s", from ? from : "", from ? ": " : "", path ? path : "",
                       path && *path ? ": " : "", message ? message : "");
      if (count > 1 && n > 0 && (size_t)n < sizeof text)
        snprintf(text + n, sizeof text - (size_t)n, " (%lld times, from t = %.6g s to %.6g s)", count,
                 json_number_value(json_object_get(entry, "first_s")),
                 json_number_value(json_object_get(entry, "last_s")));
      printf("%s: %s\n", names[l], text);
      fputs("<li>", page);
      cpl_html_text(page, text);
      fputs("</li>\n", page);
    }
    fputs("</ul>\n", page);
  }
}

static tdm_status write_report(report *r, const json_t *scene, const cpl_scenario *scenario, tdm_error *err) {
  char path[4352];
  snprintf(path, sizeof path, "%s/index.html", r->dir);
  tdm_mark_add_in(r->dir, "index.html");
  FILE *page = fopen(path, "w");
  if (!page)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", path, strerror(errno));
  write_head(page, r);
  write_remarks(page, r);
  compare(r, scenario, page);
  if (err->status == TDM_OK && plot_time(r, err) == TDM_OK)
    plot_histories(r, scene, err);
  for (int i = 0; i < r->npicture; i++)
    write_picture(page, r->picture[i]);
  if (fclose(page) != 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", path, strerror(errno));
  if (tdm_plot_interrupted())
    return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted; %s shows the pictures that were made", path);
  printf("%d pictures (PNG and SVG) in %s; %s shows them\n", r->npicture, r->dir, path);
  return err->status;
}

/* The results of a solver alone are no co-simulation's: they have their plots already. */
static tdm_status refuse_alone(const char *dir, const json_t *scene, const json_t *summary, tdm_error *err) {
  const char *software = json_string_value(json_object_get(summary, "software"));
  if (!software || json_object_get(scene, "coupling"))
    return TDM_OK;
  bool mbd = json_object_get(scene, "mbd") != NULL;
  return tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
                  "report: %s holds the results of tandem-%s run, which makes its plots itself (but with --no-plots): "
                  "%s/%s%s; report is for "
                  "results of tandem run",
                  dir, mbd ? "mbd" : "dem", dir, mbd ? "motion.svg, reactions.svg, energies.svg" : "channels.svg",
                  mbd ? "" : " and the pictures that the scene asks for");
}

tdm_status cpl_report(const char *dir, const cpl_scenario *scenarios, tdm_error *err) {
  json_t *scene = tdm_results_read(dir, "scene.json", err);
  tdm_error lack = {0};
  json_t *summary = scene ? tdm_results_read(dir, "summary.json", &lack) : NULL;
  if (lack.status != TDM_OK && !tdm_mark_has(dir))
    tdm_fail(err, lack.status, NULL, "%s", lack.message);
  else if (lack.status != TDM_OK) /* its histories are worth a look all the same */
    fprintf(stderr, "tandem: notice: no figures of the run: %s/summary.json cannot be read\n", dir);
  if (summary)
    refuse_alone(dir, scene, summary, err);
  report *r = calloc(1, sizeof *r);
  if (!r)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  if (err->status == TDM_OK) {
    r->dir = dir;
    r->summary = summary;
    write_report(r, scene, cpl_scenario_of(scenarios, scene, err), err);
  }
  free(r);
  json_decref(scene);
  json_decref(summary);
  return err->status;
}
