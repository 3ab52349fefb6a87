/* Plays one solver of a recorded exchange: see replay.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/record/replay.h"

#include "protocol/base/log.h"
#include "protocol/wire/transport.h"

#include <string.h>

typedef struct {
  tdm_record record;
  tdm_transport *transport;
  double timeout; /* [s] */
  tdm_frame out;
  tdm_replay_report *report;
  int role;
  json_t *remarks; /* that the solver had made, of the last REMARKS; owned */
  bool tells;      /* the server wants REMARKS */
  bool finished;
} replay;

/* The server's next frame that is no HEARTBEAT. */
static tdm_status hear(replay *r, tdm_header *header, const void **frame, size_t *size, tdm_error *err) {
  double silence = 0, last = tdm_clock();
  while (silence <= r->timeout) {
    if (tdm_transport_receive(r->transport, 200, NULL, frame, size, err) != TDM_OK)
      return err->status;
    const double now = tdm_clock(), passed = now - last;
    silence = *frame ? 0 : silence + (passed < 0.4 ? passed : 0.4); /* a stopped process has not waited */
    last = now;
    if (!*frame)
      continue;
    if (tdm_header_read(header, *frame, *size, err) != TDM_OK)
      return err->status;
    if (header->type == TDM_ERROR)
      return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "the server gave up");
    if (header->type != TDM_HEARTBEAT)
      return TDM_OK;
  }
  return tdm_fail(err, TDM_ERR_TIMEOUT, NULL, "the server is silent for %g s", r->timeout);
}

static tdm_status say(replay *r, const void *frame, size_t size, tdm_error *err) {
  const tdm_frame as_it_is = {.data = (uint8_t *)(uintptr_t)frame, .size = size};
  return tdm_transport_send(r->transport, NULL, &as_it_is, err);
}

/* The solver's remarks, and one of ours: that the other side does not do what it did. */
static tdm_status remark(replay *r, tdm_error *err) {
  json_t *all = r->remarks ? json_copy(r->remarks) : json_array();
  if (r->report->differ > 0)
    json_array_append_new(
        all, json_pack("{s:s, s:s, s:s, s:s, s:I, s:f, s:f}", "event", "replay", "level", "warning", "path",
                       r->role == 1 ? "dem.solver" : "mbd.solver", "message",
                       "what the other solver does is not as it was recorded: what is played does not answer to it",
                       "count", (json_int_t)1, "first_s", r->report->first, "last_s", r->report->first));
  json_t *message = json_pack("{s:o}", "remarks", all);
  if (tdm_control_write(&r->out, TDM_REMARKS, 0, message, err) == TDM_OK)
    tdm_transport_send(r->transport, NULL, &r->out, err);
  json_decref(message);
  return err->status;
}

/* Send a frame of the record; of REMARKS what it has and what there is to say now. */
static tdm_status play_frame(replay *r, const tdm_recorded *next, tdm_error *err) {
  tdm_header header;
  if (tdm_header_read(&header, next->frame, next->size, err) != TDM_OK)
    return err->status;
  if (header.type != TDM_REMARKS)
    return say(r, next->frame, next->size, err);
  json_t *json = NULL;
  if (tdm_control_read(&header, &json, err) != TDM_OK)
    return err->status;
  json_t *list = json_object_get(json, "remarks");
  json_decref(r->remarks);
  r->remarks = json_is_array(list) ? json_incref(list) : NULL;
  json_decref(json);
  return r->report->differ > 0 ? remark(r, err) : say(r, next->frame, next->size, err);
}

/* ASSIGN says whether REMARKS are wanted. */
static tdm_status note_assign(replay *r, const tdm_header *header, tdm_error *err) {
  json_t *json = NULL;
  if (tdm_control_read(header, &json, err) == TDM_OK)
    r->tells = json_is_true(json_object_get(json, "remarks"));
  json_decref(json);
  return err->status;
}

/* Times, steps and counts of a STEP: the first 40 bytes of its payload, by which the RESULT has its size. */
static bool same_window(const tdm_header *a, const tdm_header *b) {
  return a->size >= 40 && b->size >= 40 && memcmp(a->payload, b->payload, 40) == 0;
}

/* A frame came where this one was recorded. */
static tdm_status compare(replay *r, const tdm_header *is, const tdm_recorded *was, const void *frame, size_t size,
                          tdm_error *err) {
  tdm_header due;
  if (tdm_header_read(&due, was->frame, was->size, err) != TDM_OK)
    return err->status;
  if (is->type != due.type)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL,
                    "the record has %s where the server sends %s: record the run with the same settings",
                    tdm_message_name(due.type), tdm_message_name(is->type));
  if (is->type == TDM_ASSIGN)
    return note_assign(r, is, err);
  if (is->type != TDM_STEP)
    return TDM_OK;
  double time[2] = {0, 0}, recorded[2] = {0, 0};
  if (is->size >= 16 && due.size >= 16) {
    memcpy(time, is->payload, sizeof time);
    memcpy(recorded, due.payload, sizeof recorded);
  }
  if (!same_window(is, &due))
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL,
                    "the record has a window from %g s to %g s where the server sends one from %g s to %g s, or with "
                    "other output times: record the run with the same settings",
                    recorded[0], recorded[1], time[0], time[1]);
  r->report->windows++;
  const bool same = size == was->size && memcmp(frame, was->frame, size) == 0;
  r->report->differ += !same;
  if (same || r->report->differ > 1)
    return TDM_OK;
  r->report->first = time[0];
  return r->tells ? remark(r, err) : TDM_OK;
}

static tdm_status play(replay *r, int role, tdm_error *err) {
  tdm_recorded next;
  tdm_header header;
  const void *frame;
  size_t size;
  while (tdm_record_next(&r->record, role, &next, err)) {
    if (next.sender == TDM_FROM_SOLVER) {
      if (play_frame(r, &next, err) != TDM_OK)
        return err->status;
      continue;
    }
    if (hear(r, &header, &frame, &size, err) != TDM_OK)
      return err->status;
    if (header.type == TDM_FINISH) {
      r->finished = true;
      return TDM_OK;
    }
    if (compare(r, &header, &next, frame, size, err) != TDM_OK)
      return err->status;
  }
  if (err->status != TDM_OK || hear(r, &header, &frame, &size, err) != TDM_OK)
    return err->status;
  r->finished = header.type == TDM_FINISH;
  return r->finished ? TDM_OK
                     : tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "the record ends where the server sends %s",
                                tdm_message_name(header.type));
}

static void tell(replay *r, const tdm_error *err) {
  json_t *json = tdm_error_to_json(err);
  if (tdm_control_write(&r->out, TDM_ERROR, 0, json, NULL) == TDM_OK)
    tdm_transport_send(r->transport, NULL, &r->out, NULL);
  json_decref(json);
}

tdm_status tdm_replay(const char *file, int role, const char *endpoint, double timeout, tdm_replay_report *report,
                      tdm_error *err) {
  replay r = {.timeout = timeout, .report = report, .role = role};
  *report = (tdm_replay_report){0};
  if (tdm_transport_connect(&r.transport, endpoint, NULL, err) != TDM_OK)
    return err->status;
  if (tdm_record_open(&r.record, file, err) == TDM_OK)
    play(&r, role, err);
  if (err->status != TDM_OK && err->status != TDM_ERR_INTERRUPTED)
    tell(&r, err);
  tdm_record_close(&r.record);
  tdm_transport_close(&r.transport);
  tdm_frame_free(&r.out);
  json_decref(r.remarks);
  return err->status;
}
