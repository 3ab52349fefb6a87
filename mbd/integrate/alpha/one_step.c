/* The one-step formulation: steps of generalised-alpha (alpha.h) over windows, dense output, start, states in memory.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/consistent/stick.h"
#include "mbd/consistent/work.h"
#include "mbd/integrate/alpha/alpha.h"
#include "mbd/integrate/integrator.h"
#include "protocol/base/log.h"
#include "protocol/math/hermite.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FAILURES_MAX = 15 };

static const double turn_wanted = 1;  /* of a body in a step [rad] */
static const double steps_most = 1e7; /* in a window */

/* ---- life ---- */

static double *array(int n) {
  return calloc((size_t)n + 1, sizeof(double));
}

static bool memory_create(mbd_alpha_memory *to, const mbd_model *m, bool factors) {
  const int n = 6 * m->nbody + m->nrow;
  bool good = true;
#define ALLOCATE(type, name, count) good = (to->name = calloc((size_t)(count) + 1, sizeof *to->name)) && good;
  MBD_ALPHA_ARRAYS(ALLOCATE)
#undef ALLOCATE
  if (factors) {
    to->step = mbd_lu_create(n);
    to->mass = mbd_lu_create(n);
  }
  return good && (!factors || (to->step && to->mass));
}

static void memory_free(mbd_alpha_memory *from) {
#define RELEASE(type, name, count) free(from->name);
  MBD_ALPHA_ARRAYS(RELEASE)
#undef RELEASE
  mbd_lu_destroy(&from->step);
  mbd_lu_destroy(&from->mass);
}

static tdm_status create(void **out, const mbd_model *model, mbd_data *data, mbd_kkt *kkt, mbd_stop_fn stop,
                         void *context, tdm_error *err) {
  mbd_alpha *s = *out = calloc(1, sizeof *s);
  if (!s)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for the integrator");
  s->model = model;
  s->data = data;
  s->kkt = kkt;
  s->stop_fn = stop;
  s->stop_context = context;
  const double rho = model->solver.spectral_radius;
  s->am = (2 * rho - 1) / (rho + 1);
  s->af = rho / (rho + 1);
  s->gamma = 0.5 + s->af - s->am;
  s->beta = 0.25 * (s->gamma + 0.5) * (s->gamma + 0.5);
  const double shift = s->am - s->af + 0.5;
  s->c2 = 0.5 * (s->am - s->af) + s->beta - 1.0 / 6;
  s->c3 = 0.5 * (1 - s->af) - (1 - s->am - s->gamma) * shift - 1.0 / 6;
  s->nv = 6 * model->nbody;
  s->n = s->nv + model->nrow;
  double **arrays[] = {&s->vdot1, &s->guess, &s->move, &s->Q,  &s->lambda0, &s->lambda1, &s->g, &s->g_t,
                       &s->r,     &s->x,     &s->dx,   &s->X0, &s->X1,      &s->P,       &s->S};
  bool good = memory_create(&s->now, model, true) && memory_create(&s->before, model, false);
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
    good = (*arrays[i] = array(s->n)) && good;
  s->normal = array(model->nfriction);
  s->y0 = array(mbd_nunknown(model));
  s->y1 = array(mbd_nunknown(model));
  s->work = array(mbd_nunknown(model));
  s->X = array(TDM_LOAD_MAX * s->n);
  s->inertia = calloc((size_t)model->nbody + 1, sizeof *s->inertia);
  s->turned = calloc((size_t)model->nbody + 1, sizeof *s->turned);
  s->rows = calloc((size_t)model->npart + 1, sizeof *s->rows);
  if (!good || !s->normal || !s->y0 || !s->y1 || !s->work || !s->X || !s->inertia || !s->turned || !s->rows)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for the integrator (%d unknowns)", s->n);
  return TDM_OK;
}

