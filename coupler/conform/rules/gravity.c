/* The rule of READY's gravity: what falls freely falls by it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/conform/rules/motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double close = 1e-3; /* share that a fall may be off */
static const char expected[] = "what falls freely to fall by the gravity of READY";

/* Where no coupling load acts, gravity alone moves a body along the directions that are `free`. */
static void test_bodies(cpl_meeting *m, tdm_vec3 gravity, cpl_verdict *v) {
  const int n = m->settings.nbody;
  tdm_result r;
  tdm_step step = cpl_meeting_next(m, 10);
  tdm_wrench *load = calloc((size_t)n + 1, sizeof *load);
  bool seen = false;
  step.load = load;
  step.nload = 1;
  const double h = step.t1 - step.t0;
  const bool good = load && cpl_meeting_solve(m, &step, &r);
  free(load);
  for (int i = 0; good && i < n; i++)
    for (int k = 0; k < m->session.body[i].nfree; k++) {
      const tdm_vec3 along = m->session.body[i].free[k];
      const double is = tdm_dot(along, tdm_sub(r.state[i].twist.velocity, m->session.body[i].state.twist.velocity)) / h;
      const double due = tdm_dot(along, gravity);
      seen = true;
      if (fabs(is - due) > close * fabs(due) + 1e-6)
        cpl_broken(v, expected, "body %d falls along (%g, %g, %g), where it is free, with %g m/s2, not %g", i, along.x,
                   along.y, along.z, is, due);
    }
  if (good && !seen)
    cpl_not_seen(v, "it says of no coupled body that it is free along some direction");
}

/* ---- particles ---- */

/* All bodies go on through n steps; the particles at their end, the arrays being *s's. */
static bool go_and_look(cpl_meeting *m, cpl_motion *g, tdm_vec3 velocity, long n, tdm_snapshot *s) {
  tdm_header header;
  tdm_error err = {0};
  tdm_result r;
  tdm_step step = cpl_meeting_next(m, n);
  step.seen = true;
  if (!cpl_motion_go_apart(m, g, velocity, tdm_v3(0, 0, 0), &step, &r))
    return false;
  const bool good = cpl_session_view(&m->session, CPL_DEM, CPL_SNAPSHOT, &header, &err) == TDM_OK && header.size > 0 &&
                    tdm_snapshot_decode(s, header.payload, header.size, &err) == TDM_OK;
  if (err.status != TDM_OK)
    cpl_broken(m->verdict, "a snapshot as section 10 has it", "%s", err.message);
  return good;
}

/* What is nearest to gravity of the accelerations of particles that touch nothing before and after; whether there are
 * some. */
static bool nearest_fall(const tdm_snapshot *before, const tdm_snapshot *after, double h, tdm_vec3 gravity,
                         tdm_vec3 *fall) {
  double least = INFINITY;
  for (int k = 0, l = 0; k < before->nparticle && l < after->nparticle; k++) { /* ascending by id */
    while (l < after->nparticle && after->id[l] < before->id[k])
      l++;
    if (l == after->nparticle || after->id[l] != before->id[k] || tdm_norm(before->force[k]) > 0 ||
        tdm_norm(after->force[l]) > 0)
      continue;
    const tdm_vec3 a = tdm_scale(1 / h, tdm_sub(after->velocity[l], before->velocity[k]));
    const double off = tdm_norm(tdm_sub(a, gravity));
    *fall = off < least ? a : *fall;
    least = fmin(least, off);
  }
  return isfinite(least);
}

/* Bodies leave the particles behind, faster than these fall; one step then tells how those fall that touch nothing. */
static void test_particles(cpl_meeting *m, tdm_vec3 gravity, cpl_verdict *v) {
  enum { TRIES = 40, STEPS = 10 };
  const double dt = m->settings.dt, g = tdm_norm(gravity), pace = 3 * fmax(g, 10); /* [m/s2] */
  tdm_vec3 away = g > 0 ? tdm_unit(gravity) : tdm_v3(0, 0, -1);
  for (int i = 0; i < m->settings.nbody; i++) /* what is told need not be true: the load shows where particles lie */
    if (tdm_norm(m->session.load[i].force) > 0)
      away = tdm_unit(m->session.load[i].force);
  tdm_snapshot before = {0}, after = {0};
  cpl_motion motion;
  bool seen = false, good = cpl_motion_make(&motion, m);
  for (int k = 0; k < TRIES && good && !seen; k++) {
    const tdm_vec3 velocity = tdm_scale(pace * (double)m->step * dt, away);
    tdm_vec3 fall = {0, 0, 0};
    good = go_and_look(m, &motion, velocity, STEPS, &before) && go_and_look(m, &motion, velocity, 1, &after);
    seen = good && nearest_fall(&before, &after, dt, gravity, &fall);
    if (seen && tdm_norm(tdm_sub(fall, gravity)) > close * g + 1e-6)
      cpl_broken(v, expected, "a particle that touches nothing falls with (%g, %g, %g) m/s2, not (%g, %g, %g)", fall.x,
                 fall.y, fall.z, gravity.x, gravity.y, gravity.z);
  }
  if (!seen)
    cpl_not_seen(v, "all particles of this scene touch something, or there are none to see");
  tdm_snapshot_free(&before);
  tdm_snapshot_free(&after);
  cpl_motion_free(&motion);
}

static void test_gravity(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  if (!cpl_meeting_open(&m, c, v))
    return;
  const cpl_partner *p = &m.session.partner[c->role];
  if (!p->has_gravity)
    cpl_not_seen(v, "it does not tell its gravity");
  else if (c->role == CPL_MBD)
    test_bodies(&m, p->gravity, v);
  else if (!cpl_claims(c, "view"))
    cpl_not_seen(v, "without view its particles are not seen to fall");
  else
    test_particles(&m, p->gravity, v);
  cpl_meeting_drop(&m);
}

const cpl_rule cpl_rules_gravity[] = {{.name = "gravity",
                                       .section = "4",
                                       .roles = CPL_OF_BOTH,
                                       .text = "what falls freely falls by READY's gravity",
                                       .test = test_gravity},
                                      {.name = NULL}};
