/* Triangle: up at the rate w for half a period P, down for the other half, as the barrel of a tumbler screening machine
 * oscillates in Alkhaldi 2007, Eq. (4.6)-(4.7); the second branch printed there is not continuous, here
 *   x = w s                   0 <= s <= P/2,        s the time since the period began
 *   x = w (P - s)             P/2 < s <= P
 *
 * The corners are rounded over the time T around each of them: the rate goes from one to the other of +-w as
 * 10 s^3 - 15 s^4 + 6 s^5 does, which is odd about its middle, so that the triangle is met again at both ends. The
 * acceleration is at most 3.75 w/T and vanishes with its derivative at both ends. The first corner, t = 0, stays sharp:
 * a run begins at the rate w, and before it x = w t. Knots are where a corner begins, its quarters, and where it ends.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/motion/motion.h"

typedef struct {
  double rate;   /* w [rad/s] or [m/s] */
  double half;   /* P/2 [s] */
  double corner; /* T [s] */
} law;

static void read(void *own, tdm_object *o, tdm_motion_range *range) {
  law *l = own;
  (void)range;
  l->half = 0.5 * tdm_get_number(o, "period", TDM_REQUIRED, TDM_POSITIVE);
  l->corner = tdm_get_number(o, "corner", TDM_REQUIRED, TDM_POSITIVE);
  if (tdm_has(o, "rate") && tdm_has(o, "amplitude"))
    tdm_object_fail(o, "rate", "stands beside \"amplitude\"; keep one of the two");
  else if (tdm_has(o, "amplitude"))
    l->rate = tdm_get_number(o, "amplitude", TDM_REQUIRED, TDM_ANY) / l->half;
  else
    l->rate = tdm_get_number(o, "rate", TDM_REQUIRED, TDM_ANY);
  if (!o->err->status && l->corner > l->half)
    tdm_object_fail(o, "corner", "is %.9g s, longer than half a period of %.9g s; use at most that", l->corner,
                    2 * l->half);
}

/* The corner where x turns from -w t to w t, at the time u after it. */
static tdm_motion_value lower_corner(double w, double T, double u) {
  if (fabs(u) >= 0.5 * T)
    return (tdm_motion_value){w * fabs(u), u < 0 ? -w : w, 0};
  const double s = u / T + 0.5, s2 = s * s, s3 = s2 * s;
  return (tdm_motion_value){.value = w * T * (0.5 - s + 2 * s2 * s2 * (2.5 - 3 * s + s2)),
                            .rate = w * (2 * s3 * (10 - 15 * s + 6 * s2) - 1),
                            .acceleration = 60 * w / T * s2 * (1 - s) * (1 - s)};
}

static tdm_motion_value at(const void *own, double t) {
  const law *l = own;
  const double nearest = round(t / l->half);
  if (nearest <= 0)
    return (tdm_motion_value){l->rate * t, l->rate, 0};
  tdm_motion_value x = lower_corner(l->rate, l->corner, t - nearest * l->half);
  if (fmod(nearest, 2) == 0)
    return x;
  return (tdm_motion_value){l->rate * l->half - x.value, -x.rate, -x.acceleration};
}

static double knot(const void *own, double t) {
  const law *l = own;
  const double quarter = 0.25 * l->corner;
  for (double corner = fmax(1, floor(t / l->half));; corner++)
    for (int k = -2; k <= 2; k++)
      if (corner * l->half + k * quarter > t)
        return corner * l->half + k * quarter;
}

extern const tdm_motion_ops tdm_motion_triangle;
const tdm_motion_ops tdm_motion_triangle = {
    .name = "triangle",
    .size = sizeof(law),
    .read = read,
    .at = at,
    .knot = knot,
};
