/* An FMU as the multibody side of a co-simulation: see solver.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/foreign/fmu/solver.h"

#include "mbd/foreign/fmu/response.h"
#include "protocol/version.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static tdm_fmu *opened; /* the process has one */

/* What a window begins with, and what is kept of it in a slot. */
typedef struct {
  void *fmu;        /* the FMU's own state; NULL: none kept */
  double t;         /* [s] */
  tdm_state *state; /* (nbody) at t */
  double *outputs;  /* (noutput) at t */
  double *past;     /* (2 x 6 nbody) twists one and two steps ago */
  int npast;        /* how many there are */
  double h;         /* the last step [s] */
} moment;

typedef struct {
  tdm_participant *participant; /* borrowed */
  fmu_mapping map;
  fmu_response response;
  bool wants_mobility, wants_acceleration;
  double start, stop; /* of the run [s] */
  moment now;
  moment slot[TDM_SLOTS_MAX];
  /* room for a step */
  double *inputs, *outputs;
  tdm_state *before, *middle; /* (nbody) */
  tdm_wrench *load, *held;    /* (nbody) mean over the last step; at the end of the window */
  double *acceleration;       /* (6 nbody) */
  tdm_assigned_body *body;    /* (nbody) */
  tdm_channel *channel;
  double *initial;
  tdm_mobility mobility;
  json_t *report;
} solver;

/* ---- moments ---- */

static size_t past_size(const solver *s) {
  return 2 * 6 * (size_t)s->map.nbody;
}

static bool moment_init(moment *m, const solver *s) {
  m->state = calloc((size_t)s->map.nbody + 1, sizeof *m->state);
  m->outputs = calloc((size_t)s->map.outputs.nvalue + 1, sizeof *m->outputs);
  m->past = calloc(past_size(s) + 1, sizeof *m->past);
  return m->state && m->outputs && m->past;
}

static void moment_copy(moment *to, const moment *from, const solver *s) {
  to->t = from->t;
  to->npast = from->npast;
  to->h = from->h;
  memcpy(to->state, from->state, (size_t)s->map.nbody * sizeof *to->state);
  memcpy(to->outputs, from->outputs, (size_t)s->map.outputs.nvalue * sizeof *to->outputs);
  memcpy(to->past, from->past, past_size(s) * sizeof *to->past);
}

static void moment_free(moment *m, tdm_fmu *fmu) {
  tdm_fmu_forget(fmu, &m->fmu);
  free(m->state);
  free(m->outputs);
  free(m->past);
}

/* ---- start ---- */

/* Outputs and states of the FMU where it is. */
static tdm_status look(solver *s, tdm_error *err) {
  const fmu_list *out = &s->map.outputs;
  if (tdm_fmu_get(opened, out->reference, out->nvariable, s->now.outputs, out->nvalue, err) == TDM_OK)
    fmu_mapping_states(&s->map, s->now.outputs, s->now.state);
  return err->status;
}

/* An instance at the start of the run. */
static tdm_status begin(solver *s, tdm_error *err) {
  const tdm_fmu_experiment experiment = {.start = s->start, .stop = s->stop, .tolerance = s->map.tolerance};
  if (tdm_fmu_instantiate(opened, err) == TDM_OK && fmu_mapping_start(&s->map, err) == TDM_OK &&
      tdm_fmu_initialize(opened, &experiment, err) == TDM_OK)
    look(s, err);
  return err->status;
}

/* Accelerations where it is, under a load that is held from now on; `last`: the instance is thrown away after it. */
static tdm_status accelerate(solver *s, const tdm_wrench *load, bool last, tdm_error *err) {
  const fmu_mapping *m = &s->map;
  if (!m->accelerates)
    return fmu_response_accelerations(&s->response, s->now.t, s->now.state, load, last, s->acceleration, err);
  fmu_mapping_accelerations(m, s->now.outputs, s->now.state, false, s->acceleration);
  const int k = 6 * m->nbody;
  const double *to = (const double *)load, *from = (const double *)s->load;
  for (int i = 0; s->wants_mobility && i < k; i++) /* the outputs are those under the last step's mean */
    for (int j = 0; j < k; j++)
      s->acceleration[i] += s->response.Y[i * k + j] * (to[j] - from[j]);
  return TDM_OK;
}

/* Accelerations at the start of FMUs that have none among their outputs and cannot go back: of an instance of its own
 * that is thrown away; zero where the process may have one instance only. */
static tdm_status accelerate_at_start(solver *s, tdm_error *err) {
  if (s->map.accelerates || opened->description.keeps_states)
    return accelerate(s, s->held, false, err);
  if (opened->description.once_per_process)
    return TDM_OK;
  accelerate(s, s->held, true, err);
  tdm_fmu_end(opened);
  return err->status == TDM_OK ? begin(s, err) : err->status;
}

