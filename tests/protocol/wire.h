/* A solver as a thread with the test as its server, message by message. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_WIRE_H
#define TEST_WIRE_H

#include "protocol/wire/participant.h"
#include "protocol/wire/transport.h"
#include "tests/test_main.h"

#include <pthread.h>
#include <string.h>

typedef struct {
  void *context;
  tdm_transport *transport;
  tdm_peer peer;
  pthread_t thread;
  tdm_frame out, store;
  const tdm_solver_ops *ops;
  const char *endpoint;
  tdm_status ended; /* of the solver */
  int nchannel;
  tdm_error err;
} wire;

static inline void *wire_solver(void *arg) {
  wire *w = arg;
  tdm_participant_def def = tdm_participant_default_def();
  def.endpoint = w->endpoint;
  def.role = w->ops->role;
  def.context = w->context;
  def.capabilities = w->ops->capabilities;
  def.ncapability = w->ops->ncapability;
  def.timeout = 5;
  tdm_error err = {0};
  w->ended = tdm_participant_run(w->ops, &def, &err);
  return NULL;
}

/* the next message but HEARTBEAT */
static inline tdm_header hear(wire *w) {
  tdm_header header = {0};
  const void *data = NULL;
  size_t size;
  do {
    ck_assert_int_eq(tdm_transport_receive(w->transport, 5000, &w->peer, &data, &size, &w->err), TDM_OK);
    ck_assert_ptr_nonnull(data);
    ck_assert_int_eq(tdm_header_read(&header, data, size, &w->err), TDM_OK);
  } while (header.type == TDM_HEARTBEAT);
  return header;
}

/* the JSON of the answer, which must be of type `answer`; the caller's */
static inline json_t *say(wire *w, tdm_message_type type, json_t *json, tdm_message_type answer) {
  ck_assert_int_eq(tdm_control_write(&w->out, type, 0, json, &w->err), TDM_OK);
  json_decref(json);
  ck_assert_int_eq(tdm_transport_send(w->transport, &w->peer, &w->out, &w->err), TDM_OK);
  tdm_header header = hear(w);
  ck_assert_msg(header.type == answer, "%s where %s was expected: %.*s", tdm_message_name(header.type),
                tdm_message_name(answer), (int)header.size, (const char *)header.payload);
  ck_assert_int_eq(tdm_control_read(&header, &json, &w->err), TDM_OK);
  return json;
}

/* The result of a step, in w->store. */
static inline tdm_result step_over(wire *w, const tdm_step *step) {
  ck_assert_int_eq(tdm_step_write(&w->out, step, &w->err), TDM_OK);
  ck_assert_int_eq(tdm_transport_send(w->transport, &w->peer, &w->out, &w->err), TDM_OK);
  tdm_header header = hear(w);
  tdm_result result;
  ck_assert_int_eq(header.type, TDM_RESULT);
  ck_assert_int_eq(tdm_result_read(&result, &header, &w->store, &w->err), TDM_OK);
  return result;
}

/* Start the solver and hear its HELLO, which must announce `capability`. */
static inline void open_wire(wire *w, const tdm_solver_ops *ops, const char *endpoint, const char *capability) {
  *w = (wire){.context = tdm_context_create(), .ops = ops, .endpoint = endpoint};
  ck_assert_int_eq(tdm_transport_listen(&w->transport, endpoint, w->context, &w->err), TDM_OK);
  pthread_create(&w->thread, NULL, wire_solver, w);
  tdm_header header = hear(w);
  ck_assert_int_eq(header.type, TDM_HELLO);
  json_t *hello, *list;
  ck_assert_int_eq(tdm_control_read(&header, &hello, &w->err), TDM_OK);
  bool found = false;
  list = json_object_get(hello, "capabilities");
  for (size_t i = 0; i < json_array_size(list); i++)
    found = found || strcmp(json_string_value(json_array_get(list, i)), capability) == 0;
  ck_assert(found);
  json_decref(hello);
}

static inline void close_wire(wire *w, bool finish) {
  if (finish) {
    tdm_control_write(&w->out, TDM_FINISH, 0, NULL, &w->err);
    tdm_transport_send(w->transport, &w->peer, &w->out, &w->err);
  }
  pthread_join(w->thread, NULL);
  tdm_transport_close(&w->transport);
  tdm_context_destroy(&w->context);
  tdm_frame_free(&w->out);
  tdm_frame_free(&w->store);
}

#endif
