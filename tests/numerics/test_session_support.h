/* The DEM engine behind the participant's operations, with one coupled body. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_SESSION_SUPPORT_H
#define TEST_SESSION_SUPPORT_H

#include "dem/adapter/solver.h"

#include <jansson.h>
#include <stdlib.h>

typedef struct {
  json_t *json;
  tdm_assigned_body body;
  tdm_assignment assignment;
  tdm_ready ready;
  void *self;
  tdm_error err; /* of create */
} session;

/* The assignment alone, of a run of 1 s with windows of one step; takes over `json`. */
static inline session *prepare_session(json_t *json, tdm_assigned_body body, double dt) {
  session *s = calloc(1, sizeof *s);
  s->json = json;
  s->body = body;
  s->assignment = (tdm_assignment){.scene = json, .time_end = 1, .dt = dt, .n = 1, .nbody = 1, .body = &s->body};
  return s;
}

/* Look at s->err. */
static inline void start_session(session *s) {
  dem_solver_ops.create(&s->self, &s->assignment, &s->ready, NULL, &s->err);
}

static inline void close_session(session *s) {
  dem_solver_ops.destroy(s->self);
  json_decref(s->json);
  free(s);
}

#endif
