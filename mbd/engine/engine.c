/* The multibody engine: see mbd/mbd.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/mbd.h"

#include "mbd/assembly/assemble.h"
#include "mbd/engine/channels.h"
#include "mbd/engine/guard.h"
#include "mbd/engine/report.h"
#include "mbd/engine/view.h"
#include "mbd/integrate/integrator.h"
#include "mbd/mechanics/energy.h"
#include "mbd/mechanics/free.h"
#include "mbd/reduced/ahead.h"
#include "mbd/reduced/reduced.h"
#include "mbd/scene/scene.h"
#include "protocol/base/log.h"
#include "protocol/base/memory.h"
#include "protocol/math/gsl_errors.h"
#include "protocol/scene/remark.h"
#include "protocol/version.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct mbd_engine {
  tdm_participant *participant; /* borrowed, NULL without a server */
  mbd_model *model;
  mbd_data *data;
  mbd_kkt *kkt;
  const mbd_integrator_ops *integrator;
  void *integration; /* the integrator's own */
  mbd_assembly assembly;
  bool started;
  const double *sampled;   /* unknowns of the sample that is looked at; NULL: none is */
  double sampled_at;       /* its time [s] */
  long steps, most_steps;  /* made since the limit was set, and the limit; 0: none */
  bool acceleration;       /* of the coupled bodies, asked for */
  mbd_reduced *reduced;    /* NULL: not asked for */
  mbd_ahead *ahead;        /* NULL: not asked for */
  tdm_nodes path;          /* at the start */
  double *rate;            /* (6 ncoupled) accelerations at the start */
  tdm_mobility mobility;   /* at the start */
  tdm_assigned_body *body; /* (ncoupled) */
  tdm_channel *channel;    /* (nchannel) */
  double *initial;         /* (nchannel) */
  mbd_report told;
  mbd_start start;
  struct {
    mbd_data *data; /* NULL: nothing was saved */
    void *integration;
    bool started;
  } slot[TDM_SLOTS_MAX];
};

void mbd_engine_destroy(mbd_engine **engine) {
  mbd_engine *s = engine ? *engine : NULL;
  if (!s)
    return;
  if (s->started) {
    s->integrator->stats(s->integration);
    const mbd_stats *c = &s->data->stats;
    tdm_log(TDM_LOG_INFO, "integrator",
            "steps=%ld residuals=%ld jacobians=%ld error_failures=%ld convergence_failures=%ld restarts=%ld", c->steps,
            c->residuals, c->jacobians, c->error_failures, c->convergence_failures, c->restarts);
  }
  for (int i = 0; i < TDM_SLOTS_MAX; i++) {
    mbd_data_destroy(&s->slot[i].data);
    if (s->integrator && s->integrator->release)
      s->integrator->release(s->slot[i].integration);
  }
  if (s->integrator)
    s->integrator->destroy(s->integration);
  mbd_reduced_destroy(&s->reduced);
  mbd_ahead_destroy(&s->ahead);
  mbd_kkt_destroy(&s->kkt);
  mbd_data_destroy(&s->data);
  mbd_model_destroy(&s->model);
  free(s->body);
  free(s->channel);
  free(s->initial);
  free(s->rate);
  json_decref(s->start.report);
  free(s);
  *engine = NULL;
}

/* ---- create ---- */

static mbd_energies energies_now(mbd_engine *s, double t) {
  mbd_kinematics(s->model, s->data, t, s->data->y);
  return mbd_energies_at(s->model, s->data);
}

/* Stored; supplied by what is not the coupling load. */
static tdm_energy energy_of(const mbd_engine *s, mbd_energies e) {
  return (tdm_energy){.kinetic = e.kinetic,
                      .stored = e.kinetic + e.potential + e.springs,
                      .supplied = s->data->work.supplied - s->data->work.coupled,
                      .exchanged = s->data->work.coupled};
}

/* Accelerations of the coupled bodies (6 ncoupled) and the reduced model at (t, data->y), as far as asked for; NULL:
 * not wanted. */
