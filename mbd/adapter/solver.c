/* The multibody solver as a participant of a co-simulation: see solver.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/adapter/solver.h"

#include "mbd/adapter/ahead.h"
#include "mbd/adapter/guard.h"
#include "mbd/adapter/output.h"
#include "mbd/assembly/assemble.h"
#include "mbd/integrate/integrator.h"
#include "mbd/joint/frame.h"
#include "mbd/mechanics/energy.h"
#include "mbd/mechanics/free.h"
#include "mbd/reduced/reduced.h"
#include "mbd/scene/scene.h"
#include "protocol/base/log.h"
#include "protocol/version.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WARNINGS_MAX = 6 };

typedef struct {
  tdm_participant *participant; /* borrowed, NULL without a server */
  mbd_model *model;
  mbd_data *data;
  mbd_kkt *kkt;
  const mbd_integrator_ops *integrator;
  void *integration; /* the integrator's own */
  mbd_assembly assembly;
  bool started;
  bool acceleration;       /* of the coupled bodies, asked for */
  mbd_reduced *reduced;    /* NULL: not asked for */
  mbd_ahead *ahead;        /* NULL: not asked for */
  tdm_nodes path;          /* at the start */
  double *rate;            /* (6 ncoupled) accelerations at the start */
  tdm_mobility mobility;   /* at the start */
  tdm_energy energy;       /* at the start */
  tdm_assigned_body *body; /* (ncoupled) */
  int nchannel;
  tdm_channel *channel; /* (nchannel) */
  double *initial;      /* (nchannel) */
  int nwarning;
  tdm_warning warning[WARNINGS_MAX];
  json_t *report;
  struct {
    mbd_data *data; /* NULL: nothing was saved */
    void *integration;
    bool started;
  } slot[TDM_SLOTS_MAX];
} solver;

static void destroy(void *self) {
  solver *s = self;
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
  json_decref(s->report);
  free(s);
}

/* ---- create ---- */

/* Say so when the assembly changed more than rounding does. */
static void warn_about_assembly(solver *s) {
  const mbd_assembly *a = &s->assembly;
  if (a->translation > 1e-6 || a->rotation > 1e-6) {
    tdm_warning *w = &s->warning[s->nwarning++];
    snprintf(w->path, sizeof w->path, "mbd.bodies[%d].position", a->body);
    snprintf(w->message, sizeof w->message,
             "the joints and drivers do not fit the given start: body \"%s\" was moved (largest changes %.3g m, %.3g "
             "rad); correct the "
             "position, the orientation, the joints or the drivers' laws at the start",
             s->model->body[a->body].name, a->translation, a->rotation);
  }
  if (a->velocity > 1e-6 || a->angular > 1e-6) {
    tdm_warning *w = &s->warning[s->nwarning++];
    snprintf(w->path, sizeof w->path, "mbd.bodies[%d].velocity", a->body_velocity);
    snprintf(
        w->message, sizeof w->message,
        "the joints do not allow the given start velocities: those of body \"%s\" were changed (largest changes %.3g "
        "m/s, %.3g rad/s); give velocities that the joints allow",
        s->model->body[a->body_velocity].name, a->velocity, a->angular);
  }
  if (a->driver >= 0) {
    const mbd_driver *d = &s->model->driver[a->driver];
    const char *unit = mbd_coordinate_table[d->ops->coordinate].rate_unit;
    tdm_warning *w = &s->warning[s->nwarning++];
    snprintf(w->path, sizeof w->path, "mbd.drivers[%d]", a->driver);
    snprintf(
        w->message, sizeof w->message,
        "the given start velocities move the coordinate of driver \"%s\" at %.6g %s, its law starts at %.6g %s: the "
        "driver holds; give velocities that fit it, or none",
        d->name, a->given, unit, a->prescribed, unit);
  }
}

/* Files in millimetres: the largest mesh, where it is larger than machines are. */
static void warn_about_size(solver *s) {
  const double large = 10; /* radius of gyration [m] */
  const mbd_model *m = s->model;
  double most = large;
  int largest = -1;
  for (int b = 0; b < m->nbody; b++) {
    const tdm_mat3 *I = &m->body[b].inertia;
    const double gyration = sqrt((I->m[0][0] + I->m[1][1] + I->m[2][2]) / (2 * m->body[b].mass));
    if (m->body[b].mesh && gyration > most) {
      most = gyration;
      largest = b;
    }
  }
  if (largest < 0)
    return;
  tdm_warning *w = &s->warning[s->nwarning++];
  snprintf(w->path, sizeof w->path, "mbd.bodies[%d].shape", largest);
  snprintf(w->message, sizeof w->message,
           "the mesh gives body \"%s\" a radius of gyration of %.3g m and a mass of %.3g kg; is the file in "
           "millimetres? Give \"scale\": 0.001 beside \"file\"",
           m->body[largest].name, most, m->body[largest].mass);
}

