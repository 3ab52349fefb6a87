/* What a coupled run writes to be looked at: the state of both solvers at the end of windows
 * (protocol/output/outputs.h).
 *
 * Windows end where they would; a frame shows the end of the first one that reaches its time.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/observe/eyes.h"
#include "coupler/observe/observers.h"

#include <stdlib.h>

typedef struct {
  tdm_outputs outputs;
  cpl_session *session;
  cpl_eyes eyes;
} viewer;

/* The state of time t, if something is due then. A solver that has no answer costs this frame. */
static tdm_status look(viewer *v, double t, tdm_error *err) {
  bool seen;
  if (!tdm_outputs_due(&v->outputs, t))
    return TDM_OK;
  v->outputs.snapshot.with_contacts = tdm_outputs_want_contacts(&v->outputs, t);
  if (cpl_eyes_look(&v->eyes, t, &v->outputs.snapshot, &seen, err) != TDM_OK)
    return err->status;
  if (seen)
    tdm_outputs_write(&v->outputs, &v->outputs.snapshot, err);
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
  if (cpl_eyes_open(&v->eyes, s, loop->session, &v->outputs.scenery, err) != TDM_OK ||
      tdm_outputs_begin(&v->outputs, &s->outputs, outlet->results, (double)cpl_total_steps(s) * s->dt, s->dt, err) !=
          TDM_OK)
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
  if (v) {
    tdm_outputs_end(&v->outputs);
    cpl_eyes_free(&v->eyes);
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
