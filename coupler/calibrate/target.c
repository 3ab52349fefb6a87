/* Targets, and runs beside them: see target.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/calibrate/target.h"

#include "coupler/results/table.h"
#include "coupler/study/words.h"
#include "protocol/results/results.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- reading ---- */

/* The way out ends, and the way back begins, at the row whose abscissa is farthest from the first. */
static int farthest(const double *x, int n) {
  int far = 0;
  for (int i = 1; i < n; i++)
    if (fabs(x[i] - x[0]) > fabs(x[far] - x[0]))
      far = i;
  return far;
}

/* Where a target's way back begins. An abscissa that turns again is refused. */
static tdm_status find_back(cpl_target *t, tdm_error *err) {
  const int far = farthest(t->x, t->n);
  const double sign = t->x[far] > t->x[0] ? 1 : -1;
  for (int i = 1; i < t->n; i++)
    if ((i <= far ? sign : -sign) * (t->x[i] - t->x[i - 1]) < 0)
      return tdm_fail(err, TDM_ERR_FILE, NULL,
                      "%s: row %d: the abscissa turns at %g; sort the rows by it, or let it go out and back once",
                      t->file, i + 1, t->x[i]);
  if (far == 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: all rows have the same abscissa; a curve needs two", t->file);
  t->back = far + 1;
  return TDM_OK;
}

/* A column's name: "time", or a channel, with a minus in front for its negative. */
static tdm_status read_column(cpl_target *t, int k, const char *name, tdm_error *err) {
  const char *channel = *name == '-' ? name + 1 : name;
  const bool time = strcmp(channel, "time") == 0;
  t->sign[k] = *name == '-' ? -1 : 1;
  snprintf(t->column[k], sizeof t->column[k], "%s", name);
  snprintf(t->channel[k], sizeof t->channel[k], "%s", time ? "" : channel);
  if (time && k == 1)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s:1: the second column is \"time\"; put it first", t->file);
  if (!time && (!strchr(channel, ':') || *channel == ':'))
    return tdm_fail(err, TDM_ERR_FILE, NULL,
                    "%s:1: column \"%s\" is no channel of a run; name it %sSOLVER:NAME, such as "
                    "mbd:joint.guide.translation or dem:body.piston.fz",
                    t->file, name, k == 0 ? "time, or " : "");
  return TDM_OK;
}

static double scale_of(const double *y, int n) {
  double least = INFINITY, most = -INFINITY;
  for (int i = 0; i < n; i++) {
    least = fmin(least, y[i]);
    most = fmax(most, y[i]);
  }
  return most > least ? most - least : most != 0 ? fabs(most) : 1;
}

static tdm_status take_rows(cpl_target *t, const cpl_table *table, tdm_error *err) {
  t->n = table->nrow;
  t->x = malloc((size_t)t->n * sizeof *t->x);
  t->y = malloc((size_t)t->n * sizeof *t->y);
  if (!t->x || !t->y)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int i = 0; i < t->n; i++) {
    t->x[i] = table->data[i];
    t->y[i] = table->data[t->n + i];
    if (!isfinite(t->x[i]) || !isfinite(t->y[i]))
      return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: row %d has no finite numbers; leave it out", t->file, i + 1);
  }
  t->scale = scale_of(t->y, t->n);
  return find_back(t, err);
}

static tdm_status read_curve(cpl_target *t, const char *file, tdm_error *err) {
  cpl_table table = {0};
  t->file = strdup(file);
  if (!t->file)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  snprintf(t->name, sizeof t->name, "%s", strrchr(file, '/') ? strrchr(file, '/') + 1 : file);
  tdm_utf8_clean(t->name);
  if (cpl_table_read_given(&table, file, 2, err) == TDM_OK) {
    if (table.nrow < 2)
      tdm_fail(err, TDM_ERR_FILE, NULL, "%s: has %d row%s; a curve needs two", file, table.nrow,
               table.nrow == 1 ? "" : "s");
    else if (read_column(t, 0, table.name[0], err) == TDM_OK && read_column(t, 1, table.name[1], err) == TDM_OK)
      take_rows(t, &table, err);
  }
  cpl_table_free(&table);
  return err->status;
}

