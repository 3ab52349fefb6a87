/* The path of a body inside a window: see path.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/bodies/path.h"

#include "protocol/math/hermite.h"

dem_path dem_path_make(const tdm_state *start, const tdm_state *end, double duration, tdm_interpolation interpolation) {
  dem_path m = {.interpolation = interpolation, .duration = duration, .start = *start, .end = *end};
  tdm_quat q0 = start->pose.orientation;
  m.turn = tdm_quat_to_rotvec(tdm_quat_mul(tdm_quat_conj(q0), end->pose.orientation));
  m.angular = tdm_scale(1 / duration, tdm_quat_rotate(q0, m.turn));
  return m;
}

dem_path dem_path_through(const tdm_step *step, int body) {
  return (dem_path){.duration = step->t1 - step->t0,
                    .start = step->start[body],
                    .end = step->end[body],
                    .path = step->path,
                    .body = body,
                    .t0 = step->t0};
}

static tdm_state through_nodes(const dem_path *m, double s) {
  return tdm_nodes_at(&m->path, m->body, &m->start, m->t0, m->t0 + s * m->duration);
}

tdm_pose dem_path_pose(const dem_path *m, double s) {
  if (s <= 0)
    return m->start.pose;
  if (s >= 1)
    return m->end.pose;
  if (m->path.nnode > 0)
    return through_nodes(m, s).pose;
  tdm_vec3 x0 = m->start.pose.position, x1 = m->end.pose.position, x;
  if (m->interpolation == TDM_LINEAR) {
    x = tdm_axpy(s, tdm_sub(x1, x0), x0);
  } else {
    /* from x0 on: at rest exactly x0 */
    const tdm_hermite_weights h = tdm_hermite_at(s, 1);
    x = tdm_axpy(h.f1, tdm_sub(x1, x0), x0);
    x = tdm_axpy(m->duration * h.d0, m->start.twist.velocity, x);
    x = tdm_axpy(m->duration * h.d1, m->end.twist.velocity, x);
  }
  tdm_quat q = m->start.pose.orientation;
  if (tdm_dot(m->turn, m->turn) > 0) /* else exactly the start's */
    q = tdm_quat_slerp(q, m->end.pose.orientation, s);
  return (tdm_pose){x, q};
}

tdm_twist dem_path_twist(const dem_path *m, double s) {
  if (m->path.nnode > 0)
    return through_nodes(m, s).twist;
  tdm_vec3 mean = tdm_scale(1 / m->duration, tdm_sub(m->end.pose.position, m->start.pose.position));
  tdm_vec3 v = mean;
  if (m->interpolation == TDM_HERMITE) {
    const tdm_hermite_weights h = tdm_hermite_rate_at(s, 1);
    v = tdm_scale(h.f1, mean);
    v = tdm_axpy(h.d0, m->start.twist.velocity, v);
    v = tdm_axpy(h.d1, m->end.twist.velocity, v);
  }
  return (tdm_twist){v, m->angular};
}

tdm_twist dem_path_felt(const dem_path *m, double s) {
  return m->sent ? m->end.twist : dem_path_twist(m, s);
}
