/* The HTTP server of a live view: the viewer's page, the newest frame, the time histories, and a way to stop the run.
 *
 *   GET /?token=T   once, with the token of the printed address: sets the session's cookie, leads to /
 *   GET /           the page (page/page.h) with the scenery, and no frames
 *   GET /state      JSON: what the run last said of itself (cpl_server_state)
 *   GET /frame      the newest frame if its number is above that of ?after=N (204: it is not):
 *                   u32 number, u32 bytes of the roster, roster, frame (page/pack.h)
 *   GET /channels   the time histories by now (204: there is no run yet):
 *                   u32 bytes of JSON, JSON (page/channels.h), and for each file u32 bytes, bytes
 *   POST /stop      the run is to end as after Ctrl-C
 *
 * It listens on 127.0.0.1 alone. Whoever has neither token nor cookie, or calls it by another name (a page elsewhere
 * whose name leads here), gets 403. Those who run the simulation hand in what is new and never wait for who looks: one
 * frame is kept, and is sent from where it lies while the next one takes its place.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_LIVE_SERVER_H
#define CPL_LIVE_SERVER_H

#include "protocol/view/view.h"

#include <jansson.h>

typedef struct cpl_server cpl_server;

/* Listen at `port`, 0: a free one; `stop` is called with `context`, from a thread of the server's, when a viewer wants
 * the run to stop. TDM_ERR_SYSTEM: the port is taken. */
tdm_status cpl_server_open(cpl_server **server, int port, void (*stop)(void *), void *context, tdm_error *err);

/* What to open in the browser, with the token. */
const char *cpl_server_address(const cpl_server *server);

/* The run has a result directory and a scenery: from now on there is a page. `meta` is borrowed. */
tdm_status cpl_server_run(cpl_server *server, const char *dir, const tdm_scenery *scenery, const json_t *meta,
                          tdm_error *err);

/* What /state tells, in place of before (borrowed). */
void cpl_server_state(cpl_server *server, const json_t *state);

/* A new frame, in place of the last one. The buffers' contents are taken over and empty ones given back; an empty
 * roster: that of before. */
void cpl_server_frame(cpl_server *server, tdm_view_bytes *roster, tdm_view_bytes *frame);

/* Whether a viewer has asked for frames within the last seconds. */
bool cpl_server_watched(const cpl_server *server);

/* Wait until a viewer that asks for states has seen the end, three seconds at most; then end all connections. *server
 * is NULL. */
void cpl_server_close(cpl_server **server);

#endif
