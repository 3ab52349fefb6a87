/* Rules of the DEM side: a known motion gives a load that agrees with itself. What touches what is the scene's. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/conform/meeting.h"

#include <math.h>
#include <string.h>

static const char nothing[] = "nothing touches a coupled body in this scene";

/* Where bodies are, (nbody) each: at the window's start, and at its end. */
typedef struct {
  tdm_state *start, *end;
} motion;

static bool motion_make(motion *g, const cpl_meeting *m) {
  const size_t n = (size_t)m->settings.nbody;
  g->start = calloc(n + 1, sizeof *g->start);
  g->end = calloc(n + 1, sizeof *g->end);
  if (!g->start || !g->end)
    return false;
  for (size_t i = 0; i < n; i++) {
    g->start[i] = m->session.body[i].state;
    g->start[i].twist = (tdm_twist){0};
    g->end[i] = g->start[i];
  }
  return true;
}

static void motion_free(motion *g) {
  free(g->start);
  free(g->end);
}

/* All bodies go on with a velocity through n steps. */
static bool go(cpl_meeting *m, motion *g, tdm_vec3 velocity, long n, tdm_result *r) {
  tdm_step step = cpl_meeting_next(m, n);
  for (int i = 0; i < step.nbody; i++) {
    g->start[i] = g->end[i];
    g->start[i].twist.velocity = g->end[i].twist.velocity = velocity;
    g->end[i].pose.position = tdm_axpy(step.t1 - step.t0, velocity, g->start[i].pose.position);
  }
  step.nstate = step.nbody;
  step.start = g->start;
  step.end = g->end;
  return cpl_meeting_solve(m, &step, r);
}

static bool begin(cpl_meeting *m, motion *g, cpl_candidate *c, cpl_verdict *v) {
  *g = (motion){0};
  if (!cpl_meeting_open(m, c, v))
    return false;
  return motion_make(g, m);
}

static void end(cpl_meeting *m, motion *g) {
  motion_free(g);
  cpl_meeting_drop(m);
}

/* ---- loads ---- */

static const double speed = 0.01; /* [m/s] */

/* A body that is moved one way meets more resistance than one that is moved the other way, or as much. */
static void test_resistance(cpl_candidate *c, cpl_verdict *v) {
  double largest = 0;
  for (int axis = 0; axis < 3; axis++) {
    double load[2] = {0, 0}, size = 0;
    for (int way = 0; way < 2; way++) {
      cpl_meeting m;
      motion g;
      tdm_result r;
      tdm_vec3 velocity = {0, 0, 0};
      (&velocity.x)[axis] = way ? speed : -speed;
      if (!begin(&m, &g, c, v))
        return;
      const bool good = go(&m, &g, velocity, 20, &r);
      for (int i = 0; good && i < r.nbody; i++) {
        load[way] += (&r.load[i].force.x)[axis];
        size = fmax(size, tdm_norm(r.load[i].force));
      }
      end(&m, &g);
      if (!good)
        return;
    }
    largest = fmax(largest, size);
    if (load[1] - load[0] > 1e-6 * size)
      cpl_broken(v, "a load that resists the motion (on the body, world axes)",
                 "along %c: %g N when it moves forward at %g m/s, %g N when it moves back", "xyz"[axis], load[1], speed,
                 load[0]);
  }
  if (largest == 0)
    cpl_not_seen(v, nothing);
}

