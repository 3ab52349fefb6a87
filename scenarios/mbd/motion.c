/* A mechanism's motion: see motion.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/mbd/motion.h"
#include "mbd/assembly/assemble.h"
#include "mbd/scene/scene.h"

#include "mbd/adapter/output.h"
#include "mbd/integrate/integrator.h"
#include "protocol/app/command_line.h"
#include "protocol/base/log.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

json_t *scn_motion_section(const char *file, tdm_error *err) {
  tdm_scene scene = {0};
  json_t *mbd = tdm_scene_read(&scene, file, err) == TDM_OK ? json_incref(json_object_get(scene.root, "mbd")) : NULL;
  tdm_scene_destroy(&scene);
  return mbd;
}

json_t *scn_motion_scene(cpl_verify *v, const char *name, tdm_error *err) {
  char file[4096];
  return cpl_verify_find(v, "mbd", name, file, sizeof file, err) == TDM_OK ? scn_motion_section(file, err) : NULL;
}

/* a copy of the section with the method in it */
static json_t *with_method(const json_t *mbd, const scn_method *method, double tolerance, double absolute) {
  json_t *copy = json_deep_copy(mbd), *solver = json_object_get(copy, "solver");
  json_object_set_new(copy, "formulation", json_string(method->formulation));
  json_object_set_new(copy, "corrector", json_string(method->corrector));
  if (!solver) {
    solver = json_object();
    json_object_set_new(copy, "solver", solver);
  }
  json_object_set_new(solver, "relative_tolerance", json_real(tolerance));
  if (absolute > 0)
    json_object_set_new(solver, "absolute_tolerance", json_real(absolute * tolerance));
  return copy;
}

/* the solver's library at work on one scene */
typedef struct {
  scn_motion *motion;
  mbd_model *model;
  mbd_data *data;
  mbd_kkt *kkt;
  const mbd_integrator_ops *ops;
  void *integrator;
  double stop; /* wall clock [s] */
} engine;

static bool should_stop(void *context) {
  return tdm_interrupted || tdm_clock() > ((engine *)context)->stop;
}

static tdm_status take_sample(void *context, int i, double t, const double *y, tdm_error *err) {
  engine *e = context;
  scn_motion *m = e->motion;
  return mbd_output_values(e->model, e->data, e->kkt, t, y, m->value + (i + 1) * m->nchannel, err);
}

static tdm_status load(engine *e, json_t *mbd, tdm_error *err) {
  mbd_assembly assembly;
  if (mbd_model_read(&e->model, mbd, false, err) != TDM_OK || mbd_model_couple(e->model, NULL, 0, err) != TDM_OK)
    return err->status;
  e->data = mbd_data_create(e->model);
  e->kkt = mbd_kkt_create(e->model);
  e->ops = mbd_formulation_table[e->model->solver.formulation].integrator;
  if (!e->data || !e->kkt)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  if (mbd_assemble(e->model, e->data, e->kkt, &assembly, err) != TDM_OK)
    return err->status;
  e->motion->freedom = assembly.freedom;
  return e->ops->create(&e->integrator, e->model, e->data, e->kkt, should_stop, e, err);
}

/* memory for the samples; the first is the start */
static tdm_status prepare(engine *e, double end, int nstep, tdm_error *err) {
  scn_motion *m = e->motion;
  m->nchannel = mbd_output_count(e->model);
  m->nsample = nstep + 1;
  m->channel = calloc((size_t)m->nchannel, sizeof *m->channel);
  m->time = calloc((size_t)m->nsample, sizeof *m->time);
  m->value = calloc((size_t)m->nsample * (size_t)m->nchannel, sizeof *m->value);
  if (!m->channel || !m->time || !m->value)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int i = 0; i <= nstep; i++)
    m->time[i] = end * i / nstep;
  mbd_output_names(e->model, m->channel);
  return take_sample(e, -1, 0, e->data->y, err);
}

static tdm_status integrate(engine *e, double budget, tdm_error *err) {
  scn_motion *m = e->motion;
  double begin = tdm_clock();
  e->stop = begin + budget;
  if (e->ops->start(e->integrator, 0, err) == TDM_OK)
    e->ops->advance(e->integrator, m->time[m->nsample - 1], m->nsample - 1, m->time + 1, take_sample, e, err);
  m->wall = tdm_clock() - begin;
  if (err->status == TDM_ERR_INTERRUPTED && !tdm_interrupted) /* it was the budget */
    err->status = TDM_ERR_LIMIT;
  e->ops->stats(e->integrator);
  m->stats = e->data->stats;
  return err->status;
}

tdm_status scn_motion_run(scn_motion *m, const json_t *mbd, const scn_method *method, double tolerance, double absolute,
                          double end, int nstep, double budget, tdm_error *err) {
  *m = (scn_motion){0};
  engine e = {.motion = m};
  json_t *scene = with_method(mbd, method, tolerance, absolute);
  if (load(&e, scene, err) == TDM_OK && prepare(&e, end, nstep, err) == TDM_OK)
    integrate(&e, budget, err);
  if (e.integrator)
    e.ops->destroy(e.integrator);
  mbd_kkt_destroy(&e.kkt);
  mbd_data_destroy(&e.data);
  mbd_model_destroy(&e.model);
  json_decref(scene);
  return err->status;
}

void scn_motion_free(scn_motion *m) {
  free(m->channel);
  free(m->time);
  free(m->value);
  *m = (scn_motion){0};
}

const double *scn_motion_channel(const scn_motion *m, const char *format, ...) {
  char name[128];
  va_list args;
  va_start(args, format);
  vsnprintf(name, sizeof name, format, args);
  va_end(args);
  for (int c = 0; c < m->nchannel; c++)
    if (strcmp(m->channel[c].name, name) == 0)
      return m->value + c;
  return NULL;
}

bool scn_motion_angle(const scn_motion *m, const char *body, double *out) {
  const double *w = scn_motion_channel(m, "body.%s.qw", body), *z = scn_motion_channel(m, "body.%s.qz", body);
  for (int i = 0; w && z && i < m->nsample; i++) {
    double angle = 2 * atan2(z[i * m->nchannel], w[i * m->nchannel]);
    out[i] = i == 0 ? remainder(angle, 2 * M_PI) : out[i - 1] + remainder(angle - out[i - 1], 2 * M_PI);
  }
  return w && z;
}

double scn_motion_energy_drift(const scn_motion *m) {
  const double *kinetic = scn_motion_channel(m, "energy.kinetic");
  const double *balance = scn_motion_channel(m, "energy.balance");
  double least = INFINITY, greatest = 0, worst = 0;
  for (int i = 0; i < m->nsample; i++) {
    int at = i * m->nchannel;
    worst = fmax(worst, fabs(balance[at] - balance[0]));
    least = fmin(least, kinetic[at]);
    greatest = fmax(greatest, kinetic[at]);
  }
  double range = greatest - least;
  return worst / (range > 1e-3 * greatest ? range : greatest);
}

double scn_motion_drift(const scn_motion *m) {
  const double *drift = scn_motion_channel(m, "constraint.drift");
  double worst = 0;
  for (int i = 0; i < m->nsample; i++)
    worst = fmax(worst, drift[i * m->nchannel]);
  return worst;
}
