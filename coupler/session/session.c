/* A session: see session.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/session/session.h"

#include "coupler/settings/scheme.h"
#include "protocol/app/command_line.h"
#include "protocol/base/log.h"
#include "protocol/scene/json.h"
#include "protocol/scene/remark.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SLICE_MS = 100, LAST_LINES = 4 };
static const double heartbeat_interval = 0.5; /* [s] */

/* ---- errors that name a partner ---- */

/* Put the partner's name in front of an error, and the last lines of its log behind it. */
static tdm_status blame(cpl_session *s, int role, tdm_error *err, bool with_log) {
  cpl_partner *p = &s->partner[role];
  char message[TDM_MESSAGE_MAX], lines[512] = "";
  const char *refused = !p->connected && s->refused[0] ? s->refused : "";
  if (with_log && p->child)
    cpl_child_last_lines(p->child, LAST_LINES, lines, sizeof lines);
  snprintf(message, sizeof message, "%s%s%s%s: %.380s%s%s%s%s", cpl_session_name(s, (cpl_role)role),
           p->software[0] ? " (" : "", p->software, p->software[0] ? ")" : "", err->message,
           refused[0] ? "; what came from it was refused: " : "", refused, lines[0] ? "; its last log lines: " : "",
           lines);
  tdm_utf8_clean(message);
  memcpy(err->message, message, sizeof message);
  return err->status;
}

static tdm_status blame_new(cpl_session *s, int role, tdm_status status, bool with_log, tdm_error *err,
                            const char *message) {
  tdm_fail(err, status, NULL, "%s", message);
  return blame(s, role, err, with_log);
}

/* ---- receiving ---- */

static void send_error(cpl_session *s, const tdm_peer *peer, const tdm_error *reason) {
  json_t *json = tdm_error_to_json(reason);
  if (tdm_control_write(&s->out, TDM_ERROR, 0, json, NULL) == TDM_OK)
    tdm_transport_send(s->transport, peer, &s->out, NULL);
  json_decref(json);
}

/* A frame from somebody who is no partner: a HELLO makes a partner of it, anything else is answered and forgotten. */
static void meet_stranger(cpl_session *s, const tdm_peer *peer, const void *data, size_t size) {
  tdm_error reason = {0};
  tdm_header header;
  json_t *hello = NULL;
  char quoted[TDM_MESSAGE_MAX];
  if (tdm_header_read(&header, data, size, &reason) == TDM_OK && header.type != TDM_HELLO)
    tdm_fail(&reason, TDM_ERR_PROTOCOL, NULL, "%s came before HELLO", tdm_message_name(header.type));
  if (reason.status == TDM_OK && tdm_control_read(&header, &hello, &reason) == TDM_OK) {
    const char *role = json_string_value(json_object_get(hello, "role"));
    const char *name = json_string_value(json_object_get(hello, "name"));
    const char *software = json_string_value(json_object_get(hello, "software"));
    int which = -1;
    for (int r = 0; role && r < CPL_NROLE; r++)
      if (strcmp(role, cpl_role_names[r]) == 0)
        which = r;
    if (which < 0)
      tdm_fail(&reason, TDM_ERR_PROTOCOL, NULL, "malformed HELLO: the role must be \"mbd\" or \"dem\"");
    else if (s->partner[which].connected)
      tdm_fail(&reason, TDM_ERR_PROTOCOL, NULL, "the role %s is taken by %s; a run has one solver of each role", role,
               cpl_session_name(s, (cpl_role)which));
    else {
      cpl_partner *p = &s->partner[which];
      p->connected = true;
      p->peer = *peer;
      tdm_recorder_add(s->recorder, which, TDM_FROM_SOLVER, data, size);
      snprintf(p->name, sizeof p->name, "%.60s", name && *name ? name : role);
      snprintf(p->software, sizeof p->software, "%.120s", software ? software : "unknown software");
      tdm_utf8_clean(p->name);
      tdm_utf8_clean(p->software);
      p->capabilities = json_incref(json_object_get(hello, "capabilities"));
      tdm_log(TDM_LOG_INFO, "hello", "role=%s name=%s software=%s", role, p->name,
              tdm_log_quote(quoted, sizeof quoted, p->software));
    }
  }
  json_decref(hello);
  if (reason.status != TDM_OK) {
    snprintf(s->refused, sizeof s->refused, "%.250s", reason.message);
    tdm_remark(TDM_WARNING, "stranger", NULL, NAN, "a stranger was turned away: %.900s", reason.message);
    send_error(s, peer, &reason);
  }
}

