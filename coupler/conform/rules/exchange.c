/* Rules of the handshake and of windows, for both roles. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/conform/meeting.h"

#include <math.h>
#include <string.h>

/* A window without load, or with all bodies at rest, whichever the role takes. */
static bool quiet(cpl_meeting *m, long n, const double *sample, int nsample, tdm_result *result) {
  tdm_step step = cpl_meeting_next(m, n);
  tdm_state *state = cpl_meeting_rest(m);
  tdm_wrench *load = calloc((size_t)step.nbody + 1, sizeof *load);
  step.sample_time = sample;
  step.nsample = nsample;
  if (m->candidate->role == CPL_DEM) {
    step.nstate = step.nbody;
    step.start = step.end = state;
  } else {
    step.nload = 1;
    step.load = load;
  }
  const bool good = state && load && cpl_meeting_solve(m, &step, result);
  free(state);
  free(load);
  return good;
}

static void test_hello(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  if (!cpl_meeting_meet(&m, c, 0, v))
    return;
  const cpl_partner *p = &m.session.partner[c->role];
  size_t i;
  json_t *entry;
  if (!p->name[0])
    cpl_broken(v, "a name in HELLO", "none");
  if (strcmp(p->software, "unknown software") == 0)
    cpl_broken(v, "its software and version in HELLO (\"software\")", "none");
  if (p->capabilities && !json_is_array(p->capabilities))
    cpl_broken(v, "a list as \"capabilities\"", "something else");
  json_array_foreach(p->capabilities, i, entry) if (!json_is_string(entry))
      cpl_broken(v, "names as \"capabilities\"", "entry %zu is no string", i);
  cpl_meeting_drop(&m);
}

static void test_ready(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  if (cpl_meeting_open(&m, c, v))
    cpl_meeting_drop(&m);
  c->unready = v->kind == CPL_BROKEN;
}

static void test_windows(cpl_candidate *c, cpl_verdict *v) {
  static const long n[] = {5, 1, 3, 20, 2};
  cpl_meeting m;
  tdm_result r;
  if (!cpl_meeting_open(&m, c, v))
    return;
  for (size_t k = 0; k < sizeof n / sizeof n[0]; k++)
    if (!quiet(&m, n[k], NULL, 0, &r)) {
      cpl_meeting_drop(&m);
      return;
    }
  cpl_meeting_finish(&m);
}

/* A sample at the end of the window is the state there; those before come as they were asked for. */
static void test_samples(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  tdm_result r;
  if (!cpl_meeting_open(&m, c, v))
    return;
  const double dt = m.settings.dt, sample[] = {0.3 * dt, dt, 2.5 * dt, 4 * dt};
  const bool good = quiet(&m, 4, sample, 4, &r);
  for (int i = 0; good && c->role == CPL_MBD && i < r.nstate; i++) {
    const tdm_state *last = &r.sample_state[3 * r.nstate + i];
    const double away = tdm_norm(tdm_sub(last->pose.position, r.state[i].pose.position));
    if (away > 1e-9 * (1 + tdm_norm(r.state[i].pose.position)))
      cpl_broken(v, "the state at t1 as the sample at t1", "body %d is %g m away from it", i, away);
  }
  if (good)
    cpl_meeting_finish(&m);
  else
    cpl_meeting_drop(&m);
}

/* Schemes ask for what they need, which need not be all that a solver can. */
static void test_alone(cpl_candidate *c, cpl_verdict *v) {
  for (int k = -1; k < CPL_NNEED && v->kind == CPL_KEPT; k++) { /* -1: nothing is asked for */
    cpl_meeting m;
    tdm_result r;
    if (k >= 0 && !cpl_claims(c, cpl_need_names[k]))
      continue;
    if (!cpl_meeting_meet(&m, c, 0, v))
      return;
    memset(m.scheme.needs, 0, sizeof m.scheme.needs);
    if (k >= 0)
      m.scheme.needs[c->role] = 1u << k;
    if (!cpl_meeting_assign(&m))
      return;
    quiet(&m, 2, NULL, 0, &r);
    cpl_meeting_drop(&m);
  }
}

/* HEARTBEATs between windows are not answered, and change nothing. */
static void test_heartbeat(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  tdm_result r;
  tdm_frame beat = {0};
  if (!cpl_meeting_open(&m, c, v))
    return;
  for (int k = 0; k < 5 && tdm_control_write(&beat, TDM_HEARTBEAT, 0, NULL, NULL) == TDM_OK; k++)
    cpl_meeting_send(&m, &beat);
  tdm_frame_free(&beat);
  if (quiet(&m, 2, NULL, 0, &r))
    cpl_meeting_finish(&m);
  else
    cpl_meeting_drop(&m);
}

/* FINISH may come at any time: before ASSIGN, and when it is READY. */
static void test_finish(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  if (cpl_meeting_meet(&m, c, 0, v))
    cpl_meeting_finish(&m);
  if (v->kind == CPL_KEPT && cpl_meeting_open(&m, c, v))
    cpl_meeting_finish(&m);
}

const cpl_rule cpl_rules_exchange[] = {
    {.name = "hello", .section = "4", .roles = CPL_OF_BOTH, .text = "it begins with HELLO", .test = test_hello},
    {.name = "ready", .section = "4", .roles = CPL_OF_BOTH, .text = "it answers ASSIGN by READY", .test = test_ready},
    {.name = "windows",
     .section = "5",
     .roles = CPL_OF_BOTH,
     .text = "windows of 1 to 20 steps, without load or motion",
     .test = test_windows},
    {.name = "samples",
     .section = "5",
     .roles = CPL_OF_BOTH,
     .text = "output times within a window and at its end",
     .test = test_samples},
    {.name = "alone",
     .section = "4",
     .roles = CPL_OF_BOTH,
     .text = "each capability may be asked for alone, and none at all",
     .test = test_alone},
    {.name = "heartbeat",
     .section = "4",
     .roles = CPL_OF_BOTH,
     .text = "HEARTBEAT is not answered",
     .test = test_heartbeat},
    {.name = "finish", .section = "4", .roles = CPL_OF_BOTH, .text = "FINISH ends it at any time", .test = test_finish},
    {.name = NULL}};
