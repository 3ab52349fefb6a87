/* Rules of the DEM side: a known motion gives a load that agrees with itself. What touches what is the scene's. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/conform/rules/motion.h"

#include <math.h>

/* A body that is moved one way meets more resistance than one that is moved the other way, or as much. */
static void test_resistance(cpl_candidate *c, cpl_verdict *v) {
  double largest = 0;
  for (int axis = 0; axis < 3; axis++) {
    double load[2] = {0, 0}, size = 0;
    for (int way = 0; way < 2; way++) {
      cpl_meeting m;
      cpl_motion g;
      tdm_result r;
      tdm_vec3 velocity = {0, 0, 0};
      (&velocity.x)[axis] = way ? cpl_slow : -cpl_slow;
      if (!cpl_motion_begin(&g, &m, c, v))
        return;
      const bool good = cpl_motion_go(&m, &g, velocity, 20, &r);
      for (int i = 0; good && i < r.nbody; i++) {
        load[way] += (&r.load[i].force.x)[axis];
        size = fmax(size, tdm_norm(r.load[i].force));
      }
      cpl_motion_end(&g, &m);
      if (!good)
        return;
    }
    largest = fmax(largest, size);
    if (load[1] - load[0] > 1e-6 * size)
      cpl_broken(v, "a load that resists the motion (on the body, world axes)",
                 "along %c: %g N when it moves forward at %g m/s, %g N when it moves back", "xyz"[axis], load[1],
                 cpl_slow, load[0]);
  }
  if (largest == 0)
    cpl_not_seen(v, cpl_nothing_touches);
}

/* Along a straight way at constant velocity: what the interface says against the loads, the path and itself. */
static void test_interface(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  cpl_motion g;
  tdm_result r;
  const tdm_vec3 velocity = {cpl_slow, -0.5 * cpl_slow, -cpl_slow},
                 more = {0.2 * cpl_slow, 0, 0.1 * cpl_slow}; /* bodies differ */
  double largest = 0;
  if (!cpl_motion_begin(&g, &m, c, v))
    return;
  const double dt = m.settings.dt, h = 4 * dt;
  tdm_vec3 owed = {0, 0, 0}, change = {0, 0, 0};
  double first_moments = 0;
  for (int w = 0; w < 8; w++) {
    tdm_step step = cpl_meeting_next(&m, 4);
    if (!cpl_motion_go_apart(&m, &g, velocity, more, &step, &r))
      break;
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
    cpl_not_seen(v, cpl_nothing_touches);
  cpl_motion_end(&g, &m);
}

/* The load that READY tells is not far from that after a first step at rest. */
static void test_start(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  cpl_motion g;
  tdm_result r;
  double largest = 0;
  if (!cpl_motion_begin(&g, &m, c, v))
    return;
  if (cpl_motion_go(&m, &g, tdm_v3(0, 0, 0), 1, &r))
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
    cpl_not_seen(v, cpl_nothing_touches);
  cpl_motion_end(&g, &m);
}

/* A sample's load is the mean since the sample before, also over windows without one. */
static void test_samples(cpl_candidate *c, cpl_verdict *v) {
  static const long n[] = {5, 3};
  cpl_meeting m;
  cpl_motion g;
  tdm_result r;
  tdm_vec3 sum = {0, 0, 0};
  double size = 0;
  if (!cpl_motion_begin(&g, &m, c, v))
    return;
  bool good = m.settings.nbody > 0;
  for (int w = 0; good && w < 2; w++) {
    tdm_step step = cpl_meeting_next(&m, n[w]);
    const double time = step.t1;
    step.nsample = w;
    step.sample_time = &time;
    good = cpl_motion_go_apart(&m, &g, tdm_v3(0, 0, -cpl_slow), tdm_v3(0, 0, 0), &step, &r);
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
    cpl_not_seen(v, cpl_nothing_touches);
  cpl_motion_end(&g, &m);
}

/* What is stored grows by no more than the coupling load's work. */
static void test_energy(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  cpl_motion g;
  tdm_result r;
  double first = NAN, last = NAN, done = 0, moved = 0, until = 0, in_all = 0; /* [J] */
  if (!cpl_claims(c, "interface")) {
    cpl_not_seen(v, "without interface it does not tell the load's work");
    return;
  }
  if (!cpl_motion_begin(&g, &m, c, v))
    return;
  tdm_vec3 velocity = {cpl_slow, -0.5 * cpl_slow,
                       -cpl_slow}; /* or against the first load: what is pressed stores energy */
  if (m.settings.nbody > 0 && tdm_norm(m.session.load[0].force) > 0)
    velocity = tdm_scale(-cpl_slow, tdm_unit(m.session.load[0].force));
  for (int w = 0; w < 60 && cpl_motion_go(&m, &g, velocity, 4, &r); w++) {
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
    cpl_not_seen(v, isnan(first) ? "it does not look at its energy in this scene" : cpl_nothing_touches);
  else if (last - first > until + 0.05 * in_all)
    cpl_broken(v, "energy that grows by no more than what the coupling load does on the particles",
               "it grows by %g J, the load does %g J", last - first, until);
  cpl_motion_end(&g, &m);
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
                                  {.name = NULL}};
