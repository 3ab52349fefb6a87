/* The life of a loop, from its beginning to its end, and its way back: see loop.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/state/loop.h"

#include "coupler/state/mismatch.h"
#include "coupler/state/path.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- what comes from the list of fields ---- */

#define NO_VALUE(kind, type, name)

static bool make_path(tdm_nodes *path, int nbody) {
  path->nbody = nbody;
  path->time = calloc(TDM_NODES_MAX, sizeof *path->time);
  path->state = calloc(TDM_NODES_MAX * (size_t)nbody + 1, sizeof *path->state);
  return path->time && path->state;
}

static bool allocate(cpl_loop *loop) {
  bool all = true;
#define ARRAY(kind, type, name, count)                                                   \
  loop->name = calloc((size_t)(count) + 1, sizeof *loop->name); /* never an empty one */ \
  all = all && loop->name;
#define PATH(kind, name) all = make_path(&loop->name, loop->nbody) && all;
  CPL_LOOP_FIELDS(NO_VALUE, ARRAY, PATH)
#undef ARRAY
#undef PATH
  return all;
}

static void release(cpl_loop *loop) {
#define ARRAY(kind, type, name, count) free(loop->name);
#define PATH(kind, name) free(loop->name.time), free(loop->name.state);
  CPL_LOOP_FIELDS(NO_VALUE, ARRAY, PATH)
#undef ARRAY
#undef PATH
}

typedef enum { FIXED, WITHIN, CARRIED } field_kind;
typedef enum { COUNT, SAVE, RESTORE } copy_way;

static size_t copy(copy_way way, void *field, size_t size, char *saved) {
  if (way == SAVE)
    memcpy(saved, field, size);
  else if (way == RESTORE)
    memcpy(field, saved, size);
  return size;
}

static size_t copy_path(copy_way way, tdm_nodes *path, char *saved) {
  size_t at = copy(way, &path->nnode, sizeof path->nnode, saved);
  at += copy(way, path->time, TDM_NODES_MAX * sizeof *path->time, saved + at);
  return at + copy(way, path->state, TDM_NODES_MAX * (size_t)path->nbody * sizeof *path->state, saved + at);
}

/* All that is carried, to or from `saved`; returns its bytes. */
static size_t copy_carried(copy_way way, cpl_loop *loop, char *saved) {
  size_t at = 0;
#define VALUE(kind, type, name) \
  if (kind == CARRIED)          \
    at += copy(way, &loop->name, sizeof loop->name, saved + at);
#define ARRAY(kind, type, name, count) \
  if (kind == CARRIED)                 \
    at += copy(way, loop->name, (size_t)(count) * sizeof *loop->name, saved + at);
#define PATH(kind, name) \
  if (kind == CARRIED)   \
    at += copy_path(way, &loop->name, saved + at);
  CPL_LOOP_FIELDS(VALUE, ARRAY, PATH)
#undef VALUE
#undef ARRAY
#undef PATH
  return at;
}

tdm_status cpl_loop_save(cpl_loop *loop, int slot, tdm_error *err) {
  for (int r = 0; r < CPL_NROLE; r++)
    if (cpl_session_save(loop->session, (cpl_role)r, slot, err) != TDM_OK)
      return err->status;
  if (!loop->saved[slot])
    loop->saved[slot] = malloc(copy_carried(COUNT, loop, NULL));
  if (!loop->saved[slot])
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  copy_carried(SAVE, loop, loop->saved[slot]);
  return TDM_OK;
}

tdm_status cpl_loop_restore(cpl_loop *loop, int slot, tdm_error *err) {
  for (int r = 0; r < CPL_NROLE; r++)
    if (cpl_session_restore(loop->session, (cpl_role)r, slot, err) != TDM_OK)
      return err->status;
  copy_carried(RESTORE, loop, loop->saved[slot]);
  return TDM_OK;
}

/* ---- the mechanism at the window's start ---- */

void cpl_loop_keep_mechanism(cpl_loop *loop, const double *acceleration, const tdm_mobility *mobility) {
  const size_t n = (size_t)loop->nbody;
  double *at = loop->proxy_block;
  loop->proxy = (tdm_proxy){.acceleration = at, .load = (tdm_wrench *)(void *)(at + 6 * n)};
  memcpy(at, acceleration, 6 * n * sizeof *at);
  at += 6 * n;
  for (size_t i = 0; i < n; i++) {
    tdm_wrench end = {0};
    for (int j = 0; j < loop->nload; j++) {
      const tdm_wrench *c = &loop->load[i * TDM_LOAD_MAX + (size_t)j];
      end.force = tdm_add(end.force, c->force);
      end.moment = tdm_add(end.moment, c->moment);
    }
    memcpy(at + 6 * i, &end, sizeof end);
  }
  at += 6 * n;
  loop->proxy.correction = at; /* zeros */
  at += 12 * n;
  loop->proxy.mobility = *mobility;
  tdm_mobility_copy(at, mobility);
  tdm_mobility_point(&loop->proxy.mobility, at);
}