static tdm_status linearise(mbd_engine *s, double t, double *acceleration, tdm_mobility *mobility, tdm_error *err) {
  const mbd_model *m = s->model;
  tdm_mobility own;
  bool good = true;
  if (s->reduced)
    good = mbd_reduced_at(m, s->data, s->kkt, s->reduced, t, s->data->y, mobility ? mobility : &own);
  else if (s->acceleration)
    good = mbd_accelerations(m, s->data, s->kkt, t, s->data->y);
  for (int k = 0; k < m->ncoupled && s->acceleration && acceleration; k++)
    memcpy(acceleration + 6 * k, s->data->acceleration + 6 * m->coupled[k], 6 * sizeof(double));
  if (!good)
    return tdm_fail(err, TDM_ERR_NUMERIC, "mbd",
                    "no accelerations at t = %.9g s: the mechanism is in a singular position", t);
  return TDM_OK;
}

/* The same at the start, and a word when there is too much freedom. */
static tdm_status linearise_start(mbd_engine *s, const tdm_assignment *a, tdm_error *err) {
  s->acceleration = a->acceleration;
  s->rate = calloc(6 * (size_t)s->model->ncoupled + 1, sizeof *s->rate);
  s->reduced = a->mobility ? mbd_reduced_create(s->model, s->data) : NULL;
  if (!s->rate || (a->mobility && !s->reduced))
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for the reduced model");
  if (linearise(s, a->time_start, s->rate, &s->mobility, err))
    return err->status;
  const int freedom = s->reduced ? mbd_reduced_freedom(s->reduced) : 0;
  if (freedom > TDM_FREE_MAX) {
    tdm_remark(TDM_NOTICE, "mobility_alone", "mbd", a->time_start,
               "the mechanism has %d degrees of freedom, more than the %d of a reduced model: within a window the "
               "particles feel its inertia, but not its springs and dampers; keep coupling.n small",
               freedom, TDM_FREE_MAX);
    json_object_set_new(s->start.report, "reduced_model", json_string("mobility alone: too many degrees of freedom"));
  }
  return TDM_OK;
}

/* What there is to tell: coupled bodies, channels with their start values, report. */
static tdm_status prepare(mbd_engine *s, double t, tdm_error *err) {
  const mbd_model *m = s->model;
  const int nchannel = s->start.nchannel = mbd_channel_count(m);
  s->body = calloc((size_t)m->ncoupled + 1, sizeof *s->body);
  s->channel = calloc((size_t)nchannel + 1, sizeof *s->channel);
  s->initial = calloc((size_t)nchannel + 1, sizeof *s->initial);
  if (!s->body || !s->channel || !s->initial)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for the outputs");
  for (int i = 0; i < m->ncoupled; i++) {
    const mbd_body *b = &m->body[m->coupled[i]];
    s->body[i] = (tdm_assigned_body){.name = b->name,
                                     .mass = b->mass,
                                     .inertia = b->inertia,
                                     .state = mbd_body_state(s->data->y, m->coupled[i]),
                                     .origin = b->origin,
                                     .mesh = b->mesh,
                                     .scale = b->scale};
    s->body[i].nfree = mbd_free_directions(m, s->data, m->coupled[i], s->body[i].free);
  }
  mbd_channel_names(m, s->channel);
  if (mbd_channel_values(m, s->data, s->kkt, t, s->data->y, s->initial, err))
    return err->status;
  s->told = (mbd_report){.model = m, .data = s->data, .assembly = &s->assembly};
  mbd_report_warn(&s->told);
  s->start.report = mbd_report_json(&s->told);
  return s->start.report ? TDM_OK : tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for the report");
}

static bool too_many(const mbd_engine *s) {
  return s->most_steps > 0 && s->steps > s->most_steps;
}

/* tells the server, if there is one, that the solver lives; true when the work is no longer wanted, or in vain */
static bool should_stop(void *context) {
  mbd_engine *s = context;
  s->steps++;
  return tdm_participant_alive(s->participant) != TDM_OK || s->data->turned >= 0 || too_many(s);
}

/* The path from the start on, if that is asked for. */
static tdm_status look_ahead(mbd_engine *s, const tdm_assignment *a, tdm_error *err) {
  if (!(a->ahead > a->time_start))
    return TDM_OK;
  if (mbd_ahead_create(&s->ahead, s->model, s->data, s->assembly.freedom, should_stop, s, err))
    return err->status;
  return mbd_ahead_path(s->ahead, s->data, a->time_start, a->ahead, &s->path, err);
}

