/* Polynomial x = c0 + c1 t + c2 t^2 + ... */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/driver/motion.h"
#include "mbd/model/curve.h"

static void load(mbd_motion *motion, tdm_object *o) {
  motion->coefficient = mbd_read_numbers(o, "coefficients", &motion->ncoefficient);
  if (!o->err->status && motion->ncoefficient == 0)
    tdm_object_fail(o, "coefficients", "is empty; give [c0, c1, ...] of c0 + c1 t + ...");
}

/* Horner, with both derivatives */
static mbd_motion_value eval(const mbd_motion *motion, double t) {
  mbd_motion_value x = {0, 0, 0};
  for (int i = motion->ncoefficient - 1; i >= 0; i--) {
    x.acceleration = x.acceleration * t + 2 * x.rate;
    x.rate = x.rate * t + x.value;
    x.value = x.value * t + motion->coefficient[i];
  }
  return x;
}

extern const mbd_motion_ops mbd_motion_polynomial;
const mbd_motion_ops mbd_motion_polynomial = {"polynomial", load, eval};
