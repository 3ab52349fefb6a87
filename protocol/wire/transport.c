/* Transport: see transport.h. */
/* SPDX-License-Identifier: MIT */
#include "protocol/wire/transport.h"

#include "protocol/base/log.h"
#include "protocol/wire/patience.h"

#include <assert.h>
#include <errno.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <zmq.h>

struct tdm_transport {
  void *context, *socket;
  int owns_context, is_server;
  int timeout_ms; /* as set on the socket */
  tdm_patience patience;
  char endpoint[256];
  zmq_msg_t message;
};

int tdm_peer_equal(const tdm_peer *a, const tdm_peer *b) {
  return a->size == b->size && memcmp(a->id, b->id, (size_t)a->size) == 0;
}

void *tdm_context_create(void) {
  return zmq_ctx_new();
}

void tdm_context_destroy(void **context) {
  if (*context)
    zmq_ctx_term(*context);
  *context = NULL;
}

static tdm_status open_socket(tdm_transport **transport, const char *endpoint, void *context, int is_server,
                              tdm_error *err) {
  tdm_transport *t = calloc(1, sizeof *t);
  if (!t)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  t->is_server = is_server;
  t->owns_context = context == NULL;
  t->context = context ? context : zmq_ctx_new();
  t->socket = t->context ? zmq_socket(t->context, is_server ? ZMQ_ROUTER : ZMQ_DEALER) : NULL;
  zmq_msg_init(&t->message);
  t->timeout_ms = -1;
  int failed = t->socket == NULL;
  if (!failed) {
    int linger = 500, mandatory = 1, send_timeout = 200, high_water = 0;
    int64_t largest = 2 * (int64_t)TDM_VIEW_MAX; /* beyond this ZeroMQ drops the connection unread */
    zmq_setsockopt(t->socket, ZMQ_LINGER, &linger, sizeof linger);
    zmq_setsockopt(t->socket, ZMQ_SNDTIMEO, &send_timeout, sizeof send_timeout);
    zmq_setsockopt(t->socket, ZMQ_SNDHWM, &high_water, sizeof high_water);
    zmq_setsockopt(t->socket, ZMQ_MAXMSGSIZE, &largest, sizeof largest);
    if (is_server)
      zmq_setsockopt(t->socket, ZMQ_ROUTER_MANDATORY, &mandatory, sizeof mandatory);
    failed = is_server ? zmq_bind(t->socket, endpoint) : zmq_connect(t->socket, endpoint);
  }
  if (failed) {
    tdm_fail(err, TDM_ERR_SYSTEM, NULL, "cannot %s %s: %s; choose another address or port",
             is_server ? "listen on" : "connect to", endpoint, zmq_strerror(errno));
    tdm_transport_close(&t);
    return TDM_ERR_SYSTEM;
  }
  size_t size = sizeof t->endpoint;
  zmq_getsockopt(t->socket, ZMQ_LAST_ENDPOINT, t->endpoint, &size);
  *transport = t;
  return TDM_OK;
}

tdm_status tdm_transport_listen(tdm_transport **transport, const char *endpoint, void *context, tdm_error *err) {
  return open_socket(transport, endpoint, context, 1, err);
}

const char *tdm_transport_endpoint(const tdm_transport *transport) {
  return transport->endpoint;
}

tdm_status tdm_transport_connect(tdm_transport **transport, const char *endpoint, void *context, tdm_error *err) {
  return open_socket(transport, endpoint, context, 0, err);
}

/* zmq_send that starts again after a signal */
static int send_part(void *socket, const void *data, size_t size, int flags) {
  int sent;
  do
    sent = zmq_send(socket, data, size, flags);
  while (sent < 0 && errno == EINTR);
  return sent;
}

