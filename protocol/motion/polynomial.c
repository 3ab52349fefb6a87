/* Polynomial x = c0 + c1 t + c2 t^2 + ... */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/motion/motion.h"
#include "protocol/motion/spline.h"

#include <stdlib.h>

typedef struct {
  int ncoefficient;
  double *coefficient; /* (ncoefficient), owned */
} law;

static void read(void *own, tdm_object *o, tdm_motion_range *range) {
  law *l = own;
  (void)range;
  l->coefficient = tdm_get_all_numbers(o, "coefficients", &l->ncoefficient);
  if (!o->err->status && l->ncoefficient == 0)
    tdm_object_fail(o, "coefficients", "is empty; give [c0, c1, ...] of c0 + c1 t + ...");
}

static void clear(void *own) {
  free(((law *)own)->coefficient);
}

/* Horner, with both derivatives */
static tdm_motion_value at(const void *own, double t) {
  const law *l = own;
  tdm_motion_value x = {0, 0, 0};
  for (int i = l->ncoefficient - 1; i >= 0; i--) {
    x.acceleration = x.acceleration * t + 2 * x.rate;
    x.rate = x.rate * t + x.value;
    x.value = x.value * t + l->coefficient[i];
  }
  return x;
}

extern const tdm_motion_ops tdm_motion_polynomial;
const tdm_motion_ops tdm_motion_polynomial = {
    .name = "polynomial",
    .size = sizeof(law),
    .read = read,
    .at = at,
    .clear = clear,
};
