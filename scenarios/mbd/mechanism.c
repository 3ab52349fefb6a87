/* Published mechanisms: see mechanism.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/mbd/mechanism.h"

#include "protocol/base/log.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const scn_method scn_methods[] = {[SCN_GGL] = {"ggl", "ggl", "original"},
                                  [SCN_GGL_MODIFIED] = {"ggl modified", "ggl", "modified"},
                                  [SCN_INDEX3] = {"index3", "index3", "original"},
                                  [SCN_INDEX3_MODIFIED] = {"index3 modified", "index3", "modified"},
                                  [SCN_ONE_STEP] = {"one_step", "one_step", "original"},
                                  {NULL, NULL, NULL}};

/* ---- scene and reference ---- */

tdm_status scn_case_read(scn_case *c, cpl_verify *v, const scn_mechanism *of, tdm_error *err) {
  char file[4096];
  *c = (scn_case){.of = of};
  if (cpl_verify_find(v, "mbd", of->name, file, sizeof file - 16, err) != TDM_OK)
    return err->status;
  strcpy(strrchr(file, '/'), "/reference.csv");
  c->mbd = scn_motion_scene(v, of->name, err);
  if (!c->mbd || cpl_table_read(&c->reference, file, err) != TDM_OK)
    return err->status;
  const double *t = cpl_table_column(&c->reference, "t", err);
  while (t && c->row < c->reference.nrow - 1 && t[c->row] < of->at * (1 - 1e-9))
    c->row++;
  return err->status;
}

void scn_case_free(scn_case *c) {
  json_decref(c->mbd);
  cpl_table_free(&c->reference);
  *c = (scn_case){0};
}

/* ---- errors ---- */

/* the angle between an orientation at sample i and one of the reference */
static double rotation_error(const scn_case *c, const scn_motion *m, const scn_coordinate *x, int i, int row) {
  static const char *const part[] = {"qw", "qx", "qy", "qz"}, *const column[] = {"q0", "q1", "q2", "q3"};
  double a[4], b[4];
  tdm_error err = {0};
  for (int k = 0; k < 4; k++) {
    const double *value = scn_motion_channel(m, "body.%s.%s", x->of, part[k]);
    const double *reference = cpl_table_column(&c->reference, column[k], &err);
    if (!value || !reference)
      return NAN;
    a[k] = value[i * m->nchannel];
    b[k] = reference[row];
  }
  tdm_quat d = tdm_quat_mul(tdm_quat_conj((tdm_quat){b[0], b[1], b[2], b[3]}), (tdm_quat){a[0], a[1], a[2], a[3]});
  return 2 * asin(fmin(1, sqrt(d.x * d.x + d.y * d.y + d.z * d.z)));
}

/* a coordinate at every sample (the caller frees); NULL: no such channel */
static double *samples_of(const scn_motion *m, const scn_coordinate *x) {
  double *q = calloc((size_t)m->nsample, sizeof *q), *less = calloc((size_t)m->nsample, sizeof *less);
  bool good = q && less;
  if (good && x->kind == SCN_CHANNEL) {
    const double *channel = scn_motion_channel(m, "%s", x->of);
    good = channel != NULL;
    for (int i = 0; good && i < m->nsample; i++)
      q[i] = channel[i * m->nchannel];
  } else if (good) {
    good = scn_motion_angle(m, x->of, q) && (!x->less || scn_motion_angle(m, x->less, less));
    for (int i = 0; i < m->nsample; i++)
      q[i] += x->offset - less[i];
  }
  free(less);
  if (!good)
    free(q);
  return good ? q : NULL;
}

/* error of one coordinate from sample `first` on, which is row `row` of the reference; relative to the value, or to the
 * largest value on the path */
static double coordinate_error(const scn_case *c, const scn_motion *m, const scn_coordinate *x, int first, int row,
                               bool turns, bool path) {
  double worst = 0, largest = 0;
  if (x->kind == SCN_ROTATION) {
    for (int i = first; i < m->nsample; i++)
      worst = fmax(worst, rotation_error(c, m, x, i, row + i - first));
    return worst;
  }
  tdm_error err = {0};
  double *q = samples_of(m, x);
  const double *reference = cpl_table_column(&c->reference, x->column, &err);
  for (int i = first; q && reference && i < m->nsample; i++) {
    double off = q[i] - reference[row + i - first];
    if (x->kind == SCN_ANGLE && !turns)
      off = remainder(off, 2 * M_PI);
    worst = fmax(worst, fabs(off));
    largest = fmax(largest, fabs(reference[row + i - first]));
  }
  if (path) /* the largest on the whole path */
    for (int i = 0; reference && i < c->reference.nrow; i++)
      largest = fmax(largest, fabs(reference[i]));
  bool good = q && reference && largest > 0;
  free(q);
  return good ? worst / largest : NAN;
}