static void destroy(void *self) {
  mbd_alpha *s = self;
  if (!s)
    return;
  memory_free(&s->now);
  memory_free(&s->before);
  double *arrays[] = {s->vdot1, s->guess, s->move, s->Q,    s->lambda0, s->lambda1, s->g,  s->g_t, s->r, s->x,
                      s->dx,    s->y0,    s->y1,   s->work, s->X,       s->X0,      s->X1, s->P,   s->S, s->normal};
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
    free(arrays[i]);
  free(s->inertia);
  free(s->turned);
  free(s->rows);
  free(s);
}

/* ---- dense output ---- */

/* The state at t + s h inside the step that was just accepted, into s->work. Orientations by the rotation vector from
 * the start; its rate at the end is w - 1/2 D x w + 1/12 D x (D x w) + ... [rad]. */
static void interpolate(mbd_alpha *s, double at, double h) {
  double *move = s->dx;
  for (int b = 0; b < s->model->nbody; b++) {
    const double *u0 = s->y0 + MBD_BODY_UNKNOWNS * b, *u1 = s->y1 + MBD_BODY_UNKNOWNS * b, *D = s->move + 6 * b;
    tdm_vec3 w = mbd_get3(u1 + MBD_W), turn = mbd_get3(D + 3), across = tdm_cross(turn, w);
    double end[6];
    mbd_set3(end, mbd_get3(u1 + MBD_V));
    mbd_set3(end + 3, tdm_axpy(1.0 / 12, tdm_cross(turn, across), tdm_axpy(-0.5, across, w)));
    for (int i = 0; i < 6; i++) {
      move[6 * b + i] = tdm_hermite(at, 1, 0, h * u0[MBD_V + i], D[i], h * end[i]);
      s->work[MBD_BODY_UNKNOWNS * b + MBD_V + i] =
          tdm_hermite(at, 1, u0[MBD_V + i], h * s->Q[6 * b + i], u1[MBD_V + i], h * s->vdot1[6 * b + i]);
    }
  }
  mbd_alpha_place(s->model, s->work, s->y0, move);
}

/* ---- a window ---- */

/* where samples go */
typedef struct {
  int next, n;
  const double *time;
  mbd_sample_fn sample;
  void *context;
} samples;

/* The unknowns at time t inside the step that was just accepted; reactions on the straight line between its ends. */
static const double *unknowns_at(void *self, double t) {
  mbd_alpha *s = self;
  double at = (t - s->from) / (s->to - s->from), *lambda = s->work + mbd_index_lambda(s->model, 0);
  interpolate(s, at, s->to - s->from);
  for (int i = 0; i < s->model->nrow; i++)
    lambda[i] = (1 - at) * s->lambda0[i] + at * s->lambda1[i];
  return s->work;
}

/* `work` and what is done from the start of the step to time t. */
static mbd_work work_until(mbd_alpha *s, mbd_work work, double t) {
  return mbd_work_add(work, mbd_work_over(s->model, s->data, s->kkt, s->from, t, unknowns_at, s));
}

static tdm_status give_samples(mbd_alpha *s, samples *to, double t, double t1, tdm_error *err) {
  s->from = t, s->to = t1;
  mbd_work before = s->data->work, after = work_until(s, before, t1);
  for (; to->next < to->n && to->time[to->next] <= t1; to->next++) {
    double now = to->time[to->next];
    bool here = now == t1;
    s->data->work = here ? after : work_until(s, before, now);
    if (to->sample(to->context, to->next, now, here ? s->y1 : unknowns_at(s, now), err))
      return err->status;
  }
  s->data->work = after;
  return TDM_OK;
}

/* ---- friction that begins or ceases to stick ---- */

/* A step from t to t1, whatever was tried before. */
static bool step_to(mbd_alpha *s, double t, double t1) {
  mbd_alpha_copy(s, &s->now, &s->before);
  return mbd_alpha_step(s, t, t1);
}

/* The state after a step that ends at time t. */
static const double *stepped_to(void *self, double t) {
  mbd_alpha *s = self;
  if (t <= s->from)
    return s->y0;
  return step_to(s, s->from, t) ? s->y1 : NULL;
}

/* A step from t to *t1 has been made: shorten it to where a friction ends its mode (*ends) before that. false: that
 * failed. */
