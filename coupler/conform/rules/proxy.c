/* Rules of the proxy (PROTOCOL.md, section 7): reduced models that are given, and where DEM's bodies go by them. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/conform/meeting.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char untold[] = "without interface it does not tell where the proxy went";
static const char nothing[] = "nothing touches a coupled body in this scene";

enum { STEPS = 20 };

/* A window that DEM carries its bodies through; all of them alike, at rest at its start. */
typedef struct {
  tdm_vec3 acceleration, load; /* a and W(0) of each body */
  double share;                /* Y, as a share of that of free bodies */
  tdm_vec3 away;               /* from where the bodies are */
  tdm_vec3 way, rate;          /* of the correction */
  /* one independent velocity: columns of the first body's velocity, and the row of the force on it, times its mass */
  bool one;
  double u2;
  tdm_vec3 J, J_rate, B, B_rate;
} carriage;

/* What came of it, of the first body. */
typedef struct {
  double h, mass;
  tdm_wrench load;
  tdm_interface body; /* `end` as a way from the start */
} outcome;

/* The arrays of a STEP with a proxy: one block, `a` in front. */
typedef struct {
  tdm_state *start;
  double *a;
  tdm_wrench *load;
  tdm_proxy proxy;
} arrays;

static void arrays_free(arrays *x) {
  free(x->start);
  free(x->load);
  free(x->proxy.mobility.Y);
  free(x->a);
}

static void set(double *at, int stride, tdm_vec3 v) {
  at[0] = v.x;
  at[stride] = v.y;
  at[2 * stride] = v.z;
}

static void fill_model(const cpl_meeting *m, const carriage *g, tdm_mobility *y) {
  const int n = m->settings.nbody, k = 6 * n;
  for (int i = 0; i < n; i++)
    for (int axis = 0; axis < 3; axis++)
      y->Y[(6 * i + axis) * k + 6 * i + axis] = g->share / m->session.body[i].mass;
  if (!g->one)
    return;
  const double per_mass = 1 / m->session.body[0].mass;
  y->acceleration[0] = g->u2;
  set(y->J, 1, g->J);
  set(y->J_rate, 1, g->J_rate);
  set(y->B, 1, tdm_scale(per_mass, g->B));
  set(y->B_rate, 1, tdm_scale(per_mass, g->B_rate));
  for (int i = 0; i < 3; i++)
    for (int l = 0; l < 3; l++)
      y->Y[i * k + l] = y->J[i] * y->B[l];
}

static bool arrays_make(arrays *x, const cpl_meeting *m, const carriage *g) {
  const size_t n = (size_t)m->settings.nbody;
  tdm_mobility model = {.nbody = (int)n, .nfree = g->one};
  double *block = calloc(tdm_mobility_doubles(&model) + 1, sizeof *block);
  *x = (arrays){.start = cpl_meeting_rest(m),
                .a = calloc(18 * n + 1, sizeof *x->a),
                .load = calloc(n + 1, sizeof *x->load),
                .proxy.mobility.Y = block};
  if (!block || !x->start || !x->a || !x->load)
    return false;
  tdm_mobility_point(&model, block);
  fill_model(m, g, &model);
  for (size_t i = 0; i < n; i++) {
    x->load[i].force = g->load;
    set(x->a + 6 * i, 1, g->one && i > 0 ? tdm_v3(0, 0, 0) : g->acceleration);
    set(x->a + 6 * n + 12 * i, 1, g->way);
    set(x->a + 6 * n + 12 * i + 6, 1, g->rate);
    x->start[i].pose.position = tdm_add(x->start[i].pose.position, g->away);
  }
  x->proxy = (tdm_proxy){.acceleration = x->a, .load = x->load, .correction = x->a + 6 * n, .mobility = model};
  return true;
}

/* A window at rest, so that no drift is left of the start. */
static bool rest(cpl_meeting *m, long n) {
  tdm_result r;
  tdm_step step = cpl_meeting_next(m, n);
  tdm_state *state = cpl_meeting_rest(m);
  step.nstate = step.nbody;
  step.start = step.end = state;
  const bool good = state && cpl_meeting_solve(m, &step, &r);
  free(state);
  return good;
}

static bool carry_on(cpl_meeting *m, const carriage *g, outcome *out) {
  tdm_result r;
  arrays x = {0};
  tdm_step step = cpl_meeting_next(m, STEPS);
  bool good = arrays_make(&x, m, g);
  step.nstate = step.nbody;
  step.start = step.end = x.start;
  step.has_proxy = true;
  step.proxy = x.proxy;
  good = good && cpl_meeting_solve(m, &step, &r);
  if (good) {
    *out = (outcome){.h = step.t1 - step.t0, .mass = m->session.body[0].mass, .load = r.load[0], .body = r.body[0]};
    out->body.end.pose.position = tdm_sub(r.body[0].end.pose.position, x.start[0].pose.position);
  }
  arrays_free(&x);
  return good;
}

