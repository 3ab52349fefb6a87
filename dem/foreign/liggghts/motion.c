/* A path as velocities: see motion.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/foreign/liggghts/motion.h"

#include <math.h>

static const double least_turn = 1e-14; /* of a window [rad]: less is rounding */

tdm_vec3 lig_motion_angles(tdm_quat q) {
  /* of the rotation's matrix: sines first, as the angles are small */
  const double m20 = 2 * (q.x * q.z - q.w * q.y), m21 = 2 * (q.y * q.z + q.w * q.x);
  const double m10 = 2 * (q.x * q.y + q.w * q.z);
  const double m22 = 1 - 2 * (q.x * q.x + q.y * q.y), m00 = 1 - 2 * (q.y * q.y + q.z * q.z);
  return tdm_v3(atan2(m21, m22), asin(fmax(-1, fmin(1, -m20))), atan2(m10, m00));
}

lig_motion lig_motion_make(tdm_pose place, const tdm_state *start, const tdm_state *end, tdm_interpolation way,
                           double n, double dt) {
  lig_motion m = {0};
  const double h = 1 / n, window = n * dt;
  const tdm_vec3 d = tdm_sub(end->pose.position, start->pose.position);
  const tdm_vec3 v0 = start->twist.velocity, v1 = end->twist.velocity;
  tdm_vec3 p1 = d, p2 = {0, 0, 0}, p3 = {0, 0, 0};
  if (way == TDM_HERMITE) {
    p1 = tdm_scale(window, v0);
    p2 = tdm_sub(tdm_scale(3, d), tdm_scale(window, tdm_axpy(2, v0, v1)));
    p3 = tdm_axpy(-2, d, tdm_scale(window, tdm_add(v0, v1)));
  }
  p1 = tdm_add(p1, tdm_sub(start->pose.position, place.position));
  m.c[0] = tdm_scale(1 / dt, tdm_axpy(h, p1, tdm_axpy(-h * h, p2, tdm_scale(h * h * h, p3))));
  m.c[1] = tdm_scale(1 / dt, tdm_axpy(2 * h * h, p2, tdm_scale(-3 * h * h * h, p3)));
  m.c[2] = tdm_scale(3 * h * h * h / dt, p3);
  const tdm_vec3 turn = tdm_quat_turn(place.orientation, end->pose.orientation);
  m.turns = tdm_norm(turn) > least_turn;
  if (m.turns)
    m.rate = tdm_scale(1 / dt, lig_motion_angles(tdm_quat_from_rotvec(tdm_scale(h, turn))));
  return m;
}
