/* Pictures of a study: a measure over the first axis with the spread of the seeds and published values, a line for each
 * combination of the other axes; time histories of all cells. See study.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/study/study.h"

#include "protocol/app/plot.h"
#include "protocol/results/thin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { LINES_MAX = 24 }; /* that a picture can show; further ones are left out of it */

/* A picture under way. */
typedef struct {
  tdm_plot_data data;
  int nrow_max, ncurve;
  tdm_curve curve[LINES_MAX + 64];
  char using[LINES_MAX + 64][48], title[LINES_MAX + 64][512], style[LINES_MAX + 64][64];
  char heading[256], xlabel[160], ylabel[160], setup[512];
} picture;

static bool picture_begin(picture *p, int nrow, int ncolumn) {
  *p = (picture){.nrow_max = nrow, .data = {.ncolumn = ncolumn}};
  p->data.value = malloc((size_t)nrow * (size_t)ncolumn * sizeof *p->data.value + 8);
  return p->data.value != NULL;
}

/* A new row, all of it NaN. */
static double *row_of(picture *p) {
  double *row = p->data.value + (size_t)p->data.nrow++ * (size_t)p->data.ncolumn;
  for (int k = 0; k < p->data.ncolumn; k++)
    row[k] = NAN;
  return row;
}

static void add_curve(picture *p) {
  const int k = p->ncurve++;
  p->curve[k] = (tdm_curve){NULL, p->using[k], p -> title[k], p -> style[k]};
}

/* "speed [rpm]" */
static void axis_label(char *out, size_t size, const char *title, const char *unit) {
  snprintf(out, size, "%s%s%s%s", title, unit[0] ? " [" : "", unit, unit[0] ? "]" : "");
}

static void setup_line(picture *p, const char *line) {
  size_t n = strlen(p->setup);
  snprintf(p->setup + n, sizeof p->setup - n, "%s\n", line);
}

/* gnuplot refuses a panel without a number. */
static bool has_number(const picture *p) {
  for (int r = 0; r < p->data.nrow; r++)
    for (int k = 1; k < p->data.ncolumn; k++)
      if (isfinite(p->data.value[r * p->data.ncolumn + k]))
        return true;
  return false;
}

/* One of an earlier study must not stand beside this one's numbers. */
static void remove_picture(const char *out, const char *name) {
  char file[4352];
  snprintf(file, sizeof file, "%s/%s.png", out, name);
  unlink(file);
}

static void picture_write(picture *p, const char *out, const char *kind, const char *measure, int ntick,
                          const char *const *tick, tdm_error *err) {
  char name[96];
  const tdm_plot plot = {.title = p->heading,
                         .xlabel = p->xlabel,
                         .ylabel = p->ylabel,
                         .setup = p->setup,
                         .ntick = ntick,
                         .tick = tick,
                         .ncurve = p->ncurve,
                         .curve = p->curve};
  snprintf(name, sizeof name, "%s_%s", kind, measure);
  remove_picture(out, name);
  if (has_number(p))
    tdm_plot_write_data(out, name, 1, &plot, &p->data, err);
}

/* ---- measures ---- */

static int first_levels(const cpl_study *study) {
  return study->nfactor > 0 ? study->factor[0].nlevel : 1;
}

static double x_of(const cpl_study *study, int level) {
  return study->nfactor > 0 && study->factor[0].numbers ? study->factor[0].level[level].x : level;
}

/* What a line is called: its levels of all axes but the first. */
static void line_name(const cpl_study *study, int line, char *out, size_t size) {
  out[0] = 0;
  for (int f = 1; f < study->nfactor; f++) {
    const cpl_factor *factor = &study->factor[f];
    const size_t n = strlen(out);
    snprintf(out + n, size - n, "%s%.60s %.60s%s%.20s", n ? ", " : "", factor->path[0] ? factor->title : "",
             cpl_study_level(study, line, f)->label, factor->unit[0] ? " " : "", factor->unit);
  }
}

/* Columns: x, then mean, least and greatest of each line, then one of each published row of points. */
static void fill_measure(const cpl_study *study, int measure, int nline, picture *p) {
  const cpl_study_measure *m = &study->measure[measure];
  const int stride = study->ncell / first_levels(study);
  for (int i = 0; i < first_levels(study); i++) {
    double *row = row_of(p);
    row[0] = x_of(study, i);
    for (int k = 0; k < nline; k++) {
      const cpl_value v = cpl_study_value(study, i * stride + k, measure);
      row[1 + 3 * k] = v.mean;
      row[2 + 3 * k] = v.min;
      row[3 + 3 * k] = v.max;
    }
  }
  for (int i = 0; i < m->npublished; i++)
    for (int k = 0; k < m->published[i].npoint; k++) {
      double *row = row_of(p);
      row[0] = m->published[i].x[k];
      row[1 + 3 * nline + i] = m->published[i].y[k];
    }
}