/* A protocol version that does not match cannot say HELLO; while partners are missing it is worth ending for. */
static tdm_status check_version(cpl_session *s, const void *data, size_t size, tdm_error *err) {
  tdm_header header;
  tdm_error reason = {0};
  if (tdm_header_read(&header, data, size, &reason) != TDM_ERR_VERSION)
    return TDM_OK;
  for (int r = 0; r < CPL_NROLE; r++)
    if (!s->partner[r].connected)
      return tdm_fail(err, reason.status, NULL, "a solver that wants to join: %.900s", reason.message);
  return TDM_OK;
}

static void beat(cpl_session *s, double now) {
  if (now - s->last_heartbeat < heartbeat_interval)
    return;
  s->last_heartbeat = now;
  for (int r = 0; r < CPL_NROLE; r++)
    if (s->partner[r].connected && tdm_control_write(&s->out, TDM_HEARTBEAT, 0, NULL, NULL) == TDM_OK)
      tdm_transport_send(s->transport, &s->partner[r].peer, &s->out, NULL); /* a lost partner is found elsewhere */
}

void cpl_session_beat(cpl_session *s) {
  beat(s, tdm_clock());
}

/* Waiting for a partner: how long it has been silent. Only time spent listening counts, so that a run that was stopped
 * (Ctrl-Z) may go on. */
typedef struct {
  int role;
  double last_look, silence; /* [s] */
  int deaths;                /* looks at which a child was found dead */
} wait;

static tdm_status check_children(cpl_session *s, wait *w, tdm_error *err) {
  char how[96], message[256];
  for (int r = 0; r < CPL_NROLE; r++)
    if (s->partner[r].child && !cpl_child_running(s->partner[r].child, how, sizeof how)) {
      if (++w->deaths < 2)
        return TDM_OK; /* its last words may still be under way */
      snprintf(message, sizeof message, "the solver ended before the run did (%s)", how);
      return blame_new(s, r, TDM_ERR_LOST, true, err, message);
    }
  return TDM_OK;
}

/* After each look for a message: interrupts, signs of life to all, dead children, a partner that is silent too long. */
static tdm_status check_health(cpl_session *s, wait *w, bool empty, tdm_error *err) {
  const double longest_look = 2e-3 * SLICE_MS;
  double now = tdm_clock(), passed = now - w->last_look;
  char message[256];
  w->last_look = now;
  w->silence += passed < longest_look ? passed : longest_look;
  if (tdm_interrupted)
    return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted; what was computed until then is kept");
  beat(s, now);
  if (empty && check_children(s, w, err) != TDM_OK)
    return err->status;
  if (s->settings->by_hand[w->role] && !s->partner[w->role].connected) {
    if (w->silence <= s->settings->join_timeout)
      return TDM_OK;
    snprintf(message, sizeof message, "it was not started within %g s; start it with --connect %s",
             s->settings->join_timeout, tdm_transport_endpoint(s->transport));
    return blame_new(s, w->role, TDM_ERR_TIMEOUT, true, err, message);
  }
  if (w->silence <= s->settings->timeout)
    return TDM_OK;
  snprintf(message, sizeof message,
           "no answer for %g s; it hangs, or its work takes longer: then raise coupling.timeout", s->settings->timeout);
  return blame_new(s, w->role, TDM_ERR_TIMEOUT, true, err, message);
}

/* The partner who sent this, or -1. */
static int who(const cpl_session *s, const tdm_peer *peer) {
  for (int r = 0; r < CPL_NROLE; r++)
    if (s->partner[r].connected && tdm_peer_equal(&s->partner[r].peer, peer))
      return r;
  return -1;
}

