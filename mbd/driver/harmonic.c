/* Harmonic x = mean + amplitude sin(omega t + phase). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/driver/motion.h"

static void load(mbd_motion *motion, tdm_object *o) {
  motion->amplitude = tdm_get_number(o, "amplitude", TDM_REQUIRED, TDM_ANY);
  if (tdm_has(o, "omega") && tdm_has(o, "frequency"))
    tdm_object_fail(o, "omega", "stands beside \"frequency\"; keep one of the two");
  else if (tdm_has(o, "omega"))
    motion->omega = tdm_get_number(o, "omega", TDM_REQUIRED, TDM_ANY);
  else
    motion->omega = 2 * M_PI * tdm_get_number(o, "frequency", TDM_REQUIRED, TDM_ANY);
  motion->phase = tdm_get_number(o, "phase", 0, TDM_ANY);
  motion->from = tdm_get_number(o, "mean", 0, TDM_ANY);
}

static mbd_motion_value eval(const mbd_motion *motion, double t) {
  const double a = motion->amplitude, w = motion->omega, s = sin(w * t + motion->phase), c = cos(w * t + motion->phase);
  return (mbd_motion_value){motion->from + a * s, a * w * c, -a * w * w * s};
}

extern const mbd_motion_ops mbd_motion_harmonic;
const mbd_motion_ops mbd_motion_harmonic = {"harmonic", load, eval};
