/* Smooth step: from one value to another between t = start and start + rise, with s = (t - start)/rise
 *   quintic (default): x = from + (to - from) (10 s^3 - 15 s^4 + 6 s^5), rate and acceleration zero at both ends
 *   cubic:             x = from + (to - from) (3 s^2 - 2 s^3), the rate zero at both ends. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/motion/motion.h"

typedef struct {
  double from, to;    /* [rad] or [m] */
  double start, rise; /* [s] */
  bool cubic;
} law;

static void read(void *own, tdm_object *o, tdm_motion_range *range) {
  static const char *const shapes[] = {"quintic", "cubic"};
  law *l = own;
  (void)range;
  l->from = tdm_get_number(o, "from", 0, TDM_ANY);
  l->to = tdm_get_number(o, "to", TDM_REQUIRED, TDM_ANY);
  l->start = tdm_get_number(o, "start", 0, TDM_ANY);
  l->rise = tdm_get_number(o, "rise", TDM_REQUIRED, TDM_POSITIVE);
  l->cubic = tdm_get_choice(o, "shape", shapes, 2, 0) == 1;
}

static tdm_motion_value at(const void *own, double t) {
  const law *l = own;
  const double way = l->to - l->from, T = l->rise;
  double s = fmin(1, fmax(0, (t - l->start) / T)), s2 = s * s, r = 1 - s;
  if (l->cubic)
    return (tdm_motion_value){.value = l->from + way * s2 * (3 - 2 * s),
                              .rate = way / T * 6 * s * r,
                              .acceleration = s > 0 && s < 1 ? way / (T * T) * 6 * (1 - 2 * s) : 0};
  return (tdm_motion_value){.value = l->from + way * s2 * s * (10 - 15 * s + 6 * s2),
                            .rate = way / T * 30 * s2 * r * r,
                            .acceleration = way / (T * T) * 60 * s * r * (1 - 2 * s)};
}

extern const tdm_motion_ops tdm_motion_step;
const tdm_motion_ops tdm_motion_step = {
    .name = "step",
    .size = sizeof(law),
    .read = read,
    .at = at,
};
