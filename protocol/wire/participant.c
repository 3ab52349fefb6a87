/* The participant API: see participant.h. */
/* SPDX-License-Identifier: MIT */
#include "protocol/wire/participant.h"

#include "protocol/base/interrupt.h"
#include "protocol/base/log.h"
#include "protocol/base/memory.h"
#include "protocol/base/progress.h"
#include "protocol/scene/json.h"
#include "protocol/scene/remark.h"
#include "protocol/scene/scene.h"
#include "protocol/wire/transport.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SLICE_MS = 100 };
static const double alive_interval = 0.5; /* [s] between two HEARTBEATs */

struct tdm_participant {
  tdm_participant_def def;
  tdm_transport *transport;
  tdm_frame out, step_store, result_store;
  json_t *assign; /* the ASSIGN message: the assignment points into it */
  tdm_assigned_body *body;
  int nbody, nchannel;
  bool acceleration, mobility, interface, energy, matched_load; /* asked for */
  bool is_mbd, finished;                                        /* finished: the server said FINISH or was lost */
  double last_sent, step_start;
  double last_look, silence; /* when it last listened; how long nothing came while it listened [s] */
  uint64_t window;
  double t1; /* end of the window under way */
  tdm_keeper keeper;
  tdm_shower shower;
  tdm_scenery scenery; /* what shower fills */
  tdm_snapshot snapshot;
  bool tells;                       /* the server wants REMARKS */
  uint64_t told;                    /* changes of the remarks that it knows */
  double last_progress;             /* when it was last told what the solver is at [s] */
  tdm_remarks remarks;              /* of this solver's thread */
  tdm_remarks *kept[TDM_SLOTS_MAX]; /* those of the states that were saved; NULL: none */
};

tdm_participant_def tdm_participant_default_def(void) {
  return (tdm_participant_def){.name = "solver", .role = "dem", .software = "unknown", .timeout = 30};
}

/* ---- sending and receiving ---- */

static tdm_status send_frame(tdm_participant *p, tdm_error *err) {
  p->last_sent = tdm_clock();
  return tdm_transport_send(p->transport, NULL, &p->out, err);
}

static tdm_status send_control(tdm_participant *p, tdm_message_type type, const json_t *json, tdm_error *err) {
  tdm_status status = tdm_control_write(&p->out, type, p->window, json, err);
  return status == TDM_OK ? send_frame(p, err) : status;
}

/* REMARKS, if there is something new since the last, or to say what the solver is at (NULL: not to be said). */
static tdm_status send_remarks(tdm_participant *p, const char *progress, tdm_error *err) {
  if (!p->tells || (p->told == p->remarks.changes && !progress))
    return TDM_OK;
  p->told = p->remarks.changes;
  json_t *json = json_pack("{s:o}", "remarks", tdm_remarks_to_json(&p->remarks, NULL));
  if (progress)
    json_object_set_new(json, "progress", json_string(progress));
  tdm_status status = send_control(p, TDM_REMARKS, json, err);
  json_decref(json);
  return status;
}

/* Count time without a word from the server. Only time spent listening counts: a process that was stopped (Ctrl-Z) and
 * goes on has not been left alone. Returns true when it is too long. */
static bool count_silence(tdm_participant *p, bool heard, double most) {
  double now = tdm_clock(), passed = now - p->last_look;
  p->last_look = now;
  p->silence = heard ? 0 : p->silence + (passed < most ? passed : most);
  return p->silence > p->def.timeout;
}

/* Wait for the next message other than HEARTBEAT; ERROR from the server becomes err. */
static tdm_status receive(tdm_participant *p, tdm_header *header, tdm_error *err) {
  count_silence(p, true, 0);
  while (true) {
    const void *data;
    size_t size;
    tdm_status status = tdm_transport_receive(p->transport, SLICE_MS, NULL, &data, &size, err);
    if (status != TDM_OK)
      return status;
    if (count_silence(p, data != NULL, 2e-3 * SLICE_MS))
      return tdm_fail(err, TDM_ERR_TIMEOUT, NULL,
                      "nothing heard from the server at %s for %g s: it is not there, has ended or hangs",
                      p->def.endpoint, p->def.timeout);
    if (!data)
      continue;
    status = tdm_header_read(header, data, size, err);
    if (status != TDM_OK)
      return status;
    if (header->type == TDM_ERROR) {
      json_t *json = NULL;
      if (tdm_control_read(header, &json, err) == TDM_OK)
        tdm_error_from_json(json, err);
      json_decref(json);
      return err ? err->status : TDM_ERR_PROTOCOL;
    }
    if (header->type != TDM_HEARTBEAT)
      return TDM_OK;
  }
}

