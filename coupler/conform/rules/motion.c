/* Coupled bodies on known ways: see motion.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/conform/rules/motion.h"

#include <stdlib.h>

const double cpl_slow = 0.01;
const char cpl_nothing_touches[] = "nothing touches a coupled body in this scene";

bool cpl_motion_make(cpl_motion *g, const cpl_meeting *m) {
  *g = (cpl_motion){.start = cpl_meeting_rest(m), .end = cpl_meeting_rest(m)};
  return g->start && g->end;
}

void cpl_motion_free(cpl_motion *g) {
  free(g->start);
  free(g->end);
}

bool cpl_motion_begin(cpl_motion *g, cpl_meeting *m, cpl_candidate *c, cpl_verdict *v) {
  *g = (cpl_motion){0};
  if (!cpl_meeting_open(m, c, v))
    return false;
  if (cpl_motion_make(g, m))
    return true;
  cpl_motion_end(g, m);
  return false;
}

void cpl_motion_end(cpl_motion *g, cpl_meeting *m) {
  cpl_motion_free(g);
  cpl_meeting_drop(m);
}

bool cpl_motion_solve(cpl_meeting *m, const cpl_motion *g, tdm_step *step, tdm_result *r) {
  step->nstate = step->nbody;
  step->start = g->start;
  step->end = g->end;
  return cpl_meeting_solve(m, step, r);
}

bool cpl_motion_go(cpl_meeting *m, cpl_motion *g, tdm_vec3 velocity, long n, tdm_result *r) {
  tdm_step step = cpl_meeting_next(m, n);
  return cpl_motion_go_apart(m, g, velocity, tdm_v3(0, 0, 0), &step, r);
}

bool cpl_motion_go_apart(cpl_meeting *m, cpl_motion *g, tdm_vec3 velocity, tdm_vec3 more, tdm_step *step,
                         tdm_result *r) {
  for (int i = 0; i < step->nbody; i++) {
    const tdm_vec3 own = tdm_axpy(i, more, velocity);
    g->start[i] = g->end[i];
    g->start[i].twist.velocity = g->end[i].twist.velocity = own;
    g->end[i].pose.position = tdm_axpy(step->t1 - step->t0, own, g->start[i].pose.position);
  }
  return cpl_motion_solve(m, g, step, r);
}
