/* The numbers of a study: see study.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/study/study.h"

#include "coupler/results/table.h"
#include "protocol/results/results.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- one run ---- */

/* The solver's own time histories, a solver alone calls otherwise. */
void cpl_study_history_file(const cpl_cell *run, const char *channel, char *out, size_t size) {
  const int n = (int)strcspn(channel, ":");
  const bool solver = strncmp(channel, "dem:", 4) == 0 || strncmp(channel, "mbd:", 4) == 0;
  if (run->program && solver)
    snprintf(out, size, "%s/channels.csv", run->dir);
  else
    snprintf(out, size, "%s/%.*s.csv", run->dir, n, channel);
}

int cpl_study_history(const cpl_cell *run, const cpl_study_measure *m, double **time, double **value, tdm_error *err) {
  char file[4400];
  cpl_table table = {0};
  *time = *value = NULL;
  cpl_study_history_file(run, m->channel, file, sizeof file);
  if (cpl_table_read(&table, file, err) != TDM_OK)
    return 0;
  const double *t = cpl_table_column(&table, "time", err), *x = NULL;
  if (t)
    x = cpl_table_column(&table, strchr(m->channel, ':') + 1, err);
  const int n = x ? table.nrow : 0;
  *time = malloc((size_t)n * sizeof **time + 8);
  *value = malloc((size_t)n * sizeof **value + 8);
  for (int i = 0; *time && *value && i < n; i++) {
    (*time)[i] = t[i];
    (*value)[i] = m->factor * x[i];
  }
  const bool room = *time && *value;
  if (!room)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  cpl_table_free(&table);
  return room ? n : 0;
}

/* The mean over time of the straight lines between rows, from t0 to t1, where both ends of a line are numbers. */
static double mean_over(const double *t, const double *x, int n, double t0, double t1) {
  double sum = 0, length = 0;
  for (int i = 0; i + 1 < n; i++) {
    const double a = fmax(t0, t[i]), b = fmin(t1, t[i + 1]), step = t[i + 1] - t[i];
    if (!(b > a) || !isfinite(x[i]) || !isfinite(x[i + 1]))
      continue;
    const double slope = (x[i + 1] - x[i]) / step;
    sum += (b - a) * (x[i] + slope * (0.5 * (a + b) - t[i]));
    length += b - a;
  }
  return length > 0 ? sum / length : NAN;
}

/* The greatest of sign * x. */
static double extreme(const double *x, int n, double sign) {
  double most = NAN;
  for (int i = 0; i < n; i++)
    if (isfinite(x[i]) && !(sign * x[i] <= most))
      most = sign * x[i];
  return sign * most;
}

/* Leave the part of a time history that counts: n rows from *first on. */
static int part_of(const double *t, int n, const double over[2], int *first) {
  int end = n;
  *first = 0;
  while (*first < n && t[*first] < over[0])
    ++*first;
  while (end > *first && t[end - 1] > over[1])
    end--;
  return end - *first;
}

static double taken(const cpl_study_measure *m, const double *t, const double *x, int n) {
  int first;
  const int part = part_of(t, n, m->over, &first);
  switch (m->at) {
  case CPL_AT_END:
    return part > 0 ? x[first + part - 1] : NAN;
  case CPL_AT_MEAN:
    return n > 0 ? mean_over(t, x, n, fmax(m->over[0], t[0]), fmin(m->over[1], t[n - 1])) : NAN;
  case CPL_AT_MAX:
    return extreme(x + first, part, 1);
  case CPL_AT_MIN:
    return extreme(x + first, part, -1);
  case CPL_AT_AMPLITUDE:
    return 0.5 * (extreme(x + first, part, 1) - extreme(x + first, part, -1));
  }
  return NAN;
}

static double of_channel(const cpl_cell *run, const cpl_study_measure *m, tdm_error *err) {
  double *t, *x, value = NAN;
  const int n = cpl_study_history(run, m, &t, &x, err);
  if (n > 0)
    value = taken(m, t, x, n);
  free(t);
  free(x);
  if (!isfinite(value))
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: no number there", m->channel);
  return value;
}

