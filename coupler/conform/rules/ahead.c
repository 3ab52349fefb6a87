/* Rules of the path ahead that the multibody side tells (PROTOCOL.md, section 8). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/conform/meeting.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST = 5, AHEAD = 50, LOOKS = 2 * TDM_NODES_MAX }; /* steps of the two windows; times that are looked at */
static const double close = 0.01, far = 0.05;              /* shares of the motion that it may be off */

/* What is told at the end of a first window of what comes then. */
typedef struct {
  double from, until;   /* [s] */
  tdm_state *start;     /* (nbody) */
  double *acceleration; /* (nbody x 6); NULL: not told */
  tdm_nodes path;       /* until the last node; none: not told */
} outlook;

static void outlook_free(outlook *o) {
  free(o->start);
  free(o->acceleration);
  free(o->path.time);
  free(o->path.state);
}

/* A copy of n bytes, at least one; NULL: no memory. */
static void *copy(const void *from, size_t n) {
  void *to = malloc(n + 1);
  return to && n > 0 ? memcpy(to, from, n) : to;
}

/* A window under loads that grow to those of the next one, and what is told at its end. */
static bool look_ahead(cpl_meeting *m, const tdm_wrench *load, outlook *o) {
  const size_t n = (size_t)m->settings.nbody;
  tdm_result r;
  tdm_step step = cpl_meeting_next(m, FIRST);
  tdm_wrench *ramp = calloc(2 * n + 1, sizeof *ramp); /* (nbody x 2) */
  for (size_t i = 0; ramp && i < n; i++)
    ramp[2 * i + 1] = load[i];
  step.load = ramp;
  step.nload = 2;
  step.ahead = step.t1 + AHEAD * m->settings.dt;
  const bool good = ramp && cpl_meeting_solve(m, &step, &r);
  free(ramp);
  if (!good)
    return false;
  const size_t nnode = (size_t)r.path.nnode;
  *o = (outlook){.from = step.t1, .until = nnode > 0 ? r.path.time[nnode - 1] : step.ahead, .path = r.path};
  o->start = copy(r.state, n * sizeof *o->start);
  o->acceleration = r.nacceleration > 0 ? copy(r.acceleration, 6 * n * sizeof *o->acceleration) : NULL;
  o->path.time = copy(r.path.time, nnode * sizeof *o->path.time);
  o->path.state = copy(r.path.state, nnode * n * sizeof *o->path.state);
  return o->start && o->path.time && o->path.state;
}

/* The next window, under the loads held, with samples at the nodes and between them, or at its end. */
static bool follow(cpl_meeting *m, const tdm_wrench *load, const outlook *o, double time[LOOKS], tdm_result *r) {
  tdm_step step = cpl_meeting_next(m, AHEAD);
  int n = 0;
  for (int k = 0; k < o->path.nnode; k++) {
    const double before = k > 0 ? o->path.time[k - 1] : o->from;
    time[n++] = 0.5 * (before + o->path.time[k]);
    time[n++] = fmin(o->path.time[k], step.t1);
  }
  if (n == 0)
    time[n++] = step.t1;
  step.load = load;
  step.nload = 1;
  step.nsample = n;
  step.sample_time = time;
  return cpl_meeting_solve(m, &step, r);
}

/* A prescribed body that goes on with the accelerations that are told, without a path, must be where it then is. */
static void compare_parabola(const outlook *o, int i, double t, const tdm_state *is, double speed, double spin,
                             cpl_verdict *v) {
  const double *a = o->acceleration + 6 * (size_t)i, h = t - o->from;
  const tdm_state *start = &o->start[i];
  const tdm_vec3 way = tdm_axpy(0.5 * h, tdm_v3(a[0], a[1], a[2]), start->twist.velocity);
  const tdm_vec3 turn = tdm_axpy(0.5 * h, tdm_v3(a[3], a[4], a[5]), start->twist.angular);
  const tdm_quat due = tdm_quat_turned(start->pose.orientation, tdm_scale(h, turn));
  const double off = tdm_norm(tdm_sub(tdm_axpy(h, way, start->pose.position), is->pose.position));
  const double turned = tdm_norm(tdm_quat_turn(due, is->pose.orientation));
  if (off > far * h * speed + 1e-9 || turned > far * h * spin + 1e-9)
    cpl_broken(v, "a path ahead where accelerations do not tell it", "none; body %d is %g m and %g rad off after %g s",
               i, off, turned, h);
}