static tdm_status read_number(cpl_target *t, const char *word, const char *measure, tdm_error *err) {
  char *end;
  *t = (cpl_target){.n = 1, .back = 1, .sign = {1, 1}, .x = calloc(1, sizeof *t->x), .y = calloc(1, sizeof *t->y)};
  if (!t->x || !t->y)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  t->y[0] = strtod(word, &end);
  snprintf(t->name, sizeof t->name, "%s", measure);
  snprintf(t->channel[1], sizeof t->channel[1], "%s", measure);
  snprintf(t->column[1], sizeof t->column[1], "%s", measure);
  t->scale = scale_of(t->y, 1);
  return *end || !isfinite(t->y[0])
             ? tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
                        "calibrate: --target %s: the target of --measure %s is a finite number", word, measure)
             : TDM_OK;
}

tdm_status cpl_target_read(cpl_target *t, const char *word, const char *measure, tdm_error *err) {
  *t = (cpl_target){0};
  return measure ? read_number(t, word, measure, err) : read_curve(t, word, err);
}

void cpl_target_free(cpl_target *t) {
  free(t->file);
  free(t->x);
  free(t->y);
  *t = (cpl_target){0};
}

/* ---- what the study records ---- */

void cpl_target_enter(const cpl_target *t, int k, json_t *measures, json_t *curves) {
  char name[32];
  for (int c = 0; c < 2; c++) {
    json_t *of = t->file ? NULL : c == 1 ? cpl_measure_to_json(t->channel[c]) : NULL;
    if (t->file && t->channel[c][0])
      of = json_pack("{s:s}", "channel", t->channel[c]);
    if (!of)
      continue;
    snprintf(name, sizeof name, "target_%d_%s", k, c == 0 ? "x" : "y");
    json_object_set_new(of, "name", json_string(name));
    json_array_append_new(t->file ? curves : measures, of);
  }
}

/* The study's curve of column c; NULL: time. */
static const cpl_study_measure *curve_of(const cpl_target *t, int k, const cpl_study *study, int c) {
  char name[32];
  snprintf(name, sizeof name, "target_%d_%s", k, c == 0 ? "x" : "y");
  for (int i = 0; t->channel[c][0] && i < study->ncurve; i++)
    if (strcmp(study->curve[i].name, name) == 0)
      return &study->curve[i];
  return NULL;
}

/* ---- the curve of a run ---- */

/* A straight line between the rows of x, which goes on in the direction `sign`; beyond the ends their values. */
static double between(const double *x, const double *y, int n, double sign, double at) {
  int low = 0, high = n - 1;
  if (sign * (at - x[low]) <= 0)
    return y[low];
  if (sign * (at - x[high]) >= 0)
    return y[high];
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    if (sign * (at - x[middle]) >= 0)
      low = middle;
    else
      high = middle;
  }
  return y[low] + (y[high] - y[low]) * ((at - x[low]) / (x[high] - x[low]));
}

/* Move the rows from `first` to before `end` whose abscissa goes beyond all before to place `to`; returns the next. */
static int keep_records(double *x, double *y, int first, int end, double sign, int to) {
  const int begin = to;
  for (int i = first; i < end; i++) {
    if (to > begin && sign * (x[i] - x[to - 1]) <= 0)
      continue;
    x[to] = x[i];
    y[to++] = y[i];
  }
  return to;
}

/* Rows that are numbers, with values from the times of the abscissa; returns how many there are. */
static int pair_rows(const cpl_target *t, double *x, const double *tx, int nx, const double *ty, const double *y,
                     int ny, double *out) {
  int n = 0;
  for (int i = 0; i < nx; i++) {
    const double value = nx == ny && tx[i] == ty[i] ? y[i] : between(ty, y, ny, 1, tx[i]);
    if (!isfinite(x[i]) || !isfinite(value))
      continue;
    out[n] = t->sign[1] * value;
    x[n++] = t->sign[0] * x[i];
  }
  return n;
}

/* Leave of n rows those that are compared; returns how many. Which way is out is the target's. */
static int leave_ways(const cpl_target *t, double *x, double *y, int n, int *back) {
  const double sign = t->x[t->back - 1] > t->x[0] ? 1 : -1;
  int first = 0, last = 0;
  for (int i = 0; i < n; i++) {
    first = sign * (x[i] - x[first]) > 0 ? i : first;
    last = sign * (x[i] - x[last]) >= 0 ? i : last;
  }
  *back = keep_records(x, y, 0, first + 1, sign, 0);
  return t->back < t->n ? keep_records(x, y, last + 1, n, -sign, *back) : *back;
}