static tdm_status unexpected(const tdm_header *header, const char *expected, tdm_error *err) {
  return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "the server sent %s where %s was expected",
                  tdm_message_name(header->type), expected);
}

tdm_status tdm_participant_alive(tdm_participant *p) {
  if (!p)
    return tdm_interrupted ? TDM_ERR_INTERRUPTED : TDM_OK;
  if (p->finished)
    return TDM_ERR_INTERRUPTED;
  if (tdm_clock() - p->last_sent < alive_interval)
    return TDM_OK;
  tdm_error err = {0};
  const void *data;
  size_t size;
  tdm_header header;
  bool heard = false;
  /* listen first: when the server has gone there is nobody to send to */
  while (tdm_transport_receive(p->transport, 0, NULL, &data, &size, &err) == TDM_OK && data) {
    heard = true;
    if (tdm_header_read(&header, data, size, &err) != TDM_OK || header.type != TDM_HEARTBEAT)
      p->finished = true; /* FINISH or ERROR; nothing else may come while the solver works */
  }
  if (count_silence(p, heard, 4 * alive_interval))
    p->finished = true;
  if (!p->finished && (send_control(p, TDM_HEARTBEAT, NULL, &err) != TDM_OK || send_remarks(p, NULL, &err) != TDM_OK))
    p->finished = true;
  return p->finished ? TDM_ERR_INTERRUPTED : TDM_OK;
}

static _Thread_local tdm_progress alone_progress; /* of a solver without a server */

void tdm_participant_progress(tdm_participant *p, const char *format, ...) {
  double now = tdm_clock();
  if (p ? p->finished || now - p->last_progress < alive_interval : now - alone_progress.last < alive_interval)
    return;
  char text[160];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  if (p) {
    p->last_progress = now;
    send_remarks(p, text, NULL); /* that the server has gone is found elsewhere */
    return;
  }
  if (!alone_progress.unit)
    tdm_progress_begin(&alone_progress, 0, "", false);
  tdm_progress_say(&alone_progress, text);
}

void tdm_participant_progress_end(tdm_participant *p) {
  if (!p && alone_progress.unit)
    tdm_progress_end(&alone_progress);
  alone_progress = (tdm_progress){0};
}

/* ---- HELLO, ASSIGN, READY ---- */

tdm_status tdm_participant_connect(tdm_participant **participant, const tdm_participant_def *def, tdm_error *err) {
  assert(strcmp(def->role, "mbd") == 0 || strcmp(def->role, "dem") == 0);
  tdm_memory_watch_json();
  tdm_participant *p = calloc(1, sizeof *p);
  if (!p)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  p->def = *def;
  p->is_mbd = strcmp(def->role, "mbd") == 0;
  tdm_status status = tdm_transport_connect(&p->transport, def->endpoint, def->context, err);
  if (status == TDM_OK) {
    json_t *capabilities = json_array();
    for (int i = 0; i < def->ncapability; i++)
      json_array_append_new(capabilities, json_string(def->capabilities[i]));
    json_t *hello = json_pack("{s:s, s:s, s:s, s:o}", "name", def->name, "role", def->role, "software", def->software,
                              "capabilities", capabilities);
    status = send_control(p, TDM_HELLO, hello, err);
    json_decref(hello);
  }
  if (status != TDM_OK) {
    tdm_participant_finalize(&p, NULL);
    return status;
  }
  tdm_remarks_open(&p->remarks);
  *participant = p;
  return TDM_OK;
}

void tdm_part_read(tdm_assigned_body *body, tdm_object *json) {
  body->origin = tdm_get_vec3(json, "origin", &(tdm_vec3){0, 0, 0});
  body->mesh = tdm_has(json, "mesh") ? tdm_get_string(json, "mesh", NULL) : NULL;
  body->scale = tdm_get_number(json, "scale", 1, TDM_POSITIVE);
}

