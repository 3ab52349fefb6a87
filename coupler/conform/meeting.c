/* One session with the solver under test: see meeting.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/conform/meeting.h"

#include "coupler/scheme/schemes.h"
#include "protocol/base/log.h"
#include "protocol/parameters/load.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- verdicts ---- */

void cpl_broken(cpl_verdict *v, const char *expected, const char *format, ...) {
  if (v->kind != CPL_KEPT)
    return;
  va_list args;
  va_start(args, format);
  v->kind = CPL_BROKEN;
  snprintf(v->expected, sizeof v->expected, "%s", expected);
  vsnprintf(v->came, sizeof v->came, format, args);
  va_end(args);
  tdm_utf8_clean(v->came);
}

void cpl_not_seen(cpl_verdict *v, const char *why) {
  if (v->kind != CPL_KEPT)
    return;
  v->kind = CPL_NOT_SEEN;
  snprintf(v->came, sizeof v->came, "%s", why);
}

bool cpl_claims(const cpl_candidate *c, const char *capability) {
  size_t i;
  json_t *entry;
  json_array_foreach(c->capabilities, i, entry) {
    const char *name = json_string_value(entry);
    if (name && strcmp(name, capability) == 0)
      return true;
  }
  return false;
}

/* ---- start ---- */

/* The scene for tests: windows of up to 50 steps, over ipc. */
static tdm_status read_scene(cpl_meeting *m, tdm_error *err) {
  static const char *const own[] = {"coupling.scheme=proxy", "coupling.n=50", "coupling.transport=ipc"};
  enum { NOWN = sizeof own / sizeof own[0] };
  const cpl_candidate *c = m->candidate;
  size_t n = 0;
  while (c->set && c->set[n])
    n++;
  const char **set = calloc(n + NOWN + 1, sizeof *set);
  if (!set)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (size_t k = 0; k < n + NOWN; k++)
    set[k] = k < n ? c->set[k] : own[k - n];
  if (tdm_scene_load(&m->scene, c->scene, set, err) == TDM_OK)
    cpl_settings_read(&m->settings, &m->scene, cpl_schemes, err);
  if (err->status != TDM_OK)
    tdm_scene_locate(&m->scene, err);
  free(set);
  return err->status;
}

tdm_status cpl_meeting_check(cpl_candidate *c, tdm_error *err) {
  cpl_meeting m = {.candidate = c};
  read_scene(&m, err);
  cpl_settings_free(&m.settings);
  tdm_scene_destroy(&m.scene);
  return err->status;
}

static tdm_status launch(cpl_meeting *m, double timeout, tdm_error *err) {
  cpl_candidate *c = m->candidate;
  char endpoint[256], log[256], text[256];
  snprintf(endpoint, sizeof endpoint, "ipc://%s/server%d", c->dir, c->meetings++);
  if (cpl_session_open(&m->session, &m->settings, endpoint, NULL, err) != TDM_OK)
    return err->status;
  tdm_progress_begin(&m->session.progress, 0, "", true);
  for (int r = 0; r <= (int)c->role && err->status == TDM_OK; r++) { /* dem is assigned what mbd has told */
    const char *partner = cpl_launch_command(&m->settings, (cpl_role)r, c->solver[r].executable, text, sizeof text);
    snprintf(log, sizeof log, "%s/%s.log", c->dir, cpl_role_names[r]);
    cpl_launch_process(&m->session.partner[r].child, r == (int)c->role ? c->command : partner, endpoint,
                       cpl_role_names[r], log, timeout, err);
  }
  return err->status;
}

/* A scheme that needs of the solver what it can: so all of it is asked for. */
static void ask_for_all(cpl_meeting *m) {
  const cpl_candidate *c = m->candidate;
  m->scheme = (cpl_scheme){.name = "conform", .interpolation = TDM_HERMITE};
  for (int k = 0; k < CPL_NNEED; k++)
    if (cpl_claims(c, cpl_need_names[k]) && 1 << k != CPL_SENT_VELOCITY)
      m->scheme.needs[c->role] |= 1u << k;
  if (cpl_claims(c, cpl_need_names[4])) /* restore: of mbd it is looked at for both */
    m->scheme.needs[CPL_MBD] |= CPL_RESTORE;
  m->session.scheme = &m->scheme;
}

bool cpl_meeting_meet(cpl_meeting *m, cpl_candidate *c, double timeout, cpl_verdict *v) {
  tdm_error err = {0};
  *m = (cpl_meeting){.candidate = c, .verdict = v};
  m->settings.timeout = c->timeout;
  if (read_scene(m, &err) == TDM_OK) {
    m->settings.timeout = c->timeout;
    if (launch(m, timeout > 0 ? timeout : c->timeout, &err) == TDM_OK)
      for (int r = 0; r <= (int)c->role && err.status == TDM_OK; r++)
        cpl_session_meet(&m->session, (cpl_role)r, &err);
  }
  if (err.status != TDM_OK) {
    cpl_broken(v, "HELLO of the solver", "%s", err.message);
    cpl_meeting_drop(m);
    return false;
  }
  const cpl_partner *p = &m->session.partner[c->role];
  if (!c->capabilities)
    c->capabilities = p->capabilities ? json_incref(p->capabilities) : json_array();
  snprintf(c->software, sizeof c->software, "%s", p->software);
  ask_for_all(m);
  return true;
}

