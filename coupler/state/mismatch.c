/* How far two solvers are apart, and the window that follows from it: see mismatch.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/state/mismatch.h"

#include <math.h>
#include <string.h>

double cpl_body_radius(const tdm_assigned_body *body) {
  double trace = body->inertia.m[0][0] + body->inertia.m[1][1] + body->inertia.m[2][2];
  double radius = sqrt(trace / 3 / body->mass);
  return isfinite(radius) && radius > 0 ? radius : 1;
}

void cpl_apart(const tdm_state *a, const tdm_state *b, double radius, double H, double out[CPL_APART]) {
  tdm_vec3 turn = tdm_quat_turn(b->pose.orientation, a->pose.orientation);
  const tdm_vec3 parts[4] = {tdm_sub(a->pose.position, b->pose.position), tdm_scale(radius, turn),
                             tdm_scale(H, tdm_sub(a->twist.velocity, b->twist.velocity)),
                             tdm_scale(H * radius, tdm_sub(a->twist.angular, b->twist.angular))};
  memcpy(out, parts, sizeof parts);
}

double cpl_speed(const tdm_state *state, double radius) {
  return hypot(tdm_norm(state->twist.velocity), radius * tdm_norm(state->twist.angular));
}

double cpl_length(int n, const double *values) {
  double sum = 0;
  for (int i = 0; i < n; i++)
    sum += values[i] * values[i];
  return sqrt(sum);
}

double cpl_motion(const cpl_loop *loop, int body) {
  double speed = cpl_speed(&loop->state_end[body], loop->radius[body]);
  return (loop->t1 - loop->t0) * fmax(speed, loop->speed[body]);
}

/* ---- the next window ---- */

/* So that the mismatch, which is rough where particles collide, mostly stays below what is allowed; and so that one
 * quiet window does not make the next one blind. */
static const double safety = 0.9, shrink = 0.2, growth = 1.5;

long cpl_adapt_next(const cpl_auto *s, int order, long n, double excess) {
  double factor = excess > 0 ? safety * pow(excess, -1.0 / order) : growth;
  factor = fmax(shrink, fmin(factor, growth));
  double next = factor > 1 ? ceil(factor * (double)n) : floor(factor * (double)n);
  return (long)fmax((double)s->n_min, fmin(next, (double)s->n_max));
}

/* Growth by 1.5 makes at most 1.5^4 = 5 of a mismatch that was allowed: ten times as much is no growth but a mechanism
 * that has changed, and half a window would have kept it. */
static const double far = 10;

bool cpl_adapt_too_long(double excess) {
  return excess > far;
}
