/* A study for people: table.html with its pictures, and the table of a terminal. See study.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/study/study.h"

#include "coupler/results/html.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

/* A number as people read it, "–" for none. */
static const char *number(double x, char *out, size_t size) {
  if (isnan(x))
    snprintf(out, size, "–");
  else
    snprintf(out, size, "%.4g", x);
  return out;
}

/* ---- the table of cells ---- */

static void html_value(FILE *f, cpl_value v) {
  char mean[32], least[32], most[32], sd[32];
  fprintf(f, "<td>%s", number(v.mean, mean, sizeof mean));
  if (v.n > 1)
    fprintf(f, "<br><span class=\"quiet\">%s … %s, sd %s, %d runs</span>", number(v.min, least, sizeof least),
            number(v.max, most, sizeof most), number(v.sd, sd, sizeof sd), v.n);
  fputs("</td>", f);
}

/* Published values at a cell's level of the first axis. */
static void html_published(FILE *f, const cpl_study *study, int cell, const cpl_study_measure *m) {
  const cpl_factor *factor = study->nfactor > 0 ? &study->factor[0] : NULL;
  const cpl_level *level = factor ? cpl_study_level(study, cell, 0) : NULL;
  bool any = false;
  fputs("<td>", f);
  for (int i = 0; i < m->npublished; i++)
    for (int k = 0; k < m->published[i].npoint; k++) {
      const double x = !factor ? m->published[i].x[k] : factor->numbers ? level->x : (double)(level - factor->level);
      if (m->published[i].x[k] != x)
        continue;
      fprintf(f, "%s%.4g <span class=\"quiet\">", any ? "<br>" : "", m->published[i].y[k]);
      cpl_html_text(f, m->published[i].label);
      fputs("</span>", f);
      any = true;
    }
  fputs(any ? "</td>" : "–</td>", f);
}

static void html_head(FILE *f, const cpl_study *study) {
  fputs("<table>\n<tr><th class=\"text\">cell</th><th class=\"text\">status</th>", f);
  for (int m = 0; m < study->nmeasure; m++) {
    fputs("<th>", f);
    cpl_html_text(f, study->measure[m].title);
    if (study->measure[m].unit[0]) {
      fputs(" [", f);
      cpl_html_text(f, study->measure[m].unit);
      fputs("]", f);
    }
    fputs(study->measure[m].npublished > 0 ? "</th><th>published</th>" : "</th>", f);
  }
  fputs("</tr>\n", f);
}

static void html_cells(FILE *f, const cpl_study *study) {
  char name[512];
  html_head(f, study);
  for (int cell = 0; cell < study->ncell; cell++) {
    const char *status = cpl_study_status(study, cell);
    if (!status)
      continue;
    fputs("<tr>", f);
    cpl_html_cell(f, cpl_study_cell_name(study, cell, name, sizeof name));
    cpl_html_cell(f, status);
    for (int m = 0; m < study->nmeasure; m++) {
      html_value(f, cpl_study_value(study, cell, m));
      if (study->measure[m].npublished > 0)
        html_published(f, study, cell, &study->measure[m]);
    }
    fputs("</tr>\n", f);
  }
  fputs("</table>\n", f);
}

/* ---- neighbours ---- */

static void html_difference(FILE *f, const cpl_study *study, int cell, int other, int measure) {
  char text[32], name[512];
  const cpl_difference d = cpl_study_difference(study, cell, other, measure);
  if (isnan(d.difference))
    return;
  fputs("<tr>", f);
  cpl_html_cell(f, study->measure[measure].title);
  cpl_html_cell(f, cpl_study_cell_name(study, cell, name, sizeof name));
  cpl_html_cell(f, cpl_study_cell_name(study, other, name, sizeof name));
  fprintf(f, "<td>%+.4g</td><td>%s</td><td class=\"text\">%s</td></tr>\n", d.difference,
          number(d.spread, text, sizeof text),
          isnan(d.spread)                 ? "not known: one run"
          : fabs(d.difference) > d.spread ? "<b>larger than the spread</b>"
                                          : "within the spread");
}

static void html_neighbours(FILE *f, const cpl_study *study) {
  fputs("<h2>Neighbouring cells</h2>\n<p>Difference of the means of two cells that are next to each other along the "
        "first axis, beside the spread of their seeds: the larger of both greatest less least.</p>\n<table>\n<tr>"
        "<th class=\"text\">measure</th><th class=\"text\">from</th><th class=\"text\">to</th><th>difference</th>"
        "<th>spread</th><th class=\"text\">the difference is</th></tr>\n",
        f);
  for (int m = 0; m < study->nmeasure; m++)
    for (int cell = 0; cell < study->ncell; cell++)
      if (cpl_study_neighbour(study, cell) >= 0)
        html_difference(f, study, cell, cpl_study_neighbour(study, cell), m);
  fputs("</table>\n", f);
}

/* ---- what it is, its pictures, its runs ---- */

static void html_setting(FILE *f, const char *path, const json_t *value) {
  char *text = json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT | JSON_REAL_PRECISION(12));
  fputs("<tr>", f);
  cpl_html_cell(f, path);
  cpl_html_cell(f, text ? text : "");
  fputs("</tr>\n", f);
  free(text);
}

