/* Rules of the DEM side: the way on which a body is sent through a window. What touches what is the scene's. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/conform/rules/motion.h"

#include <math.h>
#include <stdlib.h>

/* The path from start to end is Hermite's, if ASSIGN says so: it also depends on the velocities there. */
static void test_hermite(cpl_candidate *c, cpl_verdict *v) {
  tdm_vec3 load[2];
  for (int bent = 0; bent < 2; bent++) {
    cpl_meeting m;
    cpl_motion g;
    tdm_result r;
    if (!cpl_motion_begin(&g, &m, c, v))
      return;
    tdm_step step = cpl_meeting_next(&m, 20);
    for (int i = 0; i < step.nbody && bent; i++) {
      g.start[i].twist.velocity = tdm_v3(0, 0, 10 * cpl_slow);
      g.end[i].twist.velocity = tdm_v3(0, 0, -10 * cpl_slow);
    }
    const bool linear = cpl_session_interpolation(&m.session) == TDM_LINEAR;
    const bool good = step.nbody > 0 && cpl_motion_solve(&m, &g, &step, &r);
    load[bent] = good ? r.load[0].force : tdm_v3(0, 0, 0);
    cpl_motion_end(&g, &m);
    if (linear)
      cpl_not_seen(v, "the scene asks for straight paths");
    if (!good || linear)
      return;
  }
  const double size = fmax(tdm_norm(load[0]), tdm_norm(load[1]));
  if (size == 0)
    cpl_not_seen(v, cpl_nothing_touches);
  else if (tdm_norm(tdm_sub(load[0], load[1])) < 1e-9 * size)
    cpl_broken(v, "Hermite's path, which goes out and back when the velocities at its ends do",
               "the load of a body at rest, %g N", size);
}

/* ---- paths ---- */

typedef enum { BY_ENDS, BY_NODES, BENT } way;

/* The mean loads of one window of 10 steps on the way of `go`, told by its ends or by nodes; or on one that goes the
 * other way first and comes to the same end. */
static bool along(cpl_candidate *c, cpl_verdict *v, way how, tdm_wrench *load, int n) {
  cpl_meeting m;
  cpl_motion g;
  tdm_result r;
  const tdm_vec3 velocity = {0, 0, -cpl_slow};
  if (!cpl_motion_begin(&g, &m, c, v))
    return false;
  tdm_step step = cpl_meeting_next(&m, 10);
  const size_t k = (size_t)step.nbody;
  tdm_state *state = calloc(2 * k + 1, sizeof *state);
  double time[2] = {0.4 * step.t1, step.t1};
  for (size_t i = 0; state && i < k; i++) {
    g.start[i].twist.velocity = velocity;
    g.end[i] = g.start[i];
    for (int j = 0; j < 2; j++) {
      const double sign = how == BENT && j == 0 ? -1 : 1;
      state[(size_t)j * k + i] = g.start[i];
      state[(size_t)j * k + i].pose.position = tdm_axpy(sign * time[j], velocity, g.start[i].pose.position);
    }
    g.end[i] = state[k + i];
  }
  if (how != BY_ENDS)
    step.path = (tdm_nodes){.nnode = 2, .nbody = step.nbody, .time = time, .state = state};
  const bool good = state && cpl_motion_solve(&m, &g, &step, &r);
  for (int i = 0; good && i < n; i++)
    load[i] = i < r.nbody ? r.load[i] : (tdm_wrench){0};
  free(state);
  cpl_motion_end(&g, &m);
  return good;
}

enum { SEEN = 4 }; /* bodies that are looked at */

