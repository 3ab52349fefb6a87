/* A solver that misbehaves on purpose, in the place of dem, or of mbd when FAULT_ROLE says so. FAULT in the environment
 * says how:
 *
 *   version, garbage, truncated, oversized, multipart-like short frames   instead of HELLO or of the first RESULT
 *   silent     says HELLO, then nothing           quits     says HELLO and exits with status 3
 *   killed     kills itself in window FAULT_WINDOW          hangs   stops answering in that window
 *   nan        returns a load that is no number in that window
 *   moments, work, supplied, infinite   announce "interface" and "energy" and return such a moment, work or energy
 *   huge                     returns in that window a load that is too large
 *   sampled, sampled_state   returns there a recorded load, or a recorded state, that is no number
 *   output, wall             returns there a channel, or a wall time, that is no number
 *   zero                     (mbd) returns there a quaternion of norm 0
 *   norm, inertia, place     (mbd) announce a quaternion of norm 100, an inertia of -1, a place of 1e200
 *   channel, unit, twin   announce a channel of the name or unit FAULT_TEXT, or two of one name
 *   further    announces "matched_load" as well, and returns such a coefficient
 *   counts     returns a RESULT with other counts           late    returns the RESULT of another window
 *   checkpoint   announces "checkpoint"; FAULT_TEXT says what it does to it: forgets (reads nothing), remembers (in the
 * process, not in the file), lenient (takes files that are not there), or nothing wrong
 *   view       announces "view"; its answers are as FAULT_TEXT says: garbage, empty, kind (a snapshot where a scenery
 * is due), bodies (more than the scenery has) wordy      logs a line, then reports ERROR              deaf    ignores
 * FINISH and SIGTERM
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/base/log.h"
#include "protocol/wire/participant.h"
#include "protocol/wire/transport.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *fault;
static uint64_t fault_window;
static tdm_transport *transport;
static tdm_frame frame;
static int nbody, is_mbd;
static double counter = 1, remembered; /* of "checkpoint": all that its loads depend on */

static int is(const char *name) {
  return strcmp(fault, name) == 0;
}

/* faults of what RESULT carries by these capabilities */
static int is_extra(void) {
  return is("moments") || is("work") || is("supplied") || is("infinite") || is("further") || is("makes");
}

static void sleep_forever(void) {
  while (1)
    pause();
}

static void send_frame(void) {
  tdm_error err = {0};
  if (tdm_transport_send(transport, NULL, &frame, &err) != TDM_OK)
    exit(4);
}

static void send_json(tdm_message_type type, json_t *json) {
  tdm_control_write(&frame, type, 0, json, NULL);
  json_decref(json);
}

/* A frame that nobody should believe; false when the fault is another one. */
static int spoil(void) {
  if (is("version"))
    frame.data[4] = 77;
  else if (is("garbage"))
    memset(frame.data, 0xA5, frame.size);
  else if (is("truncated"))
    frame.size -= 3;
  else if (is("oversized")) {
    frame.data = realloc(frame.data, (size_t)TDM_FRAME_MAX + 4096);
    memset(frame.data + frame.size, 0, (size_t)TDM_FRAME_MAX + 4096 - frame.size);
    frame.size = frame.capacity = (size_t)TDM_FRAME_MAX + 4096;
  } else
    return 0;
  return 1;
}

/* Numbers that are right, but for the fault. */
static void fill(tdm_result *r, int now) {
  for (int i = 0; i < r->nstate; i++)
    r->state[i].pose.orientation.w = is("zero") && now ? 0 : 1;
  for (int i = 0; i < r->nsample * r->nstate; i++)
    r->sample_state[i].pose.orientation.w = is("sampled_state") && now ? NAN : 1;
  for (int i = 0; i < r->ninterface; i++)
    r->body[i].end.pose.orientation.w = 1;
  if (is("huge") && now)
    r->load[0].force.x = 1e200;
  for (int i = 0; i < r->nsample && is("sampled") && now; i++)
    r->sample_load[i].moment.z = NAN;
  for (int i = 0; i < r->nsample && r->nchannel && now; i++)
    r->channel[i] = INFINITY;
  r->wall = is("wall") && now ? NAN : 0;
}

