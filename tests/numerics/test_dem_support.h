/* Support for the tests of dem/: models from JSON text, and windows without a server. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_DEM_SUPPORT_H
#define TEST_DEM_SUPPORT_H

#include "dem/adapter/solver.h"
#include "dem/bodies/path.h"
#include "dem/flow/flow.h"
#include "dem/particles/create.h"
#include "dem/scene/scene.h"
#include "dem/state/data.h"
#include "dem/step/forces.h"
#include "dem/step/step.h"
#include "dem/watch/guard.h"
#include "tests/scene_json.h"

#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ck_near(value, expected, tolerance)                                                                        \
  do {                                                                                                             \
    double ck_v = (value), ck_e = (expected), ck_t = (tolerance);                                                  \
    ck_assert_msg(fabs(ck_v - ck_e) <= ck_t, "%s = %.12g, expected %.12g within %.3g (off by %.3g)", #value, ck_v, \
                  ck_e, ck_t, ck_v - ck_e);                                                                        \
  } while (0)
#define ck_relative(value, expected, tolerance) ck_near(value, expected, (tolerance)*fabs(expected))

/* Is the vector the expected one? The distance between the two counts. */
static inline void ck_vector(tdm_vec3 v, tdm_vec3 e, double tolerance) {
  double off = tdm_norm(tdm_sub(v, e));
  ck_assert_msg(off <= tolerance, "[%.17g, %.17g, %.17g] is off [%.17g, %.17g, %.17g] by %.3g", v.x, v.y, v.z, e.x, e.y,
                e.z, off);
}

/* A state at rest at x. */
static inline tdm_state state_at(double x, double y, double z) {
  tdm_state s = {.pose = {.position = {x, y, z}, .orientation = {1, 0, 0, 0}}};
  return s;
}

typedef struct {
  json_t *json;
  tdm_assigned_body body[2];
  tdm_assignment assignment;
  dem_model *model;
  dem_data *data;
} rig;

/* Load a scene that must be good. `body` (nbody) is copied. The scene is decrefed by rig_free. */
static inline rig *rig_make(json_t *json, double dt, int nbody, const tdm_assigned_body *body) {
  rig *r = calloc(1, sizeof *r);
  r->json = json;
  for (int i = 0; i < nbody; i++)
    r->body[i] = body[i];
  r->assignment = (tdm_assignment){.scene = json, .time_end = 1, .dt = dt, .n = 1, .nbody = nbody, .body = r->body};
  tdm_error err = {0};
  dem_model_read(&r->model, &r->assignment, &err);
  ck_assert_msg(err.status == TDM_OK, "%s: %s", err.path, err.message);
  r->data = dem_data_create(r->model);
  ck_assert(r->data && dem_forces_begin(r->data, &err) == TDM_OK);
  return r;
}

/* Load a scene that must be refused, with a coupled body (NULL: none); the scene is decrefed. */
static inline tdm_error rig_refused(json_t *json, const tdm_assigned_body *body) {
  tdm_assigned_body copy = body ? *body : (tdm_assigned_body){0};
  tdm_assignment a = {.scene = json, .time_end = 1, .dt = 1e-5, .n = 1, .nbody = body != NULL, .body = &copy};
  tdm_error err = {0};
  dem_model *model = NULL;
  dem_model_read(&model, &a, &err);
  ck_assert_msg(err.status == TDM_ERR_SCENE || err.status == TDM_ERR_FILE, "not refused: %s", err.message);
  dem_model_destroy(&model);
  json_decref(json);
  return err;
}

static inline void rig_free(rig *r) {
  dem_data_destroy(&r->data);
  dem_model_destroy(&r->model);
  json_decref(r->json);
  free(r);
}

/* A step of dt; coupled bodies go along `path` (NULL: they stay where they are). */
static inline void one_step(dem_data *d, const dem_path *path, double dt) {
  tdm_error err = {0};
  ck_assert_msg(dem_step(d, &(dem_step_task){.dt = dt, .path = path, .k = 1, .n = 1}, &err) == TDM_OK, "%s",
                err.message);
}

static inline void forces_now(dem_data *d, bool settling) {
  tdm_error err = {0};
  ck_assert_msg(dem_forces_now(d, settling, &err) == TDM_OK, "%s", err.message);
}

static inline void flow_now(dem_data *d, double t, double dt) {
  tdm_error err = {0};
  ck_assert_msg(dem_flow(d, t, dt, &err) == TDM_OK, "%s", err.message);
}

/* n steps with the bodies where they are */
static inline void rig_steps(rig *r, long n) {
  for (long k = 0; k < n; k++)
    one_step(r->data, NULL, r->model->dt);
}

/* Step until the guard stops it: its error, or TDM_OK after n steps. *steps: how many were made (NULL: not wanted). */
static inline tdm_error rig_guarded(rig *r, long n, long *steps) {
  tdm_error err = {0};
  long k = 0;
  for (; k < n && !err.status; k++) {
    rig_steps(r, 1);
    dem_guard(r->data, (double)r->data->state.nstep * r->model->dt, r->model->dt, &err);
  }
  if (steps)
    *steps = k;
  return err;
}

#endif