static bool cut(mbd_alpha *s, double t, double *t1, bool *ends) {
  *ends = mbd_stick_margin(s->model, s->data, s->kkt, *t1, s->y1) < 0;
  if (!*ends)
    return true;
  s->from = t;
  const double least = 1e-8 * (*t1 - t); /* no slivers on either side */
  double end = fmax(t + least, mbd_stick_locate(s->model, s->data, s->kkt, t, *t1, stepped_to, s));
  *t1 = end < *t1 - least ? end : *t1;
  return step_to(s, t, *t1);
}

static tdm_status start(void *self, double t, tdm_error *err);

/* Let frictions stick or slide as the state y0 at t wants it, and start again from there if that changes anything. */
static tdm_status settle(mbd_alpha *s, double t, tdm_error *err) {
  bool changed;
  if (!mbd_stick_settle(s->model, s->data, s->kkt, t, s->y0, &changed))
    return mbd_stick_refuse(t, err);
  memcpy(s->data->y, s->y0, (size_t)mbd_nunknown(s->model) * sizeof(double));
  mbd_alpha_copy(s, &s->before, &s->now);
  if (!changed || start(s, t, err))
    return err->status;
  memcpy(s->now.speed, s->before.speed, (size_t)s->model->nbody * sizeof(double));
  return TDM_OK;
}

/* The number of even steps over `rest` [s] that are none longer than `longest` (0: no limit), and in which no body
 * turns by much more than turn_wanted. */
static double steps_for(const mbd_alpha *s, double rest, double longest) {
  double n = longest > 0 ? rest / longest : 0;
  for (int b = 0; b < s->model->nbody; b++)
    n = fmax(n, rest * tdm_norm(mbd_get3(s->y0 + MBD_BODY_UNKNOWNS * b + MBD_W)) / turn_wanted);
  return n;
}

/* What the error of a step of h lets the next one be, or itself where it was too large: the error goes with the cube of
 * the step. Steps stay as they are where they hardly could be longer, so that Newton's matrix serves on. */
static double want(const mbd_alpha *s, double h, double error) {
  const double factor = 0.9 / cbrt(fmax(error, 1e-6));
  if (error > 1)
    return h * fmin(fmax(factor, 0.1), 0.7);
  return factor < 1 ? factor * h : factor > 1.5 ? fmin(factor, 4) * h : fmax(h, s->now.wanted);
}

/* Try a step from t to *t1, or to where a friction ends its mode (*ends) before that; false: it is to be tried again,
 * shorter. */
static bool try(mbd_alpha *s, double t, double *t1, bool *ends) {
  const double h = *t1 - t;
  mbd_alpha_copy(s, &s->before, &s->now);
  bool good = mbd_alpha_step(s, t, *t1);
  double error = good ? mbd_alpha_error(s, h) : 0;
  if (good && error <= 1 && cut(s, t, t1, ends)) {
    s->failures = 0;
    s->now.wanted = want(s, h, error);
    return true;
  }
  mbd_alpha_copy(s, &s->now, &s->before);
  good = good && error > 1;
  s->now.wanted = good ? want(s, h, error) : 0.25 * h;
  s->failures += good ? 0 : 1;
  *(good ? &s->data->stats.error_failures : &s->data->stats.convergence_failures) += 1;
  return false;
}

/* The number of even steps to go on with from t to t1 into *n: those of steps_for, or what the error test wants. */
static tdm_status plan(const mbd_alpha *s, double t, double t1, double longest, double *n, tdm_error *err) {
  const double even = steps_for(s, t1 - t, longest);
  *n = fmax(1, ceil(fmax(even, s->now.wanted > 0 ? (t1 - t) / s->now.wanted : 0) * (1 - 1e-9)));
  if (s->stop_fn && s->stop_fn(s->stop_context))
    return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted at t = %.9g s", t);
  if (s->failures > FAILURES_MAX ||
      (*n > 1 && !((t1 - t) / *n > 64 * DBL_EPSILON * fabs(t1)))) /* the error test may want shorter ones for ever */
    return tdm_fail(err, TDM_ERR_NUMERIC, "mbd",
                    "the integration failed at t = %.9g s with steps down to %.3g s. The load on a body jumped or grew "
                    "without bound, a force jumps, or the mechanism is in a singular position: try shorter windows or "
                    "a larger mbd.solver.relative_tolerance",
                    t, (t1 - t) / *n);
  if (even > steps_most)
    return tdm_fail(err, TDM_ERR_NUMERIC, "mbd",
                    "at t = %.9g s the rest of a window, %.3g s, needs %.3g steps, one for each radian that the "
                    "fastest body turns or each mbd.solver.max_step; more than %.0e are not tried. Check velocities "
                    "and loads, or try shorter windows",
                    t, t1 - t, even, steps_most);
  return TDM_OK;
}

