/* The coupled loop: see window.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/loop/window.h"

#include "coupler/loop/adapt.h"
#include "coupler/loop/mismatch.h"
#include "coupler/loop/path.h"
#include "protocol/base/legendre.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the mechanism at the window's start ---- */

/* Keep what MBD says of the mechanism at the end of a window; `acceleration` (nbody x 6) under loop->load there. */
static void keep_proxy(cpl_loop *loop, const double *acceleration, const tdm_mobility *mobility) {
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

/* Room for the largest, and the start of the run; false: no memory. */
static bool make_proxy(cpl_loop *loop, const cpl_session *session) {
  const tdm_mobility largest = {.nbody = loop->nbody, .nfree = TDM_FREE_MAX};
  loop->proxy_block = calloc(24 * (size_t)loop->nbody + tdm_mobility_doubles(&largest) + 1, sizeof(double));
  if (loop->proxy_block)
    keep_proxy(loop, session->acceleration, &session->mobility);
  return loop->proxy_block;
}

/* All arrays of a loop: X(field, entries). */
#define LOOP_ARRAYS(X)         \
  X(sample_time, samples)      \
  X(row_time, samples)         \
  X(state_start, nbody)        \
  X(state_end, nbody)          \
  X(dem_end, nbody)            \
  X(radius, nbody)             \
  X(speed, nbody)              \
  X(mean, nbody)               \
  X(history, nbody)            \
  X(load, nbody *TDM_LOAD_MAX) \
  X(packed, nbody *TDM_LOAD_MAX)

static tdm_status make_arrays(cpl_loop *loop, size_t samples, tdm_error *err) {
  const size_t nbody = (size_t)loop->nbody + 1; /* + 1: never an empty allocation */
  bool made = true;
#define MAKE(field, entries) made = (loop->field = calloc(entries, sizeof *loop->field)) != NULL && made;
  LOOP_ARRAYS(MAKE)
#undef MAKE
  if (cpl_session_asks(loop->session, CPL_MBD, "mobility"))
    made = make_proxy(loop, loop->session) && made;
  made = cpl_paths_init(&loop->paths, loop) && made;
  return made ? TDM_OK : tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
}

/* ---- observers ---- */

bool cpl_loop_observe(cpl_loop *loop, const cpl_observer *observer, void *own) {
  if (loop->nobserving == CPL_OBSERVERS_MAX)
    return false;
  loop->observing[loop->nobserving++] = (cpl_observing){observer, own};
  return true;
}

static tdm_status open_observers(cpl_loop *loop, tdm_error *err) {
  for (int i = 0; cpl_observers[i]; i++)
    if (!cpl_loop_observe(loop, cpl_observers[i], NULL))
      return tdm_fail(err, TDM_ERR_SYSTEM, NULL, "more than %d observers", CPL_OBSERVERS_MAX);
  for (int i = 0; i < loop->nobserving; i++) {
    cpl_observing *o = &loop->observing[i];
    if (o->observer->open && o->observer->open(loop, &o->own, err) != TDM_OK)
      return err->status;
  }
  return TDM_OK;
}

static tdm_status tell_observers(cpl_loop *loop, tdm_error *err) {
  loop->through = cpl_path_through(loop, loop->state_start, loop->state_end);
  for (int i = 0; i < loop->nobserving && err->status == TDM_OK; i++)
    loop->observing[i].observer->window(loop, loop->observing[i].own, err);
  return err->status;
}

void cpl_loop_end(cpl_loop *loop) {
  for (int i = 0; i < loop->nobserving; i++)
    if (loop->observing[i].observer->end)
      loop->observing[i].observer->end(loop, loop->observing[i].own);
}

void cpl_loop_enter(const cpl_loop *loop, json_t *summary) {
  if (loop->own && loop->scheme->enter)
    loop->scheme->enter(loop, summary);
  for (int i = 0; i < loop->nobserving; i++)
    if (loop->observing[i].own && loop->observing[i].observer->enter)
      loop->observing[i].observer->enter(loop, loop->observing[i].own, summary);
}

/* ---- begin and end ---- */

tdm_status cpl_loop_init(cpl_loop *loop, const cpl_settings *settings, cpl_session *session, struct cpl_record *record,
                         tdm_error *err) {
  double steps = fmin((double)settings->n, (double)cpl_total_steps(settings)); /* of the longest window */
  double samples = ceil(steps * settings->dt / settings->output_interval) + 3;
  *loop = (cpl_loop){.settings = settings,
                     .scheme = session->scheme,
                     .scheme_settings = cpl_scheme_settings(settings, session->scheme),
                     .session = session,
                     .record = record,
                     .nbody = settings->nbody};
  for (int r = 0; r < CPL_NROLE; r++) { /* a window's RESULT must fit into a frame */
    double row = session->partner[r].nchannel + TDM_STATE_DOUBLES * (double)settings->nbody;
    if (samples > TDM_COUNT_MAX || 8 * samples * row > TDM_FRAME_MAX / 2)
      return tdm_fail(err, TDM_ERR_SCENE, "output.interval",
                      "is %g s: %g output times in a window of %g s are more than a message holds; take a longer "
                      "interval or a smaller coupling.n",
                      settings->output_interval, samples, steps * settings->dt);
  }
  loop->next_sample = 1; /* output time 0 is the start, recorded from READY */
  loop->n = settings->adapt.on ? settings->adapt.n_min : settings->n;
  if (make_arrays(loop, (size_t)samples, err) != TDM_OK)
    return err->status;
  for (int i = 0; i < loop->nbody; i++) {
    loop->state_start[i] = session->body[i].state;
    loop->radius[i] = cpl_body_radius(&session->body[i]);
    loop->speed[i] = cpl_speed(&session->body[i].state, loop->radius[i]);
    cpl_history_push(&loop->history[i], 0, session->load[i]); /* the first load is DEM's at t = 0 */
  }
  if (open_observers(loop, err) != TDM_OK)
    return err->status;
  return loop->scheme->open ? loop->scheme->open(loop, err) : TDM_OK;
}

void cpl_loop_free(cpl_loop *loop) {
  if (loop->own)
    loop->scheme->close(loop);
  for (int i = 0; i < loop->nobserving; i++)
    if (loop->observing[i].observer->close)
      loop->observing[i].observer->close(loop->observing[i].own);
#define FREE(field, entries) free(loop->field);
  LOOP_ARRAYS(FREE)
#undef FREE
  free(loop->proxy_block);
  cpl_paths_free(&loop->paths);
  *loop = (cpl_loop){0};
}

/* ---- windows ---- */

/* A body that turns fast may have grown out of the window that its error allows: SLERP takes the short way. */
static long limit_turn(const cpl_loop *loop, long n) {
  const double most = 0.5; /* [rad] */
  double rate = 0;
  for (int i = 0; i < loop->nbody; i++)
    rate = fmax(rate, tdm_norm(loop->state_start[i].twist.angular));
  double limit = most / (rate * loop->settings->dt);
  return (double)n <= limit ? n : limit > 1 ? (long)limit : 1;
}

/* How long the next window is to be, from what both solvers made of this one. */
static void adapt(cpl_loop *loop) {
  const cpl_auto *s = &loop->settings->adapt;
  double worst = 0, apart[CPL_APART];
  for (int i = 0; i < loop->nbody; i++) {
    cpl_apart(&loop->state_end[i], &loop->dem_end[i], loop->radius[i], loop->t1 - loop->t0, apart);
    double is = cpl_length(CPL_APART, apart);
    if (is > 0)
      worst = fmax(worst, is / (s->tolerance * cpl_motion(loop, i) + s->absolute));
  }
  loop->n = cpl_adapt_next(s, loop->scheme->mismatch_order, loop->n, worst);
}

static void add_sample(cpl_loop *loop, double time, double row) {
  loop->sample_time[loop->nsample] = time;
  loop->row_time[loop->nsample++] = row;
}

/* The ends of the next window, and the output times in it. */
static void open_window(cpl_loop *loop) {
  const cpl_settings *s = loop->settings;
  uint64_t total = cpl_total_steps(s);
  if (s->adapt.on) {
    const long reach = cpl_path_reach(loop);
    loop->n = limit_turn(loop, loop->n < reach ? loop->n : reach > 1 ? reach : 1);
  }
  const uint64_t n = (uint64_t)loop->n;
  loop->step0 = loop->step1;
  loop->step1 = n < total - loop->step0 ? loop->step0 + n : total;
  if (loop->step1 - loop->step0 == n) {
    loop->n_least = loop->n_least && loop->n_least < loop->n ? loop->n_least : loop->n;
    loop->n_most = loop->n_most > loop->n ? loop->n_most : loop->n;
  }
  loop->t0 = (double)loop->step0 * s->dt;
  loop->t1 = (double)loop->step1 * s->dt;
  loop->nsample = 0;
  while (true) {
    double time = (double)loop->next_sample * s->output_interval;
    if (time > loop->t1 + 1e-6 * s->dt)
      break;
    add_sample(loop, time < loop->t1 ? time : loop->t1, time);
    loop->next_sample++;
  }
  /* the last state, on the grid or not */
  if (loop->step1 == total && (double)(loop->next_sample - 1) * s->output_interval < loop->t1 - 1e-6 * s->dt)
    add_sample(loop, loop->t1, loop->t1);
}

tdm_status cpl_loop_advance(cpl_loop *loop, tdm_error *err) {
  open_window(loop);
  tdm_status status = cpl_path_open(loop, err);
  if (status == TDM_OK)
    status = loop->scheme->advance(loop, err);
  if (status != TDM_OK)
    return status;
  if (!cpl_session_has(loop->session, CPL_MBD, "ahead"))
    cpl_path_doubt(loop);
  if (loop->settings->adapt.on)
    adapt(loop);
  for (int i = 0; i < loop->nbody; i++)
    loop->speed[i] = fmax(loop->speed[i], cpl_speed(&loop->state_end[i], loop->radius[i]));
  status = tell_observers(loop, err);
  memcpy(loop->state_start, loop->state_end, (size_t)loop->nbody * sizeof *loop->state_end);
  if (loop->proxy_block)
    keep_proxy(loop, loop->result[CPL_MBD].acceleration, &loop->result[CPL_MBD].mobility);
  cpl_path_keep(&loop->paths, &loop->result[CPL_MBD].path);
  loop->window++;
  return status;
}

/* Send a STEP and wait for its RESULT, with the counts that were asked for. */
static tdm_status exchange(cpl_loop *loop, cpl_role role, tdm_step *step, tdm_error *err) {
  step->window = loop->window;
  step->t0 = loop->t0;
  step->t1 = loop->t1;
  step->nstep = loop->step1 - loop->step0;
  step->nbody = loop->nbody;
  step->nsample = loop->nsample;
  step->sample_time = loop->sample_time;
  return cpl_session_step(loop->session, role, step, &loop->result[role], err);
}

/* SLERP takes the short way, and the linear model of a mechanism ends: a body may not turn far within a window. Where
 * nodes tell how it turns they are gone by, and where no load moves it, it may turn as it likes. */
static tdm_status check_turn(cpl_loop *loop, int body, tdm_error *err) {
  const double most = 1; /* [rad] */
  double rate = fmax(tdm_norm(loop->state_start[body].twist.angular), tdm_norm(loop->state_end[body].twist.angular));
  double turn = rate * (loop->t1 - loop->t0), by_nodes = cpl_path_turn(loop, body);
  if (!isnan(by_nodes))
    turn = loop->paths.prescribed[body] ? 0 : by_nodes;
  if (turn <= most)
    return TDM_OK;
  return tdm_fail(
      err, TDM_ERR_NUMERIC, "coupling.n",
      "body \"%s\" turns by %.3g rad in the window from %g s to %g s; the path inside a window is followed up "
      "to %g rad: take a smaller n",
      loop->settings->body[body].name[CPL_MBD], turn, loop->t0, loop->t1, most);
}

tdm_status cpl_solve_mbd(cpl_loop *loop, int ncoefficient, tdm_error *err) {
  for (int i = 0; i < loop->nbody; i++)
    for (int j = 0; j < ncoefficient; j++)
      loop->packed[i * ncoefficient + j] = loop->load[i * TDM_LOAD_MAX + j];
  loop->nload = ncoefficient;
  tdm_step step = {.nload = ncoefficient, .load = loop->packed, .ahead = cpl_path_ahead(loop)};
  tdm_status status = exchange(loop, CPL_MBD, &step, err);
  if (status != TDM_OK)
    return status;
  for (int i = 0; i < loop->nbody; i++) {
    loop->state_end[i] = loop->result[CPL_MBD].state[i];
    if (check_turn(loop, i, err) != TDM_OK)
      return err->status;
  }
  return TDM_OK;
}

static tdm_status solve_dem(cpl_loop *loop, tdm_step *step, tdm_error *err) {
  tdm_status status = exchange(loop, CPL_DEM, step, err);
  if (status != TDM_OK)
    return status;
  for (int i = 0; i < loop->nbody; i++)
    loop->mean[i] = loop->result[CPL_DEM].load[i];
  return TDM_OK;
}

tdm_status cpl_solve_dem_along(cpl_loop *loop, const tdm_state *start, const tdm_state *end, tdm_error *err) {
  tdm_step step = {.nstate = loop->nbody, .start = start, .end = end};
  if (loop->paths.takes)
    step.path = *cpl_path_through(loop, start, end);
  else if (cpl_path_check(loop, start, end, err) != TDM_OK)
    return err->status;
  loop->sent_start = start;
  loop->sent_end = end;
  return solve_dem(loop, &step, err);
}

/* Coefficients in s = (t - t0)/H of the load m0 + 3 m1 P1(x) + c2 P2(x), x = 2s - 1, that has the moments of nstep
 * steps' kicks. m0 and m1 are what a free body's velocity and place at the end depend on, and stay exact. Kicks of a
 * constant load have a second moment m0/nstep^2: it is taken out, and c2 is that of the parabola through kicks that lie
 * on one: c2 = (m2 - m0/nstep^2)/(9/4 (<x^4> - <x^2>^2)), <> the mean with the kicks' weights; 5 m2 for many steps. */
static void from_moments(const tdm_wrench *moment, uint64_t nstep, int ncoefficient, tdm_wrench *out) {
  const double *m0 = (const double *)(const void *)&moment[0], *m1 = (const double *)(const void *)&moment[1];
  const double *m2 = (const double *)(const void *)&moment[2];
  const double q = 1 / ((double)nstep * (double)nstep), x2 = 1.0 / 3 + 2 * q / 3;
  const double x4 = 0.2 + 4 * q / 3 - 8 * q * q / 15, norm = 2.25 * (x4 - x2 * x2);
  for (int i = 0; i < TDM_WRENCH_DOUBLES; i++) {
    double slope = ncoefficient > 1 ? 3 * m1[i] : 0, bend = ncoefficient > 2 ? (m2[i] - q * m0[i]) / norm : 0;
    const double c[3] = {m0[i] - slope + bend, 2 * slope - 6 * bend, 6 * bend};
    for (int j = 0; j < ncoefficient; j++)
      ((double *)(void *)&out[j])[i] = c[j];
  }
}

/* Add c_3 P_3 + c_4 P_4 + ... to the parabolas of all bodies, up to the last that is not zero; `further` (nbody x
 * TDM_FURTHER). */
static void add_further(cpl_loop *loop, const tdm_wrench *further) {
  for (int j = 3; j < TDM_LOAD_MAX; j++) {
    double power[TDM_LOAD_MAX];
    bool any = false;
    for (int i = 0; i < loop->nbody && !any; i++)
      for (int l = 0; l < TDM_WRENCH_DOUBLES; l++)
        any = any || ((const double *)(const void *)&further[i * TDM_FURTHER + j - 3])[l] != 0;
    if (!any)
      continue;
    for (int i = 0; i < loop->nbody; i++)
      memset(&loop->load[i * TDM_LOAD_MAX + loop->nload], 0, (size_t)(j + 1 - loop->nload) * sizeof *loop->load);
    loop->nload = j + 1;
    tdm_legendre_powers(j, power);
    for (int i = 0; i < loop->nbody; i++)
      for (int p = 0; p <= j; p++) {
        tdm_wrench *to = &loop->load[i * TDM_LOAD_MAX + p];
        const tdm_wrench *c = &further[i * TDM_FURTHER + j - 3];
        to->force = tdm_axpy(power[p], c->force, to->force);
        to->moment = tdm_axpy(power[p], c->moment, to->moment);
      }
  }
}

tdm_status cpl_solve_dem_proxy(cpl_loop *loop, const double *correction, tdm_error *err) {
  const uint64_t nstep = loop->step1 - loop->step0;
  tdm_step step = {
      .nstate = loop->nbody, .start = loop->state_start, .end = loop->state_start, .has_proxy = loop->nbody > 0};
  step.proxy = loop->proxy;
  loop->correction = correction;
  if (correction)
    step.proxy.correction = correction;
  if (loop->paths.takes)
    step.path = loop->paths.told;
  else if (cpl_path_check(loop, NULL, NULL, err) != TDM_OK)
    return err->status;
  if (solve_dem(loop, &step, err) != TDM_OK)
    return err->status;
  loop->nload = nstep == 1 ? 1 : nstep < 4 ? 2 : 3;
  for (int i = 0; i < loop->nbody; i++) {
    const tdm_interface *body = &loop->result[CPL_DEM].body[i];
    from_moments(body->moment, nstep, loop->nload, &loop->load[i * TDM_LOAD_MAX]);
    loop->dem_end[i] = body->end;
  }
  if (loop->nload == 3 && loop->result[CPL_DEM].nfurther > 0)
    add_further(loop, loop->result[CPL_DEM].further);
  return TDM_OK;
}

tdm_status cpl_mbd_first(cpl_loop *loop, int nmean, tdm_error *err) {
  int ncoefficient = 1;
  for (int i = 0; i < loop->nbody; i++)
    ncoefficient = cpl_extrapolate(&loop->history[i], nmean, loop->t0, loop->t1, &loop->load[i * TDM_LOAD_MAX]);
  if (cpl_solve_mbd(loop, ncoefficient, err) != TDM_OK)
    return err->status;
  if (cpl_solve_dem_along(loop, loop->state_start, loop->state_end, err) != TDM_OK)
    return err->status;
  for (int i = 0; i < loop->nbody; i++)
    cpl_history_push(&loop->history[i], loop->t1, loop->mean[i]);
  return TDM_OK;
}