/* ---- the run ---- */

/* A window's RESULT must fit into a frame. */
static tdm_status check_samples(const cpl_session *session, double samples, double window, tdm_error *err) {
  const cpl_settings *s = session->settings;
  for (int r = 0; r < CPL_NROLE; r++) {
    double row = session->partner[r].nchannel + TDM_STATE_DOUBLES * (double)s->nbody;
    if (samples > TDM_COUNT_MAX || 8 * samples * row > TDM_FRAME_MAX / 2)
      return tdm_fail(err, TDM_ERR_SCENE, "output.interval",
                      "is %g s: %g output times in a window of %g s are more than a message holds; take a longer "
                      "interval or a smaller coupling.n",
                      s->output_interval, samples, window);
  }
  return TDM_OK;
}

/* What is known at t = 0. */
static void begin(cpl_loop *loop) {
  const cpl_session *session = loop->session;
  loop->next_sample = 1; /* output time 0 is the start, recorded from READY */
  loop->growth = 1;
  loop->n = loop->settings->adapt.on ? loop->settings->adapt.n_min : loop->settings->n;
  if (loop->proxy_size > 0)
    cpl_loop_keep_mechanism(loop, session->acceleration, &session->mobility);
  if (session->prescribed)
    memcpy(loop->prescribed, session->prescribed, (size_t)loop->nbody * sizeof *loop->prescribed);
  cpl_path_keep(loop, &session->path);
  for (int i = 0; i < loop->nbody; i++) {
    loop->state_start[i] = session->body[i].state;
    loop->radius[i] = cpl_body_radius(&session->body[i]);
    loop->speed[i] = cpl_speed(&session->body[i].state, loop->radius[i]);
  }
}

tdm_status cpl_loop_init(cpl_loop *loop, const cpl_settings *settings, cpl_session *session, tdm_error *err) {
  const cpl_scheme *scheme = session->scheme;
  const tdm_mobility largest = {.nbody = settings->nbody, .nfree = TDM_FREE_MAX};
  double steps = fmin((double)settings->n, (double)cpl_total_steps(settings)); /* of the longest window */
  double samples = ceil(steps * settings->dt / settings->output_interval) + 3;
  *loop = (cpl_loop){.settings = settings,
                     .scheme_settings = cpl_scheme_settings(settings, scheme),
                     .scheme = scheme,
                     .session = session,
                     .nbody = settings->nbody,
                     .takes_path = cpl_session_has(session, CPL_DEM, "path"),
                     .goes_back = settings->adapt.on && cpl_session_restores(session)};
  if (check_samples(session, samples, steps * settings->dt, err) != TDM_OK)
    return err->status;
  loop->samples_most = (size_t)samples;
  if (cpl_session_asks(session, CPL_MBD, "mobility"))
    loop->proxy_size = 24 * (size_t)settings->nbody + tdm_mobility_doubles(&largest);
  loop->memory_size = scheme->memory ? scheme->memory(settings->nbody) : 0;
  if (!allocate(loop))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  begin(loop);
  return scheme->open ? scheme->open(loop, err) : TDM_OK;
}

void cpl_loop_free(cpl_loop *loop) {
  if (loop->own)
    loop->scheme->close(loop);
  for (int k = 0; k < TDM_SLOTS_MAX; k++)
    free(loop->saved[k]);
  release(loop);
  *loop = (cpl_loop){0};
}

/* What is known of the mechanism at t0 belongs to the external loads of before. Accelerations by loads are those by the
 * difference from proxy.load, so the change of the external loads goes into that. */
void cpl_loop_press(cpl_loop *loop, const tdm_wrench *external) {
  for (int i = 0; i < loop->nbody; i++) {
    tdm_wrench *held = (tdm_wrench *)(void *)(loop->proxy_block + 6 * (size_t)loop->nbody) + i,
               *now = &loop->external[i];
    if (loop->proxy_size > 0) {
      held->force = tdm_sub(held->force, tdm_sub(external[i].force, now->force));
      held->moment = tdm_sub(held->moment, tdm_sub(external[i].moment, now->moment));
    }
    *now = external[i];
  }
}

bool cpl_loop_done(const cpl_loop *loop) {
  return loop->step1 >= cpl_total_steps(loop->settings);
}
