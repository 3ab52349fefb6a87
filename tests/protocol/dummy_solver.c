/* A solver in about a hundred lines, written with the participant API: it stands in for dem with one spring a body.
 *
 * Each coupled body is pulled back to where it started: F = -k (x - x0), k = scene.stiffness [N/m]. Its section:
 *
 *   "dem": {"stiffness": 100}
 *
 * Run by the server as: dummy_solver --connect ENDPOINT --name NAME --timeout SECONDS
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/base/log.h"
#include "protocol/scene/scene.h"
#include "protocol/wire/participant.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
  int nbody;
  double stiffness;
  tdm_vec3 start[16]; /* (nbody) */
  tdm_vec3 sum[16];   /* (nbody) loads since the last output time */
  tdm_vec3 mean[16];  /* (nbody) of those until then */
  long nsum;
} dummy;

static tdm_status load_scene(dummy *d, const tdm_assignment *a, tdm_error *err) {
  tdm_object scene = tdm_object_open(a->scene, "dem", err);
  d->stiffness = tdm_get_number(&scene, "stiffness", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  tdm_object_close(&scene);
  if (a->nbody > 16)
    tdm_fail(err, TDM_ERR_SCENE, "coupling.bodies", "the dummy takes at most 16 bodies");
  d->nbody = a->nbody;
  for (int i = 0; i < a->nbody && err->status == TDM_OK; i++)
    d->start[i] = a->body[i].state.pose.position;
  return err->status;
}

/* The mean load after each of the window's steps, on the straight path from start to end. */
static void solve(dummy *d, const tdm_step *step, tdm_result *result) {
  int sample = 0;
  for (uint64_t k = 1; k <= step->nstep; k++) {
    double s = (double)k / (double)step->nstep, t = step->t0 + s * (step->t1 - step->t0);
    for (int i = 0; i < d->nbody; i++) {
      tdm_vec3 x0 = step->start[i].pose.position, x1 = step->end[i].pose.position;
      tdm_vec3 x = tdm_axpy(s, tdm_sub(x1, x0), x0);
      tdm_vec3 force = tdm_scale(-d->stiffness, tdm_sub(x, d->start[i]));
      result->load[i].force = tdm_axpy(1.0 / (double)step->nstep, force, result->load[i].force);
      d->sum[i] = tdm_add(d->sum[i], force);
    }
    d->nsum++;
    if (sample == step->nsample || t < step->sample_time[sample] - 1e-12)
      continue;
    for (int i = 0; i < d->nbody; i++) { /* output times within one step have the same mean */
      d->mean[i] = tdm_scale(1.0 / (double)d->nsum, d->sum[i]);
      d->sum[i] = tdm_v3(0, 0, 0);
    }
    d->nsum = 0;
    for (; sample < step->nsample && t >= step->sample_time[sample] - 1e-12; sample++) {
      for (int i = 0; i < d->nbody; i++)
        result->sample_load[sample * d->nbody + i].force = d->mean[i];
      result->channel[sample] = t;
    }
  }
}

static tdm_status run(const tdm_participant_def *def, tdm_error *err) {
  static const tdm_channel channel = {.name = "dummy.time", .unit = "s"};
  static const double initial = 0;
  static const tdm_wrench no_load[16];
  tdm_participant *p = NULL;
  tdm_assignment assignment;
  tdm_step step;
  tdm_result result;
  dummy d = {0};
  if (tdm_participant_connect(&p, def, err) == TDM_OK && tdm_participant_initialize(p, &assignment, err) == TDM_OK &&
      load_scene(&d, &assignment, err) == TDM_OK) {
    tdm_ready ready = {.load = no_load, .nchannel = 1, .channel = &channel, .initial = &initial};
    tdm_participant_ready(p, &ready, err);
    while (err->status == TDM_OK && tdm_participant_next(p, &step, &result, err)) {
      solve(&d, &step, &result);
      tdm_participant_advance(p, &result, err);
    }
  }
  if (err->status == TDM_ERR_INTERRUPTED) /* FINISH before ASSIGN */
    *err = (tdm_error){0};
  tdm_participant_finalize(&p, err);
  return err->status;
}

int main(int argc, char **argv) {
  tdm_error err = {0};
  tdm_participant_def def = tdm_participant_default_def();
  def.software = "dummy 1.0";
  for (int i = 1; i + 1 < argc; i += 2) {
    if (strcmp(argv[i], "--connect") == 0)
      def.endpoint = argv[i + 1];
    if (strcmp(argv[i], "--timeout") == 0)
      def.timeout = atof(argv[i + 1]);
  }
  if (!def.endpoint)
    return 2;
  tdm_log_open(stderr, def.name);
  if (run(&def, &err) != TDM_OK)
    tdm_log(TDM_LOG_ERROR, "failed", "message=%s", err.message);
  return err.status == TDM_OK ? 0 : 1;
}
