/* A function of one variable through given points: see spline.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/motion/spline.h"

#include <gsl/gsl_spline.h>
#include <stdlib.h>
#include <string.h>

struct tdm_spline {
  gsl_spline *spline;
  int n;
  bool periodic;
  tdm_spline_value end[2]; /* at the first and the last point */
  double to_zero;          /* integral from the first point to 0 */
};

double *tdm_numbers_from_json(json_t *array, const char *path, int *n, tdm_error *err) {
  *n = (int)json_array_size(array);
  double *out = calloc((size_t)*n + 1, sizeof *out);
  if (!out)
    tdm_fail(err, TDM_ERR_MEMORY, path, "no memory for %d numbers", *n);
  for (int i = 0; i < *n && out; i++) {
    json_t *value = json_array_get(array, (size_t)i);
    out[i] = json_number_value(value);
    if (json_is_number(value) && isfinite(out[i]))
      continue;
    tdm_fail(err, TDM_ERR_SCENE, path, "element %d is not a number", i);
    free(out);
    out = NULL;
  }
  return out;
}

double *tdm_get_all_numbers(tdm_object *o, const char *key, int *n) {
  json_t *array = tdm_get_array(o, key, true);
  char path[TDM_PATH_MAX];
  *n = 0;
  return o->err->status ? NULL : tdm_numbers_from_json(array, tdm_path(path, o, key, -1), n, o->err);
}

static bool check(const double *x, const double *y, int n, bool periodic, const char *path, tdm_error *err) {
  int least = periodic ? 3 : 2;
  if (n < least)
    tdm_fail(err, TDM_ERR_SCENE, path, "has %d point%s; give at least %d", n, n == 1 ? "" : "s", least);
  for (int i = 1; i < n && !err->status; i++)
    if (!(x[i] > x[i - 1]))
      tdm_fail(err, TDM_ERR_SCENE, path, "point %d is at %.9g, the one before it at %.9g; give them in ascending order",
               i, x[i], x[i - 1]);
  if (!err->status && periodic && y[0] != y[n - 1])
    tdm_fail(err, TDM_ERR_SCENE, path, "a periodic curve must end where it begins, but has %.9g and %.9g there", y[0],
             y[n - 1]);
  return !err->status;
}

static tdm_spline_value inside(const tdm_spline *c, double x) {
  return (tdm_spline_value){gsl_spline_eval(c->spline, x, NULL), gsl_spline_eval_deriv(c->spline, x, NULL),
                            gsl_spline_eval_deriv2(c->spline, x, NULL)};
}

static void make(tdm_spline **curve, const gsl_interp_type *type, const double *x, const double *y, int n,
                 const char *path, tdm_error *err) {
  bool periodic = type == gsl_interp_cspline_periodic;
  if (err->status || !check(x, y, n, periodic, path, err))
    return;
  tdm_spline *c = *curve = calloc(1, sizeof *c);
  if (c)
    c->spline = gsl_spline_alloc(n == 2 ? gsl_interp_linear : type, (size_t)n);
  if (!c || !c->spline) {
    tdm_fail(err, TDM_ERR_MEMORY, path, "no memory for %d points", n);
    return;
  }
  gsl_spline_init(c->spline, x, y, (size_t)n);
  c->n = n;
  c->periodic = periodic;
  c->end[0] = inside(c, x[0]);
  c->end[1] = inside(c, x[n - 1]);
  c->to_zero = tdm_spline_integral(c, 0);
}

void tdm_spline_read(tdm_spline **curve, tdm_object *o, const double *x, const double *y, int n, const char *path) {
  static const char *const names[] = {"cspline", "steffen", "periodic"};
  const gsl_interp_type *const types[] = {gsl_interp_cspline, gsl_interp_steffen, gsl_interp_cspline_periodic};
  int kind = tdm_get_choice(o, "interpolation", names, 3, 1);
  if (!o->err->status)
    make(curve, types[kind], x, y, n, path, o->err);
}

void tdm_spline_read_table(tdm_spline **curve, tdm_object *o, const char *key, bool steffen) {
  json_t *array = tdm_get_array(o, key, true);
  char path[TDM_PATH_MAX];
  if (o->err->status)
    return;
  tdm_path(path, o, key, -1);
  json_t *x = json_array_get(array, 0), *y = json_array_get(array, 1);
  if (json_array_size(array) != 2 || !json_is_array(x) || json_array_size(x) != json_array_size(y)) {
    tdm_object_fail(o, key, "must be two arrays of the same length: [[x, ...], [y, ...]]");
    return;
  }
  int n;
  double *xs = tdm_numbers_from_json(x, path, &n, o->err), *ys = xs ? tdm_numbers_from_json(y, path, &n, o->err) : NULL;
  if (ys)
    make(curve, steffen ? gsl_interp_steffen : gsl_interp_cspline, xs, ys, n, path, o->err);
  free(xs);
  free(ys);
}

/* x within the points of a periodic curve, and how many periods it is away */
static double wrap(const tdm_spline *c, double x, double *periods) {
  double first = c->spline->x[0], last = c->spline->x[c->n - 1], length = last - first;
  *periods = floor((x - first) / length);
  return fmin(last, fmax(first, x - *periods * length));
}

tdm_spline_value tdm_spline_at(const tdm_spline *c, double x) {
  double first = c->spline->x[0], last = c->spline->x[c->n - 1], periods;
  if (c->periodic)
    return inside(c, wrap(c, x, &periods));
  if (x >= first && x <= last)
    return inside(c, x);
  const tdm_spline_value *end = &c->end[x > last];
  return (tdm_spline_value){end->y + end->slope * (x - (x > last ? last : first)), end->slope, 0};
}

double tdm_spline_integral(const tdm_spline *c, double x) {
  double first = c->spline->x[0], last = c->spline->x[c->n - 1], sum = -c->to_zero;
  if (c->periodic) {
    double periods;
    x = wrap(c, x, &periods);
    sum += periods * gsl_spline_eval_integ(c->spline, first, last, NULL);
  } else if (x < first || x > last) {
    const tdm_spline_value *end = &c->end[x > last];
    double from = x > last ? last : first, beyond = x - from;
    sum += beyond * (end->y + 0.5 * end->slope * beyond);
    x = from;
  }
  return sum + gsl_spline_eval_integ(c->spline, first, x, NULL);
}

void tdm_spline_range(const tdm_spline *c, double *first, double *last) {
  *first = c->periodic ? -INFINITY : c->spline->x[0];
  *last = c->periodic ? INFINITY : c->spline->x[c->n - 1];
}

int tdm_spline_points(const tdm_spline *c, const double **x, const double **y) {
  *x = c->spline->x;
  *y = c->spline->y;
  return c->n;
}

void tdm_spline_destroy(tdm_spline **curve) {
  if (!*curve)
    return;
  if ((*curve)->spline)
    gsl_spline_free((*curve)->spline);
  free(*curve);
  *curve = NULL;
}