/* REMARKS: the solver's remarks so far replace those from before. */
static tdm_status take_remarks(cpl_session *s, int from, const tdm_header *header, tdm_error *err) {
  cpl_partner *p = &s->partner[from];
  json_t *json = NULL, *remarks = NULL;
  if (tdm_control_read(header, &json, err) == TDM_OK)
    remarks = tdm_remarks_from_json(json_object_get(json, "remarks"), cpl_role_names[from], err);
  const char *progress = json_string_value(json_object_get(json, "progress"));
  if (remarks && progress && !p->ready) {
    char text[160];
    snprintf(text, sizeof text, "%s: %.140s", cpl_session_name(s, (cpl_role)from), progress);
    tdm_utf8_clean(text);
    for (char *c = text; *c; c++)
      *c = (unsigned char)*c < ' ' || *c == 127 ? ' ' : *c;
    tdm_progress_say(&s->progress, text);
  }
  json_decref(json);
  if (!remarks)
    return blame(s, from, err, true);
  json_decref(p->remarks);
  p->remarks = remarks;
  s->remarks_taken++;
  return TDM_OK;
}

/* A frame of a partner: HEARTBEAT, REMARKS and the answer to a SAVE that nobody waits for are taken (*got stays false),
 * ERROR and what was not expected become err. */
static tdm_status hear(cpl_session *s, int from, int role, tdm_message_type type, const void *data, size_t size,
                       tdm_header *header, bool *got, tdm_error *err) {
  char message[160];
  if (tdm_header_read(header, data, size, err) != TDM_OK)
    return blame(s, from, err, true);
  tdm_recorder_add(s->recorder, from, TDM_FROM_SOLVER, data, size);
  if (header->type == TDM_HEARTBEAT)
    return TDM_OK;
  if (header->type == TDM_REMARKS)
    return take_remarks(s, from, header, err);
  if (header->type == TDM_SAVE && s->partner[from].saving > 0) {
    s->partner[from].saving--;
    return TDM_OK;
  }
  if (header->type == TDM_ERROR) {
    json_t *json = NULL;
    if (tdm_control_read(header, &json, err) == TDM_OK)
      tdm_error_from_json(json, err);
    json_decref(json);
    return blame(s, from, err, false);
  }
  if (from != role || header->type != type) {
    snprintf(message, sizeof message, "it sent %s where %s of %s was expected", tdm_message_name(header->type),
             tdm_message_name(type), cpl_role_names[role]);
    return blame_new(s, from, TDM_ERR_PROTOCOL, true, err, message);
  }
  *got = true;
  return TDM_OK;
}

/* Wait for a message of `type` from `role`; the header's payload lives until the next receive. HELLO: any partner's. */
static tdm_status wait_for(cpl_session *s, int role, tdm_message_type type, tdm_header *header, tdm_error *err) {
  wait w = {.role = role, .last_look = tdm_clock()};
  while (true) {
    tdm_peer peer;
    const void *data;
    size_t size;
    tdm_status status = tdm_transport_receive(s->transport, SLICE_MS, &peer, &data, &size, err);
    int from = data ? who(s, &peer) : -1;
    if (status == TDM_OK && from >= 0) {
      bool got = false;
      status = hear(s, from, role, type, data, size, header, &got, err);
      if (got)
        return TDM_OK;
      w.silence = from == role ? 0 : w.silence;
    } else if (status == TDM_OK && data) {
      if (check_version(s, data, size, err) != TDM_OK) {
        send_error(s, &peer, err);
        return err->status;
      }
      meet_stranger(s, &peer, data, size);
      if (type == TDM_HELLO && who(s, &peer) >= 0)
        return TDM_OK;
    }
    if (status == TDM_OK)
      status = check_health(s, &w, !data, err);
    if (status != TDM_OK)
      return status;
  }
}

/* Send s->out to a partner. When that fails, how the partner ended is worth more than that it cannot be reached. */
static tdm_status send_to(cpl_session *s, int role, tdm_error *err) {
  tdm_header header;
  tdm_error broken = {0};
  tdm_recorder_add(s->recorder, role, TDM_FROM_SERVER, s->out.data, s->out.size);
  if (tdm_transport_send(s->transport, &s->partner[role].peer, &s->out, &broken) == TDM_OK)
    return TDM_OK;
  if (wait_for(s, role, TDM_FINISH, &header, err) == TDM_OK)
    return blame_new(s, role, broken.status, true, err, broken.message);
  return err->status;
}

/* ---- start ---- */

