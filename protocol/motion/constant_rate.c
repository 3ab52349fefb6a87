/* Constant rate w from a step or a smooth start at t = 0.
 *
 * step:   x = w t
 * smooth: with s = t/T from 0 to 1 the rate rises as
 *           xdot  = w (10 s^3 - 15 s^4 + 6 s^5)
 *           xddot = w/T 30 s^2 (1 - s)^2, which vanishes at both ends with its derivative; largest 1.875 w/T
 *           x     = w T (5/2 s^4 - 3 s^5 + s^6)
 *         and x = w (t - T/2) after it.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/motion/motion.h"

typedef struct {
  double rate; /* w [rad/s] or [m/s] */
  double rise; /* T [s]; 0: a step */
} law;

static void read(void *own, tdm_object *o, tdm_motion_range *range) {
  law *l = own;
  (void)range;
  static const char *const start[] = {"smooth", "step"};
  l->rate = tdm_get_number(o, "rate", TDM_REQUIRED, TDM_ANY);
  bool smooth = tdm_get_choice(o, "start", start, 2, -1) == 0;
  if (o->err->status)
    return;
  if (smooth)
    l->rise = tdm_get_number(o, "rise", TDM_REQUIRED, TDM_POSITIVE);
  else if (tdm_has(o, "rise"))
    tdm_object_fail(o, "rise", "a step start has no rise; remove it, or set \"start\" to \"smooth\"");
}

static tdm_motion_value at(const void *own, double t) {
  const law *l = own;
  const double w = l->rate, T = l->rise;
  if (!(T > 0))
    return (tdm_motion_value){w * t, w, 0};
  if (t >= T)
    return (tdm_motion_value){w * (t - 0.5 * T), w, 0};
  double s = t > 0 ? t / T : 0, s2 = s * s, s3 = s2 * s;
  return (tdm_motion_value){.value = w * T * s2 * s2 * (2.5 - 3 * s + s2),
                            .rate = w * s3 * (10 - 15 * s + 6 * s2),
                            .acceleration = 30 * w / T * s2 * (1 - s) * (1 - s)};
}

extern const tdm_motion_ops tdm_motion_constant_rate;
const tdm_motion_ops tdm_motion_constant_rate = {
    .name = "constant_rate",
    .size = sizeof(law),
    .read = read,
    .at = at,
};