int cpl_target_curve(const cpl_target *t, int k, const cpl_study *study, const cpl_cell *run, double **x, double **y,
                     int *back, tdm_error *err) {
  const cpl_study_measure *of_x = curve_of(t, k, study, 0), *of_y = curve_of(t, k, study, 1);
  double *tx = NULL, *ty = NULL, *values = NULL;
  int nx = 0, ny = 0, n = 0;
  *x = *y = NULL;
  if (of_y)
    ny = cpl_study_history(run, of_y, &ty, &values, err);
  if (of_x && ny > 0)
    nx = cpl_study_history(run, of_x, &tx, x, err);
  if (!of_x && ny > 0) { /* over time */
    nx = ny;
    tx = malloc((size_t)ny * sizeof *tx);
    *x = malloc((size_t)ny * sizeof **x);
    if (tx && *x) {
      memcpy(tx, ty, (size_t)ny * sizeof *tx);
      memcpy(*x, ty, (size_t)ny * sizeof **x);
    }
  }
  *y = malloc((size_t)nx * sizeof **y + 8);
  if (nx > 0 && ny > 0 && tx && *x && *y)
    n = leave_ways(t, *x, *y, pair_rows(t, *x, tx, nx, ty, values, ny, *y), back);
  if (n == 0)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: the run has no rows of numbers for it", t->name);
  free(tx);
  free(ty);
  free(values);
  return n;
}

/* ---- beside the target ---- */

/* How many of the target's rows the run's abscissa reaches, to rounding. */
static int count_reached(const cpl_target *t, const double *x, int out, int n) {
  int reached = 0;
  for (int i = 0; i < t->n; i++) {
    const int first = i < t->back ? 0 : out, end = i < t->back ? out : n;
    const double slack = 1e-9 * fabs(t->x[t->back - 1] - t->x[0]);
    const double least = end > first ? fmin(x[first], x[end - 1]) : INFINITY;
    const double most = end > first ? fmax(x[first], x[end - 1]) : -INFINITY;
    reached += t->x[i] >= least - slack && t->x[i] <= most + slack;
  }
  return reached;
}

static tdm_status curve_values(const cpl_target *t, int k, const cpl_study *study, const cpl_cell *run, double *value,
                               double *covered, tdm_error *err) {
  double *x, *y;
  int out = 0;
  const double sign = t->x[t->back - 1] > t->x[0] ? 1 : -1;
  const int n = cpl_target_curve(t, k, study, run, &x, &y, &out, err), reached = count_reached(t, x, out, n);
  for (int i = 0; i < t->n && n > 0; i++) {
    const bool back = i >= t->back && n > out;
    value[i] = between(x + (back ? out : 0), y + (back ? out : 0), back ? n - out : out, back ? -sign : sign, t->x[i]);
  }
  *covered = (double)reached / t->n;
  if (n > 0 && reached == 0)
    tdm_fail(err, TDM_ERR_NUMERIC, NULL,
             "%s: the run's abscissa goes from %.4g to %.4g, the target's from %.4g to %.4g", t->name, x[0], x[out - 1],
             t->x[0], t->x[t->back - 1]);
  free(x);
  free(y);
  return err->status;
}

tdm_status cpl_target_values(const cpl_target *t, int k, const cpl_study *study, const cpl_cell *run, double measure,
                             double *value, double *covered, tdm_error *err) {
  if (t->file)
    return curve_values(t, k, study, run, value, covered, err);
  value[0] = measure;
  *covered = 1;
  return isfinite(measure) ? TDM_OK : tdm_fail(err, TDM_ERR_NUMERIC, NULL, "%s: no number there", t->name);
}

/* ---- what there is ---- */

enum { NAMES = 512 };

/* Names that a run's results have. */
typedef struct {
  const char *wanted;
  int n;
  char *name[NAMES]; /* (n) owned; what comes later is left out */
} listing;

static void list_name(listing *l, const char *before, const char *name) {
  char whole[TDM_PATH_MAX];
  snprintf(whole, sizeof whole, "%s%s", before, name);
  char *copy = l->n < NAMES ? strdup(whole) : NULL;
  if (copy)
    l->name[l->n++] = copy;
}