/* Along a straight way at constant velocity: what the interface says against the loads, the path and itself. */
static void test_interface(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  motion g;
  tdm_result r;
  const tdm_vec3 velocity = {speed, -0.5 * speed, -speed};
  double largest = 0;
  if (!begin(&m, &g, c, v))
    return;
  const double dt = m.settings.dt, h = 4 * dt;
  tdm_vec3 owed = {0, 0, 0};
  for (int w = 0; w < 8 && go(&m, &g, velocity, 4, &r); w++)
    for (int i = 0; i < r.nbody; i++) {
      const tdm_interface *f = &r.body[i];
      const double away = tdm_norm(tdm_sub(f->end.pose.position, g.end[i].pose.position));
      const double size = tdm_norm(f->moment[0].force), due = h * tdm_dot(f->moment[0].force, velocity);
      largest = fmax(largest, fmax(size, tdm_norm(r.load[i].force)));
      if (away > 1e-9 * (1 + tdm_norm(g.end[i].pose.position)))
        cpl_broken(v, "as state at t1 the end of the path", "body %d is %g m away from it", i, away);
      if (fabs(f->work - due) > 1e-6 * h * size * tdm_norm(velocity) + 1e-300)
        cpl_broken(v, "as work along a straight way the impulse m0 H times the velocity", "body %d: %g J, not %g J", i,
                   f->work, due);
      if (i == 0)
        owed = tdm_axpy(h, tdm_sub(f->moment[0].force, r.load[i].force), owed);
    }
  if (tdm_norm(owed) > 1.01 * dt * largest)
    cpl_broken(v, "m0 and the mean load to give the same impulse, but for one step's",
               "they differ by %g N s over 8 windows, a step's is %g N s", tdm_norm(owed), dt * largest);
  if (largest == 0)
    cpl_not_seen(v, nothing);
  end(&m, &g);
}

/* ---- paths ---- */

typedef enum { BY_ENDS, BY_NODES, BENT } way;

/* The mean loads of one window of 10 steps on the way of `go`, told by its ends or by nodes; or on one that goes the
 * other way first and comes to the same end. */
static bool along(cpl_candidate *c, cpl_verdict *v, way how, tdm_wrench *load, int n) {
  cpl_meeting m;
  motion g;
  tdm_result r;
  const tdm_vec3 velocity = {0, 0, -speed};
  if (!begin(&m, &g, c, v))
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
  step.nstate = step.nbody;
  step.start = g.start;
  step.end = g.end;
  if (how != BY_ENDS)
    step.path = (tdm_nodes){.nnode = 2, .nbody = step.nbody, .time = time, .state = state};
  const bool good = state && cpl_meeting_solve(&m, &step, &r);
  for (int i = 0; good && i < n; i++)
    load[i] = i < r.nbody ? r.load[i] : (tdm_wrench){0};
  free(state);
  end(&m, &g);
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
    cpl_not_seen(v, nothing);
  else if (change < 1e-9 * largest)
    cpl_broken(v, "another load where nodes lead another way to the same end", "the same: %g N", largest);
}

/* ---- the proxy ---- */

/* A window that DEM carries the bodies through: accelerations that are given, and a mobility of `free` times that of
 * free bodies. What the interface has at its end goes to *out (of the first body). */
static bool carry(cpl_candidate *c, cpl_verdict *v, tdm_vec3 acceleration, double free_share, double *mass, double *h,
                  tdm_interface *out) {
  cpl_meeting m;
  motion g;
  tdm_result r;
  if (!begin(&m, &g, c, v))
    return false;
  tdm_step step = cpl_meeting_next(&m, 20);
  const size_t n = (size_t)step.nbody, k = 6 * n;
  double *a = calloc(k + 12 * n + 1, sizeof *a);
  tdm_wrench *load = calloc(n + 1, sizeof *load);
  tdm_mobility mobility = {.nbody = step.nbody};
  double *block = calloc(tdm_mobility_doubles(&mobility) + 1, sizeof *block);
  bool good = a && load && block && n > 0;
  if (good)
    tdm_mobility_point(&mobility, block);
  for (size_t i = 0; good && i < n; i++) {
    memcpy(a + 6 * i, &acceleration, sizeof acceleration);
    for (size_t axis = 0; axis < 3; axis++)
      mobility.Y[(6 * i + axis) * k + 6 * i + axis] = free_share / m.session.body[i].mass;
  }
  step.nstate = step.nbody;
  step.start = step.end = g.start;
  step.has_proxy = true;
  step.proxy = (tdm_proxy){.acceleration = a, .load = load, .correction = a + k, .mobility = mobility};
  good = good && cpl_meeting_solve(&m, &step, &r);
  if (good) {
    *out = r.body[0];
    out->end.pose.position = tdm_sub(out->end.pose.position, g.start[0].pose.position);
    *mass = m.session.body[0].mass;
    *h = step.t1 - step.t0;
  }
  free(a);
  free(load);
  free(block);
  end(&m, &g);
  return good;
}