/* What was told of body i against what came of it. */
static void compare(const cpl_meeting *m, const outlook *o, int i, const double *time, const tdm_result *r,
                    cpl_verdict *v) {
  static const char expected[] = "the path ahead to be the one that it then takes, at its nodes and between them";
  const double h = o->until - o->from;
  double speed = 0, spin = 0; /* the most on the way */
  for (int j = 0; j < r->nsample; j++) {
    speed = fmax(speed, tdm_norm(r->sample_state[j * r->nbody + i].twist.velocity));
    spin = fmax(spin, tdm_norm(r->sample_state[j * r->nbody + i].twist.angular));
  }
  for (int j = 0; j < r->nsample; j++) {
    const tdm_state is = r->sample_state[j * r->nbody + i];
    if (o->path.nnode == 0) {
      if (o->acceleration && m->session.prescribed && m->session.prescribed[i])
        compare_parabola(o, i, time[j], &is, speed, spin, v);
      continue;
    }
    const tdm_state told = tdm_nodes_at(&o->path, i, &o->start[i], o->from, time[j]);
    const double way = tdm_norm(tdm_sub(told.pose.position, is.pose.position));
    const double turn = tdm_norm(tdm_quat_turn(told.pose.orientation, is.pose.orientation));
    const double velocity = tdm_norm(tdm_sub(told.twist.velocity, is.twist.velocity));
    const double angular = tdm_norm(tdm_sub(told.twist.angular, is.twist.angular));
    if (way > close * h * speed + 1e-9 || turn > close * h * spin + 1e-9)
      cpl_broken(v, expected, "at %g s body %d is %g m and %g rad off", time[j], i, way, turn);
    if (velocity > close * speed + 1e-6 || angular > close * spin + 1e-6)
      cpl_broken(v, expected, "at %g s body %d is %g m/s and %g rad/s off", time[j], i, velocity, angular);
  }
}

static void test_ahead(cpl_candidate *c, cpl_verdict *v) {
  double time[LOOKS];
  outlook o = {0};
  cpl_meeting m;
  tdm_result r;
  if (!cpl_meeting_open(&m, c, v))
    return;
  const int n = m.settings.nbody;
  tdm_wrench *load = calloc((size_t)n + 1, sizeof *load);
  for (int i = 0; load && i < n; i++) {
    const double mass = isfinite(m.session.body[i].mass) ? m.session.body[i].mass : 0;
    load[i].force = tdm_v3(mass, mass, mass);
  }
  if (load && look_ahead(&m, load, &o) && follow(&m, load, &o, time, &r)) {
    for (int i = 0; i < n; i++)
      compare(&m, &o, i, time, &r, v);
    if (o.path.nnode == 0)
      cpl_not_seen(v, "the accelerations tell the path of this scene, so none is told");
  }
  outlook_free(&o);
  free(load);
  cpl_meeting_drop(&m);
}

/* ---- what loads do not move ---- */

/* Where bodies are after a window of 20 steps under forces and moments that accelerate a free body at `size` [m/s2,
 * rad/s2]: (nbody), the caller's to free; NULL: not seen, or broken. *h is the window's length. */
static tdm_state *push(cpl_candidate *c, cpl_verdict *v, double size, bool **prescribed, int *n, double *h) {
  cpl_meeting m;
  tdm_result r;
  if (!cpl_meeting_open(&m, c, v))
    return NULL;
  tdm_step step = cpl_meeting_next(&m, 20);
  tdm_wrench *load = calloc((size_t)step.nbody + 1, sizeof *load);
  for (int i = 0; load && i < step.nbody; i++) {
    const tdm_assigned_body *b = &m.session.body[i];
    const double mass = isfinite(b->mass) ? b->mass : 1, inertia = isfinite(b->mass) ? b->inertia.m[0][0] : 1;
    load[i].force = tdm_scale(size * mass, tdm_v3(1, 1, 1));
    load[i].moment = tdm_scale(size * inertia, tdm_v3(1, 1, 1));
  }
  step.load = load;
  step.nload = 1;
  *n = step.nbody;
  *h = step.t1 - step.t0;
  free(*prescribed);
  *prescribed = m.session.prescribed ? copy(m.session.prescribed, (size_t)*n * sizeof **prescribed) : NULL;
  tdm_state *end = load && cpl_meeting_solve(&m, &step, &r) ? copy(r.state, (size_t)*n * sizeof *end) : NULL;
  free(load);
  cpl_meeting_drop(&m);
  return end;
}

static void test_prescribed(cpl_candidate *c, cpl_verdict *v) {
  const double size = 10;
  bool *prescribed = NULL, seen = false;
  double h = 0;
  int n = 0;
  tdm_state *left = push(c, v, 0, &prescribed, &n, &h), *pushed = left ? push(c, v, size, &prescribed, &n, &h) : NULL;
  for (int i = 0; pushed && prescribed && i < n; i++) {
    if (!prescribed[i])
      continue;
    seen = true;
    const double way = tdm_norm(tdm_sub(pushed[i].pose.position, left[i].pose.position));
    const double turn = tdm_norm(tdm_quat_turn(left[i].pose.orientation, pushed[i].pose.orientation));
    if (fmax(way, turn) > 1e-3 * 0.5 * size * h * h + 1e-12)
      cpl_broken(v, "no load to move a body that is called prescribed", "a load moves body %d by %g m and %g rad", i,
                 way, turn);
  }
  if (pushed && !seen)
    cpl_not_seen(v, "it calls no coupled body of this scene prescribed");
  free(left);
  free(pushed);
  free(prescribed);
}

const cpl_rule cpl_rules_ahead[] = {{.name = "ahead",
                                     .section = "8",
                                     .roles = CPL_OF_MBD,
                                     .capability = "ahead",
                                     .text = "the path ahead is the one that it takes",
                                     .test = test_ahead},
                                    {.name = "ahead.prescribed",
                                     .section = "8",
                                     .roles = CPL_OF_MBD,
                                     .capability = "ahead",
                                     .text = "loads leave alone what is called prescribed",
                                     .test = test_prescribed},
                                    {.name = NULL}};