/* Names what is there, for mbd_engine_start. */
static void tell_start(mbd_engine *s, double t) {
  mbd_start *now = &s->start;
  now->body = s->body;
  now->acceleration = s->rate;
  now->mobility = &s->mobility;
  now->path = &s->path;
  now->prescribed = s->ahead ? mbd_ahead_prescribed(s->ahead) : NULL;
  now->channel = s->channel;
  now->initial = s->initial;
  now->nwarning = s->told.nwarning;
  now->warning = s->told.warning;
  now->energy = energy_of(s, energies_now(s, t));
  now->gravity = s->model->gravity;
  now->freedom = s->assembly.freedom;
}

static tdm_status create(mbd_engine *s, const tdm_assignment *a, tdm_error *err) {
  if (mbd_model_read(&s->model, a->scene, a->nbody > 0 || a->restores, err) ||
      mbd_model_check_times(s->model, a->time_start, a->time_end, err) ||
      mbd_model_couple(s->model, a->body, a->nbody, err))
    return err->status;
  s->integrator = mbd_formulation_table[s->model->solver.formulation].integrator;
  s->data = mbd_data_create(s->model);
  s->kkt = mbd_kkt_create(s->model);
  if (!s->data || !s->kkt)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for %d bodies", s->model->nbody);
  s->data->t = a->time_start;
  if (mbd_assemble(s->model, s->data, s->kkt, &s->assembly, err) || prepare(s, a->time_start, err) ||
      linearise_start(s, a, err) || look_ahead(s, a, err) ||
      s->integrator->create(&s->integration, s->model, s->data, s->kkt, should_stop, s, err))
    return err->status;
  tell_start(s, a->time_start);
  return TDM_OK;
}

tdm_status mbd_engine_create(mbd_engine **engine, const tdm_assignment *assignment, tdm_participant *participant,
                             tdm_error *err) {
  assert(!*engine);
  tdm_gsl_return_errors();
  tdm_memory_watch_json();
  const unsigned long before = tdm_memory_notes();
  mbd_engine *s = calloc(1, sizeof *s);
  if (!s)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory");
  s->participant = participant;
  create(s, assignment, err);
  if (tdm_memory_since(before, "mbd", err))
    mbd_engine_destroy(&s);
  *engine = s;
  return err->status;
}

const mbd_start *mbd_engine_start(const mbd_engine *s) {
  return &s->start;
}

/* ---- a window ---- */

typedef struct {
  mbd_engine *self;
  const mbd_outcome *outcome;
} sample_target;

static tdm_status sample(void *context, int i, double t, const double *y, tdm_error *err) {
  const sample_target *to = context;
  const mbd_model *m = to->self->model;
  const mbd_outcome *o = to->outcome;
  for (int k = 0; k < m->ncoupled && o->sample_state; k++)
    o->sample_state[i * m->ncoupled + k] = mbd_body_state(y, m->coupled[k]);
  mbd_engine *s = to->self;
  if (o->channel && mbd_channel_values(m, s->data, s->kkt, t, y, o->channel + i * s->start.nchannel, err))
    return err->status;
  if (!o->look)
    return TDM_OK;
  s->sampled = y;
  s->sampled_at = t;
  tdm_status status = o->look(o->looker, i, err);
  s->sampled = NULL;
  return status;
}

/* A force has turned too far: says so in place of what came of it. */
static tdm_status refuse_turned(const mbd_engine *s, tdm_error *err) {
  char path[TDM_PATH_MAX];
  const mbd_force *f = &s->model->force[s->data->turned];
  snprintf(path, sizeof path, "mbd.forces[%d]", s->data->turned);
  *err = (tdm_error){0};
  return tdm_fail(
      err, TDM_ERR_NUMERIC, path,
      "the %s \"%s\" has turned by 3 rad at t = %.9g s: its torque would jump at half a turn. Take a stiffer "
      "or more damped one, or a joint with a torsional_spring_damper, whose angle is counted over turns",
      f->ops->name, f->name, s->data->turned_at);
}

/* A dependent row has opened. */
static tdm_status refuse_open(const mbd_engine *s, double t, tdm_error *err) {
  mbd_origin o = mbd_origin_of(s->model, s->data->open_row);
  return tdm_fail(err, TDM_ERR_NUMERIC, o.path,
                  "the equation \"%s\" of %s \"%s\" followed from the joints before it at the start and contradicts "
                  "them at t = %.9g s: the mechanism is over-constrained; use joints with more freedom",
                  o.equation, o.kind, o.name, t);
}