bool cpl_meeting_assign(cpl_meeting *m) {
  tdm_error err = {0};
  for (int r = 0; r <= (int)m->candidate->role && err.status == TDM_OK; r++)
    cpl_session_assign(&m->session, (cpl_role)r, &m->scene, &err);
  if (err.status == TDM_OK)
    return true;
  if (m->candidate->unready) /* is told once */
    cpl_not_seen(m->verdict, "it is not READY");
  cpl_broken(m->verdict, "READY, as section 4 has it", "%s%s%s", err.path, err.path[0] ? ": " : "", err.message);
  cpl_meeting_drop(m);
  return false;
}

bool cpl_meeting_open(cpl_meeting *m, cpl_candidate *c, cpl_verdict *v) {
  return cpl_meeting_meet(m, c, 0, v) && cpl_meeting_assign(m);
}

/* ---- windows ---- */

tdm_step cpl_meeting_next(const cpl_meeting *m, long n) {
  const double dt = m->settings.dt;
  return (tdm_step){.window = m->window,
                    .t0 = (double)m->step * dt,
                    .t1 = (double)(m->step + (uint64_t)n) * dt,
                    .nstep = (uint64_t)n,
                    .nbody = m->settings.nbody};
}

tdm_state *cpl_meeting_rest(const cpl_meeting *m) {
  const int n = m->settings.nbody;
  tdm_state *state = calloc((size_t)n + 1, sizeof *state);
  for (int i = 0; state && i < n; i++) {
    state[i] = m->session.body[i].state;
    state[i].twist = (tdm_twist){0};
  }
  return state;
}

bool cpl_meeting_solve(cpl_meeting *m, const tdm_step *step, tdm_result *result) {
  tdm_error err = {0};
  if (cpl_session_step(&m->session, m->candidate->role, step, result, &err) != TDM_OK) {
    char expected[128];
    snprintf(expected, sizeof expected, "RESULT for a STEP from %g s to %g s", step->t0, step->t1);
    cpl_broken(m->verdict, expected, "%s", err.message);
    return false;
  }
  m->window++;
  m->step += step->nstep;
  return true;
}

bool cpl_meeting_send(cpl_meeting *m, const tdm_frame *frame) {
  return tdm_transport_send(m->session.transport, &m->session.partner[m->candidate->role].peer, frame, NULL) == TDM_OK;
}

/* ---- end ---- */

bool cpl_meeting_ended(cpl_meeting *m, double seconds, char *how, size_t size) {
  const double end = tdm_clock() + seconds;
  cpl_child *child = m->session.partner[m->candidate->role].child;
  while (cpl_child_running(child, how, size)) {
    if (tdm_clock() > end)
      return false;
    nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
  }
  return true;
}

static void let_go(cpl_meeting *m, double wait) {
  for (int r = 0; r < CPL_NROLE; r++)
    cpl_child_stop(&m->session.partner[r].child, wait);
  tdm_frame_free(&m->kept);
  cpl_settings_free(&m->settings);
  tdm_scene_destroy(&m->scene);
}

void cpl_meeting_finish(cpl_meeting *m) {
  char how[96];
  const double grace = m->candidate->timeout;
  cpl_child *child[CPL_NROLE]; /* the session forgets them */
  for (int r = 0; r < CPL_NROLE; r++)
    child[r] = m->session.partner[r].child;
  cpl_session_close(&m->session, NULL);
  for (int r = 0; r < CPL_NROLE; r++)
    m->session.partner[r].child = child[r];
  if (!cpl_meeting_ended(m, grace, how, sizeof how))
    cpl_broken(m->verdict, "its end with exit status 0 after FINISH", "it goes on for more than %g s", grace);
  else if (strcmp(how, "exit status 0") != 0)
    cpl_broken(m->verdict, "its end with exit status 0 after FINISH", "%s", how);
  let_go(m, grace);
}

void cpl_meeting_drop(cpl_meeting *m) {
  cpl_child *child[CPL_NROLE];
  for (int r = 0; r < CPL_NROLE; r++)
    child[r] = m->session.partner[r].child;
  if (m->session.settings)
    cpl_session_close(&m->session, &(tdm_error){.status = TDM_ERR_PROTOCOL});
  for (int r = 0; r < CPL_NROLE; r++)
    m->session.partner[r].child = child[r];
  let_go(m, 0);
}