static bool make_room(solver *s) {
  const size_t n = (size_t)s->map.nbody + 1, nchannel = (size_t)s->map.nchannel + 1;
  bool good = moment_init(&s->now, s);
  s->inputs = calloc((size_t)s->map.inputs.nvalue + 1, sizeof *s->inputs);
  s->outputs = calloc((size_t)s->map.outputs.nvalue + 1, sizeof *s->outputs);
  s->before = calloc(n, sizeof *s->before);
  s->middle = calloc(n, sizeof *s->middle);
  s->load = calloc(n, sizeof *s->load);
  s->held = calloc(n, sizeof *s->held);
  s->acceleration = calloc(6 * n, sizeof *s->acceleration);
  s->body = calloc(n, sizeof *s->body);
  s->channel = calloc(nchannel, sizeof *s->channel);
  s->initial = calloc(nchannel, sizeof *s->initial);
  good = good && s->inputs && s->outputs && s->before && s->middle && s->load && s->held && s->acceleration && s->body;
  return good && s->channel && s->initial;
}

static json_t *report_of(const solver *s) {
  const tdm_fmi_description *d = &opened->description;
  const char *mobility = s->response.by_derivatives ? "directional derivatives"
                         : d->keeps_states          ? "trials with saved states"
                                                    : "none";
  return json_pack("{s:s, s:s, s:s?, s:f, s:s, s:b, s:b}", "fmu", opened->file, "fmi", d->version == 3 ? "3.0" : "2.0",
                   "tool", d->tool, "communication_step_s", s->map.step, "mobility", mobility, "saves_states",
                   d->keeps_states, "acceleration_outputs", s->map.accelerates);
}

static void fill_ready(solver *s, tdm_ready *ready) {
  for (int i = 0; i < s->map.nbody; i++) {
    const fmu_body *b = &s->map.body[i];
    s->body[i] = (tdm_assigned_body){
        .name = b->name, .mass = b->mass, .inertia = b->inertia, .state = s->now.state[i], .scale = 1};
  }
  for (int i = 0; i < s->map.nchannel; i++) {
    s->channel[i] = s->map.channel[i].channel;
    s->initial[i] = s->now.outputs[s->map.channel[i].at];
  }
  s->report = report_of(s);
  s->mobility = (tdm_mobility){.nbody = s->map.nbody, .Y = s->response.Y};
  *ready = (tdm_ready){.body = s->body,
                       .acceleration = s->acceleration,
                       .mobility = s->wants_mobility ? &s->mobility : NULL,
                       .nchannel = s->map.nchannel,
                       .channel = s->channel,
                       .initial = s->initial,
                       .report = s->report};
}

static tdm_status create(void **self, const tdm_assignment *a, tdm_ready *ready, tdm_participant *p, tdm_error *err) {
  solver *s = calloc(1, sizeof *s);
  *self = s;
  if (!s)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  s->participant = p;
  s->start = s->now.t = a->time_start;
  s->stop = a->time_end;
  s->wants_mobility = a->mobility;
  s->wants_acceleration = a->acceleration;
  if (fmu_mapping_read(&s->map, opened, a, err) != TDM_OK)
    return err->status;
  if (!make_room(s))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  const double trial = opened->description.varies_step ? fmin(s->map.step, a->dt) : s->map.step;
  fmu_response_init(&s->response, &s->map, trial, err);
  if (err->status == TDM_OK && a->mobility && !s->response.by_derivatives && !opened->description.keeps_states)
    return tdm_fail(err, TDM_ERR_SCENE, "mbd.bodies",
                    "the scheme asks for the mobility; %s gives directional derivatives but keeps no states, so "
                    "\"acceleration\" and \"angular_acceleration\" must be among the outputs; or take coupling.scheme "
                    "\"dem-first\", \"lommen\" or \"hold\"",
                    opened->file);
  if (err->status == TDM_OK && begin(s, err) == TDM_OK && a->mobility)
    fmu_response_mobility(&s->response, s->now.t, s->now.state, s->held, err);
  if (err->status == TDM_OK && a->acceleration)
    accelerate_at_start(s, err);
  if (err->status == TDM_OK)
    fill_ready(s, ready);
  return err->status;
}

static void destroy(void *self) {
  solver *s = self;
  if (!s)
    return;
  for (int i = 0; i < TDM_SLOTS_MAX; i++)
    moment_free(&s->slot[i], opened);
  moment_free(&s->now, opened);
  fmu_response_free(&s->response);
  fmu_mapping_free(&s->map);
  tdm_fmu_end(opened);
  free(s->inputs);
  free(s->outputs);
  free(s->before);
  free(s->middle);
  free(s->load);
  free(s->held);
  free(s->acceleration);
  free(s->body);
  free(s->channel);
  free(s->initial);
  json_decref(s->report);
  free(s);
}