static double of_summary(const json_t *summary, const cpl_study_measure *m, tdm_error *err) {
  const json_t *value = tdm_scene_value(summary, m->path);
  if (json_is_number(value))
    return m->factor * json_number_value(value);
  tdm_fail(err, TDM_ERR_FILE, NULL, "summary.json: %s %s", m->path, value ? "is no number" : "is missing");
  return NAN;
}

/* All measures of a run that came to its end. */
static void measure_run(cpl_study *study, const cpl_cell *run, double *value) {
  json_t *summary = run->row ? tdm_results_read(run->dir, "summary.json", &(tdm_error){0}) : NULL;
  const char *status = json_string_value(json_object_get(summary, "status"));
  const bool whole = status && strcmp(status, tdm_status_name(TDM_OK)) == 0;
  for (int k = 0; whole && k < study->nmeasure; k++) {
    cpl_study_measure *m = &study->measure[k];
    tdm_error err = {0};
    value[k] = m->path[0] ? of_summary(summary, m, &err) : of_channel(run, m, &err);
    if (err.status != TDM_OK && !m->lack[0])
      snprintf(m->lack, sizeof m->lack, "%.60s: %.180s", run->name, err.message);
  }
  json_decref(summary);
}

tdm_status cpl_study_collect(cpl_study *study, tdm_error *err) {
  const size_t n = (size_t)study->nmeasure;
  free(study->value);
  study->value = malloc((size_t)(study->ncell * study->nseed) * n * sizeof *study->value + 8);
  if (!study->value)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int cell = 0; cell < study->ncell; cell++)
    for (int seed = 0; seed < study->nseed; seed++) {
      double *value = study->value + (size_t)(cell * study->nseed + seed) * n;
      for (size_t k = 0; k < n; k++)
        value[k] = NAN;
      const cpl_cell *run = cpl_study_run_of(study, cell, seed);
      if (run)
        measure_run(study, run, value);
    }
  return TDM_OK;
}

/* ---- cells ---- */

double cpl_study_value_of(const cpl_study *study, int cell, int seed, int measure) {
  return study->value ? study->value[(cell * study->nseed + seed) * study->nmeasure + measure] : NAN;
}

cpl_value cpl_study_value(const cpl_study *study, int cell, int measure) {
  cpl_value v = {.mean = NAN, .min = NAN, .max = NAN, .sd = NAN};
  double sum = 0, squares = 0;
  for (int s = 0; s < study->nseed; s++) {
    const double x = cpl_study_value_of(study, cell, s, measure);
    if (isnan(x))
      continue;
    v.n++;
    sum += x;
    v.min = fmin(v.min, x);
    v.max = fmax(v.max, x);
  }
  v.mean = v.n > 0 ? sum / v.n : NAN;
  for (int s = 0; s < study->nseed; s++) {
    const double x = cpl_study_value_of(study, cell, s, measure);
    squares += isnan(x) ? 0 : (x - v.mean) * (x - v.mean);
  }
  v.sd = v.n > 1 ? sqrt(squares / (v.n - 1)) : NAN;
  return v;
}

double cpl_study_mean(const cpl_study *study, const char *cell, const char *measure) {
  const int c = cpl_study_find_cell(study, cell, NULL), m = cpl_study_find_measure(study, measure, NULL);
  return c < 0 || m < 0 ? NAN : cpl_study_value(study, c, m).mean;
}

int cpl_study_neighbour(const cpl_study *study, int cell) {
  const int first = study->nfactor > 0 ? study->factor[0].nlevel : 1, stride = study->ncell / first;
  return cell + stride < study->ncell ? cell + stride : -1;
}

cpl_difference cpl_study_difference(const cpl_study *study, int first, int second, int measure) {
  const cpl_value a = cpl_study_value(study, first, measure), b = cpl_study_value(study, second, measure);
  cpl_difference d = {.difference = b.mean - a.mean, .spread = NAN};
  if (a.n > 1 && b.n > 1)
    d.spread = fmax(a.max - a.min, b.max - b.min);
  return d;
}
