/* Rows of a sweep: see sweep_rows.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/sweep/sweep_rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const double cpl_good_nse = 0.999;

const char *cpl_row_text(const json_t *row, const char *key) {
  const char *text = json_string_value(json_object_get(row, key));
  return text ? text : "";
}

double cpl_row_number(const json_t *row, const char *group, const char *key) {
  const json_t *value = json_object_get(group ? json_object_get(row, group) : row, key);
  return json_is_number(value) ? json_number_value(value) : NAN;
}

cpl_columns cpl_columns_find(const cpl_cell *cell, int ncell) {
  cpl_columns c = {0};
  const char *key;
  json_t *value;
  for (int i = 0; i < ncell && c.nname == 0; i++) {
    json_object_foreach(json_object_get(cell[i].row, "r2"), key, value) if (c.nname < 8) c.name[c.nname++] = key;
    json_object_foreach(json_object_get(cell[i].row, "nse"), key, value) if (c.nstate < 4) c.state[c.nstate++] = key;
  }
  return c;
}

double cpl_row_error(const json_t *row, const cpl_columns *c) {
  double error = c->nstate ? 0 : NAN;
  for (int i = 0; i < c->nstate; i++)
    error = isnan(error) ? NAN : fmax(error, 1 - cpl_row_number(row, "nse", c->state[i]));
  for (int i = 0; i < c->nstate; i++)
    if (isnan(cpl_row_number(row, "nse", c->state[i])))
      error = NAN;
  return error;
}

int cpl_cheapest(const cpl_cell *cell, int ncell, const cpl_columns *c) {
  int best = -1;
  for (int k = 0; k < ncell; k++) {
    bool good =
        strcmp(cpl_row_text(cell[k].row, "status"), "ok") == 0 && cpl_row_error(cell[k].row, c) <= 1 - cpl_good_nse;
    double wall = cpl_row_number(cell[k].row, NULL, "wall_s");
    if (good && (best < 0 || wall < cpl_row_number(cell[best].row, NULL, "wall_s")))
      best = k;
  }
  return best;
}

int cpl_distinct_schemes(const cpl_cell *cell, int ncell, const char *group, const char *key, const char **out) {
  int n = 0;
  for (int k = 0; k < ncell; k++) {
    const char *scheme = cpl_row_text(cell[k].row, "scheme");
    int i = 0;
    while (i < n && strcmp(out[i], scheme) != 0)
      i++;
    if (i == n && n < CPL_SCHEMES_MAX && !isnan(cpl_row_number(cell[k].row, group, key)))
      out[n++] = scheme;
  }
  return n;
}

static int by_size(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

double cpl_price(const cpl_cell *cell, int ncell, const char *scheme) {
  double *price = calloc((size_t)ncell + 1, sizeof *price);
  int n = 0;
  for (int k = 0; price && k < ncell; k++) {
    double x = cpl_row_number(cell[k].row, NULL, "window_s");
    if (strcmp(cpl_row_text(cell[k].row, "scheme"), scheme) == 0 && !isnan(x))
      price[n++] = x;
  }
  if (price)
    qsort(price, (size_t)n, sizeof *price, by_size);
  double median = n > 0 ? 0.5 * (price[(n - 1) / 2] + price[n / 2]) : NAN;
  free(price);
  return median;
}

bool cpl_on_front(const cpl_cell *cell, int ncell, int k, const cpl_columns *c) {
  double error = cpl_row_error(cell[k].row, c), wall = cpl_row_number(cell[k].row, NULL, "wall_s");
  for (int j = 0; j < ncell; j++)
    if (j != k && cpl_row_error(cell[j].row, c) < error && cpl_row_number(cell[j].row, NULL, "wall_s") < wall)
      return false;
  return !isnan(error);
}
