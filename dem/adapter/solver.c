/* The coupling adapter: the engine of dem.h as a participant (see protocol/wire/participant.h). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/adapter/solver.h"

#include "dem/dem.h"
#include "dem/model/model.h"
#include "dem/state/data.h"
#include "protocol/version.h"

#include <stdlib.h>

typedef struct {
  dem_engine *engine;
  dem_path *path; /* (ncoupled) of the present window */
  bool sent;      /* contacts feel the twists that are sent */
} dem_solver;

static tdm_status create(void **self, const tdm_assignment *assignment, tdm_ready *ready, tdm_participant *p,
                         tdm_error *err) {
  dem_solver *s = calloc(1, sizeof *s);
  *self = s;
  if (!s)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the DEM solver");
  s->path = calloc((size_t)assignment->nbody + 1, sizeof *s->path);
  if (!s->path)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the paths of %d bodies", assignment->nbody);
  s->sent = assignment->sent_velocity;
  if (dem_engine_create(&s->engine, assignment, p, err))
    return err->status;
  const dem_start *start = dem_engine_start(s->engine);
  ready->load = start->load;
  ready->energy = &start->energy;
  ready->rest = start->rest;
  ready->nchannel = start->nchannel;
  ready->channel = start->channel;
  ready->initial = start->initial;
  ready->nwarning = start->nwarning;
  ready->warning = start->warning;
  ready->gravity = &start->gravity;
  ready->report = start->report;
  return TDM_OK;
}

/* the bodies' paths of this window */
static void make_paths(dem_solver *s, const tdm_step *step) {
  const dem_model *m = dem_engine_data(s->engine)->model;
  for (int c = 0; c < m->ncoupled; c++) { /* the server sees to it that no body turns far in a window without nodes */
    s->path[c] = step->path.nnode > 0
                     ? dem_path_through(step, c)
                     : dem_path_make(&step->start[c], &step->end[c], step->t1 - step->t0, m->interpolation);
    s->path[c].sent = s->sent;
  }
}

static tdm_status solve(void *self, const tdm_step *step, tdm_result *result, tdm_error *err) {
  dem_solver *s = self;
  const int ncoupled = dem_engine_data(s->engine)->model->ncoupled;
  if (step->nbody != ncoupled || step->nstate != ncoupled)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "STEP has states of %d bodies, ASSIGN had %d", step->nstate, ncoupled);
  if (!step->has_proxy)
    make_paths(s, step);
  const dem_mechanism mechanism = {.start = step->start, .proxy = step->proxy, .path = step->path};
  const dem_window window = {.t0 = step->t0,
                             .t1 = step->t1,
                             .nstep = step->nstep,
                             .path = s->path,
                             .mechanism = step->has_proxy ? &mechanism : NULL,
                             .seen = step->seen,
                             .nsample = step->nsample,
                             .sample_time = step->sample_time};
  const bool channels = result->nchannel == dem_engine_start(s->engine)->nchannel;
  const dem_outcome outcome = {.load = result->nload == 1 ? result->load : NULL,
                               .body = result->ninterface > 0 ? result->body : NULL,
                               .further = result->nfurther > 0 ? result->further : NULL,
                               .energy = result->has_energy ? result->energy : NULL,
                               .channel = channels ? result->channel : NULL,
                               .sample_load = result->nload > 0 ? result->sample_load : NULL};
  for (int c = 0; c < result->ninterface && !step->has_proxy; c++)
    result->body[c].end = step->end[c];
  return dem_engine_advance(s->engine, &window, &outcome, err);
}

static tdm_status save(void *self, int slot, tdm_error *err) {
  dem_solver *s = self;
  return dem_engine_save(s->engine, slot, err);
}

static tdm_status restore(void *self, int slot, tdm_error *err) {
  dem_solver *s = self;
  return dem_engine_restore(s->engine, slot, err);
}

static tdm_status scenery(void *self, tdm_scenery *out, tdm_error *err) {
  dem_solver *s = self;
  return dem_engine_scenery(s->engine, out, err);
}

static tdm_status snapshot(void *self, tdm_snapshot *out, tdm_error *err) {
  dem_solver *s = self;
  return dem_engine_snapshot(s->engine, out, err);
}

static void destroy(void *self) {
  dem_solver *s = self;
  if (!s)
    return;
  dem_engine_destroy(&s->engine);
  free(s->path);
  free(s);
}

const dem_data *dem_solver_data(const void *self) {
  const dem_solver *s = self;
  return dem_engine_data(s->engine);
}

static const char *const capabilities[] = {"restore", "interface", "proxy", "matched_load",
                                           "energy",  "path",      "view",  "sent_velocity"};

const tdm_solver_ops dem_solver_ops = {
    .capabilities = capabilities,
    .ncapability = sizeof capabilities / sizeof capabilities[0],
    .role = "dem",
    .software = "tandem-dem " TDM_VERSION,
    .create = create,
    .step = solve,
    .save = save,
    .restore = restore,
    .scenery = scenery,
    .snapshot = snapshot,
    .destroy = destroy,
};