/* ---- windows ---- */

/* The mean of the load polynomial between two shares of the window. */
static void mean_load(const tdm_step *in, double s0, double s1, tdm_wrench *out) {
  for (int i = 0; i < in->nbody; i++) {
    out[i] = (tdm_wrench){0};
    for (int j = 0; j < in->nload; j++) {
      const double weight = (pow(s1, j + 1) - pow(s0, j + 1)) / ((j + 1) * (s1 - s0));
      const tdm_wrench *c = &in->load[i * in->nload + j];
      out[i].force = tdm_axpy(weight, c->force, out[i].force);
      out[i].moment = tdm_axpy(weight, c->moment, out[i].moment);
    }
  }
}

/* One communication step of the FMU, from the share s0 to s1 of the window. */
static tdm_status communicate(solver *s, const tdm_step *in, double s0, double s1, tdm_error *err) {
  const fmu_list *inputs = &s->map.inputs;
  const double window = in->t1 - in->t0, t = in->t0 + s0 * window, h = (s1 - s0) * window;
  const size_t k = 6 * (size_t)s->map.nbody;
  mean_load(in, s0, s1, s->load);
  for (int i = 0; i < s->map.nbody; i++) { /* the load acts where the body is in the middle of the step */
    s->before[i] = s->middle[i] = s->now.state[i];
    s->middle[i].pose.position = tdm_axpy(h / 2, s->now.state[i].twist.velocity, s->now.state[i].pose.position);
    s->middle[i].pose.orientation =
        tdm_quat_turned(s->now.state[i].pose.orientation, tdm_scale(h / 2, s->now.state[i].twist.angular));
  }
  fmu_mapping_inputs(&s->map, s->middle, s->load, s->inputs);
  memcpy(s->outputs, s->now.outputs, (size_t)s->map.outputs.nvalue * sizeof *s->outputs);
  if (tdm_fmu_set(opened, inputs->reference, inputs->nvariable, s->inputs, inputs->nvalue, err) != TDM_OK ||
      tdm_fmu_step(opened, t, h, !opened->description.keeps_states, err) != TDM_OK || look(s, err) != TDM_OK)
    return err->status;
  const bool same = fabs(h - s->now.h) < 1e-9 * h;
  memmove(s->now.past + k, s->now.past, k * sizeof(double));
  for (int i = 0; i < s->map.nbody; i++)
    memcpy(s->now.past + 6 * i, &s->before[i].twist, 6 * sizeof(double));
  s->now.npast = same && s->now.npast > 0 ? 2 : 1;
  s->now.h = h;
  s->now.t = t + h;
  return TDM_OK;
}

/* Samples up to the share s1 of the window, between the communication points before and now; all that are left if s1
 * is its end. */
static int take_samples(const solver *s, const tdm_step *in, double s0, double s1, int next, tdm_result *result) {
  const double window = in->t1 - in->t0, t0 = in->t0 + s0 * window, h = (s1 - s0) * window;
  for (; next < in->nsample && (s1 >= 1 || in->sample_time[next] <= t0 + h * (1 + 1e-9)); next++) {
    const double share = fmin(fmax((in->sample_time[next] - t0) / h, 0), 1);
    for (int i = 0; i < s->map.nbody; i++)
      result->sample_state[next * s->map.nbody + i] = tdm_state_between(&s->before[i], &s->now.state[i], h, share);
    for (int c = 0; c < s->map.nchannel; c++) {
      const int at = s->map.channel[c].at;
      result->channel[next * s->map.nchannel + c] = s->outputs[at] + share * (s->now.outputs[at] - s->outputs[at]);
    }
  }
  return next;
}

/* Communication steps in a window; 0 after an error. */
static long count_steps(const solver *s, const tdm_step *in, tdm_error *err) {
  const double window = in->t1 - in->t0, n = window / s->map.step;
  if (!(n < 1e9)) {
    tdm_fail(err, TDM_ERR_SCENE, "mbd.step",
             "a window of %g s would take %.3g communication steps of %g s; give a "
             "longer step",
             window, n, s->map.step);
    return 0;
  }
  if (opened->description.varies_step)
    return (long)fmax(ceil(n - 1e-6), 1);
  if (fabs(n - round(n)) > 1e-6 * fmax(n, 1) || n < 0.5) {
    tdm_fail(err, TDM_ERR_SCENE, "mbd.step",
             "%s takes communication steps of one length only, and a window of %g s is no multiple of %g s; give a "
             "step that divides all windows (time.dt does), or coupling.n",
             opened->file, window, s->map.step);
    return 0;
  }
  return (long)round(n);
}

