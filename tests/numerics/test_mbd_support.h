/* What the tests of mbd/ share: an engine run through mbd/mbd.h, scenes written with single
 * quotes.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_MBD_SUPPORT_H
#define TEST_MBD_SUPPORT_H

#include "mbd/mbd.h"
#include "protocol/base/log.h"
#include "protocol/math/random.h"
#include "tests/scene_json.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RUN_BODIES = 4, RUN_SAMPLES = 64 };

typedef struct {
  mbd_engine *self;
  json_t *scene;
  tdm_assigned_body body[RUN_BODIES];
  int nbody;
  mbd_start ready;
  tdm_error err;
  tdm_status status; /* of create */
  double t;
  tdm_state state[RUN_BODIES]; /* at t */
  tdm_state sample[RUN_SAMPLES * RUN_BODIES];
  double *channel; /* (RUN_SAMPLES x nchannel) */
} run;

/* Create a solver; `names` are the coupled bodies, separated by spaces ("" for none). Look at r->status. */
static inline void run_open(run *r, const char *scene, const char *names) {
  static char buffer[RUN_BODIES][64];
  memset(r, 0, sizeof *r);
  r->scene = scene_json("%s", scene);
  if (!json_object_get(r->scene, "formulation")) /* that of bodies alone; "names" couples them to push them */
    json_object_set_new(r->scene, "formulation", json_string("ggl"));
  for (int used; sscanf(names, "%63s%n", buffer[r->nbody], &used) == 1; names += used) {
    r->body[r->nbody].name = buffer[r->nbody];
    r->nbody++;
  }
  tdm_assignment a = {.scene = r->scene, .time_end = 1, .dt = 1e-3, .n = 1, .nbody = r->nbody, .body = r->body};
  r->status = mbd_engine_create(&r->self, &a, NULL, &r->err);
  if (r->status)
    return;
  r->ready = *mbd_engine_start(r->self);
  r->channel = calloc((size_t)(RUN_SAMPLES * r->ready.nchannel), sizeof(double));
  for (int i = 0; i < r->nbody; i++)
    r->state[i] = r->ready.body[i].state;
}

static inline void run_open_good(run *r, const char *scene, const char *names) {
  run_open(r, scene, names);
  ck_assert_msg(r->status == TDM_OK, "%s: %s", r->err.path, r->err.message);
}

static inline void run_close(run *r) {
  mbd_engine_destroy(&r->self);
  json_decref(r->scene);
  free(r->channel);
}

/* Close, and return the integrator's steps: from the log, the way a user sees them. */
static inline long run_close_steps(run *r) {
  char *text = NULL;
  size_t size = 0;
  FILE *sink = open_memstream(&text, &size);
  tdm_log_open(sink, "mbd");
  run_close(r);
  tdm_log_open(NULL, "mbd");
  fclose(sink);
  const char *at = strstr(text, " steps=");
  ck_assert_ptr_nonnull(at);
  long steps = strtol(at + 7, NULL, 10);
  free(text);
  return steps;
}

/* One window to t1 with load (nbody x nload) and samples. */
static inline tdm_status run_step(run *r, double t1, const tdm_wrench *load, int nload, int nsample,
                                  const double *time) {
  const mbd_window in = {.t0 = r->t, .t1 = t1, .nload = nload, .load = load, .nsample = nsample, .sample_time = time};
  const mbd_outcome out = {.state = r->state, .channel = r->channel, .sample_state = r->sample};
  r->t = t1;
  return mbd_engine_advance(r->self, &in, &out, &r->err);
}

static inline void run_window(run *r, double t1, const tdm_wrench *load, int nload, int nsample, const double *time) {
  ck_assert_msg(run_step(r, t1, load, nload, nsample, time) == TDM_OK, "%s", r->err.message);
}

/* A window without load and with one sample at its end. */
static inline void run_to(run *r, double t1) {
  run_window(r, t1, NULL, 0, 1, &t1);
}

static inline int run_channel(const run *r, const char *name) {
  for (int i = 0; i < r->ready.nchannel; i++)
    if (strcmp(r->ready.channel[i].name, name) == 0)
      return i;
  ck_abort_msg("no channel %s", name);
  return -1;
}

/* A channel at sample 0 of the last window. */
static inline double run_value(const run *r, const char *name) {
  return r->channel[run_channel(r, name)];
}

/* In windows of h to `end`. */
static inline void run_on(run *r, double end, double h) {
  while (r->t < end - 0.5 * h)
    run_to(r, r->t + h);
}

/* A channel at the start. */
static inline double first(const run *r, const char *name) {
  return r->ready.initial[run_channel(r, name)];
}

/* Kinetic energy, and what gravity and springs store: at the start, and at sample 0 of the last window. */
static inline double first_energy(const run *r) {
  return first(r, "energy.kinetic") + first(r, "energy.potential") + first(r, "energy.springs");
}

static inline double energy(const run *r) {
  return run_value(r, "energy.kinetic") + run_value(r, "energy.potential") + run_value(r, "energy.springs");
}

/* The row of a CSV file of tests/reference/mbd whose first column is t, into out (n columns). */
static inline void reference_row(const char *file, double t, double *out, int n) {
  char path[512], line[1024];
  snprintf(path, sizeof path, "%s/tests/reference/mbd/%s", TANDEM_SOURCE_DIR, file);
  FILE *f = fopen(path, "r");
  ck_assert_msg(f != NULL, "%s", path);
  while (fgets(line, sizeof line, f)) {
    char *at = line, *end;
    for (int i = 0; i < n; i++, at = *end == ',' ? end + 1 : end)
      out[i] = strtod(at, &end);
    if (line[0] >= '0' && line[0] <= '9' && fabs(out[0] - t) < 1e-9) {
      fclose(f);
      return;
    }
  }
  fclose(f);
  ck_abort_msg("no t = %g in %s", t, file);
}

static inline double apart(tdm_state a, tdm_state b) {
  double d = tdm_norm(tdm_sub(a.pose.position, b.pose.position));
  tdm_quat turn = tdm_quat_mul(a.pose.orientation, tdm_quat_conj(b.pose.orientation));
  d = fmax(d, tdm_norm(tdm_quat_to_rotvec(turn)));
  d = fmax(d, tdm_norm(tdm_sub(a.twist.velocity, b.twist.velocity)));
  return fmax(d, tdm_norm(tdm_sub(a.twist.angular, b.twist.angular)));
}

/* the next random number, -1 to 1 */
static inline double noise(uint64_t *draw) {
  return 2 * tdm_random_next(draw) - 1;
}

#define CLOSE(x, y, tol)                                                                                        \
  ck_assert_msg(fabs((x) - (y)) <= (tol), "%s = %.15g, expected %.15g within %g", #x, (double)(x), (double)(y), \
                (double)(tol))

#endif