void tdm_part_write(const tdm_assigned_body *body, json_t *json) {
  if (body->mesh || tdm_norm(body->origin) > 0)
    json_object_set_new(json, "origin", tdm_numbers_to_json(&body->origin.x, 3));
  if (!body->mesh)
    return;
  json_object_set_new(json, "mesh", json_string(body->mesh));
  json_object_set_new(json, "scale", json_real(body->scale));
}

static void read_body(tdm_participant *p, tdm_assigned_body *body, json_t *json, const char *path, tdm_error *err) {
  tdm_object o = tdm_object_open(json, path, err);
  body->name = tdm_get_string(&o, "name", NULL);
  if (!p->is_mbd) {
    bool movable = tdm_has(&o, "mass") && !json_is_null(json_object_get(json, "mass"));
    body->mass = movable ? tdm_get_number(&o, "mass", TDM_REQUIRED, TDM_POSITIVE) : INFINITY;
    tdm_get_numbers(&o, "inertia", &body->inertia.m[0][0], 9, true);
    tdm_get_numbers(&o, "state", (double *)(void *)&body->state, TDM_STATE_DOUBLES, true);
    if (!err->status && movable && !tdm_is_inertia(&body->inertia))
      tdm_object_fail(&o, "inertia", "is not symmetric, or negative about some axis");
    if (!err->status && !tdm_quat_is_unit(body->state.pose.orientation))
      tdm_object_fail(&o, "state", "has a quaternion that is not of norm 1");
    tdm_part_read(body, &o);
  }
}

/* Whether ASSIGN's "results" has `name`. */
static bool asks(tdm_object *o, const char *name) {
  json_t *results = tdm_get_array(o, "results", false);
  bool found = false;
  for (size_t i = 0; i < json_array_size(results); i++) {
    const char *text = json_string_value(json_array_get(results, i));
    found = found || (text && strcmp(text, name) == 0);
  }
  return found;
}

static bool is_able(const tdm_participant *p, const char *capability) {
  for (int c = 0; c < p->def.ncapability; c++)
    if (strcmp(p->def.capabilities[c], capability) == 0)
      return true;
  return false;
}

/* A solver is asked only for what it has offered. */
static void refuse_unable(const tdm_participant *p, const tdm_assignment *a, tdm_object *o) {
  const struct {
    const char *capability, *key;
    bool asked;
  } wanted[] = {{"acceleration", "results", a->acceleration},
                {"mobility", "results", a->mobility},
                {"interface", "results", a->interface},
                {"energy", "results", a->energy},
                {"matched_load", "results", a->matched_load},
                {"restore", "restores", a->restores},
                {"proxy", "proxy", a->proxy},
                {"sent_velocity", "wall_velocity", a->sent_velocity}};
  for (size_t k = 0; k < sizeof wanted / sizeof wanted[0]; k++)
    if (wanted[k].asked && !is_able(p, wanted[k].capability))
      tdm_object_fail(o, wanted[k].key, "asks for the capability \"%s\", which this solver (%s) has not announced",
                      wanted[k].capability, p->def.role);
}