/* Many steps, tried or made, that cover hardly any of a window go nowhere. */
static tdm_status gets_on(mbd_alpha *s, double t, double window, tdm_error *err) {
  const long many = 20000;
  const double hardly = 1e-2; /* so no window takes more than 2e6 */
  if (++s->since < many)
    return TDM_OK;
  if (t - s->mark < hardly * window)
    return tdm_fail(err, TDM_ERR_NUMERIC, "mbd",
                    "the integration stands still at t = %.9g s: the last %ld steps cover %.3g s. A force is too stiff "
                    "or jumps: try a larger mbd.solver.relative_tolerance, a softer force, or shorter windows",
                    t, many, t - s->mark);
  s->since = 0;
  s->mark = t;
  return TDM_OK;
}

/* Where the steps from t are to end: t1, or a driver's knot before it. What is prescribed has no error that would make
 * steps shorter, but drivers' work and what hangs on it would go wrong. */
static double next_end(const mbd_alpha *s, double t, double t1, double window) {
  const double sliver = 1e-6 * window;
  double end = t1;
  for (int i = 0; i < s->model->ndriver; i++)
    end = fmin(end, tdm_motion_knot(&s->model->driver[i].motion, t + sliver));
  return end < t1 - sliver ? end : t1;
}

static tdm_status advance(void *self, double t1, int nsample, const double *sample_time, mbd_sample_fn sample,
                          void *context, tdm_error *err) {
  mbd_alpha *s = self;
  mbd_data *data = s->data;
  const double window = t1 - data->t, max_step = s->model->solver.max_step;
  const double longest = max_step > 0 || nsample < 2 ? max_step : window / nsample;
  const size_t size = (size_t)mbd_nunknown(s->model) * sizeof(double);
  samples to = {0, nsample, sample_time, sample, context};
  memcpy(s->y0, data->y, size);
  memcpy(s->y1, data->y, size);
  if (mbd_stick_margin(s->model, data, s->kkt, data->t, s->y0) < 0 && settle(s, data->t, err)) /* the load jumps */
    return err->status;
  s->failures = 0;
  s->since = 0;
  s->mark = data->t;
  if (!s->responded && !mbd_alpha_respond(s, data->t))
    return tdm_fail(err, TDM_ERR_NUMERIC, "mbd",
                    "no response to the load at t = %.9g s: the mechanism is in a singular position", data->t);
  for (double t = data->t; t < t1;) {
    const double until = next_end(s, t, t1, window);
    double n;
    if (plan(s, t, until, longest, &n, err))
      return err->status;
    double end = n > 1 ? t + (until - t) / n : until;
    bool ends;
    if (!try(s, t, &end, &ends)) {
      if (gets_on(s, t, window, err))
        return err->status;
      continue;
    }
    mbd_alpha_accept(s, end, end - t);
    if (give_samples(s, &to, t, end, err))
      return err->status;
    memcpy(s->y0, s->y1, size);
    t = end;
    if (ends && settle(s, t, err))
      return err->status;
    if (gets_on(s, t, window, err))
      return err->status;
  }
  s->responded = false; /* to the next load */
  data->t = t1;
  memcpy(data->y, s->y0, size);
  return TDM_OK;
}

/* ---- start ---- */

