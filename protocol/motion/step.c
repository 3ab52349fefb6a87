/* Smooth step: from one value to another between t = start and start + rise,
 *   x = from + (to - from) (10 s^3 - 15 s^4 + 6 s^5), s = (t - start)/rise,
 * with rate and acceleration zero at both ends. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/motion/motion.h"

typedef struct {
  double from, to;    /* [rad] or [m] */
  double start, rise; /* [s] */
} law;

static void read(void *own, tdm_object *o, tdm_motion_range *range) {
  law *l = own;
  (void)range;
  l->from = tdm_get_number(o, "from", 0, TDM_ANY);
  l->to = tdm_get_number(o, "to", TDM_REQUIRED, TDM_ANY);
  l->start = tdm_get_number(o, "start", 0, TDM_ANY);
  l->rise = tdm_get_number(o, "rise", TDM_REQUIRED, TDM_POSITIVE);
}

static tdm_motion_value at(const void *own, double t) {
  const law *l = own;
  const double way = l->to - l->from, T = l->rise;
  double s = fmin(1, fmax(0, (t - l->start) / T)), s2 = s * s, r = 1 - s;
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
