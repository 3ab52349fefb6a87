/* Harmonic x = mean + amplitude sin(omega t + phase). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/motion/harmonic.h"

static void read(void *own, tdm_object *o, tdm_motion_range *range) {
  tdm_harmonic *h = own;
  (void)range;
  h->amplitude = tdm_get_number(o, "amplitude", TDM_REQUIRED, TDM_ANY);
  if (tdm_has(o, "omega") && tdm_has(o, "frequency"))
    tdm_object_fail(o, "omega", "stands beside \"frequency\"; keep one of the two");
  else if (tdm_has(o, "omega"))
    h->omega = tdm_get_number(o, "omega", TDM_REQUIRED, TDM_ANY);
  else
    h->omega = 2 * M_PI * tdm_get_number(o, "frequency", TDM_REQUIRED, TDM_ANY);
  h->phase = tdm_get_number(o, "phase", 0, TDM_ANY);
  h->mean = tdm_get_number(o, "mean", 0, TDM_ANY);
}

tdm_motion_value tdm_harmonic_at(const tdm_harmonic *h, double t) {
  const double a = h->amplitude, w = h->omega, s = sin(w * t + h->phase), c = cos(w * t + h->phase);
  return (tdm_motion_value){h->mean + a * s, a * w * c, -a * w * w * s};
}

static tdm_motion_value at(const void *own, double t) {
  return tdm_harmonic_at(own, t);
}

extern const tdm_motion_ops tdm_motion_harmonic;
const tdm_motion_ops tdm_motion_harmonic = {
    .name = "harmonic",
    .size = sizeof(tdm_harmonic),
    .read = read,
    .at = at,
};