/* Keys that this version does not know are left alone: a newer server may send more. */
static void read_assignment(tdm_participant *p, tdm_assignment *a, tdm_error *err) {
  static const char *const interpolations[] = {"linear", "hermite"}, *const velocities[] = {"path", "sent"};
  tdm_object o = tdm_object_open(p->assign, "", err);
  tdm_object scene = tdm_get_object(&o, "scene", true);
  a->scene = scene.json;
  a->time_start = tdm_get_number(&o, "start", 0, TDM_ANY);
  a->time_end = tdm_get_number(&o, "end", TDM_REQUIRED, TDM_ANY);
  a->dt = tdm_get_number(&o, "dt", TDM_REQUIRED, TDM_POSITIVE);
  a->n = tdm_get_integer(&o, "n", TDM_REQUIRED_INT, 1);
  a->interpolation = (tdm_interpolation)tdm_get_choice(&o, "interpolation", interpolations, 2, TDM_LINEAR);
  p->def.timeout = tdm_get_number(&o, "timeout", p->def.timeout, TDM_POSITIVE);
  p->acceleration = a->acceleration = asks(&o, "acceleration");
  p->mobility = a->mobility = asks(&o, "mobility");
  p->interface = a->interface = asks(&o, "interface");
  p->energy = a->energy = asks(&o, "energy");
  p->matched_load = a->matched_load = asks(&o, "matched_load");
  a->ahead = tdm_get_number(&o, "ahead", 0, TDM_ANY);
  a->restores = tdm_get_bool(&o, "restores", false);
  a->proxy = tdm_get_bool(&o, "proxy", false);
  a->sent_velocity = tdm_get_choice(&o, "wall_velocity", velocities, 2, 0) == 1;
  p->tells = tdm_get_bool(&o, "remarks", false);
  refuse_unable(p, a, &o);
  json_t *bodies = tdm_get_array(&o, "bodies", true);
  p->nbody = (int)json_array_size(bodies);
  p->body = calloc((size_t)p->nbody + 1, sizeof *p->body);
  if (!p->body)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int i = 0; i < p->nbody && p->body; i++) {
    char path[TDM_PATH_MAX];
    read_body(p, &p->body[i], json_array_get(bodies, (size_t)i), tdm_path(path, &o, "bodies", i), err);
  }
  a->nbody = p->nbody;
  a->body = p->body;
}

tdm_status tdm_participant_initialize(tdm_participant *p, tdm_assignment *a, tdm_error *err) {
  tdm_error local = {0};
  err = err ? err : &local;
  tdm_header header;
  *a = (tdm_assignment){0};
  if (receive(p, &header, err) != TDM_OK)
    return err->status;
  if (header.type == TDM_FINISH) {
    p->finished = true;
    return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "the server ended the session before it began");
  }
  if (header.type != TDM_ASSIGN)
    return unexpected(&header, "ASSIGN", err);
  if (tdm_control_read(&header, &p->assign, err) != TDM_OK)
    return err->status;
  read_assignment(p, a, err);
  if (err->status == TDM_ERR_SCENE) { /* it is the server's message, not the user's scene, that is wrong */
    tdm_error scene = *err;
    *err = (tdm_error){0};
    tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed ASSIGN: %s: %.800s", scene.path, scene.message);
  }
  return err->status;
}

static json_t *ready_bodies(const tdm_participant *p, const tdm_ready *ready) {
  json_t *bodies = json_array();
  for (int i = 0; p->is_mbd && i < p->nbody; i++) {
    const tdm_assigned_body *b = &ready->body[i];
    json_t *mass = tdm_number_to_json(b->mass);
    json_t *body = json_pack("{s:s, s:o, s:o, s:o}", "name", b->name, "mass", mass, "inertia",
                             tdm_numbers_to_json(&b->inertia.m[0][0], 9), "state",
                             tdm_numbers_to_json((const double *)(const void *)&b->state, TDM_STATE_DOUBLES));
    tdm_part_write(b, body);
    if (b->nfree > 0)
      json_object_set_new(body, "free", tdm_numbers_to_json(&b->free[0].x, 3 * b->nfree));
    json_array_append_new(bodies, body);
  }
  return bodies;
}

static json_t *mobility_to_json(const tdm_mobility *mobility) {
  size_t n = tdm_mobility_doubles(mobility);
  double *block = calloc(n + 1, sizeof *block);
  if (!block)
    return NULL;
  tdm_mobility_copy(block, mobility);
  json_t *json = json_pack("{s:i, s:o}", "nfree", mobility->nfree, "numbers", tdm_numbers_to_json(block, (int)n));
  free(block);
  return json;
}

static json_t *path_to_json(const tdm_nodes *path) {
  const int n = path->nnode * path->nbody * TDM_STATE_DOUBLES;
  return json_pack("{s:o, s:o}", "times", tdm_numbers_to_json(path->time, path->nnode), "states",
                   tdm_numbers_to_json((const double *)(const void *)path->state, n));
}

