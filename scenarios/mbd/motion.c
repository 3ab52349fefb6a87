/* A mechanism's motion: see motion.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/mbd/motion.h"

#include "mbd/mbd.h"
#include "protocol/base/log.h"
#include "protocol/parameters/load.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

json_t *scn_motion_section(const char *file, tdm_error *err) {
  tdm_scene scene = {0};
  json_t *mbd =
      tdm_scene_load(&scene, file, NULL, err) == TDM_OK ? json_incref(json_object_get(scene.root, "mbd")) : NULL;
  tdm_scene_locate(&scene, err);
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
  json_object_set_new(copy, "guard", json_pack("{s:s}", "action", "off")); /* errors are what is looked for */
  if (!solver) {
    solver = json_object();
    json_object_set_new(copy, "solver", solver);
  }
  json_object_set_new(solver, "relative_tolerance", json_real(tolerance));
  if (absolute > 0)
    json_object_set_new(solver, "absolute_tolerance", json_real(absolute * tolerance));
  return copy;
}

/* memory for the samples; the first is the start */
static tdm_status prepare(scn_motion *m, const mbd_start *start, double end, int nstep, tdm_error *err) {
  const size_t nchannel = (size_t)start->nchannel;
  m->freedom = start->freedom;
  m->nchannel = start->nchannel;
  m->nsample = nstep + 1;
  m->channel = calloc(nchannel, sizeof *m->channel);
  m->time = calloc((size_t)m->nsample, sizeof *m->time);
  m->value = calloc((size_t)m->nsample * nchannel, sizeof *m->value);
  if (!m->channel || !m->time || !m->value)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int i = 0; i <= nstep; i++)
    m->time[i] = end * i / nstep;
  memcpy(m->channel, start->channel, nchannel * sizeof *m->channel);
  memcpy(m->value, start->initial, nchannel * sizeof *m->value);
  return TDM_OK;
}

static tdm_status integrate(scn_motion *m, mbd_engine *engine, long most_steps, tdm_error *err) {
  const mbd_window window = {.t1 = m->time[m->nsample - 1], .nsample = m->nsample - 1, .sample_time = m->time + 1};
  const mbd_outcome outcome = {.channel = m->value + m->nchannel};
  double begin = tdm_clock();
  mbd_engine_limit_steps(engine, most_steps);
  mbd_engine_advance(engine, &window, &outcome, err);
  m->wall = tdm_clock() - begin;
  m->stats = *mbd_engine_stats(engine);
  return err->status;
}

tdm_status scn_motion_run(scn_motion *m, const json_t *mbd, const scn_method *method, double tolerance, double absolute,
                          double end, int nstep, long most_steps, tdm_error *err) {
  *m = (scn_motion){0};
  mbd_engine *engine = NULL;
  json_t *scene = with_method(mbd, method, tolerance, absolute);
  const tdm_assignment assignment = {.scene = scene, .time_end = end, .dt = end, .n = 1};
  if (mbd_engine_create(&engine, &assignment, NULL, err) == TDM_OK &&
      prepare(m, mbd_engine_start(engine), end, nstep, err) == TDM_OK)
    integrate(m, engine, most_steps, err);
  mbd_engine_destroy(&engine);
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
