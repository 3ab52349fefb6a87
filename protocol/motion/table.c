/* Table: a spline through points (t, x), given in the scene or in a CSV file of two columns.
 *
 * A run that goes on after the last point is refused, unless the table ends at rest and "after" says "hold"; a periodic
 * table has no end.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/motion/motion.h"
#include "protocol/motion/spline.h"
#include "protocol/scene/input.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
  int n, capacity;
  double *t, *x;
} points;

static bool append(points *p, double t, double x) {
  if (p->n == p->capacity) {
    size_t capacity = p->capacity ? 2 * (size_t)p->capacity : 64;
    double *more_t = realloc(p->t, capacity * sizeof *p->t);
    p->t = more_t ? more_t : p->t;
    double *more_x = realloc(p->x, capacity * sizeof *p->x);
    p->x = more_x ? more_x : p->x;
    if (!more_t || !more_x)
      return false;
    p->capacity = (int)capacity;
  }
  p->t[p->n] = t;
  p->x[p->n++] = x;
  return true;
}

/* Two numbers of a line, separated by a comma, semicolon or blanks; nothing but blanks may follow. */
static bool two_numbers(const char *line, double *t, double *x) {
  char *end;
  *t = strtod(line, &end);
  if (end == line)
    return false;
  end += strspn(end, " \t");
  end += *end == ',' || *end == ';';
  const char *second = end;
  *x = strtod(second, &end);
  return end != second && end[strspn(end, " \t\r\n")] == 0 && isfinite(*t) && isfinite(*x);
}

static void read_csv(points *p, const char *file, const char *path, tdm_error *err) {
  const char *why;
  FILE *f = tdm_open_input(file, false, &why);
  if (!f) {
    tdm_fail(err, TDM_ERR_FILE, path, "\"%s\" cannot be opened: %s; check the name and the folder", file, why);
    return;
  }
  char *line = NULL;
  size_t size = 0;
  bool started = false;
  for (long number = 1; getline(&line, &size, f) >= 0 && !err->status; number++) {
    const char *at = line + strspn(line, " \t\r\n");
    double t, x;
    if (*at == 0 || *at == '#')
      continue;
    if (two_numbers(at, &t, &x)) {
      if (!append(p, t, x))
        tdm_fail(err, TDM_ERR_MEMORY, path, "no memory for the points of \"%s\"", file);
    } else if (started)
      tdm_fail(err, TDM_ERR_FILE, path, "\"%s\" line %ld is not two numbers \"time, value\"", file, number);
    started = true; /* one line of names may stand first */
  }
  free(line);
  fclose(f);
}

/* "hold": the table must end at rest. */
static void check_rest(const tdm_spline *curve, tdm_object *o) {
  const double *t, *x;
  int n = tdm_spline_points(curve, &t, &x);
  double fastest = 0;
  for (int i = 1; i < n; i++)
    fastest = fmax(fastest, fabs((x[i] - x[i - 1]) / (t[i] - t[i - 1])));
  double rate = tdm_spline_at(curve, t[n - 1]).slope;
  if (fabs(rate) > 1e-9 * fastest)
    tdm_object_fail(o, "after",
                    "is \"hold\", but the table ends with the rate %.6g; let it end at rest (with \"interpolation\": "
                    "\"steffen\" two equal values at the end do)",
                    rate);
}

typedef struct {
  tdm_spline *curve; /* owned */
} law;

static void read(void *own, tdm_object *o, tdm_motion_range *range) {
  law *l = own;
  static const char *const after[] = {"error", "hold"};
  points p = {0};
  int n = 0;
  char path[TDM_PATH_MAX];
  if (tdm_has(o, "file")) {
    read_csv(&p, tdm_get_string(o, "file", NULL), tdm_path(path, o, "file", -1), o->err);
    n = p.n;
  } else {
    p.t = tdm_get_all_numbers(o, "times", &p.n);
    p.x = tdm_get_all_numbers(o, "values", &n);
    if (!o->err->status && n != p.n)
      tdm_object_fail(o, "values", "has %d numbers, \"times\" has %d; give one for each time", n, p.n);
    tdm_path(path, o, "times", -1);
  }
  if (!o->err->status)
    tdm_spline_read(&l->curve, o, p.t, p.x, n, path);
  free(p.t);
  free(p.x);
  if (o->err->status)
    return;
  tdm_spline_range(l->curve, &range->first, &range->last);
  if (isfinite(range->last) && tdm_get_choice(o, "after", after, 2, 0) == 1) {
    check_rest(l->curve, o);
    range->last = INFINITY;
  }
}

static void clear(void *own) {
  tdm_spline_destroy(&((law *)own)->curve);
}

static tdm_motion_value at(const void *own, double t) {
  const law *l = own;
  tdm_spline_value c = tdm_spline_at(l->curve, t);
  return (tdm_motion_value){c.y, c.slope, c.second};
}

extern const tdm_motion_ops tdm_motion_table;
const tdm_motion_ops tdm_motion_table = {
    .name = "table",
    .size = sizeof(law),
    .read = read,
    .at = at,
    .clear = clear,
};