/* Say so when joints lock the mechanism, or may do so by rounding. */
static void warn_about_freedom(solver *s) {
  if (s->assembly.near_row >= 0) {
    mbd_origin o = mbd_origin_of(s->model, s->assembly.near_row);
    tdm_warning *w = &s->warning[s->nwarning++];
    snprintf(w->path, sizeof w->path, "%s", o.path);
    snprintf(w->message, sizeof w->message,
             "the equation \"%s\" of %s \"%s\" follows nearly, but not exactly, from the joints before it, and takes a "
             "freedom away that the mechanism may need; make axes exactly parallel and points exactly fit, or use a "
             "joint with more freedom",
             o.equation, o.kind, o.name);
  }
  if (s->assembly.freedom <= 0 && s->model->ndriver == 0) {
    tdm_warning *w = &s->warning[s->nwarning++];
    snprintf(w->path, sizeof w->path, "mbd.joints");
    snprintf(w->message, sizeof w->message,
             "the joints leave no degree of freedom and there is no driver: nothing can move; use joints with more "
             "freedom where it should");
  }
}

/* mass, where the centre of mass is at the start, inertia as a scene gives it, and the origin of a mesh's file */
static json_t *report_body(const solver *s, int i) {
  const mbd_body *b = &s->model->body[i];
  const double(*m)[3] = b->inertia.m, inertia[] = {m[0][0], m[1][1], m[2][2], m[0][1], m[0][2], m[1][2]};
  tdm_pose pose = mbd_body_state(s->data->y, i).pose;
  json_t *json = json_pack("{s:f, s:o, s:o}", "mass", b->mass, "centre", tdm_numbers_to_json(&pose.position.x, 3),
                           "inertia", tdm_numbers_to_json(inertia, 6));
  if (b->mesh)
    json_object_set_new(json, "origin_of_file", tdm_numbers_to_json(&b->origin.x, 3));
  return json;
}

static json_t *make_report(const solver *s) {
  const mbd_model *m = s->model;
  json_t *bodies = json_object(), *joints = json_object(), *drivers = json_object();
  double mass = 0;
  for (int i = 0; i < m->nbody; i++) {
    json_object_set_new(bodies, m->body[i].name, report_body(s, i));
    mass += m->body[i].mass;
  }
  for (int i = 0; i < m->njoint; i++)
    json_object_set_new(joints, m->joint[i].name, json_string(m->joint[i].ops->name));
  for (int i = 0; i < m->ndriver; i++)
    json_object_set_new(drivers, m->driver[i].name, json_string(m->driver[i].ops->name));
  json_t *dependent = json_array();
  for (int i = 0; i < m->nrow - m->nfriction; i++)
    if (s->data->dependent[i]) {
      mbd_origin o = mbd_origin_of(m, i);
      json_array_append_new(dependent, json_pack("{s:s, s:s}", o.kind, o.name, "equation", o.equation));
    }
  return json_pack("{s:i, s:o, s:s, s:f, s:o, s:o, s:o, s:i, s:{s:f, s:f, s:f, s:f}}", "degrees_of_freedom",
                   s->assembly.freedom, "redundant", dependent, "formulation",
                   mbd_formulation_table[m->solver.formulation].name, "mass", mass, "bodies", bodies, "joints", joints,
                   "drivers", drivers, "forces", m->nforce, "assembly", "translation", s->assembly.translation,
                   "rotation", s->assembly.rotation, "velocity", s->assembly.velocity, "angular_velocity",
                   s->assembly.angular);
}

static mbd_energies energies_now(solver *s, double t) {
  mbd_kinematics(s->model, s->data, t, s->data->y);
  return mbd_energies_at(s->model, s->data);
}

/* Stored; supplied by what is not the coupling load. */
static tdm_energy energy_of(const solver *s, mbd_energies e) {
  return (tdm_energy){.kinetic = e.kinetic,
                      .stored = e.kinetic + e.potential + e.springs,
                      .supplied = s->data->work.supplied - s->data->work.coupled,
                      .exchanged = s->data->work.coupled};
}

