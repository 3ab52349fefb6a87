/* What became of a run: see judge.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/stability/judge.h"

#include "coupler/results/table.h"
#include "protocol/results/results.h"
#include "protocol/scene/json.h"
#include "scenarios/support.h"

#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double accurate = 0.05; /* an error that a user would not call wrong */
static const double tame = 100; /* a larger growth of a difference is chaos: the coupling's own errors grow so, too */
static const double spread = 3; /* chaotic: so many times what the neighbour is off is no error either */

const char scn_auto[] = "auto";

const char *const scn_outcome_name[SCN_OUTCOMES] = {"ok",      "warned", "inexact", "stopped",
                                                    "refused", "SILENT", "BROKEN"};

const double scn_nudge[SCN_TRIO] = {0, 1e-12, 1e-6};

scn_outcome scn_row_outcome(const json_t *row) {
  const char *name = json_string_value(json_object_get(row, "outcome"));
  for (int i = 0; name && i < SCN_OUTCOMES; i++)
    if (strcmp(name, scn_outcome_name[i]) == 0)
      return (scn_outcome)i;
  return SCN_BROKEN;
}

/* ---- how far off ---- */

/* a time history, on the output grid */
typedef struct {
  int n;
  double *t, *x; /* (n) both, one block; NULL: none */
} series;

/* The family's column of a run that came to its end. */
static series read_series(const scn_family *f, const cpl_cell *cell) {
  char file[4352];
  const char *ended = json_string_value(json_object_get(cell->row, "ended"));
  series s = {0};
  cpl_table table = {0};
  if (!ended || strcmp(ended, "TDM_OK") != 0)
    return s;
  snprintf(file, sizeof file, "%s/%s", cell->dir, f->file);
  if (cpl_table_read(&table, file, NULL) == TDM_OK) {
    const double *time = cpl_table_column(&table, "time", NULL), *x = cpl_table_column(&table, f->column, NULL);
    const size_t size = (size_t)table.nrow * sizeof *s.t;
    s.t = time && x ? malloc(2 * size) : NULL;
    if (s.t) {
      s.n = table.nrow;
      s.x = s.t + s.n;
      memcpy(s.t, time, size);
      memcpy(s.x, x, size);
    }
  }
  cpl_table_free(&table);
  return s;
}

/* Of a run and its reference those rows alone that are ends of the run's windows: between them a load is a polynomial,
 * whatever impacts it stands for. Both are shortened in place. */
static void keep_ends(series *s, series *reference, double window) {
  int kept = 0;
  for (int i = 0; i < s->n; i++)
    if (i + 1 == s->n || fabs(remainder(s->t[i], window)) < 1e-6 * window) {
      s->x[kept] = s->x[i];
      reference->x[kept++] = reference->x[i];
    }
  s->n = reference->n = kept;
}

/* Of a run and its reference the means over times as long as a window: where windows end anywhere. */
static void keep_means(series *s, series *reference, double window) {
  const int rows = (int)fmax(1, fmin(s->n, round(window / (s->t[1] - s->t[0]))));
  int kept = 0;
  for (int i = 0; i + rows <= s->n; i += rows, kept++) {
    s->x[kept] = gsl_stats_mean(s->x + i, 1, (size_t)rows);
    reference->x[kept] = gsl_stats_mean(reference->x + i, 1, (size_t)rows);
  }
  s->n = reference->n = kept;
}

static void keep_all(series *s, series *reference, double window) {
  (void)s, (void)reference, (void)window;
}

static double rms(const series *s) {
  double sum = 0;
  for (int i = 0; i < s->n; i++)
    sum += s->x[i] * s->x[i];
  return sqrt(sum / s->n);
}

/* scale: the spread of the whole reference */
static double path_error(const series *s, const series *reference, double scale) {
  double sum = 0;
  for (int i = 0; i < s->n; i++)
    sum += pow(s->x[i] - reference->x[i], 2);
  return sqrt(sum / s->n) / scale;
}

static double statistics_error(const series *s, const series *reference, double scale) {
  const double mean = gsl_stats_mean(s->x, 1, (size_t)s->n) - gsl_stats_mean(reference->x, 1, (size_t)s->n);
  return fmax(fabs(mean), fabs(rms(s) - rms(reference))) / scale;
}

typedef double measure(const series *s, const series *reference, double scale);

typedef void choice_of_rows(series *s, series *reference, double window);

/* How far a run is from the reference, by those rows, its windows [s] being of that length; NaN where one of both has
 * not come to its end. */
static double off(measure *by, choice_of_rows *keep, const scn_family *f, const cpl_cell *cell,
                  const cpl_cell *reference, double window) {
  series s = read_series(f, cell), right = read_series(f, reference);
  double error = NAN;
  if (s.n > 1 && s.n == right.n) {
    const double scale = fmax(gsl_stats_sd(right.x, 1, (size_t)right.n), f->floor);
    keep(&s, &right, window);
    error = by(&s, &right, scale);
  }
  free(s.t);
  free(right.t);
  return error;
}

/* ---- what it said ---- */

/* The first warning, "event: message"; returns how many there are. */
static size_t first_warning(const json_t *summary, char *text, size_t size) {
  const json_t *warnings = json_object_get(summary, "warnings"), *first = json_array_get(warnings, 0);
  const char *message = json_string_value(json_object_get(first, "message"));
  if (message)
    snprintf(text, size, "%s", message);
  return json_array_size(warnings);
}

