/* Paths through a window: see path.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/state/path.h"

#include "coupler/state/mismatch.h"
#include "protocol/math/hermite.h"
#include "protocol/scene/remark.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of the way that a body makes in a window at its fastest. Half a period of an oscillation along Hermite's cubic is
 * 0.07 off, one along the straight line of 0.4 rad 0.05. */
static const double far = 0.05;

/* ---- nodes ---- */

static void set_node(tdm_nodes *path, int k, double time, const tdm_state *state) {
  path->time[k] = time;
  memcpy(path->state + k * path->nbody, state, (size_t)path->nbody * sizeof *state);
}

void cpl_path_keep(cpl_loop *loop, const tdm_nodes *from) {
  loop->coming.nnode = from->nnode;
  for (int k = 0; k < from->nnode; k++)
    set_node(&loop->coming, k, from->time[k], from->state + k * loop->nbody);
}

/* ---- windows ---- */

/* DEM steps of the longest window that may follow. Where windows choose their length and few nodes were told, or none,
 * MBD is asked for more: in a short time a path that turns is near enough to a parabola for it to tell none, but not
 * for windows to grow on it. */
static uint64_t steps_ahead(const cpl_loop *loop) {
  const cpl_settings *s = loop->settings;
  enum { FEW = 4, FAR = 4 };
  if (!s->adapt.on)
    return (uint64_t)loop->n;
  const double growth = loop->coming.nnode <= FEW ? FAR : fmax(1, loop->growth);
  return (uint64_t)fmin(ceil(growth * (double)loop->n), (double)s->adapt.n_max);
}

double cpl_path_ahead(const cpl_loop *loop) {
  const cpl_settings *s = loop->settings;
  const uint64_t total = cpl_total_steps(s), left = total - loop->step1, n = steps_ahead(loop);
  if (left == 0 || !cpl_session_asks(loop->session, CPL_MBD, "ahead"))
    return 0;
  return (double)(loop->step1 + (n < left ? n : left)) * s->dt;
}

long cpl_path_reach(const cpl_loop *loop) {
  const tdm_nodes *coming = &loop->coming;
  const double t0 = (double)loop->step1 * loop->settings->dt;
  if (coming->nnode == 0)
    return LONG_MAX;
  return (long)floor((coming->time[coming->nnode - 1] - t0) / loop->settings->dt + 1e-6);
}

/* The told path ends before the window does. */
static tdm_status refuse_bends(const cpl_loop *loop, double last, tdm_error *err) {
  const double most = floor((last - loop->t0) / loop->settings->dt + 1e-6);
  char cure[64] = "a smaller time.dt", who[256] = "the coupled bodies";
  if (most >= 1)
    snprintf(cure, sizeof cure, "an n of %.0f at most", most);
  if (loop->nbody == 1)
    snprintf(who, sizeof who, "body \"%.200s\"", loop->settings->body[0].name[CPL_MBD]);
  return tdm_fail(err, TDM_ERR_NUMERIC, most < 1 ? "time.dt" : "coupling.n",
                  "what drivers prescribe for %s bends too much in the window from %.9g s to %.9g s: %d nodes follow "
                  "its path until %.9g s; take %s",
                  who, loop->t0, loop->t1, TDM_NODES_MAX, last, cure);
}

tdm_status cpl_path_open(cpl_loop *loop, tdm_error *err) {
  const tdm_nodes *from = &loop->coming;
  const double slack = 1e-6 * loop->settings->dt;
  loop->told.nnode = 0;
  if (from->nnode == 0)
    return TDM_OK;
  const double last = from->time[from->nnode - 1];
  if (last < loop->t1 - slack)
    return refuse_bends(loop, last, err);
  for (int k = 0; k < from->nnode && from->time[k] < loop->t1 - slack; k++)
    set_node(&loop->told, loop->told.nnode++, from->time[k], from->state + k * loop->nbody);
  const int end = loop->told.nnode++;
  for (int i = 0; i < loop->nbody; i++)
    loop->told.state[end * loop->nbody + i] = tdm_nodes_at(from, i, &loop->state_start[i], loop->t0, loop->t1);
  loop->told.time[end] = loop->t1;
  return TDM_OK;
}