/* Accelerations of the coupled bodies (6 ncoupled) and the reduced model at (t, data->y), as far as asked for. */
static tdm_status linearise(solver *s, double t, double *acceleration, tdm_mobility *mobility, tdm_error *err) {
  const mbd_model *m = s->model;
  bool good = true;
  if (s->reduced)
    good = mbd_reduced_at(m, s->data, s->kkt, s->reduced, t, s->data->y, mobility);
  else if (s->acceleration)
    good = mbd_accelerations(m, s->data, s->kkt, t, s->data->y);
  for (int k = 0; k < m->ncoupled && s->acceleration; k++)
    memcpy(acceleration + 6 * k, s->data->acceleration + 6 * m->coupled[k], 6 * sizeof(double));
  if (!good)
    return tdm_fail(err, TDM_ERR_NUMERIC, "mbd",
                    "no accelerations at t = %.9g s: the mechanism is in a singular position", t);
  return TDM_OK;
}

/* The same at the start, and a word when there is too much freedom. */
static tdm_status linearise_start(solver *s, const tdm_assignment *a, tdm_error *err) {
  s->acceleration = a->acceleration;
  s->rate = calloc(6 * (size_t)s->model->ncoupled + 1, sizeof *s->rate);
  s->reduced = a->mobility ? mbd_reduced_create(s->model, s->data) : NULL;
  if (!s->rate || (a->mobility && !s->reduced))
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for the reduced model");
  if (linearise(s, a->time_start, s->rate, &s->mobility, err))
    return err->status;
  const int freedom = s->reduced ? mbd_reduced_freedom(s->reduced) : 0;
  if (freedom > TDM_FREE_MAX) {
    tdm_log(TDM_LOG_INFO, "mobility_alone", "degrees_of_freedom=%d limit=%d", freedom, TDM_FREE_MAX);
    json_object_set_new(s->report, "reduced_model", json_string("mobility alone: too many degrees of freedom"));
  }
  return TDM_OK;
}

/* What READY needs: coupled bodies, channels with their start values, report. */
static tdm_status prepare(solver *s, double t, tdm_error *err) {
  const mbd_model *m = s->model;
  s->nchannel = mbd_output_count(m);
  s->body = calloc((size_t)m->ncoupled + 1, sizeof *s->body);
  s->channel = calloc((size_t)s->nchannel + 1, sizeof *s->channel);
  s->initial = calloc((size_t)s->nchannel + 1, sizeof *s->initial);
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
  mbd_output_names(m, s->channel);
  if (mbd_output_values(m, s->data, s->kkt, t, s->data->y, s->initial, err))
    return err->status;
  warn_about_assembly(s);
  warn_about_size(s);
  warn_about_freedom(s);
  s->report = make_report(s);
  return s->report ? TDM_OK : tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for the report");
}

/* tells the server, if there is one, that the solver lives; true when the work is no longer wanted, or in vain */
static bool should_stop(void *context) {
  solver *s = context;
  return tdm_participant_alive(s->participant) != TDM_OK || s->data->turned >= 0;
}

/* The path from the start on, if that is asked for. */
static tdm_status look_ahead(solver *s, const tdm_assignment *a, tdm_error *err) {
  if (!(a->ahead > a->time_start))
    return TDM_OK;
  if (mbd_ahead_create(&s->ahead, s->model, s->data, s->assembly.freedom, should_stop, s, err))
    return err->status;
  return mbd_ahead_path(s->ahead, s->data, a->time_start, a->ahead, &s->path, err);
}

static tdm_status create(void **self, const tdm_assignment *assignment, tdm_ready *ready, tdm_participant *p,
                         tdm_error *err) {
  solver *s = *self = calloc(1, sizeof *s);
  if (!s)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory");
  s->participant = p;
  if (mbd_model_read(&s->model, assignment->scene, assignment->restores, err) ||
      mbd_model_check_times(s->model, assignment->time_start, assignment->time_end, err) ||
      mbd_model_couple(s->model, assignment->body, assignment->nbody, err))
    return err->status;
  s->integrator = mbd_formulation_table[s->model->solver.formulation].integrator;
  s->data = mbd_data_create(s->model);
  s->kkt = mbd_kkt_create(s->model);
  if (!s->data || !s->kkt)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for %d bodies", s->model->nbody);
  s->data->t = assignment->time_start;
  if (mbd_assemble(s->model, s->data, s->kkt, &s->assembly, err) || prepare(s, assignment->time_start, err) ||
      linearise_start(s, assignment, err) || look_ahead(s, assignment, err) ||
      s->integrator->create(&s->integration, s->model, s->data, s->kkt, should_stop, s, err))
    return err->status;
  s->energy = energy_of(s, energies_now(s, assignment->time_start));
  *ready = (tdm_ready){.body = s->body,
                       .energy = &s->energy,
                       .acceleration = s->rate,
                       .mobility = &s->mobility,
                       .path = &s->path,
                       .prescribed = s->ahead ? mbd_ahead_prescribed(s->ahead) : NULL,
                       .nchannel = s->nchannel,
                       .channel = s->channel,
                       .initial = s->initial,
                       .nwarning = s->nwarning,
                       .warning = s->warning,
                       .gravity = &s->model->gravity,
                       .report = s->report};
  return TDM_OK;
}

