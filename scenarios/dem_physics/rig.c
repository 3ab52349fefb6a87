/* A small scene of particles in memory: see rig.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE /* vasprintf */
#include "scenarios/dem_physics/rig.h"

#include "dem/particles/create.h"
#include "dem/particles/field.h"
#include "dem/scene/scene.h"
#include "dem/settle/settle.h"
#include "dem/step/forces.h"
#include "dem/step/step.h"
#include "dem/watch/energy_balance.h"
#include "protocol/app/command_line.h"
#include "protocol/base/log.h"
#include "protocol/results/results.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* JSON text with ' for " as a section; NULL and an error. */
static json_t *parse(const char *format, va_list args, tdm_error *err) {
  char *text = NULL;
  json_error_t error;
  if (vasprintf(&text, format, args) < 0) {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    return NULL;
  }
  for (char *c = text; *c; c++)
    if (*c == '\'')
      *c = '"';
  json_t *json = json_loads(text, JSON_REJECT_DUPLICATES, &error);
  if (!json)
    tdm_fail(err, TDM_ERR_JSON, NULL, "built-in scene, line %d column %d: %s", error.line, error.column, error.text);
  free(text);
  return json;
}

tdm_status scn_rig_open(scn_rig *rig, cpl_verify *v, double dt, tdm_error *err, const char *format, ...) {
  *rig = (scn_rig){.verify = v, .dt = dt, .begin = tdm_clock()};
  va_list args;
  va_start(args, format);
  rig->scene = parse(format, args, err);
  va_end(args);
  if (!rig->scene)
    return err->status;
  const tdm_assignment assignment = {.scene = rig->scene, .time_end = 1, .dt = dt, .n = 1};
  if (dem_model_read(&rig->model, &assignment, err) != TDM_OK)
    return err->status;
  rig->data = dem_data_create(rig->model);
  if (!rig->data)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %d particles", rig->model->nparticle);
  if (dem_forces_begin(rig->data, err))
    return err->status;
  dem_settled settled;
  return rig->model->settle.wanted ? dem_settle(rig->data, NULL, &settled, err) : TDM_OK;
}

tdm_status scn_rig_steps(scn_rig *rig, long n, tdm_error *err) {
  dem_data *d = rig->data;
  for (long k = 0; k < n; k++) {
    const dem_step_task task = {.dt = rig->dt, .time = (double)(d->state.nstep + 1) * rig->dt, .flow = true};
    if (dem_step(d, &task, err))
      return err->status;
    rig->time += rig->dt;
    if (tdm_interrupted)
      return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted");
  }
  return TDM_OK;
}

void scn_rig_close(scn_rig *rig) {
  if (rig->data)
    cpl_verify_alone(rig->verify, CPL_DEM, rig->time, tdm_clock() - rig->begin);
  dem_data_destroy(&rig->data);
  dem_model_destroy(&rig->model);
  json_decref(rig->scene);
  rig->scene = NULL;
}

double scn_rig_kinetic(const scn_rig *rig) {
  return dem_kinetic_energy(rig->data);
}

/* ---- impacts ---- */

typedef struct {
  double overlap, rate, force; /* rate: of approach [m/s] */
} contact_now;

static contact_now look(const dem_data *d) {
  const dem_sphere *s = d->state.sphere;
  tdm_vec3 n = tdm_v3(0, 0, 1), v = d->state.pace[0].velocity;
  double distance = s[0].position.z - s[0].radius;
  if (d->state.nparticle > 1) {
    tdm_vec3 way = tdm_sub(s[0].position, s[1].position);
    distance = tdm_norm(way) - s[0].radius - s[1].radius;
    n = tdm_scale(1 / tdm_norm(way), way);
    v = tdm_sub(v, d->state.pace[1].velocity);
  }
  return (contact_now){-distance, -tdm_dot(v, n), tdm_dot(d->state.push[0].force, n)};
}

tdm_status scn_rig_impact(scn_rig *rig, long most, scn_impact *impact, scn_impact_watch *watch, void *context,
                          tdm_error *err) {
  *impact = (scn_impact){0};
  contact_now before[2] = {{0}}, now = {0};
  for (long k = 1;; k++) {
    before[1] = before[0], before[0] = now;
    if (k > most)
      return tdm_fail(err, TDM_ERR_NUMERIC, NULL, "still in contact after %ld steps", most);
    if (scn_rig_steps(rig, 1, err) != TDM_OK)
      return err->status;
    now = look(rig->data);
    double t = (double)k * rig->dt;
    if (watch)
      watch(context, t, fmax(0, now.overlap), now.force);
    impact->overlap = fmax(impact->overlap, now.overlap);
    impact->force = fmax(impact->force, now.force);
    if (impact->push_time == 0 && now.force <= 0 && before[0].force > 0) /* along the slope that it came with */
      impact->push_time = t - rig->dt * (1 - fmin(1, before[0].force / (before[1].force - before[0].force)));
    if (now.overlap <= 0) {
      impact->time = t - now.overlap / now.rate;
      break;
    }
  }
  for (int i = 0; i < rig->data->state.nparticle && i < 2; i++) {
    impact->velocity[i] = rig->data->state.pace[i].velocity;
    impact->spin[i] = rig->data->state.pace[i].spin;
  }
  return TDM_OK;
}

/* ---- results ---- */

void scn_worst(double *most, double difference) {
  if (!(fabs(difference) <= *most))
    *most = isnan(*most) ? NAN : fabs(difference);
}

FILE *scn_curve(cpl_verify *v, const char *name, tdm_error *err) {
  char file[4352];
  if (tdm_make_directory(cpl_verify_dir(v), err) != TDM_OK)
    return NULL;
  snprintf(file, sizeof file, "%s/%s", cpl_verify_dir(v), name);
  FILE *f = fopen(file, "w");
  if (!f)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno));
  return f;
}
