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
  g->start = cpl_meeting_rest(m);
  g->end = cpl_meeting_rest(m);
  return g->start && g->end;
}

static void motion_free(motion *g) {
  free(g->start);
  free(g->end);
}

/* Body i goes on with `velocity` and i times `more` through n steps. */
static bool go_apart(cpl_meeting *m, motion *g, tdm_vec3 velocity, tdm_vec3 more, long n, tdm_result *r) {
  tdm_step step = cpl_meeting_next(m, n);
  for (int i = 0; i < step.nbody; i++) {
    const tdm_vec3 own = tdm_axpy(i, more, velocity);
    g->start[i] = g->end[i];
    g->start[i].twist.velocity = g->end[i].twist.velocity = own;
    g->end[i].pose.position = tdm_axpy(step.t1 - step.t0, own, g->start[i].pose.position);
  }
  step.nstate = step.nbody;
  step.start = g->start;
  step.end = g->end;
  return cpl_meeting_solve(m, &step, r);
}

/* All bodies go on with a velocity. */
static bool go(cpl_meeting *m, motion *g, tdm_vec3 velocity, long n, tdm_result *r) {
  return go_apart(m, g, velocity, tdm_v3(0, 0, 0), n, r);
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
  const tdm_vec3 velocity = {speed, -0.5 * speed, -speed}, more = {0.2 * speed, 0, 0.1 * speed}; /* bodies differ */
  double largest = 0;
  if (!begin(&m, &g, c, v))
    return;
  const double dt = m.settings.dt, h = 4 * dt;
  tdm_vec3 owed = {0, 0, 0}, change = {0, 0, 0};
  double first_moments = 0;
  for (int w = 0; w < 8 && go_apart(&m, &g, velocity, more, 4, &r); w++)
    for (int i = 0; i < r.nbody; i++) {
      const tdm_interface *f = &r.body[i];
      const double away = tdm_norm(tdm_sub(f->end.pose.position, g.end[i].pose.position));
      const double size = tdm_norm(f->moment[0].force);
      const double due = h * tdm_dot(f->moment[0].force, tdm_axpy(i, more, velocity));
      largest = fmax(largest, fmax(size, tdm_norm(r.load[i].force)));
      if (away > 1e-9 * (1 + tdm_norm(g.end[i].pose.position)))
        cpl_broken(v, "as state at t1 the end of the path", "body %d is %g m away from it", i, away);
      if (fabs(f->work - due) > 1e-6 * h * size * tdm_norm(velocity) + 1e-300)
        cpl_broken(v, "as work along a straight way the impulse m0 H times the velocity", "body %d: %g J, not %g J", i,
                   f->work, due);
      if (i > 0)
        continue;
      change = tdm_sub(r.load[i].force, m.session.load[i].force);
      first_moments += tdm_norm(f->moment[1].force);
      owed = tdm_axpy(h, tdm_sub(f->moment[0].force, r.load[i].force), owed);
    }
  if (tdm_norm(owed) > 1.01 * dt * largest)
    cpl_broken(v, "m0 and the mean load to give the same impulse, but for one step's",
               "they differ by %g N s over 8 windows, a step's is %g N s", tdm_norm(owed), dt * largest);
  /* kicks are half a step earlier than the values after each step, so a load that grows has less of them */
  const double size = tdm_norm(change);
  if (size > 1e-3 * largest && tdm_dot(owed, change) > 0.2 * dt * size * size)
    cpl_broken(v, "the mean load over the values after each step", "it is rather that of the values before");
  if (size > 1e-3 * largest && first_moments == 0)
    cpl_broken(v, "a first moment of a load that changes within a window", "zero");
  if (largest == 0)
    cpl_not_seen(v, nothing);
  end(&m, &g);
}

/* The load that READY tells is not far from that after a first step at rest. */
static void test_start(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  motion g;
  tdm_result r;
  double largest = 0;
  if (!begin(&m, &g, c, v))
    return;
  if (go(&m, &g, tdm_v3(0, 0, 0), 1, &r))
    for (int i = 0; i < r.nbody; i++) {
      const tdm_vec3 told = m.session.load[i].force, is = r.load[i].force;
      const double before = tdm_norm(told), after = tdm_norm(is);
      largest = fmax(largest, fmax(before, after));
      if (before == 0) /* a contact may begin within the step */
        continue;
      if (before > 10 * after || after > 10 * before || tdm_dot(told, is) < 0)
        cpl_broken(v, "in READY the load at the start", "body %d: (%g, %g, %g) N, after a first step (%g, %g, %g) N", i,
                   told.x, told.y, told.z, is.x, is.y, is.z);
    }
  if (largest == 0)
    cpl_not_seen(v, nothing);
  end(&m, &g);
}

/* A sample's load is the mean since the sample before, also over windows without one. */
static void test_samples(cpl_candidate *c, cpl_verdict *v) {
  static const long n[] = {5, 3};
  cpl_meeting m;
  motion g;
  tdm_result r;
  tdm_vec3 sum = {0, 0, 0};
  double size = 0;
  if (!begin(&m, &g, c, v))
    return;
  bool good = m.settings.nbody > 0;
  for (int w = 0; good && w < 2; w++) {
    tdm_step step = cpl_meeting_next(&m, n[w]);
    const double time = step.t1;
    for (int i = 0; i < step.nbody; i++) {
      g.start[i] = g.end[i];
      g.start[i].twist.velocity = g.end[i].twist.velocity = tdm_v3(0, 0, -speed);
      g.end[i].pose.position.z -= speed * (step.t1 - step.t0);
    }
    step.nstate = step.nbody;
    step.start = g.start;
    step.end = g.end;
    step.nsample = w;
    step.sample_time = &time;
    good = cpl_meeting_solve(&m, &step, &r);
    if (good)
      sum = tdm_axpy((double)n[w] / 8, r.load[0].force, sum);
  }
  if (good) {
    size = tdm_norm(sum);
    const double off = tdm_norm(tdm_sub(r.sample_load[0].force, sum));
    if (off > 1e-6 * size)
      cpl_broken(v, "as recorded load the mean since the output time before", "it is %g N off, of %g N", off, size);
  }
  if (size == 0)
    cpl_not_seen(v, nothing);
  end(&m, &g);
}

