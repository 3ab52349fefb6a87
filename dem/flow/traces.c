/* Paths of chosen particles: see traces.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/flow/traces.h"

#include "dem/seam/homes.h"

#include <math.h>
#include <stdlib.h>

void dem_traces_made(dem_data *d, int s, uint64_t k) {
  const dem_model *m = d->model;
  for (int p = 0; p < m->ntrace; p++)
    if (m->trace[p].source == s && m->trace[p].particle == k)
      d->state.traced[p] = d->state.ledger.created; /* 1 + its id */
}

/* the place of a home particle in the arrays, -1: it is not there; ids ascend unless there are several chunks */
static int find(const dem_data *d, uint64_t id) {
  for (int i = dem_home_first_particle(d); i < dem_home_end_particle(d); i++)
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

static dem_relative trace_at(const dem_data *d, const dem_trace *trace, int i) {
  if (trace->body < 0)
    return (dem_relative){d->state.sphere[i].position, d->state.pace[i].velocity};
  return dem_relative_to(&d->state.pose[trace->body], &d->state.twist[trace->body], d->state.sphere[i].position,
                         d->state.pace[i].velocity);
}

dem_relative dem_trace_now(const dem_data *d, int k) {
  const dem_trace *trace = &d->model->trace[k];
  const uint64_t known = trace->source >= 0 ? d->state.traced[k] : trace->particle + 1;
  const int i = known > 0 ? find(d, known - 1) : -1;
  const tdm_vec3 none = {NAN, NAN, NAN};
  dem_relative now = i < 0 ? (dem_relative){none, none} : trace_at(d, trace, i);
  if (dem_alone(d))
    return now;
  int n;
  dem_relative *found = dem_homes_join(d, &now, i < 0 ? 0 : 1, sizeof now, &n); /* by the rank whose it is */
  now = n > 0 ? found[0] : now;
  free(found);
  return now;
}