/* ---- step ---- */

typedef struct {
  solver *self;
  tdm_result *result;
} sample_target;

static tdm_status sample(void *context, int i, double t, const double *y, tdm_error *err) {
  const sample_target *to = context;
  const mbd_model *m = to->self->model;
  tdm_result *r = to->result;
  for (int k = 0; k < m->ncoupled; k++)
    r->sample_state[i * m->ncoupled + k] = mbd_body_state(y, m->coupled[k]);
  return mbd_output_values(m, to->self->data, to->self->kkt, t, y, r->channel + i * to->self->nchannel, err);
}

/* A force has turned too far: says so in place of what came of it. */
static tdm_status refuse_turned(const solver *s, tdm_error *err) {
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

static tdm_status step(void *self, const tdm_step *in, tdm_result *result, tdm_error *err) {
  solver *s = self;
  const mbd_model *m = s->model;
  if (mbd_model_check_times(m, in->t0, in->t1, err) || mbd_data_set_load(s->data, m, in, err))
    return err->status;
  /* the consistent start waits for the first load */
  if (!s->started || m->solver.restart_each_window) {
    mbd_kkt_reset(s->kkt); /* so that nothing depends on what was before */
    if (s->integrator->start(s->integration, in->t0, err))
      return err->status;
  }
  s->started = true;
  sample_target to = {s, result};
  s->integrator->advance(s->integration, in->t1, in->nsample, in->sample_time, sample, &to, err);
  if (s->data->turned >= 0)
    return refuse_turned(s, err);
  if (err->status)
    return err->status;
  if (s->data->open_row >= 0) {
    mbd_origin o = mbd_origin_of(m, s->data->open_row);
    return tdm_fail(err, TDM_ERR_NUMERIC, o.path,
                    "the equation \"%s\" of %s \"%s\" followed from the joints before it at the start and contradicts "
                    "them at t = %.9g s: the mechanism is over-constrained; use joints with more freedom",
                    o.equation, o.kind, o.name, in->t1);
  }
  for (int k = 0; k < m->ncoupled; k++)
    result->state[k] = mbd_body_state(s->data->y, m->coupled[k]);
  mbd_energies energies = energies_now(s, in->t1);
  if (mbd_guard_look(m, s->data, in->t1, energies, err))
    return err->status;
  if (result->has_energy)
    *result->energy = energy_of(s, energies);
  if (in->ahead > 0 && s->ahead && mbd_ahead_path(s->ahead, s->data, in->t1, in->ahead, &result->path, err))
    return err->status;
  return linearise(s, in->t1, result->acceleration, &result->mobility, err);
}

/* ---- states in memory ---- */

static tdm_status save(void *self, int slot, tdm_error *err) {
  solver *s = self;
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

static tdm_status restore(void *self, int slot, tdm_error *err) {
  solver *s = self;
  if (!s->slot[slot].data)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "RESTORE of slot %d, in which nothing was saved", slot);
  mbd_data_copy(s->model, s->data, s->slot[slot].data);
  mbd_kkt_reset(s->kkt);
  s->started = s->slot[slot].started;
  return s->started ? s->integrator->restore(s->integration, s->slot[slot].integration, err) : TDM_OK;
}

const mbd_model *mbd_solver_model(const void *self) {
  return ((const solver *)self)->model;
}

const mbd_stats *mbd_solver_stats(void *self) {
  solver *s = self;
  s->integrator->stats(s->integration);
  return &s->data->stats;
}

double mbd_solver_off(const void *self, double *share) {
  const mbd_guard_state *g = &((const solver *)self)->data->guard;
  *share = g->share;
  return g->off;
}

static const char *const capabilities[] = {"restore", "acceleration", "mobility", "matched_load", "energy", "ahead"};

const tdm_solver_ops mbd_solver_ops = {
    .capabilities = capabilities,
    .ncapability = sizeof capabilities / sizeof capabilities[0],
    .role = "mbd",
    .software = "tandem-mbd " TDM_VERSION,
    .create = create,
    .step = step,
    .save = save,
    .restore = restore,
    .destroy = destroy,
};