static void test_path(cpl_candidate *c, cpl_verdict *v) {
  tdm_wrench by_ends[SEEN], by_nodes[SEEN], bent[SEEN];
  double largest = 0, change = 0;
  if (!along(c, v, BY_ENDS, by_ends, SEEN) || !along(c, v, BY_NODES, by_nodes, SEEN) || !along(c, v, BENT, bent, SEEN))
    return;
  for (int i = 0; i < SEEN; i++) {
    const double size = tdm_norm(by_ends[i].force), off = tdm_norm(tdm_sub(by_nodes[i].force, by_ends[i].force));
    largest = fmax(largest, size);
    change = fmax(change, tdm_norm(tdm_sub(bent[i].force, by_ends[i].force)));
    if (off > 1e-6 * size)
      cpl_broken(v, "the same load on a straight way with nodes and without", "body %d: %g N apart, of %g N", i, off,
                 size);
  }
  if (largest == 0)
    cpl_not_seen(v, cpl_nothing_touches);
  else if (change < 1e-9 * largest)
    cpl_broken(v, "another load where nodes lead another way to the same end", "the same: %g N", largest);
}

/* ---- turns between nodes ---- */

typedef enum { BY_ONE_NODE, BY_ALL_NODES, OTHERWISE } telling;

/* The mean loads of one window of 10 steps in which bodies turn, about the load on them, while another turn comes up:
 * told by a node at its end, or by one at each step; or on the way that it would be if the rates of rotation vectors
 * were angular velocities. */
static bool turn(cpl_candidate *c, cpl_verdict *v, telling how, tdm_wrench *load, int n) {
  enum { STEPS = 10 };
  const double angle = 5e-3, comes_up = 4e-3; /* [rad] */
  cpl_meeting m;
  cpl_motion g;
  tdm_result r;
  if (!cpl_motion_begin(&g, &m, c, v))
    return false;
  tdm_step step = cpl_meeting_next(&m, STEPS);
  const int k = step.nbody, nnode = how == BY_ONE_NODE ? 1 : STEPS;
  const double h = step.t1 - step.t0;
  tdm_state *state = calloc((size_t)(nnode * k) + 1, sizeof *state);
  double time[STEPS];
  for (int j = 0; j < nnode; j++)
    time[j] = step.t0 + (j + 1) * h / nnode;
  for (int i = 0; state && i < k; i++) {
    const tdm_vec3 force = m.session.load[i].force, axis = tdm_norm(force) > 0 ? tdm_unit(force) : tdm_v3(0, 0, 1);
    const tdm_vec3 phi = tdm_scale(angle, axis), across = fabs(axis.x) < 0.9 ? tdm_v3(1, 0, 0) : tdm_v3(0, 1, 0);
    tdm_vec3 w = tdm_scale(comes_up / h, tdm_unit(tdm_cross(axis, across)));
    if (how == OTHERWISE)
      w = tdm_axpy(0.5, tdm_cross(phi, w), w);
    g.end[i].pose.orientation = tdm_quat_turned(g.start[i].pose.orientation, phi);
    g.end[i].twist.angular = w;
    for (int j = 0; j < nnode; j++)
      state[j * k + i] = tdm_state_between(&g.start[i], &g.end[i], h, (j + 1.0) / nnode);
  }
  step.path = (tdm_nodes){.nnode = nnode, .nbody = k, .time = time, .state = state};
  const bool good = state && cpl_motion_solve(&m, &g, &step, &r);
  for (int i = 0; good && i < n; i++)
    load[i] = i < r.nbody ? r.load[i] : (tdm_wrench){0};
  free(state);
  cpl_motion_end(&g, &m);
  return good;
}

static void test_turns(cpl_candidate *c, cpl_verdict *v) {
  tdm_wrench one[SEEN], all[SEEN], other[SEEN];
  bool seen = false;
  if (!turn(c, v, BY_ONE_NODE, one, SEEN) || !turn(c, v, BY_ALL_NODES, all, SEEN) ||
      !turn(c, v, OTHERWISE, other, SEEN))
    return;
  for (int i = 0; i < SEEN; i++) {
    const double change = tdm_norm(tdm_sub(other[i].force, all[i].force));
    const double off = tdm_norm(tdm_sub(one[i].force, all[i].force));
    if (change <= 1e-6 * tdm_norm(all[i].force))
      continue;
    seen = true;
    if (off > 0.1 * change)
      cpl_broken(v,
                 "rotation vectors by Hermite's polynomial, with the rates that make the angular velocities of nodes",
                 "body %d: %g N, with nodes at each step of the same way %g N; with angular velocities as rates %g N",
                 i, tdm_norm(one[i].force), tdm_norm(all[i].force), tdm_norm(other[i].force));
  }
  if (!seen)
    cpl_not_seen(v, "no contact of a coupled body feels how it turns in this scene");
}