static void answer_step(const tdm_header *header) {
  tdm_step step;
  tdm_frame step_store = {0}, result_store = {0};
  tdm_error err = {0};
  if (tdm_step_read(&step, header, &step_store, &err) != TDM_OK)
    exit(5);
  tdm_result r = {.window = step.window, .t = step.t1, .nbody = nbody, .nload = !is_mbd, .nsample = step.nsample};
  r.nstate = is_mbd ? nbody : 0;
  r.nchannel = is("output");
  r.ninterface = is_extra() ? nbody : 0;
  r.has_energy = is_extra();
  r.nfurther = is("further") ? nbody : 0;
  if (step.window >= fault_window) {
    r.nload = is("counts") ? 3 : r.nload;
    r.window += is("late");
    if (is("killed"))
      raise(SIGKILL);
    if (is("hangs"))
      sleep_forever();
  }
  tdm_result_layout(&r, &result_store, &err);
  fill(&r, step.window >= fault_window);
  if (is("nan") && step.window >= fault_window)
    r.load[0].force.y = NAN;
  if (is("checkpoint"))
    r.load[0].force.x = counter = 1.5 * counter + (double)step.nstep;
  if (is_extra() && step.window >= fault_window) {
    r.body[0].moment[2].force.z = is("moments") ? NAN : 0;
    r.body[0].work = is("work") ? NAN : 0;
    if (is("further"))
      r.further[TDM_FURTHER - 1].moment.z = NAN;
    if (is("makes")) /* energy from nowhere */
      *r.energy = (tdm_energy){1, 1 + (double)step.window, 0, 0};
    else
      *r.energy = (tdm_energy){NAN, is("infinite") ? INFINITY : NAN, is("supplied") ? NAN : 0, 0};
  }
  tdm_result_write(&frame, &r, &err);
  if (step.window >= fault_window)
    spoil();
  if (step.window >= fault_window && (is("chatty") || is("mumbles") || is("wordy"))) {
    json_t *remark = json_pack("{s:s, s:s, s:s, s:i}", "event", "dust", "level", is("mumbles") ? "shout" : "warning",
                               "message", "it is dusty", "count", (int)step.window + 1);
    tdm_frame result = frame;
    frame = (tdm_frame){0};
    send_json(TDM_REMARKS, json_pack("{s:[o]}", "remarks", remark));
    send_frame();
    tdm_frame_free(&frame);
    frame = result;
  }
  if (is("wordy") && step.window >= fault_window) {
    tdm_log(TDM_LOG_INFO, "words", "last=words");
    send_json(TDM_ERROR, json_pack("{s:s, s:s, s:s}", "status", "TDM_ERR_SCENE", "path", "dem.depth", "message",
                                   "too deep; raise it"));
  }
  send_frame();
  tdm_frame_free(&step_store);
  tdm_frame_free(&result_store);
}

static void answer_checkpoint(const tdm_header *header) {
  const char *text = getenv("FAULT_TEXT") ? getenv("FAULT_TEXT") : "";
  json_t *question = NULL;
  tdm_control_read(header, &question, NULL);
  const char *name = json_string_value(json_object_get(question, "file"));
  const int writes = strcmp(json_string_value(json_object_get(question, "mode")), "write") == 0;
  FILE *file = fopen(name, writes ? "wb" : "rb");
  double kept = counter;
  const int good = file && (writes ? fwrite(&kept, sizeof kept, 1, file) : fread(&kept, sizeof kept, 1, file)) == 1;
  if (file)
    fclose(file);
  if (strcmp(text, "remembers") == 0 && writes)
    remembered = counter;
  if (!writes && strcmp(text, "forgets") != 0)
    counter = strcmp(text, "remembers") == 0 ? remembered : kept;
  if (good || strcmp(text, "lenient") == 0)
    send_json(TDM_CHECKPOINT, json_incref(question));
  else
    send_json(TDM_ERROR, json_pack("{s:s, s:s, s:s}", "status", "TDM_ERR_FILE", "path", "", "message", "no such file"));
  json_decref(question);
  send_frame();
}

static void answer_view(const tdm_header *header) {
  const char *text = getenv("FAULT_TEXT") ? getenv("FAULT_TEXT") : "";
  json_t *question = NULL;
  tdm_scenery scenery = {0};
  tdm_snapshot snapshot = {0};
  tdm_control_read(header, &question, NULL);
  const char *what = json_string_value(json_object_get(question, "what"));
  const int first = what && strcmp(what, "scenery") == 0 && strcmp(text, "kind") != 0;
  if (strcmp(text, "bodies") == 0 && !first) {
    tdm_snapshot_resize(&snapshot, 1, 0, 0, 0, NULL);
    snapshot.pose[0] = (tdm_pose){.orientation = {1, 0, 0, 0}};
  }
  json_decref(question);
  if (strcmp(text, "empty") == 0) {
    tdm_control_write(&frame, TDM_VIEW, 0, NULL, NULL);
  } else {
    tdm_view_write(&frame, 0, first ? &scenery : NULL, &snapshot, NULL);
    if (strcmp(text, "garbage") == 0)
      memset(frame.data + TDM_HEADER_BYTES, 0xA5, frame.size - TDM_HEADER_BYTES);
  }
  tdm_snapshot_free(&snapshot);
  send_frame();
}