/* What is stored grows by no more than the coupling load's work. */
static void test_energy(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  motion g;
  tdm_result r;
  double first = NAN, last = NAN, done = 0, moved = 0, until = 0, in_all = 0; /* [J] */
  if (!cpl_claims(c, "interface")) {
    cpl_not_seen(v, "without interface it does not tell the load's work");
    return;
  }
  if (!begin(&m, &g, c, v))
    return;
  tdm_vec3 velocity = {speed, -0.5 * speed, -speed}; /* or against the first load: what is pressed stores energy */
  if (m.settings.nbody > 0 && tdm_norm(m.session.load[0].force) > 0)
    velocity = tdm_scale(-speed, tdm_unit(m.session.load[0].force));
  for (int w = 0; w < 60 && go(&m, &g, velocity, 4, &r); w++) {
    for (int i = 0; i < r.nbody; i++) {
      done -= r.body[i].work;
      moved += fabs(r.body[i].work);
    }
    if (isnan(r.energy->stored)) /* it did not look */
      continue;
    last = r.energy->stored - r.energy->supplied;
    if (isnan(first)) {
      first = last;
      done = moved = 0;
    }
    until = done;
    in_all = moved;
  }
  if (isnan(first) || in_all == 0)
    cpl_not_seen(v, isnan(first) ? "it does not look at its energy in this scene" : nothing);
  else if (last - first > until + 0.05 * in_all)
    cpl_broken(v, "energy that grows by no more than what the coupling load does on the particles",
               "it grows by %g J, the load does %g J", last - first, until);
  end(&m, &g);
}

/* The path from start to end is Hermite's, if ASSIGN says so: it also depends on the velocities there. */
static void test_hermite(cpl_candidate *c, cpl_verdict *v) {
  tdm_vec3 load[2];
  for (int bent = 0; bent < 2; bent++) {
    cpl_meeting m;
    motion g;
    tdm_result r;
    if (!begin(&m, &g, c, v))
      return;
    tdm_step step = cpl_meeting_next(&m, 20);
    for (int i = 0; i < step.nbody && bent; i++) {
      g.start[i].twist.velocity = tdm_v3(0, 0, 10 * speed);
      g.end[i].twist.velocity = tdm_v3(0, 0, -10 * speed);
    }
    step.nstate = step.nbody;
    step.start = g.start;
    step.end = g.end;
    const bool linear = cpl_session_interpolation(&m.session) == TDM_LINEAR;
    const bool good = step.nbody > 0 && cpl_meeting_solve(&m, &step, &r);
    load[bent] = good ? r.load[0].force : tdm_v3(0, 0, 0);
    end(&m, &g);
    if (linear)
      cpl_not_seen(v, "the scene asks for straight paths");
    if (!good || linear)
      return;
  }
  const double size = fmax(tdm_norm(load[0]), tdm_norm(load[1]));
  if (size == 0)
    cpl_not_seen(v, nothing);
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

/* The loads after one step to the same place, where bodies have the velocity that contacts feel: by Hermite's path,
 * or as it is sent. */
static bool feel(cpl_candidate *c, cpl_verdict *v, bool sent, tdm_vec3 velocity, tdm_wrench *load, int n) {
  cpl_meeting m;
  motion g = {0};
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
  bool good = motion_make(&g, &m) && v->kind == CPL_KEPT;
  for (int i = 0; good && i < step.nbody; i++)
    g.end[i].twist.velocity = velocity;
  step.nstate = step.nbody;
  step.start = g.start;
  step.end = g.end;
  good = good && cpl_meeting_solve(&m, &step, &r);
  for (int i = 0; good && i < n; i++)
    load[i] = i < r.nbody ? r.load[i] : (tdm_wrench){0};
  end(&m, &g);
  return good;
}

static void test_sent_velocity(cpl_candidate *c, cpl_verdict *v) {
  tdm_wrench still[SEEN], by_path[SEEN], sent[SEEN];
  const tdm_vec3 none = {0, 0, 0}, velocity = {speed, 0, -10 * speed};
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

const cpl_rule cpl_rules_dem[] = {{.name = "load",
                                   .section = "5",
                                   .roles = CPL_OF_DEM,
                                   .text = "a known motion gives a load that resists it",
                                   .test = test_resistance},
                                  {.name = "load.start",
                                   .section = "4",
                                   .roles = CPL_OF_DEM,
                                   .text = "READY tells the load at the start",
                                   .test = test_start},
                                  {.name = "load.samples",
                                   .section = "5",
                                   .roles = CPL_OF_DEM,
                                   .text = "recorded loads are means since the output time before",
                                   .test = test_samples},
                                  {.name = "load.path",
                                   .section = "4",
                                   .roles = CPL_OF_DEM,
                                   .text = "the path within a window goes by ends and velocities",
                                   .test = test_hermite},
                                  {.name = "energy",
                                   .section = "7",
                                   .roles = CPL_OF_DEM,
                                   .capability = "energy",
                                   .text = "energy grows by no more than the coupling load's work",
                                   .test = test_energy},
                                  {.name = "interface",
                                   .section = "7",
                                   .roles = CPL_OF_DEM,
                                   .capability = "interface",
                                   .text = "moments, ends and works agree with loads and path",
                                   .test = test_interface},
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