/* Of an inaccurate run: a notice that the mechanism changed inside a window, or vibrates too fast for it. */
static bool tells_of_windows(const json_t *summary, double error, char *text, size_t size) {
  size_t i;
  json_t *notice;
  json_array_foreach(json_object_get(summary, "notices"), i, notice) {
    const char *path = json_string_value(json_object_get(notice, "path"));
    const char *message = json_string_value(json_object_get(notice, "message"));
    if (error > accurate && path && message && strncmp(path, "coupling", 8) == 0) {
      snprintf(text, size, "%s", message);
      return true;
    }
  }
  return false;
}

/* The run's own estimate of its error, as a share of the motion, where it is so large that a user is warned by it;
 * false: it says nothing of the kind. */
static bool estimates_more(const json_t *summary, double error, char *text, size_t size) {
  const double estimate = scn_number_or(summary, "error_estimate.worst_coupling", NAN);
  if (!(estimate > 0.5 * accurate) || !(error > accurate))
    return false;
  snprintf(text, size, "its own estimate of its error is %.2g of the motion", estimate);
  return true;
}

static scn_outcome outcome_of(const char *ended, double error, double allowed, size_t nwarning) {
  if (strcmp(ended, "TDM_OK") == 0) {
    const bool good = error <= allowed; /* NaN is not */
    return good ? (nwarning ? SCN_WARNED : SCN_OK) : (nwarning ? SCN_INEXACT : SCN_SILENT);
  }
  if (strcmp(ended, "TDM_ERR_NUMERIC") == 0)
    return SCN_STOPPED;
  return strcmp(ended, "TDM_ERR_SCENE") == 0 ? SCN_REFUSED : SCN_BROKEN;
}

static json_t *number_at(const json_t *json, const char *path) {
  return tdm_number_to_json(scn_number_or(json, path, NAN));
}

/* Length of the run's windows, the longest where they choose it [s]; 0: it did not come so far. */
static double window_of(const json_t *summary, bool chosen) {
  const json_t *settings = json_object_get(summary, "settings");
  if (chosen)
    return scn_number_or(summary, "parameters.H", 0);
  return json_number_value(json_object_get(settings, "coupling.n")) *
         json_number_value(json_object_get(settings, "time.dt"));
}

/* Does a condition of the scene's parameters hold? */
static int holds(const json_t *summary, const char *path) {
  return scn_number_or(summary, path, 0) != 0;
}

json_t *scn_judge(const scn_family *f, const scn_stability_case *c, const char *scheme, const cpl_cell *cell,
                  const cpl_cell trio[SCN_TRIO]) {
  const cpl_cell *right = &trio[SCN_REFERENCE];
  const char *ended = json_string_value(json_object_get(cell->row, "ended"));
  json_t *summary = tdm_results_read(cell->dir, "summary.json", NULL);
  json_t *fine = tdm_results_read(right->dir, "summary.json", NULL);
  const bool chosen = strcmp(scheme, scn_auto) == 0;
  const double window = window_of(summary, chosen), step = window_of(fine, false);
  const double growth = off(path_error, keep_ends, f, &trio[SCN_NEIGHBOUR], right, step) / scn_nudge[SCN_NEIGHBOUR];
  const bool chaotic = !(growth <= tame);
  measure *by = chaotic ? statistics_error : path_error;
  choice_of_rows *keep = !chosen ? keep_ends : chaotic ? keep_all : keep_means;
  const double error = off(by, keep, f, cell, right, window);
  const double ceiling = off(by, keep_ends, f, &trio[SCN_TWIN], right, step);
  const double reach = off(by, keep_ends, f, &trio[SCN_NEIGHBOUR], right, step);
  const double allowed = chaotic ? fmax(accurate, spread * reach) : accurate;
  char said[TDM_MESSAGE_MAX];
  snprintf(said, sizeof said, "%s", json_string_value(json_object_get(cell->row, "reason")));
  size_t nwarning = ended && strcmp(ended, "TDM_OK") == 0 ? first_warning(summary, said, sizeof said) : 0;
  if (nwarning == 0)
    nwarning = estimates_more(summary, error, said, sizeof said) || tells_of_windows(summary, error, said, sizeof said);
  json_t *row = json_pack(
      "{s:s, s:s, s:s, s:o, s:o, s:o, s:b, s:b, s:b, s:o, s:o, s:o, s:o, s:o, s:s, s:o}", "case", c->name, "scheme",
      scheme, "outcome", scn_outcome_name[outcome_of(ended ? ended : "", error, allowed, nwarning)], "error",
      tdm_number_to_json(error), "ceiling", tdm_number_to_json(ceiling), "growth", tdm_number_to_json(growth),
      "chaotic", (int)chaotic, "beyond", holds(summary, "parameters.beyond"), "coarse",
      holds(summary, "parameters.coarse"), "estimate", number_at(summary, "error_estimate.worst_coupling"),
      "residual_share", number_at(summary, "ledger.residual_share"), "energy_residual",
      number_at(summary, "ledger.energy_residual"), "ratio", number_at(summary, "parameters.ratio"), "H",
      tdm_number_to_json(window), "said", said, "wall_s", number_at(cell->row, "wall_s"));
  json_decref(fine);
  json_decref(summary);
  return row;
}