static bool open(cpl_meeting *m, cpl_candidate *c, cpl_verdict *v) {
  if (!cpl_claims(c, "interface")) {
    cpl_not_seen(v, untold);
    return false;
  }
  if (!cpl_meeting_open(m, c, v))
    return false;
  if (m->settings.nbody > 0 && rest(m, STEPS))
    return true;
  cpl_not_seen(v, "the scene couples no body");
  cpl_meeting_drop(m);
  return false;
}

static bool carry(cpl_candidate *c, cpl_verdict *v, const carriage *g, outcome *out) {
  cpl_meeting m;
  if (!open(&m, c, v))
    return false;
  const bool good = carry_on(&m, g, out);
  cpl_meeting_drop(&m);
  return good;
}

static void expect_velocity(cpl_verdict *v, const outcome *o, tdm_vec3 due, double scale, const char *expected) {
  const tdm_vec3 is = o->body.end.twist.velocity;
  if (tdm_norm(tdm_sub(is, due)) > 1e-6 * (tdm_norm(due) + scale) + 1e-14)
    cpl_broken(v, expected, "(%g, %g, %g) m/s after %g s, due are (%g, %g, %g) m/s", is.x, is.y, is.z, o->h, due.x,
               due.y, due.z);
}

/* ---- by Y alone ---- */

static void test_proxy(cpl_candidate *c, cpl_verdict *v) {
  const tdm_vec3 some = {0.3, 0.1, 0.2};
  outcome o;
  if (!carry(c, v, &(carriage){0}, &o))
    return;
  if (tdm_norm(o.body.end.pose.position) > 1e-12 || tdm_norm(o.body.end.twist.velocity) > 1e-12)
    cpl_broken(v, "a body at rest without acceleration and mobility to stay", "it goes %g m, at %g m/s",
               tdm_norm(o.body.end.pose.position), tdm_norm(o.body.end.twist.velocity));
  if (!carry(c, v, &(carriage){.acceleration = some}, &o))
    return;
  const tdm_vec3 off = tdm_axpy(-0.5 * o.h * o.h, some, o.body.end.pose.position);
  if (tdm_norm(off) > 1e-6 * o.h * o.h * tdm_norm(some) + 1e-15)
    cpl_broken(v, "a body with an acceleration a and no mobility to go by a H^2 / 2", "it is off by %g m",
               tdm_norm(off));
  expect_velocity(v, &o, tdm_scale(o.h, some), 0, "a body with an acceleration a and no mobility to go at a H");
  if (!isfinite(o.mass) || !carry(c, v, &(carriage){.share = 1}, &o))
    return;
  expect_velocity(v, &o, tdm_scale(o.h / o.mass, o.body.moment[0].force), 0,
                  "a free body to gain the impulse m0 H over its mass");
  const tdm_vec3 held = tdm_scale(o.mass, some);
  if (!carry(c, v, &(carriage){.share = 1, .load = held}, &o))
    return;
  expect_velocity(v, &o, tdm_scale(o.h / o.mass, tdm_sub(o.body.moment[0].force, held)), o.h,
                  "W - W(0) to move a free body whose acceleration belongs to W(0)");
}

/* ---- by independent velocities ---- */

static void test_model(cpl_candidate *c, cpl_verdict *v) {
  const tdm_vec3 x = {1, 0, 0}, z = {0, 0, 1}, some = {0.3, 0.1, 0.2};
  outcome o;
  /* what drivers prescribe: a is more than J u'' */
  if (!carry(c, v, &(carriage){.one = true, .J = x, .u2 = 1, .acceleration = tdm_add(x, some)}, &o))
    return;
  const double h = o.h;
  expect_velocity(v, &o, tdm_scale(h, tdm_add(x, some)), 0,
                  "V = J u' + tau a_t, a_t = a - J u'': what drivers prescribe");
  /* J turns from x to z within the window */
  if (!carry(c, v, &(carriage){.one = true, .J = x, .J_rate = tdm_scale(1 / h, z), .u2 = 1, .acceleration = x}, &o))
    return;
  expect_velocity(v, &o, tdm_scale(h, tdm_add(x, z)), 0, "V = (J + tau dJ/dt) u'");
  if (!isfinite(o.mass))
    return;
  if (!carry(c, v, &(carriage){.one = true, .J = z, .B = z}, &o))
    return;
  expect_velocity(v, &o, tdm_v3(0, 0, h / o.mass * o.body.moment[0].force.z), 0, "u'' = B W");
  /* B grows from zero; J must change too, as it does where B does */
  const tdm_vec3 held = {0, 0, o.mass};
  const carriage grows = {
      .one = true, .J = z, .J_rate = tdm_scale(0.1 / h, x), .B_rate = tdm_scale(1 / h, z), .load = held};
  if (!carry(c, v, &grows, &o))
    return;
  const double u1 = 0.5 * h / o.mass * (o.body.moment[0].force.z + o.body.moment[1].force.z - held.z);
  expect_velocity(v, &o, tdm_v3(0.1 * u1, 0, u1), h, "u'' = (B + tau dB/dt) (W - W(0))");
}

