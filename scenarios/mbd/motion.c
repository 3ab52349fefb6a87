#include "scenarios/mbd/motion.h"

#include "protocol/find.h"
#include "protocol/log.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WINDOWS = 20 }; /* of a run: the wall time is looked at between them */

json_t *scn_motion_scene(cpl_verify *v, const char *name, tdm_error *err) {
  char file[4096];
  tdm_scene scene = {0};
  json_t *mbd = NULL;
  if (cpl_verify_find(v, "mbd", name, file, sizeof file, err) == TDM_OK && tdm_scene_read(&scene, file, err) == TDM_OK)
    mbd = json_incref(json_object_get(scene.root, "mbd"));
  tdm_scene_destroy(&scene);
  return mbd;
}

/* a copy of the section with the method in it */
static json_t *with_method(const json_t *mbd, const scn_method *method, double tolerance) {
  json_t *copy = json_deep_copy(mbd), *solver = json_object_get(copy, "solver");
  json_object_set_new(copy, "formulation", json_string(method->formulation));
  json_object_set_new(copy, "corrector", json_string(method->corrector));
  if (!solver) {
    solver = json_object();
    json_object_set_new(copy, "solver", solver);
  }
  json_object_set_new(solver, "relative_tolerance", json_real(tolerance));
  return copy;
}

static tdm_status allocate(scn_motion *m, const tdm_ready *ready, int nstep, tdm_error *err) {
  m->nchannel = ready->nchannel;
  m->nsample = nstep + 1;
  m->channel = calloc((size_t)m->nchannel, sizeof *m->channel);
  m->time = calloc((size_t)m->nsample, sizeof *m->time);
  m->value = calloc((size_t)m->nsample * (size_t)m->nchannel, sizeof *m->value);
  if (!m->channel || !m->time || !m->value)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  memcpy(m->channel, ready->channel, (size_t)m->nchannel * sizeof *m->channel);
  memcpy(m->value, ready->initial, (size_t)m->nchannel * sizeof *m->value);
  m->report = json_incref(ready->report);
  return TDM_OK;
}

/* windows up to the end; samples are taken from dense output */
static tdm_status integrate(scn_motion *m, void *solver, double budget, tdm_error *err) {
  double end = m->time[m->nsample - 1], begin = tdm_clock();
  int next = 1;
  for (int w = 0; w < WINDOWS && err->status == TDM_OK; w++) {
    tdm_step step = {.window = (uint64_t)w, .t0 = m->last, .t1 = end * (w + 1) / WINDOWS, .nstep = 1};
    step.sample_time = m->time + next;
    while (next + step.nsample < m->nsample && m->time[next + step.nsample] <= step.t1)
      step.nsample++;
    tdm_result result = {.nsample = step.nsample, .nchannel = m->nchannel, .channel = m->value + next * m->nchannel};
    mbd_solver_ops.step(solver, &step, &result, err);
    m->last = step.t1;
    next += step.nsample;
    if (err->status == TDM_OK && tdm_clock() - begin > budget)
      tdm_fail(err, TDM_ERR_LIMIT, NULL, "stopped after %g s of wall time at t = %g s of %g s", budget, m->last, end);
  }
  m->wall = tdm_clock() - begin;
  m->stats = *mbd_solver_stats(solver);
  return err->status;
}

tdm_status scn_motion_run(scn_motion *m, const json_t *mbd, const scn_method *method, double tolerance, double end,
                          int nstep, double budget, tdm_error *err) {
  *m = (scn_motion){0};
  json_t *scene = with_method(mbd, method, tolerance);
  const tdm_assignment assignment = {.scene = scene, .time_end = end, .dt = end / nstep, .n = 1};
  tdm_ready ready = {0};
  void *solver = NULL;
  if (mbd_solver_ops.create(&solver, &assignment, &ready, NULL, err) == TDM_OK &&
      allocate(m, &ready, nstep, err) == TDM_OK) {
    for (int i = 0; i <= nstep; i++)
      m->time[i] = end * i / nstep;
    integrate(m, solver, budget, err);
  }
  mbd_solver_ops.destroy(solver);
  json_decref(scene);
  return err->status;
}

void scn_motion_free(scn_motion *m) {
  free(m->channel);
  free(m->time);
  free(m->value);
  json_decref(m->report);
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
  const double *potential = scn_motion_channel(m, "energy.potential");
  const double *supplied = scn_motion_channel(m, "energy.supplied"), none = 0;
  double least = INFINITY, greatest = 0, worst = 0, E0 = kinetic[0] + potential[0];
  for (int i = 0; i < m->nsample; i++) {
    int at = i * m->nchannel;
    worst = fmax(worst, fabs(kinetic[at] + potential[at] - E0 - (supplied ? supplied[at] - supplied[0] : none)));
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
