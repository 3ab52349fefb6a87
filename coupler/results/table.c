/* Time histories read back, and how well two of them agree: see table.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/results/table.h"

#include "protocol/scene/input.h"

#include <errno.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Cut the header line into names; the unit behind the blank is dropped. */
static int read_names(cpl_table *t, char *line) {
  int capacity = 1;
  for (const char *c = line; *c; c++)
    capacity += *c == ',';
  t->name = calloc((size_t)capacity, sizeof *t->name);
  if (!t->name)
    return -1;
  for (char *rest = line, *cell; (cell = strsep(&rest, ",")) != NULL;) {
    cell[strcspn(cell, " \r\n")] = 0;
    t->name[t->ncolumn] = strdup(cell);
    if (!t->name[t->ncolumn++])
      return -1;
  }
  return 0;
}

/* Row-major numbers of the file, grown as they come. Returns NULL when memory ran out or a row is too short. */
static double *read_rows(cpl_table *t, FILE *f, char **line, size_t *size, int *bad_row) {
  size_t capacity = 1024 * (size_t)t->ncolumn, used = 0;
  double *rows = malloc(capacity * sizeof *rows);
  while (rows && getline(line, size, f) > 0) {
    if (used + (size_t)t->ncolumn > capacity) {
      double *larger = realloc(rows, 2 * capacity * sizeof *rows);
      if (!larger) {
        free(rows);
        return NULL;
      }
      rows = larger;
      capacity *= 2;
    }
    if (!strchr(*line, '\n'))
      break; /* the last row of a run that was cut short, not whole */
    char *p = *line;
    for (int c = 0; c < t->ncolumn; c++) {
      char *end;
      rows[used++] = strtod(p, &end);
      if (end == p || (*end != ',' && c + 1 < t->ncolumn)) {
        *bad_row = t->nrow + 2;
        free(rows);
        return NULL;
      }
      p = end + 1;
    }
    t->nrow++;
  }
  return rows;
}

tdm_status cpl_table_read(cpl_table *t, const char *file, tdm_error *err) {
  *t = (cpl_table){0};
  const char *why;
  FILE *f = tdm_open_input(file, false, &why);
  if (!f)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be opened: %s", file, why);
  char *line = NULL;
  size_t size = 0;
  int bad_row = 0;
  double *rows = NULL;
  if (getline(&line, &size, f) <= 0)
    bad_row = 1;
  else if (read_names(t, line) == 0)
    rows = read_rows(t, f, &line, &size, &bad_row);
  fclose(f);
  free(line);
  t->data = rows ? malloc((size_t)t->ncolumn * (size_t)t->nrow * sizeof *t->data + 8) : NULL;
  if (!t->data) {
    free(rows);
    cpl_table_free(t);
    return bad_row ? tdm_fail(err, TDM_ERR_FILE, NULL, "%s:%d: not a row of numbers", file, bad_row)
                   : tdm_fail(err, TDM_ERR_MEMORY, NULL, "%s: out of memory", file);
  }
  for (int r = 0; r < t->nrow; r++)
    for (int c = 0; c < t->ncolumn; c++)
      t->data[(size_t)c * (size_t)t->nrow + (size_t)r] = rows[(size_t)r * (size_t)t->ncolumn + (size_t)c];
  free(rows);
  return TDM_OK;
}

void cpl_table_free(cpl_table *t) {
  for (int c = 0; t->name && c < t->ncolumn; c++)
    free(t->name[c]);
  free(t->name);
  free(t->data);
  *t = (cpl_table){0};
}

const double *cpl_table_column(const cpl_table *t, const char *name, tdm_error *err) {
  for (int c = 0; c < t->ncolumn; c++)
    if (strcmp(t->name[c], name) == 0)
      return t->data + (size_t)c * (size_t)t->nrow;
  const char *near = tdm_nearest(name, (const char *const *)t->name, t->ncolumn);
  tdm_fail(err, TDM_ERR_FILE, NULL, "no column \"%s\"%s%s", name, near ? "; the nearest is " : "", near ? near : "");
  return NULL;
}

static int all_finite(const double *values, int n) {
  for (int i = 0; i < n; i++)
    if (!isfinite(values[i]))
      return 0;
  return 1;
}

double cpl_nse(const double *simulation, const double *reference, int n) {
  if (n < 2 || !all_finite(simulation, n) || !all_finite(reference, n))
    return NAN;
  double mean = gsl_stats_mean(reference, 1, (size_t)n), sse = 0, sst = 0;
  for (int i = 0; i < n; i++) {
    sse += (simulation[i] - reference[i]) * (simulation[i] - reference[i]);
    sst += (reference[i] - mean) * (reference[i] - mean);
  }
  return 1 - sse / sst;
}

double cpl_r2(const double *simulation, const double *reference, int n) {
  if (n < 2 || !all_finite(simulation, n) || !all_finite(reference, n))
    return NAN;
  double r = gsl_stats_correlation(simulation, 1, reference, 1, (size_t)n);
  return r * r;
}
