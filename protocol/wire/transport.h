/* Transport: whole frames between the server and its solvers over ZeroMQ (ipc, tcp, inproc).
 *
 * The server listens on one ROUTER socket, each solver connects one DEALER socket, in any order of starting. A
 * transport belongs to one thread.
 */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_WIRE_TRANSPORT_H
#define TDM_WIRE_TRANSPORT_H

#include "protocol/wire/message.h"

typedef struct tdm_transport tdm_transport;

/* Who sent a frame, on the server's side. */
typedef struct {
  unsigned char id[255];
  int size;
} tdm_peer;

int tdm_peer_equal(const tdm_peer *a, const tdm_peer *b);

/* A ZeroMQ context to be shared by the threads of one process (needed for inproc). NULL when there is none to be had.
 */
void *tdm_context_create(void);
void tdm_context_destroy(void **context);

/* The server's end. `context` is borrowed; NULL: the transport makes its own. */
tdm_status tdm_transport_listen(tdm_transport **transport, const char *endpoint, void *context, tdm_error *err);

/* A solver's end. Connecting waits in the background until somebody listens. */
tdm_status tdm_transport_connect(tdm_transport **transport, const char *endpoint, void *context, tdm_error *err);

/* Where a server's end listens, with the port that a wildcard ("tcp://127.0.0.1:*") became. Lives with the transport.
 */
const char *tdm_transport_endpoint(const tdm_transport *transport);

/* Send one frame; `peer` is NULL on a solver's side. TDM_ERR_LOST when the peer is gone. Never blocks long. */
tdm_status tdm_transport_send(tdm_transport *transport, const tdm_peer *peer, const tdm_frame *frame, tdm_error *err);

/* Wait up to `timeout_ms` for a frame. *data is NULL when none came (or a signal did); else it lives until the next
 * receive. *peer is set on the server's side, and may be NULL on a solver's. */
tdm_status tdm_transport_receive(tdm_transport *transport, int timeout_ms, tdm_peer *peer, const void **data,
                                 size_t *size, tdm_error *err);

/* Frames under way are delivered for up to half a second. *transport becomes NULL. */
void tdm_transport_close(tdm_transport **transport);

#endif