static tdm_status integrate(mbd_engine *s, const mbd_window *in, const mbd_outcome *out, tdm_error *err) {
  /* the consistent start waits for the first load */
  if (!s->started || s->model->solver.restart_each_window) {
    mbd_kkt_reset(s->kkt); /* so that nothing depends on what was before */
    if (s->integrator->start(s->integration, in->t0, err))
      return err->status;
  }
  s->started = true;
  sample_target to = {s, out};
  s->integrator->advance(s->integration, in->t1, in->nsample, in->sample_time, sample, &to, err);
  if (s->data->turned >= 0)
    return refuse_turned(s, err);
  if (err->status == TDM_ERR_INTERRUPTED && too_many(s)) {
    *err = (tdm_error){0};
    return tdm_fail(err, TDM_ERR_LIMIT, "mbd.solver", "more than %ld steps", s->most_steps);
  }
  if (!err->status && s->data->open_row >= 0)
    return refuse_open(s, in->t1, err);
  return err->status;
}

static tdm_status advance(mbd_engine *s, const mbd_window *in, const mbd_outcome *out, tdm_error *err) {
  const mbd_model *m = s->model;
  if (mbd_model_check_times(m, in->t0, in->t1, err) ||
      mbd_data_set_load(s->data, m, in->t0, in->t1, in->nload, in->load, err) || integrate(s, in, out, err))
    return err->status;
  for (int k = 0; k < m->ncoupled && out->state; k++)
    out->state[k] = mbd_body_state(s->data->y, m->coupled[k]);
  mbd_energies energies = energies_now(s, in->t1);
  if (mbd_guard_look(m, s->data, in->t1, energies, err))
    return err->status;
  if (out->energy)
    *out->energy = energy_of(s, energies);
  if (in->ahead > 0 && s->ahead && out->path && mbd_ahead_path(s->ahead, s->data, in->t1, in->ahead, out->path, err))
    return err->status;
  return linearise(s, in->t1, out->acceleration, out->mobility, err);
}

tdm_status mbd_engine_advance(mbd_engine *s, const mbd_window *in, const mbd_outcome *out, tdm_error *err) {
  const unsigned long before = tdm_memory_notes();
  advance(s, in, out, err);
  return tdm_memory_since(before, "mbd", err);
}

void mbd_engine_limit_steps(mbd_engine *s, long most) {
  s->steps = 0;
  s->most_steps = most;
}

/* ---- states in memory ---- */

tdm_status mbd_engine_save(mbd_engine *s, int slot, tdm_error *err) {
  mbd_data **kept = &s->slot[slot].data;
  if (!*kept)
    *kept = mbd_data_create(s->model);
  if (!*kept)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory to save the state");
  mbd_data_copy(s->model, *kept, s->data);
  if (s->integrator->save && s->started && s->integrator->save(s->integration, &s->slot[slot].integration, err))
    return err->status;
  s->started = s->started && s->integrator->save; /* else it starts again, here and after RESTORE */
  s->slot[slot].started = s->started;
  mbd_kkt_reset(s->kkt); /* the run goes on with the bits of one that is restored */
  return TDM_OK;
}

tdm_status mbd_engine_restore(mbd_engine *s, int slot, tdm_error *err) {
  if (!s->slot[slot].data)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "RESTORE of slot %d, in which nothing was saved", slot);
  mbd_data_copy(s->model, s->data, s->slot[slot].data);
  mbd_kkt_reset(s->kkt);
  s->started = s->slot[slot].started;
  return s->started ? s->integrator->restore(s->integration, s->slot[slot].integration, err) : TDM_OK;
}

/* ---- observe ---- */

const mbd_model *mbd_engine_model(const mbd_engine *s) {
  return s->model;
}

const mbd_data *mbd_engine_data(const mbd_engine *s) {
  return s->data;
}

tdm_status mbd_engine_scenery(const mbd_engine *s, tdm_scenery *scenery, tdm_error *err) {
  return mbd_view_scenery(s->model, scenery, err);
}

tdm_status mbd_engine_snapshot(const mbd_engine *s, tdm_snapshot *snapshot, tdm_error *err) {
  return s->sampled ? mbd_view_snapshot(s->model, s->sampled_at, s->sampled, snapshot, err)
                    : mbd_view_snapshot(s->model, s->data->t, s->data->y, snapshot, err);
}

const mbd_stats *mbd_engine_stats(mbd_engine *s) {
  s->integrator->stats(s->integration);
  return &s->data->stats;
}

double mbd_engine_energy_off(const mbd_engine *s, double *share) {
  *share = s->data->guard.share;
  return s->data->guard.off;
}
