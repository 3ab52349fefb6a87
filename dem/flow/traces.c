/* Paths of chosen particles: see traces.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/flow/traces.h"

#include <math.h>

void dem_traces_made(dem_data *d, int s, uint64_t k) {
  const dem_model *m = d->model;
  for (int p = 0; p < m->ntrace; p++)
    if (m->trace[p].source == s && m->trace[p].particle == k)
      d->state.traced[p] = d->state.ledger.created; /* 1 + its id */
}

/* the place of a particle in the arrays, -1: it is not there; ids ascend unless there are several chunks */
static int find(const dem_data *d, uint64_t id) {
  for (int i = 0; i < d->state.nparticle; i++)
    if (d->state.id[i] == id)
      return i;
  return -1;
}

dem_relative dem_relative_to(const tdm_pose *pose, const tdm_twist *twist, tdm_vec3 position, tdm_vec3 velocity) {
  const tdm_quat to_body = tdm_quat_conj(pose->orientation);
  const tdm_vec3 from = tdm_sub(position, pose->position), carried = tdm_cross(twist->angular, from);
  return (dem_relative){tdm_quat_rotate(to_body, from),
                        tdm_quat_rotate(to_body, tdm_sub(tdm_sub(velocity, twist->velocity), carried))};
}

dem_relative dem_trace_now(const dem_data *d, int k) {
  const dem_trace *trace = &d->model->trace[k];
  const uint64_t known = trace->source >= 0 ? d->state.traced[k] : trace->particle + 1;
  const int i = known > 0 ? find(d, known - 1) : -1;
  const tdm_vec3 none = {NAN, NAN, NAN};
  if (i < 0)
    return (dem_relative){none, none};
  if (trace->body < 0)
    return (dem_relative){d->state.sphere[i].position, d->state.pace[i].velocity};
  return dem_relative_to(&d->state.pose[trace->body], &d->state.twist[trace->body], d->state.sphere[i].position,
                         d->state.pace[i].velocity);
}
