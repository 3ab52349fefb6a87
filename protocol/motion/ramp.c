/* Ramp: at rest until t = start, then the rate rises to w over T, and stays. With s = (t - start)/T from 0 to 1
 *   quintic (default): xdot = w (10 s^3 - 15 s^4 + 6 s^5), x = w T (5/2 s^4 - 3 s^5 + s^6)
 *   cubic:             xdot = w (3 s^2 - 2 s^3),           x = w T (s^3 - 1/2 s^4)
 * and x = w (t - start - T/2) after it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/motion/motion.h"

typedef struct {
  double rate;        /* w [rad/s] or [m/s] */
  double start, rise; /* T [s] */
  bool cubic;
} law;

static void read(void *own, tdm_object *o, tdm_motion_range *range) {
  static const char *const shapes[] = {"quintic", "cubic"};
  law *l = own;
  (void)range;
  l->rate = tdm_get_number(o, "rate", TDM_REQUIRED, TDM_ANY);
  l->start = tdm_get_number(o, "start", 0, TDM_ANY);
  l->rise = tdm_get_number(o, "rise", TDM_REQUIRED, TDM_POSITIVE);
  l->cubic = tdm_get_choice(o, "shape", shapes, 2, 0) == 1;
}

static tdm_motion_value at(const void *own, double t) {
  const law *l = own;
  const double w = l->rate, T = l->rise, s = fmax(0, (t - l->start) / T), s2 = s * s;
  if (s >= 1)
    return (tdm_motion_value){w * (t - l->start - 0.5 * T), w, 0};
  if (l->cubic)
    return (tdm_motion_value){w * T * s2 * s * (1 - 0.5 * s), w * s2 * (3 - 2 * s), w / T * 6 * s * (1 - s)};
  return (tdm_motion_value){.value = w * T * s2 * s2 * (2.5 - 3 * s + s2),
                            .rate = w * s2 * s * (10 - 15 * s + 6 * s2),
                            .acceleration = 30 * w / T * s2 * (1 - s) * (1 - s)};
}

extern const tdm_motion_ops tdm_motion_ramp;
const tdm_motion_ops tdm_motion_ramp = {
    .name = "ramp",
    .size = sizeof(law),
    .read = read,
    .at = at,
};