/* ---- velocities ---- */

/* The loads after one step to the same place, where bodies have the velocity that contacts feel: by Hermite's path,
 * or as it is sent. */
static bool feel(cpl_candidate *c, cpl_verdict *v, bool sent, tdm_vec3 velocity, tdm_wrench *load, int n) {
  cpl_meeting m;
  cpl_motion g = {0};
  tdm_result r;
  if (!cpl_meeting_meet(&m, c, 0, v))
    return false;
  if (sent) {
    m.scheme.needs[CPL_DEM] = CPL_SENT_VELOCITY;
    m.scheme.interpolation = TDM_LINEAR;
  }
  if (!cpl_meeting_assign(&m))
    return false;
  if (!sent && cpl_session_interpolation(&m.session) == TDM_LINEAR)
    cpl_not_seen(v, "the scene asks for straight paths");
  tdm_step step = cpl_meeting_next(&m, 1);
  bool good = cpl_motion_make(&g, &m) && v->kind == CPL_KEPT;
  for (int i = 0; good && i < step.nbody; i++)
    g.end[i].twist.velocity = velocity;
  good = good && cpl_motion_solve(&m, &g, &step, &r);
  for (int i = 0; good && i < n; i++)
    load[i] = i < r.nbody ? r.load[i] : (tdm_wrench){0};
  cpl_motion_end(&g, &m);
  return good;
}

static void test_sent_velocity(cpl_candidate *c, cpl_verdict *v) {
  tdm_wrench still[SEEN], by_path[SEEN], sent[SEEN];
  const tdm_vec3 none = {0, 0, 0}, velocity = {cpl_slow, 0, -10 * cpl_slow};
  if (!feel(c, v, false, none, still, SEEN) || !feel(c, v, false, velocity, by_path, SEEN) ||
      !feel(c, v, true, velocity, sent, SEEN))
    return;
  bool seen = false;
  for (int i = 0; i < SEEN; i++) {
    const double change = tdm_norm(tdm_sub(by_path[i].force, still[i].force));
    if (change <= 1e-6 * tdm_norm(still[i].force))
      continue;
    seen = true;
    if (tdm_norm(tdm_sub(sent[i].force, by_path[i].force)) > 0.01 * change)
      cpl_broken(v, "contacts that feel the velocity that is sent",
                 "body %d: %g N, with the same velocity by the path %g N, at rest %g N", i, tdm_norm(sent[i].force),
                 tdm_norm(by_path[i].force), tdm_norm(still[i].force));
  }
  if (!seen)
    cpl_not_seen(v, "no contact of a coupled body feels its velocity in this scene");
}

const cpl_rule cpl_rules_path[] = {{.name = "load.path",
                                    .section = "4",
                                    .roles = CPL_OF_DEM,
                                    .text = "the path within a window goes by ends and velocities",
                                    .test = test_hermite},
                                   {.name = "path",
                                    .section = "8",
                                    .roles = CPL_OF_DEM,
                                    .capability = "path",
                                    .text = "nodes tell the path within a window",
                                    .test = test_path},
                                   {.name = "path.turns",
                                    .section = "8",
                                    .roles = CPL_OF_DEM,
                                    .capability = "path",
                                    .text = "between nodes bodies turn by their angular velocities",
                                    .test = test_turns},
                                   {.name = "sent_velocity",
                                    .section = "8",
                                    .roles = CPL_OF_DEM,
                                    .capability = "sent_velocity",
                                    .text = "contacts may feel the velocity that is sent",
                                    .test = test_sent_velocity},
                                   {.name = NULL}};