tdm_status tdm_transport_send(tdm_transport *t, const tdm_peer *peer, const tdm_frame *frame, tdm_error *err) {
  assert((peer != NULL) == (t->is_server != 0));
  if ((peer && send_part(t->socket, peer->id, (size_t)peer->size, ZMQ_SNDMORE) < 0) ||
      send_part(t->socket, frame->data, frame->size, 0) < 0)
    return tdm_fail(err, TDM_ERR_LOST, NULL, "the partner cannot be reached: %s", zmq_strerror(errno));
  return TDM_OK;
}

/* Drop the rest of a message that has more parts than the protocol knows. Returns how many there were. */
static int drop_parts(tdm_transport *t) {
  int parts = 0;
  while (zmq_msg_more(&t->message)) {
    if (zmq_msg_recv(&t->message, t->socket, 0) < 0)
      break;
    parts++;
  }
  return parts;
}

static bool nothing_came(int got) {
  return got < 0 && errno == EAGAIN;
}

/* Look for a message without sleeping for a short while. Yielding lets ZeroMQ's own threads, and partners on the same
 * processor, work; what comes back late had somebody else's work in between. Returns as zmq_msg_recv. */
static int look(tdm_transport *t) {
  const double while_looking = 100e-6, away = 50e-6; /* [s] */
  const double begin = tdm_clock();
  double now = begin, before;
  int got;
  do {
    before = now;
    sched_yield();
    got = zmq_msg_recv(&t->message, t->socket, ZMQ_DONTWAIT);
    now = tdm_clock();
  } while (nothing_came(got) && now - before < away && now - begin < while_looking);
  const int reason = errno;
  tdm_patience_learn(&t->patience, got >= 0 && now - before < away);
  errno = reason;
  return got;
}

/* The next message, looked for first where that pays (patience.h). Returns as zmq_msg_recv. */
static int receive_soon(tdm_transport *t, int timeout_ms) {
  int got = zmq_msg_recv(&t->message, t->socket, ZMQ_DONTWAIT);
  if (nothing_came(got) && timeout_ms != 0 && tdm_patience_looks(&t->patience))
    got = look(t);
  return nothing_came(got) && timeout_ms != 0 ? zmq_msg_recv(&t->message, t->socket, 0) : got;
}

tdm_status tdm_transport_receive(tdm_transport *t, int timeout_ms, tdm_peer *peer, const void **data, size_t *size,
                                 tdm_error *err) {
  *data = NULL;
  *size = 0;
  if (timeout_ms != t->timeout_ms) {
    zmq_setsockopt(t->socket, ZMQ_RCVTIMEO, &timeout_ms, sizeof timeout_ms);
    t->timeout_ms = timeout_ms;
  }
  if (receive_soon(t, timeout_ms) < 0) {
    if (errno == EAGAIN || errno == EINTR)
      return TDM_OK;
    return tdm_fail(err, TDM_ERR_LOST, NULL, "cannot receive: %s", zmq_strerror(errno));
  }
  if (t->is_server) { /* the first part is the sender's routing id, made by ROUTER: 5 bytes */
    assert(peer);
    peer->size = (int)zmq_msg_size(&t->message);
    if (peer->size > (int)sizeof peer->id)
      peer->size = (int)sizeof peer->id;
    memcpy(peer->id, zmq_msg_data(&t->message), (size_t)peer->size);
    if (!zmq_msg_more(&t->message) || zmq_msg_recv(&t->message, t->socket, 0) < 0)
      return TDM_OK;
  }
  *data = zmq_msg_data(&t->message);
  *size = zmq_msg_size(&t->message);
  if (zmq_msg_more(&t->message)) { /* a message of several parts is nobody's: hand on something that fails the check */
    drop_parts(t);
    *data = "";
    *size = 0;
  }
  return TDM_OK;
}

void tdm_transport_close(tdm_transport **transport) {
  tdm_transport *t = *transport;
  if (!t)
    return;
  zmq_msg_close(&t->message);
  if (t->socket)
    zmq_close(t->socket);
  if (t->owns_context && t->context)
    zmq_ctx_term(t->context);
  free(t);
  *transport = NULL;
}