/* channels of READY; NULL: none */
static json_t *channels(void) {
  const char *text = getenv("FAULT_TEXT") ? getenv("FAULT_TEXT") : "";
  if (is("output"))
    return json_pack("[{s:s, s:s}]", "name", "belt.speed", "unit", "m/s");
  if (is("channel"))
    return json_pack("[{s:s, s:s}]", "name", text, "unit", "m");
  if (is("unit"))
    return json_pack("[{s:s, s:s}]", "name", "x", "unit", text);
  if (is("twin"))
    return json_pack("[{s:s, s:s}, {s:s, s:s}]", "name", "x", "unit", "m", "name", "x", "unit", "m");
  return NULL;
}

/* bodies of mbd's READY */
static json_t *bodies(const json_t *assign) {
  json_t *array = json_array(), *body;
  size_t i;
  json_array_foreach(json_object_get(assign, "bodies"), i, body) {
    double inertia = is("inertia") ? -1 : 1, x = is("place") ? 1e200 : 0, w = is("norm") ? 100 : 1;
    json_t *moments = json_pack("[f,f,f,f,f,f,f,f,f]", inertia, 0., 0., 0., 1., 0., 0., 0., 1.);
    json_t *state = json_pack("[f,f,f,f,f,f,f,f,f,f,f,f,f]", x, 0., 0., w, 0., 0., 0., 0., 0., 0., 0., 0., 0.);
    json_array_append_new(array, json_pack("{s:O, s:f, s:o, s:o}", "name", json_object_get(body, "name"), "mass", 1.,
                                           "inertia", moments, "state", state));
  }
  return array;
}

static void answer_assign(const tdm_header *header) {
  json_t *json, *loads = json_array();
  tdm_error err = {0};
  if (tdm_control_read(header, &json, &err) != TDM_OK)
    exit(6);
  nbody = (int)json_array_size(json_object_get(json, "bodies"));
  json_t *announced = is_mbd ? bodies(json) : json_array();
  json_decref(json);
  for (int i = 0; i < nbody; i++)
    json_array_append_new(loads, json_pack("[f,f,f,f,f,f]", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0));
  send_json(TDM_READY, json_pack("{s:o, s:o, s:o*}", "loads", loads, "bodies", announced, "channels", channels()));
  send_frame();
}

int main(int argc, char **argv) {
  const char *window = getenv("FAULT_WINDOW"), *endpoint = argc > 2 ? argv[2] : "";
  tdm_error err = {0};
  fault = getenv("FAULT") ? getenv("FAULT") : "";
  is_mbd = getenv("FAULT_ROLE") && strcmp(getenv("FAULT_ROLE"), "mbd") == 0;
  fault_window = window ? strtoull(window, NULL, 10) : 0;
  tdm_log_open(stderr, "faulty");
  tdm_log(TDM_LOG_INFO, "start", "fault=%s", fault);
  if (is("deaf"))
    signal(SIGTERM, SIG_IGN);
  if (tdm_transport_connect(&transport, endpoint, NULL, &err) != TDM_OK)
    return 2;
  json_t *capabilities = is("further") ? json_pack("[s, s, s, s]", "interface", "energy", "proxy", "matched_load")
                         : is_extra()  ? json_pack("[s, s]", "interface", "energy")
                         : is("view") || is("checkpoint") ? json_pack("[s]", fault)
                                                          : json_array();
  send_json(TDM_HELLO, json_pack("{s:s, s:s, s:s, s:o}", "name", "faulty", "role", is_mbd ? "mbd" : "dem", "software",
                                 "faulty 1.0", "capabilities", capabilities));
  if (!window)
    spoil();
  send_frame();
  if (is("quits")) {
    tdm_log(TDM_LOG_ERROR, "quits", "reason=mood");
    tdm_transport_close(&transport);
    return 3;
  }
  if (is("silent"))
    sleep_forever();
  while (1) {
    const void *data;
    size_t size;
    tdm_header header;
    if (tdm_transport_receive(transport, 1000, NULL, &data, &size, &err) != TDM_OK)
      return 7;
    if (!data || tdm_header_read(&header, data, size, &err) != TDM_OK)
      continue;
    if (header.type == TDM_ASSIGN)
      answer_assign(&header);
    if (header.type == TDM_VIEW)
      answer_view(&header);
    if (header.type == TDM_CHECKPOINT)
      answer_checkpoint(&header);
    if (header.type == TDM_STEP)
      answer_step(&header);
    if ((header.type == TDM_FINISH || header.type == TDM_ERROR) && !is("deaf"))
      break;
  }
  tdm_transport_close(&transport);
  tdm_frame_free(&frame);
  return 0;
}