/* ---- through two states ---- */

/* Value and rate, by t, at the share s of the cubic over h between two ways with their rates. */
static tdm_vec3 between(double s, double h, const tdm_vec3 *a, const tdm_vec3 *b, tdm_vec3 *rate) {
  const tdm_hermite_weights v = tdm_hermite_at(s, h), d = tdm_hermite_rate_at(s, h);
  tdm_vec3 way = tdm_axpy(1 - v.f1, a[0], tdm_scale(v.f1, b[0]));
  way = tdm_axpy(v.d0, a[1], tdm_axpy(v.d1, b[1], way));
  *rate = tdm_axpy(d.f0, a[0], tdm_scale(d.f1, b[0]));
  *rate = tdm_axpy(d.d0, a[1], tdm_axpy(d.d1, b[1], *rate));
  return way;
}

/* What a state is away from another: way, turn (world axes), and their rates. */
typedef struct {
  tdm_vec3 way[2], turn[2];
} apart;

static apart apart_of(const tdm_state *a, const tdm_state *b) {
  return (apart){
      {tdm_sub(a->pose.position, b->pose.position), tdm_sub(a->twist.velocity, b->twist.velocity)},
      {tdm_quat_turn(b->pose.orientation, a->pose.orientation), tdm_sub(a->twist.angular, b->twist.angular)}};
}

tdm_nodes cpl_path_through(const cpl_loop *loop, const tdm_state *start, const tdm_state *end) {
  const double h = loop->t1 - loop->t0;
  const int last = loop->told.nnode - 1;
  tdm_nodes made = loop->made;
  made.nnode = loop->told.nnode;
  for (int k = 0; k < last; k++) {
    const double s = (loop->told.time[k] - loop->t0) / h;
    set_node(&made, k, loop->told.time[k], loop->told.state + k * loop->nbody);
    for (int i = 0; i < loop->nbody; i++) {
      const apart a = apart_of(&start[i], &loop->state_start[i]);
      const apart b = apart_of(&end[i], &loop->told.state[last * loop->nbody + i]);
      tdm_state *node = made.state + k * loop->nbody + i;
      tdm_vec3 rate;
      node->pose.position = tdm_add(node->pose.position, between(s, h, a.way, b.way, &rate));
      node->twist.velocity = tdm_add(node->twist.velocity, rate);
      node->pose.orientation = tdm_quat_turned(node->pose.orientation, between(s, h, a.turn, b.turn, &rate));
      node->twist.angular = tdm_add(node->twist.angular, rate);
    }
  }
  if (last >= 0)
    set_node(&made, last, loop->told.time[last], end);
  return made;
}

tdm_state cpl_predict(const tdm_state *state, const double *acceleration, double h) {
  tdm_vec3 a = {acceleration[0], acceleration[1], acceleration[2]};
  tdm_vec3 alpha = {acceleration[3], acceleration[4], acceleration[5]};
  const tdm_twist *twist = &state->twist;
  tdm_vec3 moved = tdm_axpy(0.5 * h * h, a, tdm_scale(h, twist->velocity));
  tdm_vec3 turned = tdm_axpy(0.5 * h * h, alpha, tdm_scale(h, twist->angular));
  tdm_state next;
  next.pose.position = tdm_add(state->pose.position, moved);
  next.pose.orientation = tdm_quat_turned(state->pose.orientation, turned);
  next.twist.velocity = tdm_axpy(h, a, twist->velocity);
  next.twist.angular = tdm_axpy(h, alpha, twist->angular);
  return next;
}

/* ---- what DEM cannot follow ---- */

/* How far two poses are apart; turns count at the radius [m]. */
static double distance(const tdm_pose *a, const tdm_pose *b, double radius) {
  tdm_vec3 turn = tdm_quat_turn(b->orientation, a->orientation);
  return hypot(tdm_norm(tdm_sub(a->position, b->position)), radius * tdm_norm(turn));
}