/* "3 runs", "1 to 3 runs": how many a cell's values come from; returns the most, 0: no cell has one. */
static int count_runs(const cpl_study *study, int measure, char *out, size_t size) {
  int least = 0, most = 0;
  for (int cell = 0; cell < study->ncell; cell++) {
    const int n = cpl_study_value(study, cell, measure).n;
    least = n > 0 && (least == 0 || n < least) ? n : least;
    most = n > most ? n : most;
  }
  snprintf(out, size, least < most ? "%d to %d runs" : "%d runs", least, most);
  return most;
}

static void measure_curves(const cpl_study *study, int measure, int nline, picture *p) {
  char runs[48];
  const cpl_study_measure *m = &study->measure[measure];
  const bool lines = study->nfactor > 0 && study->factor[0].numbers;
  const bool bars = count_runs(study, measure, runs, sizeof runs) > 1;
  for (int k = 0; k < nline; k++) {
    const int c = p->ncurve;
    snprintf(p->using[c], sizeof p->using[c], bars ? "1:%d:%d:%d" : "1:%d", 2 + 3 * k, 3 + 3 * k, 4 + 3 * k);
    snprintf(p->style[c], sizeof p->style[c], "%s lw 2 pt 7 ps 1.2 lc %d",
             bars    ? lines ? "yerrorlines" : "yerrorbars"
             : lines ? "linespoints"
                     : "points",
             k + 1);
    line_name(study, k, p->title[c], sizeof p->title[c]);
    if (!p->title[c][0])
      snprintf(p->title[c], sizeof p->title[c], bars ? "mean, least to greatest of %s" : "tandem", runs);
    add_curve(p);
  }
  for (int i = 0; i < m->npublished; i++) {
    const int c = p->ncurve;
    snprintf(p->using[c], sizeof p->using[c], "1:%d", 2 + 3 * nline + i);
    snprintf(p->style[c], sizeof p->style[c], "points pt %d ps 1.8 lw 2 lc 'black'", 4 + 2 * (i % 4));
    snprintf(p->title[c], sizeof p->title[c], "%s", m->published[i].label);
    add_curve(p);
  }
}

/* Labels that would run into each other: the picture has room for about 100 letters. */
static bool is_crowded(const cpl_factor *f) {
  bool crowded = false;
  for (int i = 0; i < f->nlevel; i++)
    crowded = crowded || (int)strlen(f->level[i].label) * f->nlevel > 120;
  return crowded;
}

static void plot_measure(const cpl_study *study, int measure, const char *out, tdm_error *err) {
  const cpl_study_measure *m = &study->measure[measure];
  const cpl_factor *f = study->nfactor > 0 ? &study->factor[0] : NULL;
  const bool ticks = f && !f->numbers;
  const char *tick[64];
  char runs[48];
  int nrow = first_levels(study), nline = study->ncell / first_levels(study);
  nline = nline < LINES_MAX ? nline : LINES_MAX;
  for (int i = 0; i < m->npublished; i++)
    nrow += m->published[i].npoint;
  picture *p = calloc(1, sizeof *p);
  if (!p || !picture_begin(p, nrow, 1 + 3 * nline + m->npublished)) {
    free(p);
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    return;
  }
  fill_measure(study, measure, nline, p);
  measure_curves(study, measure, nline, p);
  snprintf(p->heading, sizeof p->heading, "%s%s%s", study->title, study->title[0] ? ": " : "", m->title);
  if (count_runs(study, measure, runs, sizeof runs) > 1 && nline > 1) {
    const size_t n = strlen(p->heading);
    snprintf(p->heading + n, sizeof p->heading - n, " (bars: least to greatest of %s)", runs);
  }
  axis_label(p->ylabel, sizeof p->ylabel, m->title, m->unit);
  if (f)
    axis_label(p->xlabel, sizeof p->xlabel, ticks && !f->path[0] ? "" : f->title, f->unit);
  for (int i = 0; ticks && i < f->nlevel; i++)
    tick[i] = f->level[i].label;
  setup_line(p, nline > 1 ? "set key outside right top" : "set key below");
  setup_line(p, "set offsets graph 0.04, graph 0.04, graph 0.08, graph 0.08");
  if (ticks && is_crowded(f))
    setup_line(p, "set xtics rotate by -20 left\nset rmargin 14");
  if (f && f->log)
    setup_line(p, "set logscale x");
  if (m->log)
    setup_line(p, "set logscale y");
  if (!f)
    setup_line(p, "unset xtics");
  picture_write(p, out, "measure", m->name, ticks ? f->nlevel : 0, tick, err);
  free(p->data.value);
  free(p);
}

