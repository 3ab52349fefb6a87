/* Smooth step: from one value to another between t = start and start + rise,
 *   x = from + (to - from) (10 s^3 - 15 s^4 + 6 s^5), s = (t - start)/rise,
 * with rate and acceleration zero at both ends. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/driver/motion.h"

static void load(mbd_motion *motion, tdm_object *o) {
  motion->from = tdm_get_number(o, "from", 0, TDM_ANY);
  motion->to = tdm_get_number(o, "to", TDM_REQUIRED, TDM_ANY);
  motion->start = tdm_get_number(o, "start", 0, TDM_ANY);
  motion->rise = tdm_get_number(o, "rise", TDM_REQUIRED, TDM_POSITIVE);
}

static mbd_motion_value eval(const mbd_motion *motion, double t) {
  const double way = motion->to - motion->from, T = motion->rise;
  double s = fmin(1, fmax(0, (t - motion->start) / T)), s2 = s * s, r = 1 - s;
  return (mbd_motion_value){.value = motion->from + way * s2 * s * (10 - 15 * s + 6 * s2),
                            .rate = way / T * 30 * s2 * r * r,
                            .acceleration = way / (T * T) * 60 * s * r * (1 - 2 * s)};
}

extern const mbd_motion_ops mbd_motion_step;
const mbd_motion_ops mbd_motion_step = {"step", load, eval};
