/* Time histories read back, and how well two of them agree: see table.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/results/table.h"

#include "protocol/scene/input.h"

#include <errno.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdbool.h>
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
    cell += strspn(cell, " ");
    cell[strcspn(cell, " \r\n")] = 0;
    t->name[t->ncolumn] = strdup(cell);
    if (!t->name[t->ncolumn++])
      return -1;
  }
  return 0;
}

/* A file under way. */
typedef struct {
  FILE *f;
  char *line; /* owned */
  size_t size;
  int given;   /* columns of a file by people, which is whole; 0: of a run, perhaps under way */
  int at;      /* number of the line */
  int bad_row; /* 0: none */
} reading;

/* The numbers of a line into `row`; false: it is no row. */
static bool read_row(const cpl_table *t, const reading *r, double *row) {
  char *p = r->line;
  for (int c = 0; c < t->ncolumn; c++) {
    char *end;
    row[c] = strtod(p, &end);
    if (end == p || (*end != ',' && c + 1 < t->ncolumn))
      return false;
    p = end + 1;
    if (r->given && c + 1 == t->ncolumn && end[strspn(end, " \t\r\n")])
      return false;
  }
  return true;
}

/* Row-major numbers of the file, grown as they come. Returns NULL when memory ran out or a row is too short. */
static double *read_rows(cpl_table *t, reading *r) {
  size_t capacity = 1024 * (size_t)t->ncolumn, used = 0;
  double *rows = malloc(capacity * sizeof *rows);
  while (rows && getline(&r->line, &r->size, r->f) > 0) {
    r->at++;
    if (used + (size_t)t->ncolumn > capacity) {
      double *larger = realloc(rows, 2 * capacity * sizeof *rows);
      if (!larger) {
        free(rows);
        return NULL;
      }
      rows = larger;
      capacity *= 2;
    }
    if (!r->given && !strchr(r->line, '\n'))
      break; /* the last row of a run that was cut short, not whole */
    if (r->given && !r->line[strspn(r->line, " \t\r\n")])
      continue;
    if (!read_row(t, r, rows + used)) {
      r->bad_row = r->at;
      free(rows);
      return NULL;
    }
    used += (size_t)t->ncolumn;
    t->nrow++;
  }
  return rows;
}

static tdm_status read_table(cpl_table *t, const char *file, int given, tdm_error *err) {
  *t = (cpl_table){0};
  const char *why;
  reading r = {.f = tdm_open_input(file, false, &why), .given = given, .at = 1};
  if (!r.f)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be opened: %s", file, why);
  double *rows = NULL;
  if (getline(&r.line, &r.size, r.f) <= 0)
    r.bad_row = 1;
  else if (read_names(t, r.line) == 0 && (given == 0 || t->ncolumn == given))
    rows = read_rows(t, &r);
  fclose(r.f);
  free(r.line);
  t->data = rows ? malloc((size_t)t->ncolumn * (size_t)t->nrow * sizeof *t->data + 8) : NULL;
  if (!t->data) {
    free(rows);
    if (given > 0 && t->ncolumn != given && r.bad_row == 0)
      tdm_fail(err, TDM_ERR_FILE, NULL, "%s:1: has %d column%s; give it %d, with commas between them", file, t->ncolumn,
               t->ncolumn == 1 ? "" : "s", given);
    cpl_table_free(t);
    return r.bad_row ? tdm_fail(err, TDM_ERR_FILE, NULL, "%s:%d: not a row of numbers", file, r.bad_row)
                     : tdm_fail(err, TDM_ERR_MEMORY, NULL, "%s: out of memory", file);
  }
  for (int i = 0; i < t->nrow; i++)
    for (int c = 0; c < t->ncolumn; c++)
      t->data[(size_t)c * (size_t)t->nrow + (size_t)i] = rows[(size_t)i * (size_t)t->ncolumn + (size_t)c];
  free(rows);
  return TDM_OK;
}

tdm_status cpl_table_read(cpl_table *table, const char *file, tdm_error *err) {
  return read_table(table, file, 0, err);
}

tdm_status cpl_table_read_given(cpl_table *table, const char *file, int ncolumn, tdm_error *err) {
  return read_table(table, file, ncolumn, err);
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