static void test_proxy(cpl_candidate *c, cpl_verdict *v) {
  const tdm_vec3 none = {0, 0, 0}, some = {0.3, 0.1, 0.2};
  double mass, h;
  tdm_interface f;
  if (!carry(c, v, none, 0, &mass, &h, &f))
    return;
  if (tdm_norm(f.end.pose.position) > 1e-12 || tdm_norm(f.end.twist.velocity) > 1e-12)
    cpl_broken(v, "a body at rest without acceleration and mobility to stay", "it goes %g m, at %g m/s",
               tdm_norm(f.end.pose.position), tdm_norm(f.end.twist.velocity));
  if (!carry(c, v, some, 0, &mass, &h, &f))
    return;
  tdm_vec3 off = tdm_axpy(-0.5 * h * h, some, f.end.pose.position), fast = tdm_axpy(-h, some, f.end.twist.velocity);
  if (tdm_norm(off) > 1e-6 * h * h * tdm_norm(some) + 1e-15 || tdm_norm(fast) > 1e-6 * h * tdm_norm(some) + 1e-15)
    cpl_broken(v, "a body with an acceleration a and no mobility to go by a H^2 / 2, at a H",
               "it is off by %g m and %g m/s", tdm_norm(off), tdm_norm(fast));
  if (!carry(c, v, none, 1, &mass, &h, &f) || !isfinite(mass))
    return;
  fast = tdm_axpy(-h / mass, f.moment[0].force, f.end.twist.velocity);
  if (tdm_norm(fast) > 1e-6 * h / mass * tdm_norm(f.moment[0].force) + 1e-12)
    cpl_broken(v, "a free body to gain the impulse m0 H over its mass", "it is off by %g m/s of %g m/s", tdm_norm(fast),
               h / mass * tdm_norm(f.moment[0].force));
}

static void test_sent_velocity(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  motion g = {0};
  tdm_result r;
  if (!cpl_meeting_meet(&m, c, 0, v))
    return;
  m.scheme.needs[CPL_DEM] = CPL_SENT_VELOCITY;
  if (!cpl_meeting_assign(&m))
    return;
  if (motion_make(&g, &m))
    go(&m, &g, tdm_v3(0, 0, -speed), 10, &r);
  end(&m, &g);
}

const cpl_rule cpl_rules_dem[] = {{.name = "load",
                                   .section = "5",
                                   .roles = CPL_OF_DEM,
                                   .text = "a known motion gives a load that resists it",
                                   .test = test_resistance},
                                  {.name = "interface",
                                   .section = "7",
                                   .roles = CPL_OF_DEM,
                                   .capability = "interface",
                                   .text = "moments, ends and works agree with loads and path",
                                   .test = test_interface},
                                  {.name = "proxy",
                                   .section = "7",
                                   .roles = CPL_OF_DEM,
                                   .capability = "proxy",
                                   .text = "the mechanism is carried through the window",
                                   .test = test_proxy},
                                  {.name = "path",
                                   .section = "8",
                                   .roles = CPL_OF_DEM,
                                   .capability = "path",
                                   .text = "nodes tell the path within a window",
                                   .test = test_path},
                                  {.name = "sent_velocity",
                                   .section = "8",
                                   .roles = CPL_OF_DEM,
                                   .capability = "sent_velocity",
                                   .text = "contacts may feel the velocity that is sent",
                                   .test = test_sent_velocity},
                                  {.name = NULL}};