/* Where DEM has body i at the share s of the window without nodes. */
static tdm_pose without_nodes(const cpl_loop *loop, int i, const tdm_state *start, const tdm_state *end, double s) {
  const double h = loop->t1 - loop->t0;
  if (!start)
    return cpl_predict(&loop->state_start[i], loop->proxy.acceleration + 6 * i, s * h).pose;
  tdm_pose pose = tdm_state_between(&start[i], &end[i], h, s).pose;
  if (cpl_session_interpolation(loop->session) == TDM_LINEAR)
    pose.position = tdm_axpy(s, tdm_sub(end[i].pose.position, start[i].pose.position), start[i].pose.position);
  return pose;
}

tdm_status cpl_path_check(cpl_loop *loop, const tdm_state *start, const tdm_state *end, tdm_error *err) {
  const tdm_nodes path = start ? cpl_path_through(loop, start, end) : loop->told;
  for (int i = 0; i < loop->nbody; i++) {
    const tdm_pose *from = start ? &start[i].pose : &loop->state_start[i].pose;
    double motion = (loop->t1 - loop->t0) * loop->speed[i], off = 0; /* at its fastest so far: it may turn back here */
    for (int k = 0; k < path.nnode; k++) {
      const double s = (path.time[k] - loop->t0) / (loop->t1 - loop->t0);
      const tdm_pose *node = &path.state[k * loop->nbody + i].pose, there = without_nodes(loop, i, start, end, s);
      motion = fmax(motion, distance(node, from, loop->radius[i]));
      off = fmax(off, distance(node, &there, loop->radius[i]));
    }
    if (off > far * motion)
      return tdm_fail(err, TDM_ERR_NUMERIC, "coupling.n",
                      "what drivers prescribe for body \"%.200s\" bends by %.3g of its way in the window from %.9g s "
                      "to %.9g s, and %s cannot follow it: it lacks the capability \"path\"; take a smaller n",
                      loop->settings->body[i].name[CPL_MBD], off / motion, loop->t0, loop->t1,
                      cpl_session_name(loop->session, CPL_DEM));
  }
  return TDM_OK;
}

/* How far DEM was from MBD's body i at the end of the window, where it told, or else at output times, as a share of the
 * way that the body makes at its fastest and of what is allowed there. */
static double excess(const cpl_loop *loop, int i) {
  const double way = cpl_motion(loop, i), at_end = 0.1, inside = 0.2;
  const double least = 1e-7 / at_end; /* [m] */
  double off = 0;
  if (loop->scheme->mismatch_order > 0)
    return distance(&loop->state_end[i].pose, &loop->dem_end[i].pose, loop->radius[i]) / (at_end * (way + least));
  for (int k = 0; k < loop->nsample; k++) {
    const double s = (loop->sample_time[k] - loop->t0) / (loop->t1 - loop->t0);
    const tdm_pose there = without_nodes(loop, i, loop->sent_start, loop->sent_end, s);
    off = fmax(off, distance(&loop->result[CPL_MBD].sample_state[k * loop->nbody + i].pose, &there, loop->radius[i]));
  }
  return off / (inside * (way + least));
}

void cpl_path_doubt(const cpl_loop *loop) {
  for (int i = 0; i < loop->nbody; i++)
    if (excess(loop, i) > 1) {
      tdm_remark(
          TDM_WARNING, "path_unknown", "coupling.n", loop->t0,
          "body \"%.200s\" went another way in %s than in %s in the window from %.6g s on (a load that jumped, or "
          "drivers: the solver does not tell ahead what they prescribe, by the capability \"ahead\"); take a "
          "smaller n",
          loop->settings->body[i].name[CPL_MBD], cpl_session_name(loop->session, CPL_MBD),
          cpl_session_name(loop->session, CPL_DEM), loop->t0);
      return;
    }
}

double cpl_path_turn(const cpl_loop *loop, int body) {
  const tdm_nodes *told = &loop->told;
  double most = 0;
  for (int k = 0; k < told->nnode; k++)
    most = fmax(most, tdm_norm(tdm_quat_turn(loop->state_start[body].pose.orientation,
                                             told->state[k * loop->nbody + body].pose.orientation)));
  return told->nnode > 0 && loop->takes_path ? most : NAN;
}
