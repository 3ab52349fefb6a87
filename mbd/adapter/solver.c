/* The multibody solver as a participant of a co-simulation: the engine's words for READY, STEP and RESULT. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/adapter/solver.h"

#include "mbd/mbd.h"
#include "protocol/version.h"

static void destroy(void *self) {
  mbd_engine *engine = self;
  mbd_engine_destroy(&engine);
}

static tdm_status create(void **self, const tdm_assignment *assignment, tdm_ready *ready, tdm_participant *p,
                         tdm_error *err) {
  mbd_engine *engine = NULL;
  if (mbd_engine_create(&engine, assignment, p, err))
    return err->status;
  *self = engine;
  const mbd_start *s = mbd_engine_start(engine);
  *ready = (tdm_ready){.body = s->body,
                       .energy = &s->energy,
                       .acceleration = s->acceleration,
                       .mobility = s->mobility,
                       .path = s->path,
                       .prescribed = s->prescribed,
                       .nchannel = s->nchannel,
                       .channel = s->channel,
                       .initial = s->initial,
                       .nwarning = s->nwarning,
                       .warning = s->warning,
                       .gravity = &s->gravity,
                       .report = s->report};
  return TDM_OK;
}

static tdm_status step(void *self, const tdm_step *in, tdm_result *result, tdm_error *err) {
  mbd_engine *engine = self;
  const int ncoupled = mbd_engine_model(engine)->ncoupled;
  if (in->nload > 0 && in->nbody != ncoupled)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "STEP carries %d bodies, ASSIGN named %d", in->nbody, ncoupled);
  const mbd_window window = {.t0 = in->t0,
                             .t1 = in->t1,
                             .nload = in->nload,
                             .load = in->load,
                             .nsample = in->nsample,
                             .sample_time = in->sample_time,
                             .ahead = in->ahead};
  const mbd_outcome outcome = {.state = result->state,
                               .acceleration = result->acceleration,
                               .mobility = &result->mobility,
                               .path = &result->path,
                               .energy = result->has_energy ? result->energy : NULL,
                               .channel = result->channel,
                               .sample_state = result->sample_state};
  return mbd_engine_advance(engine, &window, &outcome, err);
}

static tdm_status save(void *self, int slot, tdm_error *err) {
  return mbd_engine_save(self, slot, err);
}

static tdm_status restore(void *self, int slot, tdm_error *err) {
  return mbd_engine_restore(self, slot, err);
}

static tdm_status scenery(void *self, tdm_scenery *out, tdm_error *err) {
  return mbd_engine_scenery(self, out, err);
}

static tdm_status snapshot(void *self, tdm_snapshot *out, tdm_error *err) {
  return mbd_engine_snapshot(self, out, err);
}

static const char *const capabilities[] = {"restore", "acceleration", "mobility", "matched_load",
                                           "energy",  "ahead",        "view"};

const tdm_solver_ops mbd_solver_ops = {
    .capabilities = capabilities,
    .ncapability = sizeof capabilities / sizeof capabilities[0],
    .role = "mbd",
    .software = "tandem-mbd " TDM_VERSION,
    .create = create,
    .step = step,
    .save = save,
    .restore = restore,
    .scenery = scenery,
    .snapshot = snapshot,
    .destroy = destroy,
};