/* Accelerations and reactions at the start, and how they rise: from those a moment later on the parabola. */
static tdm_status start(void *self, double t, tdm_error *err) {
  mbd_alpha *s = self;
  const mbd_model *m = s->model;
  mbd_data *d = s->data;
  const double moment = d->load_t1 > t ? 1e-3 * (d->load_t1 - t) : 1e-6;
  mbd_kkt_reset(s->kkt); /* the start must not depend on what was before */
  s->now = (mbd_alpha_memory){.w = s->now.w,
                              .slope = s->now.slope,
                              .a = s->now.a,
                              .lambda = s->now.lambda,
                              .lambda_slope = s->now.lambda_slope,
                              .speed = s->now.speed,
                              .step = s->now.step,
                              .mass = s->now.mass,
                              .started = true};
  memset(s->now.speed, 0, (size_t)m->nbody * sizeof(double));
  memcpy(s->y0, d->y, (size_t)mbd_nunknown(m) * sizeof(double));
  bool good = mbd_alpha_respond(s, t) && mbd_accelerations(m, d, s->kkt, t, d->y);
  mbd_alpha_response(s, t, s->X0);
  mbd_alpha_response(s, t + moment, s->X1);
  for (int k = 0; k < s->nv; k++)
    s->now.w[k] = s->now.a[k] = d->acceleration[k] - s->X0[k];
  for (int k = 0; k < m->nrow; k++)
    s->now.lambda[k] = d->lambda[k] - s->X0[s->nv + k];
  for (int b = 0; b < m->nbody; b++)
    for (int i = 0; i < 6; i++) {
      double v = d->y[MBD_BODY_UNKNOWNS * b + MBD_V + i], vdot = d->acceleration[6 * b + i];
      s->move[6 * b + i] = moment * (v + 0.5 * moment * vdot);
      s->work[MBD_BODY_UNKNOWNS * b + MBD_V + i] = v + moment * vdot;
    }
  mbd_alpha_place(m, s->work, d->y, s->move);
  good = good && mbd_accelerations(m, d, s->kkt, t + moment, s->work);
  if (!good)
    return tdm_fail(err, TDM_ERR_NUMERIC, "mbd",
                    "no consistent accelerations at the start, t = %g s; check joints and masses", t);
  for (int k = 0; k < s->nv; k++)
    s->now.slope[k] = (d->acceleration[k] - s->X1[k] - s->now.w[k]) / moment;
  for (int k = 0; k < m->nrow; k++)
    s->now.lambda_slope[k] = (d->lambda[k] - s->X1[s->nv + k] - s->now.lambda[k]) / moment;
  d->t = t;
  return TDM_OK;
}

static void stats(void *self) {
  (void)self; /* counted as they happen */
}

/* ---- states in memory ---- */

static bool copy_memory(const mbd_alpha *s, mbd_alpha_memory *to, const mbd_alpha_memory *from) {
  mbd_alpha_copy(s, to, from);
  to->step_length = from->step_length;
  to->mass_made = from->mass_made;
  return mbd_lu_copy(to->step, from->step) && mbd_lu_copy(to->mass, from->mass);
}

static void release(void *kept) {
  if (kept)
    memory_free(kept);
  free(kept);
}

static tdm_status save(const void *self, void **kept, tdm_error *err) {
  const mbd_alpha *s = self;
  if (!*kept) {
    *kept = calloc(1, sizeof(mbd_alpha_memory));
    if (*kept && !memory_create(*kept, s->model, true)) {
      release(*kept);
      *kept = NULL;
    }
  }
  if (!*kept || !copy_memory(s, *kept, &s->now))
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory to save the integrator's state");
  return TDM_OK;
}

static tdm_status restore(void *self, const void *kept, tdm_error *err) {
  mbd_alpha *s = self;
  if (!copy_memory(s, &s->now, kept))
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory to restore the integrator's state");
  return TDM_OK;
}

const mbd_integrator_ops mbd_one_step = {
    .create = create,
    .start = start,
    .advance = advance,
    .stats = stats,
    .destroy = destroy,
    .save = save,
    .restore = restore,
    .release = release,
};