/* What a summary has of the scene and the machine, and is listed only for who asks for it. */
static bool is_aside(const listing *l, const char *path) {
  static const char *const aside[] = {"machine", "parameters", "report", "solvers", "settings", "warnings", "notices"};
  for (size_t k = 0; k < sizeof aside / sizeof *aside; k++)
    if (strcmp(path, aside[k]) == 0)
      return strncmp(l->wanted, path, strlen(path)) != 0;
  return false;
}

/* Paths of all numbers in a summary. */
static void list_numbers(listing *l, const json_t *json, const char *path) {
  char at[TDM_PATH_MAX];
  const char *key;
  json_t *value;
  size_t i;
  if (is_aside(l, path))
    return;
  if (json_is_number(json) || json_is_null(json))
    list_name(l, "", path);
  json_object_foreach((json_t *)json, key, value) {
    snprintf(at, sizeof at, "%s%s%s", path, *path ? "." : "", key);
    list_numbers(l, value, at);
  }
  json_array_foreach((json_t *)json, i, value) {
    snprintf(at, sizeof at, "%s[%zu]", path, i);
    list_numbers(l, value, at);
  }
}

/* Refuse what is wanted unless it is listed; frees the names. */
static tdm_status judge(listing *l, const cpl_target *t, const char *where, tdm_error *err) {
  char all[600] = "";
  bool found = false, cut = false;
  const char *near = tdm_nearest(l->wanted, (const char *const *)l->name, l->n);
  for (int i = 0; i < l->n; i++) {
    const size_t n = strlen(all);
    found = found || strcmp(l->name[i], l->wanted) == 0;
    cut = cut || n + strlen(l->name[i]) + 3 > sizeof all;
    if (!cut)
      snprintf(all + n, sizeof all - n, "%s%s", n ? ", " : "", l->name[i]);
  }
  if (!found)
    tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s%s\"%s\" is not in the results of a run%s%s%s %s has %s%s",
             t->file ? t->file : "--measure ", t->file ? ":1: column " : "", l->wanted, near ? "; did you mean " : ".",
             near ? near : "", near ? "?" : "", where, all, cut ? " and more" : "");
  for (int i = 0; i < l->n; i++)
    free(l->name[i]);
  return err->status;
}

/* A channel "dem:particles.count" among the columns of its file. */
static tdm_status channel_known(const cpl_target *t, const char *channel, const cpl_cell *run, tdm_error *err) {
  char file[4400], before[TDM_PATH_MAX], wanted[TDM_PATH_MAX];
  cpl_table table = {0};
  listing l = {.wanted = wanted};
  snprintf(wanted, sizeof wanted, "%.*s", (int)strcspn(channel, "@"), channel);
  snprintf(before, sizeof before, "%.*s:", (int)strcspn(channel, ":"), channel);
  cpl_study_history_file(run, channel, file, sizeof file);
  if (cpl_table_read(&table, file, err) != TDM_OK) {
    *err = (tdm_error){0};
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
                    "%s%s\"%s\" is not in the results of a run: there is no file %s; name dem: or mbd: as the solver, "
                    "or another CSV file there",
                    t->file ? t->file : "--measure ", t->file ? ":1: column " : "", channel, file);
  }
  for (int c = 0; c < table.ncolumn; c++)
    list_name(&l, before, table.name[c]);
  cpl_table_free(&table);
  return judge(&l, t, file, err);
}

tdm_status cpl_target_known(const cpl_target *t, const cpl_cell *run, tdm_error *err) {
  static const char summary[] = "summary.";
  const bool path = !t->file && !strchr(t->channel[1], ':');
  for (int c = 0; c < 2 && !path && err->status == TDM_OK; c++)
    if (t->channel[c][0])
      channel_known(t, t->channel[c], run, err);
  if (path) {
    const bool whole = strncmp(t->channel[1], summary, strlen(summary)) == 0;
    listing l = {.wanted = t->channel[1] + (whole ? strlen(summary) : 0)};
    json_t *json = tdm_results_read(run->dir, "summary.json", err);
    list_numbers(&l, json, "");
    json_decref(json);
    if (err->status == TDM_OK)
      judge(&l, t, "summary.json", err);
  }
  return err->status;
}
