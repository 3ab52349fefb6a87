/* Paths: see nodes.h. */
/* SPDX-License-Identifier: MIT */
#include "protocol/wire/nodes.h"

#include "protocol/math/hermite.h"

/* x of the cubic with values 0 and x1 and rates r0, r1 (by s) at the ends, and its rate by s */
static tdm_vec3 cubic(double s, tdm_vec3 x1, tdm_vec3 r0, tdm_vec3 r1, tdm_vec3 *rate) {
  const tdm_hermite_weights v = tdm_hermite_at(s, 1), d = tdm_hermite_rate_at(s, 1);
  *rate = tdm_axpy(d.f1, x1, tdm_axpy(d.d0, r0, tdm_scale(d.d1, r1)));
  return tdm_axpy(v.f1, x1, tdm_axpy(v.d0, r0, tdm_scale(v.d1, r1)));
}

/* D(phi) x */
static tdm_vec3 spread(tdm_vec3 phi, tdm_vec3 x) {
  const double a2 = tdm_dot(phi, phi), a = sqrt(a2);
  /* the quotients by their series where they lose digits */
  const double one = a > 1e-2 ? (1 - cos(a)) / a2 : 0.5 - a2 / 24 + a2 * a2 / 720;
  const double two = a > 1e-2 ? (a - sin(a)) / (a2 * a) : 1.0 / 6 - a2 / 120 + a2 * a2 / 5040;
  tdm_vec3 across = tdm_cross(phi, x);
  return tdm_axpy(two, tdm_cross(phi, across), tdm_axpy(one, across, x));
}

/* D(phi)^-1 x */
static tdm_vec3 gather(tdm_vec3 phi, tdm_vec3 x) {
  const double a2 = tdm_dot(phi, phi), a = sqrt(a2);
  const double two = a > 1e-2 ? (1 - 0.5 * a * sin(a) / (1 - cos(a))) / a2 : 1.0 / 12 + a2 / 720 + a2 * a2 / 30240;
  tdm_vec3 across = tdm_cross(phi, x);
  return tdm_axpy(two, tdm_cross(phi, across), tdm_axpy(-0.5, across, x));
}

tdm_state tdm_state_between(const tdm_state *a, const tdm_state *b, double h, double s) {
  if (s <= 0)
    return *a;
  if (s >= 1)
    return *b;
  tdm_state at;
  tdm_vec3 way = tdm_sub(b->pose.position, a->pose.position), rate;
  way = cubic(s, way, tdm_scale(h, a->twist.velocity), tdm_scale(h, b->twist.velocity), &rate);
  at.pose.position = tdm_add(a->pose.position, way);
  at.twist.velocity = tdm_scale(1 / h, rate);
  const tdm_vec3 turn = tdm_quat_turn(a->pose.orientation, b->pose.orientation);
  const tdm_vec3 last = tdm_scale(h, gather(turn, b->twist.angular));
  const tdm_vec3 turned = cubic(s, turn, tdm_scale(h, a->twist.angular), last, &rate);
  /* a body that does not turn keeps its orientation to the bit */
  at.pose.orientation =
      tdm_dot(turned, turned) > 0 ? tdm_quat_turned(a->pose.orientation, turned) : a->pose.orientation;
  at.twist.angular = tdm_scale(1 / h, spread(turned, rate));
  return at;
}

tdm_state tdm_nodes_at(const tdm_nodes *path, int body, const tdm_state *start, double t0, double t) {
  int low = 0, high = path->nnode - 1; /* the first node that is not before t, or the last */
  while (low < high) {
    const int middle = (low + high) / 2;
    if (path->time[middle] < t)
      low = middle + 1;
    else
      high = middle;
  }
  const tdm_state *to = &path->state[low * path->nbody + body];
  const tdm_state *from = low > 0 ? to - path->nbody : start;
  const double begin = low > 0 ? path->time[low - 1] : t0, h = path->time[low] - begin;
  return tdm_state_between(from, to, h, (t - begin) / h);
}
