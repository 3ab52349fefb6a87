/* What a coupled run writes to be looked at: the state of both solvers at the end of windows
 * (protocol/output/outputs.h).
 *
 * Solvers are asked by VIEW, between windows, and nothing of the run depends on it: a solver that cannot be seen, or
 * says what makes no sense, is a remark. Windows end where they would; a frame shows the end of the first one that
 * reaches its time.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/observe/join.h"
#include "coupler/observe/observers.h"
#include "protocol/scene/remark.h"

#include <math.h>
#include <stdlib.h>

typedef struct {
  tdm_outputs outputs;
  cpl_session *session;
  bool sees[CPL_NROLE];
  tdm_scenery scenery[CPL_NROLE];
  tdm_snapshot snapshot[CPL_NROLE];
  cpl_join join;
} viewer;

/* Ask a solver and decode its answer. *seen: there was one. An error is one of the session, and ends the run. */
static tdm_status ask(viewer *v, cpl_role role, bool scenery, double t, bool *seen, tdm_error *err) {
  tdm_header header;
  tdm_error own = {0};
  *seen = false;
  if (cpl_session_view(v->session, role, scenery ? "scenery" : "snapshot", &header, err) != TDM_OK)
    return err->status;
  if (header.size == 0) /* it has said why */
    return TDM_OK;
  if (scenery)
    tdm_scenery_decode(&v->scenery[role], header.payload, header.size, &own);
  else if (tdm_snapshot_decode(&v->snapshot[role], header.payload, header.size, &own) == TDM_OK)
    tdm_snapshot_check(&v->snapshot[role], &v->scenery[role], &own);
  *seen = own.status == TDM_OK;
  if (!*seen)
    tdm_remark(TDM_WARNING, "unseen", NULL, t, "what %s tells of what there is to see is of no use: %.800s",
               cpl_session_name(v->session, role), own.message);
  return TDM_OK;
}

/* The sceneries of those that have one. */
static tdm_status look_around(viewer *v, const cpl_settings *settings, tdm_error *err) {
  for (int r = 0; r < CPL_NROLE; r++) {
    if (!cpl_session_has(v->session, (cpl_role)r, "view"))
      tdm_remark(TDM_NOTICE, "unseen", NULL, 0,
                 "%s does not have the capability \"view\": frames and pictures are without what is in it",
                 cpl_session_name(v->session, (cpl_role)r));
    else if (ask(v, (cpl_role)r, true, 0, &v->sees[r], err) != TDM_OK)
      return err->status;
    if (!v->sees[r])
      tdm_scenery_clear(&v->scenery[r]);
  }
  return cpl_join_sceneries(&v->join, settings, v->scenery, &v->outputs.scenery, err);
}

/* The state of time t, if something is due then. A solver that has no answer costs this frame. */
static tdm_status look(viewer *v, double t, tdm_error *err) {
  bool all = true;
  if (!tdm_outputs_due(&v->outputs, t))
    return TDM_OK;
  for (int r = 0; r < CPL_NROLE; r++) {
    bool seen = true;
    if (v->sees[r] && ask(v, (cpl_role)r, false, t, &seen, err) != TDM_OK)
      return err->status;
    all = all && seen;
  }
  if (all) {
    if (cpl_join_snapshots(&v->join, v->snapshot, &v->outputs.snapshot, err) != TDM_OK)
      return err->status;
    v->outputs.snapshot.time = t;
    tdm_outputs_write(&v->outputs, &v->outputs.snapshot, err);
  }
  v->session->seen_from = tdm_outputs_next(&v->outputs);
  return err->status;
}

static tdm_status begin(const cpl_observer *self, const cpl_loop *loop, const cpl_outlet *outlet, void **own,
                        tdm_error *err) {
  (void)self;
  const cpl_settings *s = loop->settings;
  if (!tdm_outputs_wanted(&s->outputs))
    return TDM_OK;
  viewer *v = *own = calloc(1, sizeof *v);
  if (!v)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  v->session = loop->session;
  if (look_around(v, s, err) != TDM_OK || tdm_outputs_begin(&v->outputs, &s->outputs, outlet->results,
                                                            (double)cpl_total_steps(s) * s->dt, s->dt, err) != TDM_OK)
    return err->status;
  return look(v, 0, err);
}

static tdm_status window(void *own, const cpl_loop *loop, tdm_error *err) {
  return own ? look(own, loop->t1, err) : TDM_OK;
}

static tdm_status finish(void *own, tdm_error *err) {
  (void)err; /* pictures that fail are a remark */
  viewer *v = own;
  if (v)
    tdm_outputs_finish(&v->outputs, v->outputs.snapshot.time);
  return TDM_OK;
}

static void enter(const void *own, json_t *summary) {
  const viewer *v = own;
  if (v && v->outputs.settings->pictures.count > 0)
    json_object_set_new(summary, "pictures", json_integer(tdm_outputs_pictures(&v->outputs)));
}

static void let_go(void *own) {
  viewer *v = own;
  for (int r = 0; v && r < CPL_NROLE; r++) {
    tdm_scenery_free(&v->scenery[r]);
    tdm_snapshot_free(&v->snapshot[r]);
  }
  if (v) {
    tdm_outputs_end(&v->outputs);
    cpl_join_free(&v->join);
  }
  free(v);
}

const cpl_observer cpl_observer_view = {
    .name = "view",
    .open = begin,
    .window = window,
    .close = finish,
    .enter = enter,
    .free = let_go,
};