static json_t *ready_to_json(const tdm_participant *p, const tdm_ready *ready) {
  json_t *loads = json_array(), *channels = json_array(), *warnings = json_array();
  for (int i = 0; !p->is_mbd && i < p->nbody; i++)
    json_array_append_new(loads,
                          tdm_numbers_to_json((const double *)(const void *)&ready->load[i], TDM_WRENCH_DOUBLES));
  for (int i = 0; i < ready->nchannel; i++) {
    const tdm_channel *c = &ready->channel[i];
    double initial = ready->initial[i];
    json_t *entry =
        json_pack("{s:s, s:s, s:o}", "name", c->name, "unit", c->unit, "initial", tdm_number_to_json(initial));
    if (c->gaps)
      json_object_set_new(entry, "gaps", json_true());
    json_array_append_new(channels, entry);
  }
  for (int i = 0; i < ready->nwarning; i++)
    json_array_append_new(
        warnings, json_pack("{s:s, s:s}", "path", ready->warning[i].path, "message", ready->warning[i].message));
  json_t *report = ready->report ? json_incref(ready->report) : json_object();
  json_t *json = json_pack("{s:o, s:o, s:o, s:o, s:o}", "bodies", ready_bodies(p, ready), "loads", loads, "channels",
                           channels, "warnings", warnings, "report", report);
  if (json && p->acceleration)
    json_object_set_new(json, "acceleration", tdm_numbers_to_json(ready->acceleration, 6 * p->nbody));
  if (json && p->mobility)
    json_object_set_new(json, "mobility", mobility_to_json(ready->mobility));
  if (json && ready->path && ready->path->nnode > 0)
    json_object_set_new(json, "path", path_to_json(ready->path));
  if (json && ready->prescribed) {
    json_t *flags = json_array();
    for (int i = 0; i < p->nbody; i++)
      json_array_append_new(flags, json_boolean(ready->prescribed[i]));
    json_object_set_new(json, "prescribed", flags);
  }
  if (json && ready->rest > 0 && isfinite(ready->rest))
    json_object_set_new(json, "rest", json_real(ready->rest));
  if (json && p->energy && ready->energy && isfinite(ready->energy->stored))
    json_object_set_new(json, "energy", tdm_numbers_to_json(&ready->energy->kinetic, 3));
  if (json && ready->gravity)
    json_object_set_new(json, "gravity", tdm_numbers_to_json(&ready->gravity->x, 3));
  return json;
}

tdm_status tdm_participant_ready(tdm_participant *p, const tdm_ready *ready, tdm_error *err) {
  json_t *json = ready_to_json(p, ready);
  if (!json)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "READY cannot be written: a name in it is not UTF-8");
  p->nchannel = ready->nchannel;
  tdm_status status = send_control(p, TDM_READY, json, err);
  json_decref(json);
  return status == TDM_OK ? send_remarks(p, NULL, err) : status;
}

/* ---- the loop ---- */

void tdm_participant_keep(tdm_participant *p, const tdm_keeper *keeper) {
  p->keeper = *keeper;
}

static tdm_status keep_remarks(tdm_participant *p, int slot, tdm_error *err) {
  if (!p->kept[slot])
    p->kept[slot] = calloc(1, sizeof *p->kept[slot]);
  if (!p->kept[slot])
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory to save the state");
  tdm_remarks_copy(p->kept[slot], &p->remarks);
  return TDM_OK;
}

static void bring_remarks_back(tdm_participant *p, int slot) {
  if (p->kept[slot] && (p->remarks.count > 0 || p->kept[slot]->count > 0))
    tdm_remarks_copy(&p->remarks, p->kept[slot]);
}

/* SAVE or RESTORE, answered by a message of the same type */
static tdm_status keep(tdm_participant *p, const tdm_header *header, tdm_error *err) {
  json_t *json = NULL;
  if (tdm_control_read(header, &json, err) != TDM_OK)
    return err->status;
  json_t *slot = json_object_get(json, "slot");
  json_int_t number = json_integer_value(slot);
  if (!json_is_integer(slot) || number < 0 || number >= TDM_SLOTS_MAX)
    tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed %s: \"slot\" must be a whole number from 0 to %d",
             tdm_message_name(header->type), TDM_SLOTS_MAX - 1);
  else if (header->type == TDM_SAVE && keep_remarks(p, (int)number, err) == TDM_OK)
    p->keeper.save(p->keeper.self, (int)number, err);
  else if (header->type == TDM_RESTORE && p->keeper.restore(p->keeper.self, (int)number, err) == TDM_OK)
    bring_remarks_back(p, (int)number);
  json_decref(json);
  if (err->status != TDM_OK)
    return err->status;
  json = json_pack("{s:I}", "slot", number);
  send_control(p, header->type, json, err);
  json_decref(json);
  return err->status;
}

