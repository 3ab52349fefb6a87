/* Sum of laws: the oscillation of a body beside the steady turn of what it stands on. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/motion/motion.h"

#include <stdlib.h>

typedef struct {
  int n;
  tdm_motion *part; /* (n) owned */
} law;

static void read(void *own, tdm_object *o, tdm_motion_range *range) {
  law *l = own;
  json_t *laws = tdm_get_array(o, "laws", true);
  const int n = (int)json_array_size(laws);
  if (o->err->status)
    return;
  if (n == 0) {
    tdm_object_fail(o, "laws", "is empty; give the laws to add");
    return;
  }
  l->part = calloc((size_t)n, sizeof *l->part);
  if (!l->part) {
    tdm_object_fail(o, "laws", "no memory for %d motion laws", n);
    o->err->status = TDM_ERR_MEMORY;
    return;
  }
  for (l->n = 0; l->n < n && !o->err->status; l->n++) {
    char path[TDM_PATH_MAX];
    tdm_motion *part = &l->part[l->n];
    tdm_object one = tdm_object_open(json_array_get(laws, (size_t)l->n), tdm_path(path, o, "laws", l->n), o->err);
    tdm_motion_read_law(part, &one);
    range->first = fmax(range->first, part->range.first);
    range->last = fmin(range->last, part->range.last);
  }
}

static tdm_motion_value at(const void *own, double t) {
  const law *l = own;
  tdm_motion_value sum = {0, 0, 0};
  for (int i = 0; i < l->n; i++) {
    const tdm_motion_value x = tdm_motion_at(&l->part[i], t);
    sum.value += x.value;
    sum.rate += x.rate;
    sum.acceleration += x.acceleration;
  }
  return sum;
}

static double magnitude(const void *own, double t) {
  const law *l = own;
  double sum = 0;
  for (int i = 0; i < l->n; i++)
    sum += tdm_motion_magnitude(&l->part[i], t);
  return sum;
}

static double knot(const void *own, double t) {
  const law *l = own;
  double first = INFINITY;
  for (int i = 0; i < l->n; i++)
    first = fmin(first, tdm_motion_knot(&l->part[i], t));
  return first;
}

static void clear(void *own) {
  law *l = own;
  for (int i = 0; i < l->n; i++)
    tdm_motion_clear(&l->part[i]);
  free(l->part);
}

extern const tdm_motion_ops tdm_motion_sum;
const tdm_motion_ops tdm_motion_sum = {
    .name = "sum",
    .size = sizeof(law),
    .read = read,
    .at = at,
    .clear = clear,
    .knot = knot,
    .magnitude = magnitude,
};