static void html_about(FILE *f, const cpl_study *study) {
  const char *path;
  json_t *value;
  fputs("<p>Scene: ", f);
  cpl_html_text(f, study->scene);
  if (study->seeds.nlevel > 0) {
    fputs(". Each cell runs with ", f);
    cpl_html_text(f, study->seeds.path);
    int n = 0;
    for (int s = 0; s < study->seeds.nlevel; s++) {
      if (!cpl_study_has_seed(study, s))
        continue;
      fputs(n++ > 0 ? ", " : " = ", f);
      cpl_html_text(f, study->seeds.level[s].label);
    }
    if (n < study->seeds.nlevel)
      fprintf(f, " (of %d in the study)", study->seeds.nlevel);
  }
  fputs(".</p>\n", f);
  if (json_object_size(study->set) == 0)
    return;
  fputs("<details><summary>settings of all cells</summary><table>\n", f);
  json_object_foreach(study->set, path, value) html_setting(f, path, value);
  fputs("</table></details>\n", f);
}

/* A picture, if there is one: gnuplot may be missing, and one that would show nothing is not made. */
static void html_picture(FILE *f, const char *out, const char *kind, const cpl_study_measure *m) {
  char file[4352];
  snprintf(file, sizeof file, "%s/%s_%s.png", out, kind, m->name);
  if (access(file, R_OK) != 0)
    return;
  fputs("<h3>", f);
  cpl_html_text(f, m->title);
  fprintf(f, "</h3>\n<img src=\"%s_%s.png\" alt=\"", kind, m->name);
  cpl_html_text(f, m->title);
  fputs("\">\n", f);
  for (int i = 0; i < m->npublished; i++) {
    if (!m->published[i].source[0])
      continue;
    fputs("<p class=\"quiet\">", f);
    cpl_html_text(f, m->published[i].label);
    fputs(": ", f);
    cpl_html_text(f, m->published[i].source);
    fputs("</p>\n", f);
  }
}

static void html_run(FILE *f, const cpl_study *study, const cpl_cell *run) {
  const char *status = json_string_value(json_object_get(run->row, "status"));
  const char *reason = json_string_value(json_object_get(run->row, "reason"));
  fputs("<tr><td class=\"text\"><a href=\"", f);
  cpl_html_link(f, run->dir + strlen(study->cells.out) + 1);
  fputs("\">", f);
  cpl_html_text(f, run->name);
  fputs("</a></td>", f);
  cpl_html_cell(f, status ? status : "not run");
  fprintf(f, "<td>%.4g</td>", json_number_value(json_object_get(run->row, "wall_s")));
  cpl_html_cell(f, reason ? reason : "");
  fputs("</tr>\n", f);
}

static void html_runs(FILE *f, const cpl_study *study) {
  fputs("<h2>Runs</h2>\n<table>\n<tr><th class=\"text\">run</th><th class=\"text\">status</th><th>run time [s]</th>"
        "<th class=\"text\">why</th></tr>\n",
        f);
  for (int i = 0; i < study->cells.ncell; i++)
    html_run(f, study, &study->cells.cell[i]);
  fputs("</table>\n", f);
}

tdm_status cpl_study_page(const cpl_study *study, const char *out, tdm_error *err) {
  char file[4352];
  snprintf(file, sizeof file, "%s/table.html", out);
  FILE *f = fopen(file, "w");
  if (!f)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno));
  cpl_html_head(f, study->title[0] ? study->title : "tandem sweep");
  html_about(f, study);
  html_cells(f, study);
  fputs("<h2>Measures</h2>\n", f);
  for (int m = 0; m < study->nmeasure; m++)
    html_picture(f, out, "measure", &study->measure[m]);
  if (study->ncurve > 0)
    fputs("<h2>Time histories</h2>\n", f);
  for (int c = 0; c < study->ncurve; c++)
    html_picture(f, out, "curve", &study->curve[c]);
  html_neighbours(f, study);
  html_runs(f, study);
  return fclose(f) == 0 ? TDM_OK
                        : tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno));
}

/* ---- the terminal ---- */

static void print_value(cpl_value v) {
  char text[64] = "-";
  if (v.n > 1)
    snprintf(text, sizeof text, "%.4g (%.4g..%.4g)", v.mean, v.min, v.max);
  else if (v.n == 1)
    snprintf(text, sizeof text, "%.4g", v.mean);
  printf("  %-26s", text);
}

void cpl_study_print(const cpl_study *study) {
  char name[512];
  printf("%-40s %-8s", "cell", "status");
  for (int m = 0; m < study->nmeasure; m++) {
    char head[160];
    snprintf(head, sizeof head, "%.18s%s%.10s%s", study->measure[m].name, study->measure[m].unit[0] ? " [" : "",
             study->measure[m].unit, study->measure[m].unit[0] ? "]" : "");
    printf("  %-26s", head);
  }
  puts("");
  for (int cell = 0; cell < study->ncell; cell++) {
    const char *status = cpl_study_status(study, cell);
    if (!status)
      continue;
    printf("%-40s %-8s", cpl_study_cell_name(study, cell, name, sizeof name), status);
    for (int m = 0; m < study->nmeasure; m++)
      print_value(cpl_study_value(study, cell, m));
    puts("");
  }
}