/* ---- time histories ---- */

/* Add a history to the sum of those before, without its gaps. */
static void add_history(double *sum, double *count, const double *x, int n) {
  for (int i = 0; i < n; i++)
    if (isfinite(x[i])) {
      sum[i] += x[i];
      count[i]++;
    }
}

/* The mean of the seeds' histories whose rows have the same times as the first one's; 0: there is none. */
static int history_of(const cpl_study *study, int cell, const cpl_study_measure *m, double **time, double **value) {
  double *count = NULL;
  int n = 0;
  *time = *value = NULL;
  for (int s = 0; s < study->nseed; s++) {
    const cpl_cell *run = cpl_study_run_of(study, cell, s);
    double *t = NULL, *x = NULL;
    const int rows = run ? cpl_study_history(run, m, &t, &x, &(tdm_error){0}) : 0;
    if (rows > 0 && !*time) {
      n = rows;
      *time = t;
      t = NULL;
      *value = calloc((size_t)n, sizeof **value);
      count = calloc((size_t)n, sizeof *count);
    }
    if (rows > 0 && rows == n && *value && count && (!t || memcmp(t, *time, (size_t)n * sizeof *t) == 0))
      add_history(*value, count, x, n);
    free(t);
    free(x);
  }
  for (int i = 0; i < n && *value && count; i++)
    (*value)[i] = count[i] > 0 ? (*value)[i] / count[i] : NAN;
  n = *value && count ? n : 0;
  free(count);
  return n;
}

/* Rows of one cell, thinned: the time, and its value in column 1 + line. */
static bool fill_history(const cpl_study *study, int cell, const cpl_study_measure *m, int line, picture *p) {
  tdm_thin thin = {0};
  double *time, *value;
  const int n = history_of(study, cell, m, &time, &value);
  bool good = n > 0 && tdm_thin_begin(&thin, 1);
  for (int i = 0; good && i < n; i++)
    tdm_thin_add(&thin, time[i], &value[i]);
  for (int i = 0; good && i < tdm_thin_rows(&thin) && p->data.nrow < p->nrow_max; i++) {
    double *row = row_of(p);
    row[0] = tdm_thin_time(&thin, i);
    row[1 + line] = tdm_thin_value(&thin, i, 0);
  }
  tdm_thin_free(&thin);
  free(time);
  free(value);
  return good;
}

static void plot_curve(const cpl_study *study, const cpl_study_measure *m, const char *out, tdm_error *err) {
  const int most = study->ncell < LINES_MAX ? study->ncell : LINES_MAX;
  picture *p = calloc(1, sizeof *p);
  if (!p || !picture_begin(p, most * 4 * TDM_THIN_BINS, 1 + most)) {
    free(p);
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    return;
  }
  int nseed = 0;
  for (int s = 0; s < study->nseed; s++)
    nseed += cpl_study_has_seed(study, s);
  for (int cell = 0; cell < study->ncell && p->ncurve < most; cell++) {
    const int c = p->ncurve;
    if (!fill_history(study, cell, m, c, p))
      continue;
    snprintf(p->using[c], sizeof p->using[c], "1:%d", 2 + c);
    snprintf(p->style[c], sizeof p->style[c], "lines lw 2 lc %d dt %d", c % 8 + 1, c / 8 + 1);
    cpl_study_cell_name(study, cell, p->title[c], sizeof p->title[c]);
    add_curve(p);
  }
  snprintf(p->heading, sizeof p->heading, "%s%s%s%s", study->title, study->title[0] ? ": " : "", m->title,
           nseed > 1 ? ", mean of the runs of a cell" : "");
  snprintf(p->xlabel, sizeof p->xlabel, "time [s]");
  axis_label(p->ylabel, sizeof p->ylabel, m->title, m->unit);
  setup_line(p, "set key outside right top");
  if (m->log)
    setup_line(p, "set logscale y");
  picture_write(p, out, "curve", m->name, 0, NULL, err);
  free(p->data.value);
  free(p);
}

tdm_status cpl_study_plot(const cpl_study *study, const char *out, tdm_error *err) {
  for (int m = 0; m < study->nmeasure && err->status == TDM_OK; m++)
    plot_measure(study, m, out, err);
  for (int c = 0; c < study->ncurve && err->status == TDM_OK; c++)
    plot_curve(study, &study->curve[c], out, err);
  return err->status;
}
