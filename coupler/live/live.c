/* The live view of a run: see live.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/live/live.h"

#include "coupler/live/server.h"
#include "coupler/observe/eyes.h"
#include "coupler/page/pack.h"
#include "coupler/page/page.h"
#include "protocol/base/log.h"
#include "protocol/version.h"

#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

static const double share = 0.02;       /* of the time that looking may take */
static const double pause_least = 0.05; /* between two frames [s] */
static const double state_every = 0.1;  /* between two looks at who watches [s] */

struct cpl_live {
  cpl_server *server;
  pthread_t runner; /* whom a stop interrupts */
  cpl_observer row;
};

/* what the observer holds */
typedef struct {
  cpl_server *server;
  cpl_session *session;
  cpl_eyes eyes;
  tdm_scenery scenery;
  tdm_snapshot snapshot[2]; /* the next one and the last one, for the roster */
  int shown;
  uint32_t roster;
  tdm_view_bytes packed, packed_roster;
  double begin, next_state, next_look; /* wall clock [s] */
  bool wanted;                         /* the end of the next window is to be shown */
} watch;

static void stop_runner(void *of) {
  const cpl_live *live = of;
  pthread_kill(live->runner, SIGINT);
}

/* ---- what is told ---- */

static void tell(watch *w, const cpl_loop *loop, double t, const char *status, const char *error) {
  const double end = (double)cpl_total_steps(loop->settings) * loop->settings->dt, wall = tdm_clock() - w->begin;
  json_t *state =
      json_pack("{s:f, s:f, s:I, s:f, s:b, s:s, s:s?}", "t", t, "end", end, "windows", (json_int_t)loop->window,
                "wall_s", wall, "over", status != NULL, "status", status ? status : "running", "error", error);
  if (t > 0)
    json_object_set_new(state, "left_s", json_real(wall * fmax(0, end - loop->t1) / loop->t1));
  cpl_server_state(w->server, state);
  json_decref(state);
}

/* Ask both solvers, and hand the frame to the server. */
static tdm_status look(watch *w, double t, tdm_error *err) {
  const double begin = tdm_clock();
  tdm_snapshot *now = &w->snapshot[w->shown % 2];
  bool seen = false;
  w->wanted = w->session->seen_next = false;
  if (cpl_eyes_look(&w->eyes, t, now, &seen, err) != TDM_OK)
    return err->status;
  if (seen) {
    const bool renewed = w->shown == 0 || !cpl_pack_same_roster(now, &w->snapshot[(w->shown + 1) % 2]);
    w->packed_roster.size = 0;
    if ((renewed && cpl_pack_roster(now, ++w->roster, &w->packed_roster, err) != TDM_OK) ||
        cpl_pack_frame(&w->scenery, now, w->roster, &w->packed, err) != TDM_OK)
      return err->status;
    cpl_server_frame(w->server, &w->packed_roster, &w->packed);
    w->shown++;
  }
  const double end = tdm_clock();
  w->next_look = end + fmax(pause_least, (end - begin) * (1 - share) / share);
  return TDM_OK;
}

/* ---- the observer ---- */

static tdm_status show_run(watch *w, const cpl_outlet *outlet, tdm_error *err) {
  json_t *meta = cpl_page_scenery(&w->scenery);
  char scene[4096];
  snprintf(scene, sizeof scene, "%s", outlet->scene);
  tdm_utf8_clean(scene);
  json_object_set_new(meta, "tandem", json_string(TDM_VERSION));
  json_object_set_new(meta, "live", json_true());
  json_object_set_new(meta, "status", json_string("running"));
  json_object_set_new(meta, "scene", json_string(scene));
  json_object_set_new(meta, "times", json_array());
  json_object_set_new(meta, "channels", json_array());
  cpl_server_run(w->server, outlet->results->dir, &w->scenery, meta, err);
  json_decref(meta);
  return err->status;
}

static tdm_status begin(const cpl_observer *self, const cpl_loop *loop, const cpl_outlet *outlet, void **own,
                        tdm_error *err) {
  const cpl_live *live = self->context;
  watch *w = *own = calloc(1, sizeof *w);
  if (!w)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  w->server = live->server;
  w->session = loop->session;
  w->begin = tdm_clock();
  if (cpl_eyes_open(&w->eyes, loop->settings, loop->session, &w->scenery, err) != TDM_OK ||
      show_run(w, outlet, err) != TDM_OK)
    return err->status;
  tell(w, loop, 0, NULL, NULL);
  return look(w, 0, err);
}

static tdm_status window(void *own, const cpl_loop *loop, tdm_error *err) {
  watch *w = own;
  const double now = tdm_clock();
  if (w->wanted && look(w, loop->t1, err) != TDM_OK)
    return err->status;
  if (now < w->next_state)
    return TDM_OK;
  w->next_state = now + state_every;
  tell(w, loop, loop->t1, NULL, NULL);
  w->wanted = w->session->seen_next = tdm_clock() >= w->next_look && cpl_server_watched(w->server);
  return TDM_OK;
}

static void done(void *own, const cpl_loop *loop) {
  tell(own, loop, loop->t1, "TDM_OK", NULL);
}

static void failed(void *own, const cpl_loop *loop, const tdm_error *reason) {
  if (own)
    tell(own, loop, loop->window > 0 ? loop->t1 : 0, tdm_status_name(reason->status), reason->message);
}

static void let_go(void *own) {
  watch *w = own;
  if (!w)
    return;
  cpl_eyes_free(&w->eyes);
  tdm_scenery_free(&w->scenery);
  for (int k = 0; k < 2; k++)
    tdm_snapshot_free(&w->snapshot[k]);
  tdm_view_bytes_free(&w->packed);
  tdm_view_bytes_free(&w->packed_roster);
  free(w);
}

tdm_status cpl_live_open(cpl_live **live, int port, tdm_error *err) {
  cpl_live *l = *live = calloc(1, sizeof *l);
  if (!l)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  l->runner = pthread_self();
  l->row = (cpl_observer){
      .name = "live", .context = l, .open = begin, .window = window, .done = done, .failed = failed, .free = let_go};
  if (cpl_server_open(&l->server, port, stop_runner, l, err) != TDM_OK)
    return err->status;
  return TDM_OK;
}

void cpl_live_tell(void *live) {
  fprintf(stderr, "tandem: look at the run at %s\n", cpl_server_address(((cpl_live *)live)->server));
}

const cpl_observer *cpl_live_observer(const cpl_live *live) {
  return &live->row;
}

void cpl_live_close(cpl_live **live) {
  if (*live)
    cpl_server_close(&(*live)->server);
  free(*live);
  *live = NULL;
}