static double largest_error(const scn_case *c, const scn_motion *m, int first, int row, bool turns, bool path) {
  double worst = 0;
  for (const scn_coordinate *x = c->of->coordinate; x < c->of->coordinate + SCN_COORDINATES && x->column; x++) {
    double error = coordinate_error(c, m, x, first, row, turns, path);
    if (!(error <= worst))
      worst = error;
  }
  return worst;
}

double scn_case_error(const scn_case *c, const scn_motion *m, int row, bool turns) {
  return largest_error(c, m, m->nsample - 1, row, turns, false);
}

double scn_case_path_error(const scn_case *c, const scn_motion *m) {
  return largest_error(c, m, 0, 0, true, true);
}

/* ---- runs ---- */

tdm_status scn_case_tightest(const scn_case *c, cpl_verify *v, scn_motion *m, double *tolerance, tdm_error *err) {
  double end = cpl_table_column(&c->reference, "t", err)[c->reference.nrow - 1];
  for (*tolerance = 1e-13; *tolerance < 2e-8; *tolerance *= 10) {
    tdm_error failed = {0};
    if (scn_motion_run(m, c->mbd, &scn_methods[SCN_GGL], *tolerance, c->of->absolute, end, c->reference.nrow - 1,
                       SCN_MOST_STEPS, &failed) == TDM_OK) {
      cpl_verify_alone(v, CPL_MBD, end, m->wall);
      return TDM_OK;
    }
    scn_motion_free(m);
    if (failed.status == TDM_ERR_INTERRUPTED || *tolerance > 2e-9)
      return tdm_fail(err, failed.status, NULL, "%s", failed.message);
  }
  return TDM_OK;
}

tdm_status scn_case_time(const scn_case *c, const scn_method *method, double tolerance, double end, long most_steps,
                         scn_motion *m, double *wall, tdm_error *err) {
  enum { REPEATS = 3 };
  const double enough = 0.05; /* [s] long runs are not repeated */
  *wall = INFINITY;
  for (int k = 0; k < REPEATS && (k == 0 || *wall < enough); k++) {
    scn_motion_free(m);
    if (scn_motion_run(m, c->mbd, method, tolerance, c->of->absolute, end, 1, most_steps, err) != TDM_OK)
      return err->status;
    *wall = fmin(*wall, m->wall);
  }
  return TDM_OK;
}

/* ---- work and precision ---- */

/* steps of a run, and of all runs of a method after which there is no further one */
enum { SWEEP_STEPS = 60000, SWEEP_PATIENCE = 120000 };

/* one method over all tolerances, as long as they take few steps, into its CSV file; its rows */
static int sweep(const scn_case *c, cpl_verify *v, const scn_method *method, const char *file, tdm_error *err) {
  char path[4352];
  int good = 0;
  long steps = 0;
  snprintf(path, sizeof path, "%s/%s", cpl_verify_dir(v), file);
  FILE *f = fopen(path, "w");
  if (!f) {
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written", path);
    return 0;
  }
  fputs("relative_tolerance,error,wall [s],steps,residuals,jacobians,drift [m]\n", f);
  for (int k = 4; k <= 13 && err->status == TDM_OK && steps < SWEEP_PATIENCE; k++) {
    scn_motion m = {0};
    double wall, tolerance = pow(10, -k);
    tdm_error failed = {0};
    bool done = scn_case_time(c, method, tolerance, c->of->at, SWEEP_STEPS, &m, &wall, &failed) == TDM_OK;
    if (done) {
      fprintf(f, "%g,%.4g,%.4g,%ld,%ld,%ld,%.3g\n", tolerance, scn_case_error(c, &m, c->row, false), wall,
              m.stats.steps, m.stats.residuals, m.stats.jacobians, scn_motion_drift(&m));
      good++;
    } else if (failed.status == TDM_ERR_INTERRUPTED)
      *err = failed;
    steps += m.stats.steps;
    scn_motion_free(&m);
    if (!done && k >= 6) /* tighter ones do not run either */
      break;
  }
  fclose(f);
  return good;
}

tdm_status scn_work_precision(const scn_case *c, cpl_verify *v, tdm_error *err) {
  enum { METHODS = 8 };
  char file[METHODS][64];
  tdm_curve curve[METHODS];
  int n = 0;
  for (const scn_method *method = scn_methods; method->name && n < METHODS && err->status == TDM_OK; method++) {
    snprintf(file[n], sizeof file[n], "work_%s.csv", method->name);
    for (char *s = file[n]; *s; s++)
      *s = *s == ' ' ? '_' : *s;
    if (sweep(c, v, method, file[n], err) > 0) {
      curve[n] = (tdm_curve){file[n], "3:2", method->name, "linespoints pt 7"};
      n++;
    }
  }
  const tdm_plot plot = {.title = c->of->name,
                         .xlabel = "run time [s]",
                         .ylabel = "largest relative error",
                         .setup = "set logscale xy\nset format y '10^{%T}'\nset key bottom left\n",
                         .ncurve = n,
                         .curve = curve};
  if (err->status == TDM_OK && n > 0)
    cpl_verify_plot(v, "work", 1, &plot);
  return err->status;
}
