/* How far two states of a body, or what two solvers make of a window, are apart: see mismatch.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/loop/mismatch.h"

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