tdm_status cpl_session_open(cpl_session *s, const cpl_settings *settings, const char *endpoint, void *context,
                            tdm_error *err) {
  size_t nbody = (size_t)settings->nbody + 1;
  *s = (cpl_session){.settings = settings, .warnings = json_array(), .seen_from = INFINITY};
  s->body = calloc(nbody, sizeof *s->body);
  s->load = calloc(nbody, sizeof *s->load);
  if (!s->body || !s->load)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  if (tdm_transport_listen(&s->transport, endpoint, context, err) == TDM_OK)
    return TDM_OK;
  if (settings->transport == CPL_TCP)
    snprintf(err->path, sizeof err->path, "coupling.address");
  return err->status;
}

static json_t *assigned_body(const cpl_session *s, int role, int i) {
  json_t *body = json_pack("{s:s}", "name", s->settings->body[i].name[role]);
  if (role == CPL_DEM) {
    const tdm_assigned_body *b = &s->body[i];
    json_object_set_new(body, "mass", tdm_number_to_json(b->mass));
    json_object_set_new(body, "inertia", tdm_numbers_to_json(&b->inertia.m[0][0], 9));
    json_object_set_new(body, "state", tdm_numbers_to_json((const double *)(const void *)&b->state, TDM_STATE_DOUBLES));
    tdm_part_write(b, body);
  }
  return body;
}

static tdm_status assign(cpl_session *s, int role, const tdm_scene *scene, tdm_error *err) {
  const cpl_settings *set = s->settings;
  json_t *bodies = json_array();
  for (int i = 0; i < set->nbody; i++)
    json_array_append_new(bodies, assigned_body(s, role, i));
  json_t *message = json_pack(
      "{s:o, s:f, s:f, s:f, s:I, s:s, s:f, s:o}", "scene", tdm_scene_section(scene->root, cpl_role_names[role]),
      "start", 0.0, "end", set->time_end, "dt", set->dt, "n", (json_int_t)set->n, "interpolation",
      cpl_session_interpolation(s) == TDM_LINEAR ? "linear" : "hermite", "timeout", set->timeout, "bodies", bodies);
  json_object_set_new(message, "remarks", json_true());
  json_t *results = json_array();
  for (int i = 0; i < CPL_NEXTRA; i++)
    if (cpl_session_asks(s, (cpl_role)role, cpl_extras[i].name))
      json_array_append_new(results, json_string(cpl_extras[i].name));
  if (json_array_size(results) > 0)
    json_object_set(message, "results", results);
  json_decref(results);
  if (cpl_session_asks(s, (cpl_role)role, "ahead"))
    json_object_set_new(message, "ahead", json_real(cpl_first_window(set)));
  const unsigned needs = cpl_session_needs(s, (cpl_role)role);
  if (cpl_session_restores(s))
    json_object_set_new(message, "restores", json_true());
  if (needs & CPL_PROXY)
    json_object_set_new(message, "proxy", json_true());
  if (needs & CPL_SENT_VELOCITY)
    json_object_set_new(message, "wall_velocity", json_string("sent"));
  tdm_status status = tdm_control_write(&s->out, TDM_ASSIGN, 0, message, err);
  if (status == TDM_OK)
    status = send_to(s, role, err);
  json_decref(message);
  return status;
}

tdm_status cpl_session_wait(cpl_session *s, cpl_role role, tdm_message_type type, tdm_header *header, tdm_error *err) {
  return wait_for(s, role, type, header, err);
}

tdm_status cpl_session_meet(cpl_session *s, cpl_role role, tdm_error *err) {
  tdm_header header;
  while (!s->partner[role].connected)
    if (wait_for(s, role, TDM_HELLO, &header, err) != TDM_OK)
      return err->status;
  return TDM_OK;
}

tdm_status cpl_session_assign(cpl_session *s, cpl_role role, const tdm_scene *scene, tdm_error *err) {
  tdm_header header;
  if (assign(s, role, scene, err) != TDM_OK || wait_for(s, role, TDM_READY, &header, err) != TDM_OK)
    return err->status;
  if (cpl_session_read_ready(s, role, &header, err) != TDM_OK)
    return blame(s, role, err, true);
  tdm_log(TDM_LOG_INFO, "ready", "role=%s channels=%d", cpl_role_names[role], s->partner[role].nchannel);
  return TDM_OK;
}