void tdm_participant_show(tdm_participant *p, const tdm_shower *shower) {
  p->shower = *shower;
}

/* VIEW, answered by one with what there is to see; without payload where there is nothing to send. That no memory is
 * there for it, or no room in a message, is a warning: the run goes on. */
static tdm_status show(tdm_participant *p, const tdm_header *header, tdm_error *err) {
  json_t *json = NULL;
  if (tdm_control_read(header, &json, err) != TDM_OK)
    return err->status;
  const char *what = json_string_value(json_object_get(json, "what"));
  const bool scenery = what && strcmp(what, "scenery") == 0, snapshot = what && strcmp(what, "snapshot") == 0;
  p->snapshot.with_contacts = json_is_true(json_object_get(json, "contacts"));
  json_decref(json);
  if (!scenery && !snapshot)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed VIEW: \"what\" must be \"scenery\" or \"snapshot\"");
  tdm_error own = {0};
  tdm_status status = scenery ? p->shower.scenery(p->shower.self, &p->scenery, &own)
                              : p->shower.snapshot(p->shower.self, &p->snapshot, &own);
  if (status == TDM_OK)
    status = tdm_view_write(&p->out, p->window, scenery ? &p->scenery : NULL, &p->snapshot, &own);
  if (status == TDM_OK)
    return send_frame(p, err);
  tdm_remark(TDM_WARNING, "unseen", NULL, p->t1, "what there is to see cannot be told: %.900s", own.message);
  return send_remarks(p, NULL, err) == TDM_OK ? send_control(p, TDM_VIEW, NULL, err) : err->status;
}

/* A message that is answered here, between two windows. Returns false when it is none, or after an error. */
static bool answer(tdm_participant *p, const tdm_header *header, tdm_error *err) {
  if (p->keeper.save && (header->type == TDM_SAVE || header->type == TDM_RESTORE))
    return keep(p, header, err) == TDM_OK;
  return p->shower.scenery && header->type == TDM_VIEW && show(p, header, err) == TDM_OK;
}

bool tdm_participant_next(tdm_participant *p, tdm_step *step, tdm_result *result, tdm_error *err) {
  tdm_error own = {0};
  err = err ? err : &own;
  tdm_header header;
  do
    if (p->finished || receive(p, &header, err) != TDM_OK)
      return false;
  while (answer(p, &header, err));
  if (err->status != TDM_OK)
    return false;
  if (header.type == TDM_FINISH) {
    p->finished = true;
    return false;
  }
  p->step_start = p->last_look; /* when the message came */
  p->last_sent = p->step_start; /* the work begins: no sign of life is due before alive_interval */
  if (header.type != TDM_STEP) {
    unexpected(&header, "STEP", err);
    return false;
  }
  if (tdm_step_read(step, &header, &p->step_store, err) != TDM_OK)
    return false;
  if (step->nbody != p->nbody || (p->is_mbd ? step->nload == 0 && p->nbody > 0 : step->nstate != p->nbody)) {
    tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed STEP: %d bodies, %d states, %d load coefficients for %d bodies",
             step->nbody, step->nstate, step->nload, p->nbody);
    return false;
  }
  for (int i = 0; i < step->nstate; i++)
    if (!tdm_quat_is_unit(step->start[i].pose.orientation) || !tdm_quat_is_unit(step->end[i].pose.orientation)) {
      tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed STEP: body %d has a quaternion that is not of norm 1", i);
      return false;
    }
  p->window = step->window;
  p->t1 = step->t1;
  *result = (tdm_result){.window = step->window,
                         .nbody = p->nbody,
                         .nstate = p->is_mbd ? p->nbody : 0,
                         .nload = p->is_mbd ? 0 : 1,
                         .nsample = step->nsample,
                         .nchannel = p->nchannel,
                         .nacceleration = p->acceleration ? p->nbody : 0,
                         .has_mobility = p->mobility,
                         .ninterface = p->interface ? p->nbody : 0,
                         .nfurther = p->matched_load ? p->nbody : 0,
                         .has_energy = p->energy,
                         .mobility = {.nbody = p->nbody}};
  return tdm_result_layout(result, &p->result_store, err) == TDM_OK;
}

