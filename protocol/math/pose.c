/* Poses, twists, wrenches and the conversions of [L18] Section 2.2: see pose.h. */
/* SPDX-License-Identifier: MIT */
#include "protocol/math/pose.h"

#include <assert.h>

tdm_quat tdm_quat_identity(void) {
  return (tdm_quat){1, 0, 0, 0};
}

tdm_quat tdm_quat_mul(tdm_quat a, tdm_quat b) {
  return (tdm_quat){a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                    a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

tdm_quat tdm_quat_conj(tdm_quat q) {
  return (tdm_quat){q.w, -q.x, -q.y, -q.z};
}

tdm_quat tdm_quat_unit(tdm_quat q) {
  double n = sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  if (!(n > 0))
    return tdm_quat_identity();
  return (tdm_quat){q.w / n, q.x / n, q.y / n, q.z / n};
}

tdm_vec3 tdm_quat_rotate(tdm_quat q, tdm_vec3 v) {
  /* v + 2 u x (u x v + w v), u the vector part */
  tdm_vec3 u = tdm_v3(q.x, q.y, q.z);
  tdm_vec3 t = tdm_axpy(q.w, v, tdm_cross(u, v));
  return tdm_axpy(2, tdm_cross(u, t), v);
}

tdm_quat tdm_quat_from_rotvec(tdm_vec3 r) {
  double angle = tdm_norm(r);
  /* sin(a/2)/a, by its series where the quotient loses digits */
  double s = angle > 1e-4 ? sin(0.5 * angle) / angle : 0.5 - angle * angle / 48;
  return (tdm_quat){cos(0.5 * angle), s * r.x, s * r.y, s * r.z};
}

tdm_vec3 tdm_quat_to_rotvec(tdm_quat q) {
  if (q.w < 0) /* q and -q are one rotation: take the short way */
    q = (tdm_quat){-q.w, -q.x, -q.y, -q.z};
  tdm_vec3 u = tdm_v3(q.x, q.y, q.z);
  double s = tdm_norm(u);
  double factor = s > 1e-8 ? 2 * atan2(s, q.w) / s : 2 / q.w;
  return tdm_scale(factor, u);
}

tdm_vec3 tdm_quat_turn(tdm_quat from, tdm_quat to) {
  return tdm_quat_to_rotvec(tdm_quat_mul(to, tdm_quat_conj(from)));
}

tdm_quat tdm_quat_turned(tdm_quat q, tdm_vec3 turn) {
  return tdm_quat_unit(tdm_quat_mul(tdm_quat_from_rotvec(turn), q));
}

tdm_mat3 tdm_quat_to_matrix(tdm_quat q) {
  double w = q.w, x = q.x, y = q.y, z = q.z;
  return (tdm_mat3){{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                     {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                     {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

tdm_quat tdm_quat_from_matrix(tdm_mat3 a) {
  /* divide by the largest of the four components (Shepperd's choice): no loss of digits at any angle */
  double trace = a.m[0][0] + a.m[1][1] + a.m[2][2];
  double largest = trace;
  int which = -1;
  for (int i = 0; i < 3; i++)
    if (a.m[i][i] > largest) {
      largest = a.m[i][i];
      which = i;
    }
  double v[3], w;
  if (which < 0) {
    w = 0.5 * sqrt(1 + trace);
    v[0] = (a.m[2][1] - a.m[1][2]) / (4 * w);
    v[1] = (a.m[0][2] - a.m[2][0]) / (4 * w);
    v[2] = (a.m[1][0] - a.m[0][1]) / (4 * w);
  } else {
    int i = which, j = (i + 1) % 3, k = (i + 2) % 3;
    v[i] = 0.5 * sqrt(1 + 2 * a.m[i][i] - trace);
    v[j] = (a.m[i][j] + a.m[j][i]) / (4 * v[i]);
    v[k] = (a.m[i][k] + a.m[k][i]) / (4 * v[i]);
    w = (a.m[k][j] - a.m[j][k]) / (4 * v[i]);
  }
  tdm_quat q = tdm_quat_unit((tdm_quat){w, v[0], v[1], v[2]});
  return q.w < 0 ? (tdm_quat){-q.w, -q.x, -q.y, -q.z} : q;
}

tdm_quat tdm_quat_slerp(tdm_quat a, tdm_quat b, double s) {
  double cosine = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
  if (cosine < 0) { /* the short way */
    b = (tdm_quat){-b.w, -b.x, -b.y, -b.z};
    cosine = -cosine;
  }
  double wa = 1 - s, wb = s; /* nearly equal: linear, the difference to SLERP is below round-off */
  if (cosine < 1 - 1e-12) {
    /* the angle from its sine as well: acos alone loses digits near 1 */
    tdm_quat d = tdm_quat_mul(tdm_quat_conj(a), b);
    double angle = atan2(sqrt(d.x * d.x + d.y * d.y + d.z * d.z), cosine);
    wa = sin((1 - s) * angle) / sin(angle);
    wb = sin(s * angle) / sin(angle);
  }
  return tdm_quat_unit((tdm_quat){wa * a.w + wb * b.w, wa * a.x + wb * b.x, wa * a.y + wb * b.y, wa * a.z + wb * b.z});
}

tdm_mat3 tdm_euler313_to_matrix(tdm_euler313 e) {
  double cf = cos(e.phi), sf = sin(e.phi), ct = cos(e.theta), st = sin(e.theta), cp = cos(e.psi), sp = sin(e.psi);
  /* [L18] Eq. 16; the bottom row is damaged in print */
  return (tdm_mat3){{{cp * cf - sp * ct * sf, -sp * cf - cp * ct * sf, st * sf},
                     {cp * sf + sp * ct * cf, -sp * sf + cp * ct * cf, -st * cf},
                     {sp * st, cp * st, ct}}};
}

tdm_quat tdm_euler313_to_quat(tdm_euler313 e) {
  double c = cos(0.5 * e.theta), s = sin(0.5 * e.theta);
  double sum = 0.5 * (e.phi + e.psi), difference = 0.5 * (e.phi - e.psi);
  return (tdm_quat){c * cos(sum), s * cos(difference), s * sin(difference), c * sin(sum)};
}

tdm_euler313 tdm_euler313_from_quat(tdm_quat q) {
  /* q = (c cos(sum), s cos(diff), s sin(diff), c sin(sum)) with c, s of theta/2, sum and diff half of phi +- psi */
  double c = hypot(q.w, q.z), s = hypot(q.x, q.y);
  const double singular = 1e-12;
  tdm_euler313 e = {.theta = 2 * atan2(s, c)};
  if (s <= singular * c) {
    e.phi = 2 * atan2(q.z, q.w); /* theta = 0: only phi + psi is defined */
    e.theta = 0;
  } else if (c <= singular * s) {
    e.phi = 2 * atan2(q.y, q.x); /* theta = pi: only phi - psi is defined */
    e.theta = M_PI;
  } else {
    double sum = atan2(q.z, q.w), difference = atan2(q.y, q.x);
    e.phi = sum + difference;
    e.psi = sum - difference;
  }
  e.phi = remainder(e.phi, 2 * M_PI);
  e.psi = remainder(e.psi, 2 * M_PI);
  if (e.phi <= -M_PI)
    e.phi = M_PI;
  if (e.psi <= -M_PI)
    e.psi = M_PI;
  return e;
}

tdm_euler313 tdm_euler313_from_matrix(tdm_mat3 m) {
  return tdm_euler313_from_quat(tdm_quat_from_matrix(m));
}

tdm_vec3 tdm_pose_point(tdm_pose pose, tdm_vec3 body_point) {
  return tdm_add(pose.position, tdm_quat_rotate(pose.orientation, body_point));
}

tdm_vec3 tdm_point_velocity(const tdm_state *state, tdm_vec3 world_point) {
  tdm_vec3 r = tdm_sub(world_point, state->pose.position);
  return tdm_add(state->twist.velocity, tdm_cross(state->twist.angular, r));
}

int tdm_finite(const double *values, int n) {
  for (int i = 0; i < n; i++)
    if (!isfinite(values[i]))
      return 0;
  return 1;
}

int tdm_usable(const double *values, int n) {
  for (int i = 0; i < n; i++)
    if (!(fabs(values[i]) <= 1e150))
      return 0;
  return 1;
}

int tdm_quat_is_unit(tdm_quat q) {
  return fabs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1) <= 1e-5;
}

int tdm_is_inertia(const tdm_mat3 *inertia) {
  const double(*m)[3] = inertia->m;
  double trace = m[0][0] + m[1][1] + m[2][2], a[3][3];
  if (!tdm_usable(&m[0][0], 9) || trace < 0)
    return 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      a[i][j] = trace > 0 ? m[i][j] / trace : 0;
      if (fabs(m[i][j] - m[j][i]) > 1e-9 * trace || (trace == 0 && m[i][j] != 0))
        return 0;
    }
  /* all principal minors, of numbers around 1 */
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3;
    if (a[i][i] < -1e-9 || a[i][i] * a[j][j] - a[i][j] * a[i][j] < -1e-9)
      return 0;
  }
  return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[1][2]) - a[0][1] * (a[0][1] * a[2][2] - a[1][2] * a[0][2]) +
             a[0][2] * (a[0][1] * a[1][2] - a[1][1] * a[0][2]) >=
         -1e-9;
}