tdm_status cpl_session_start(cpl_session *s, const tdm_scene *scene, tdm_error *err) {
  for (int r = 0; r < CPL_NROLE; r++)
    if (cpl_session_meet(s, (cpl_role)r, err) != TDM_OK)
      return err->status;
  if (cpl_session_choose(s, err) != TDM_OK)
    return err->status;
  /* mbd first: its READY has the bodies that dem needs */
  for (int r = 0; r < CPL_NROLE; r++)
    if (cpl_session_assign(s, (cpl_role)r, scene, err) != TDM_OK)
      return err->status;
  cpl_session_compare(s);
  return TDM_OK;
}

/* ---- windows ---- */

tdm_status cpl_session_step(cpl_session *s, cpl_role role, const tdm_step *step, tdm_result *result, tdm_error *err) {
  cpl_partner *p = &s->partner[role];
  tdm_header header;
  if (tdm_interrupted)
    return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted at %g s; what was computed until then is kept",
                    step->t0);
  double begin = tdm_clock();
  tdm_status status = tdm_step_write(&s->out, step, err);
  if (status != TDM_OK)
    return status;
  status = send_to(s, role, err);
  if (status != TDM_OK)
    return status;
  status = wait_for(s, role, TDM_RESULT, &header, err);
  if (status != TDM_OK)
    return status;
  if (tdm_result_read(result, &header, &p->store, err) != TDM_OK ||
      cpl_session_check_result(s, role, step, result, err) != TDM_OK)
    return blame(s, role, err, true);
  p->step_time += result->wall;
  p->trip_time += tdm_clock() - begin;
  return TDM_OK;
}

/* Send a question (owned). */
static tdm_status put(cpl_session *s, cpl_role role, tdm_message_type type, json_t *question, tdm_error *err) {
  tdm_status status = tdm_control_write(&s->out, type, 0, question, err);
  json_decref(question);
  return status == TDM_OK ? send_to(s, role, err) : status;
}

/* Send a question (owned), and wait for the answer of the same type. */
static tdm_status ask(cpl_session *s, cpl_role role, tdm_message_type type, json_t *question, tdm_header *answer,
                      tdm_error *err) {
  tdm_status status = put(s, role, type, question, err);
  return status == TDM_OK ? wait_for(s, role, type, answer, err) : status;
}

tdm_status cpl_session_view(cpl_session *s, cpl_role role, cpl_sight sight, tdm_header *header, tdm_error *err) {
  json_t *question = json_pack("{s:s}", "what", sight == CPL_SCENERY ? "scenery" : "snapshot");
  if (question && sight == CPL_SNAPSHOT_WITH_CONTACTS)
    json_object_set_new(question, "contacts", json_true());
  return ask(s, role, TDM_VIEW, question, header, err);
}

tdm_status cpl_session_save(cpl_session *s, cpl_role role, int slot, tdm_error *err) {
  tdm_status status = put(s, role, TDM_SAVE, json_pack("{s:i}", "slot", slot), err);
  s->partner[role].saving += status == TDM_OK;
  return status;
}

tdm_status cpl_session_restore(cpl_session *s, cpl_role role, int slot, tdm_error *err) {
  tdm_header answer;
  return ask(s, role, TDM_RESTORE, json_pack("{s:i}", "slot", slot), &answer, err);
}

/* ---- end ---- */

void cpl_session_close(cpl_session *s, const tdm_error *err) {
  for (int r = 0; r < CPL_NROLE; r++) {
    cpl_partner *p = &s->partner[r];
    if (p->connected && s->transport) {
      if (err && err->status != TDM_OK && err->status != TDM_ERR_INTERRUPTED)
        send_error(s, &p->peer, &(tdm_error){.status = TDM_ERR_INTERRUPTED, .message = "the run was given up"});
      else if (tdm_control_write(&s->out, TDM_FINISH, 0, NULL, NULL) == TDM_OK)
        tdm_transport_send(s->transport, &p->peer, &s->out, NULL);
    }
    json_decref(p->capabilities);
    json_decref(p->report);
    json_decref(p->remarks);
    free(p->channel);
    free(p->initial);
    tdm_frame_free(&p->store);
  }
  tdm_transport_close(&s->transport);
  tdm_frame_free(&s->out);
  json_decref(s->warnings);
  json_decref(s->bodies);
  free(s->body);
  free(s->load);
  free(s->acceleration);
  free(s->prescribed);
  free(s->path.time);
  free(s->path.state);
  free(s->mobility.Y); /* the first in its block */
  *s = (cpl_session){0};
}