tdm_status tdm_participant_advance(tdm_participant *p, const tdm_result *result, tdm_error *err) {
  tdm_result r = *result;
  r.window = p->window;
  r.t = p->t1;
  r.wall = tdm_clock() - p->step_start;
  tdm_status status = send_remarks(p, NULL, err);
  if (status == TDM_OK)
    status = tdm_result_write(&p->out, &r, err);
  return status == TDM_OK ? send_frame(p, err) : status;
}

void tdm_participant_finalize(tdm_participant **participant, const tdm_error *err) {
  tdm_participant *p = participant ? *participant : NULL;
  if (!p)
    return;
  if (p->transport && err && err->status != TDM_OK) {
    json_t *json = tdm_error_to_json(err);
    send_remarks(p, NULL, NULL);
    send_control(p, TDM_ERROR, json, NULL);
    json_decref(json);
  }
  tdm_remarks_open(NULL);
  for (int k = 0; k < TDM_SLOTS_MAX; k++)
    free(p->kept[k]);
  tdm_transport_close(&p->transport);
  tdm_frame_free(&p->out);
  tdm_frame_free(&p->step_store);
  tdm_frame_free(&p->result_store);
  tdm_scenery_free(&p->scenery);
  tdm_snapshot_free(&p->snapshot);
  json_decref(p->assign);
  free(p->body);
  free(p);
  *participant = NULL;
}

/* ---- a solver as a table of operations ---- */

tdm_status tdm_participant_run(const tdm_solver_ops *ops, const tdm_participant_def *def, tdm_error *err) {
  tdm_participant *p = NULL;
  tdm_assignment assignment;
  tdm_ready ready = {0};
  void *self = NULL;
  char quoted[TDM_MESSAGE_MAX];
  tdm_status status = tdm_participant_connect(&p, def, err);
  if (status == TDM_OK)
    status = tdm_participant_initialize(p, &assignment, err);
  const bool unused = p && p->finished; /* FINISH came first: an end like any other */
  if (unused) {
    *err = (tdm_error){0};
    status = TDM_OK;
  } else if (status == TDM_OK) {
    tdm_log(TDM_LOG_INFO, "assigned", "bodies=%d dt=%g n=%ld end=%g", assignment.nbody, assignment.dt, assignment.n,
            assignment.time_end);
    status = ops->create(&self, &assignment, &ready, p, err);
  }
  if (status == TDM_OK && !unused)
    status = tdm_participant_ready(p, &ready, err);
  if (status == TDM_OK && !unused) {
    for (int i = 0; i < ready.nwarning; i++)
      tdm_log(TDM_LOG_WARNING, "doubtful", "path=%s message=%s", ready.warning[i].path,
              tdm_log_quote(quoted, sizeof quoted, ready.warning[i].message));
    tdm_log(TDM_LOG_INFO, "ready", "channels=%d warnings=%d", ready.nchannel, ready.nwarning);
    tdm_keeper keeper = {.self = self, .save = ops->save, .restore = ops->restore};
    tdm_participant_keep(p, &keeper);
    tdm_shower shower = {.self = self, .scenery = ops->scenery, .snapshot = ops->snapshot};
    tdm_participant_show(p, &shower);
    tdm_step step;
    tdm_result result;
    while (status == TDM_OK && tdm_participant_next(p, &step, &result, err)) {
      status = ops->step(self, &step, &result, err);
      if (status == TDM_OK)
        status = tdm_participant_advance(p, &result, err);
    }
    status = err->status;
  }
  if (status != TDM_OK)
    tdm_log(TDM_LOG_ERROR, "failed", "status=%s path=%s message=%s", tdm_status_name(status), err->path,
            tdm_log_quote(quoted, sizeof quoted, err->message));
  else
    tdm_log(TDM_LOG_INFO, "finished", "windows=%llu", (unsigned long long)(p->window + 1));
  tdm_participant_finalize(&p, err);
  ops->destroy(self);
  return status;
}