/* ---- correction ---- */

/* With way a H^2/2 and rate a H a correction leads where an acceleration a does: contacts feel the same. */
static void test_correction(cpl_candidate *c, cpl_verdict *v) {
  const tdm_vec3 way = {2e-5, 1e-5, -5e-5};
  outcome corrected, led, left;
  if (!carry(c, v, &(carriage){0}, &left) ||
      !carry(c, v, &(carriage){.way = way, .rate = tdm_scale(2 / left.h, way)}, &corrected) ||
      !carry(c, v, &(carriage){.acceleration = tdm_scale(2 / (left.h * left.h), way)}, &led))
    return;
  const double change = tdm_norm(tdm_sub(led.load.force, left.load.force));
  const double off = tdm_norm(tdm_sub(corrected.load.force, led.load.force));
  if (change == 0)
    cpl_not_seen(v, nothing);
  if (off > 1e-3 * change)
    cpl_broken(v, "with a correction a H^2/2, a H the load that an acceleration a leads to",
               "%g N in place of %g N, without either %g N", tdm_norm(corrected.load.force), tdm_norm(led.load.force),
               tdm_norm(left.load.force));
  if (fabs(corrected.body.work - led.body.work) > 1e-3 * fabs(led.body.work))
    cpl_broken(v, "the work along the correction", "%g J, along the same way without one %g J", corrected.body.work,
               led.body.work);
  if (tdm_norm(corrected.body.end.pose.position) > 1e-12)
    cpl_broken(v, "as state at t1 where the proxy went, without the correction", "it is %g m away",
               tdm_norm(corrected.body.end.pose.position));
}

/* ---- drift ---- */

/* MBD has the bodies elsewhere than DEM left them: they do not jump there, but get there. What the load does along that
 * is told, and adds up to load times way. */
static void test_drift(cpl_candidate *c, cpl_verdict *v) {
  enum { WINDOWS = 50 };
  const carriage g = {.away = {0, 0, -1e-6}};
  double least = INFINITY, most = -INFINITY, done = 0, first = 0; /* [N], [J] */
  cpl_meeting m;
  outcome o;
  bool good = open(&m, c, v);
  if (!good)
    return;
  for (int w = 0; w < WINDOWS && (good = carry_on(&m, &g, &o)); w++) {
    first = w == 0 ? fabs(o.body.blending) : first;
    if (fabs(o.body.blending) >= 1e-2 * first) {
      least = fmin(least, o.body.moment[0].force.z);
      most = fmax(most, o.body.moment[0].force.z);
    }
    done += o.body.blending;
  }
  cpl_meeting_drop(&m);
  const double weak = fmin(fabs(least), fabs(most)), strong = fmax(fabs(least), fabs(most)), way = g.away.z;
  if (!good)
    return;
  if (least * most <= 0 || weak < 0.1 * strong)
    cpl_not_seen(v, "no load stays on a coupled body of this scene");
  else if (done / (way * least) < 0.3 * weak / strong || done / (way * least) > 1.5 * strong / weak)
    cpl_broken(v, "the work of the load along the closing of a drift: load times way, in 50 windows",
               "%g J in all; loads of %g N to %g N along a way of %g m", done, least, most, way);
}

const cpl_rule cpl_rules_proxy[] = {{.name = "proxy",
                                     .section = "7",
                                     .roles = CPL_OF_DEM,
                                     .capability = "proxy",
                                     .text = "bodies are carried through the window by a, Y and W - W(0)",
                                     .test = test_proxy},
                                    {.name = "proxy.model",
                                     .section = "7",
                                     .roles = CPL_OF_DEM,
                                     .capability = "proxy",
                                     .text = "and by the independent velocities of a reduced model",
                                     .test = test_model},
                                    {.name = "proxy.correction",
                                     .section = "7",
                                     .roles = CPL_OF_DEM,
                                     .capability = "proxy",
                                     .text = "a correction changes the path, and its work",
                                     .test = test_correction},
                                    {.name = "proxy.drift",
                                     .section = "7",
                                     .roles = CPL_OF_DEM,
                                     .capability = "proxy",
                                     .text = "what DEM stands apart is closed, and its work told",
                                     .test = test_drift},
                                    {.name = NULL}};