/* Accelerations at the end by the last steps' velocities, where nothing else tells them. */
static void accelerate_by_past(solver *s, double *out) {
  const int k = 6 * s->map.nbody;
  for (int i = 0; i < k; i++) {
    const double v = ((const double *)(const void *)&s->now.state[i / 6].twist)[i % 6];
    const double one = s->now.past[i], two = s->now.past[k + i];
    out[i] = s->now.npast > 1 ? (3 * v - 4 * one + two) / (2 * s->now.h) : (v - one) / s->now.h;
  }
}

/* Are the accelerations among the outputs those of another load than the window's last: the mean over the last step,
 * without a mobility that tells the difference? */
static bool is_late(const solver *s) {
  return s->map.accelerates && !s->wants_mobility &&
         memcmp(s->load, s->held, (size_t)s->map.nbody * sizeof *s->load) != 0;
}

/* Accelerations and mobility at the end of a window, under the load polynomial's value there. */
static tdm_status respond(solver *s, const tdm_step *in, tdm_result *result, tdm_error *err) {
  const size_t k = 6 * (size_t)s->map.nbody;
  for (int i = 0; i < s->map.nbody; i++) {
    s->held[i] = (tdm_wrench){0};
    for (int j = 0; j < in->nload; j++) {
      s->held[i].force = tdm_add(s->held[i].force, in->load[i * in->nload + j].force);
      s->held[i].moment = tdm_add(s->held[i].moment, in->load[i * in->nload + j].moment);
    }
  }
  if (s->wants_mobility && fmu_response_mobility(&s->response, s->now.t, s->now.state, s->held, err) != TDM_OK)
    return err->status;
  if (s->wants_mobility)
    result->mobility = s->mobility;
  if (!s->wants_acceleration)
    return TDM_OK;
  if (is_late(s) && opened->description.keeps_states)
    fmu_response_accelerations(&s->response, s->now.t, s->now.state, s->held, false, s->acceleration, err);
  else if (is_late(s) ? s->now.npast < 2 : s->map.accelerates || opened->description.keeps_states)
    accelerate(s, s->held, false, err);
  else
    accelerate_by_past(s, s->acceleration);
  memcpy(result->acceleration, s->acceleration, k * sizeof(double));
  return err->status;
}

static tdm_status step(void *self, const tdm_step *in, tdm_result *result, tdm_error *err) {
  solver *s = self;
  if (in->nload > 0 && in->nbody != s->map.nbody)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "STEP carries %d bodies, ASSIGN named %d", in->nbody, s->map.nbody);
  const long n = count_steps(s, in, err);
  int next = 0;
  for (long k = 0; k < n && err->status == TDM_OK; k++) {
    const double s0 = (double)k / (double)n, s1 = (double)(k + 1) / (double)n;
    if (communicate(s, in, s0, s1, err) != TDM_OK)
      break;
    next = take_samples(s, in, s0, s1, next, result);
    if (tdm_participant_alive(s->participant) != TDM_OK)
      return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted");
  }
  if (err->status != TDM_OK)
    return err->status;
  memcpy(result->state, s->now.state, (size_t)s->map.nbody * sizeof *result->state);
  return respond(s, in, result, err);
}

/* ---- states ---- */

static tdm_status save(void *self, int slot, tdm_error *err) {
  solver *s = self;
  moment *m = &s->slot[slot];
  if (!m->state && !moment_init(m, s))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  if (tdm_fmu_keep(opened, &m->fmu, err) == TDM_OK)
    moment_copy(m, &s->now, s);
  return err->status;
}

static tdm_status restore(void *self, int slot, tdm_error *err) {
  solver *s = self;
  if (!s->slot[slot].fmu)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "nothing was saved in slot %d", slot);
  if (tdm_fmu_go_back(opened, s->slot[slot].fmu, err) == TDM_OK)
    moment_copy(&s->now, &s->slot[slot], s);
  opened->t = s->now.t;
  return err->status;
}

tdm_solver_ops fmu_solver_ops(tdm_fmu *fmu, const char **capability) {
  int n = 0;
  opened = fmu;
  capability[n++] = "acceleration";
  if (fmu->description.keeps_states)
    capability[n++] = "restore";
  if (fmu->description.keeps_states || fmu->description.gives_derivatives)
    capability[n++] = "mobility";
  return (tdm_solver_ops){.role = "mbd",
                          .software = "tandem-fmu " TDM_VERSION,
                          .capabilities = capability,
                          .ncapability = n,
                          .create = create,
                          .step = step,
                          .save = save,
                          .restore = restore,
                          .destroy = destroy};
}
