/* A window of the engine: its steps, and the samples of the outputs. See dem.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/adapter/engine.h"
#include "dem/adapter/orders.h"

#include "dem/exchange/balance.h"
#include "dem/flow/flow.h"
#include "dem/flow/screening.h"
#include "dem/particles/container.h"
#include "dem/seam/homes.h"
#include "dem/step/step.h"
#include "dem/watch/check.h"
#include "dem/watch/energy_balance.h"
#include "dem/watch/guard.h"
#include "protocol/base/memory.h"

#include <string.h>

/* ---- samples ---- */

static tdm_wrench mean_load(const tdm_wrench *sum, double n) {
  return (tdm_wrench){tdm_scale(1 / n, sum->force), tdm_scale(1 / n, sum->moment)};
}

static void add_load(tdm_wrench *sum, double weight, const tdm_wrench *load) {
  sum->force = tdm_axpy(weight, load->force, sum->force);
  sum->moment = tdm_axpy(weight, load->moment, sum->moment);
}

/* The share `share` of the present step, into the means of the output interval. */
static void sum_loads(dem_data *d, double share, tdm_vec3 fixed) {
  const int nload = d->model->nload;
  for (int l = 0; l < nload; l++)
    add_load(&d->state.sample_sum[l], share, &d->state.body_load[l]);
  add_load(&d->state.sample_sum[nload], share, &(tdm_wrench){.force = fixed});
  d->state.sample_steps += share;
}

/* Close the output interval: means since the sample before (which repeats if no time lies between), and channels, at
 * `share` of the present step, which ends at t. */
static void close_sample(dem_engine *e, int j, double share, double t, double dt, const dem_outcome *out) {
  dem_data *d = e->data;
  const dem_model *m = e->model;
  for (int l = 0; l <= m->nload; l++) {
    if (d->state.sample_steps > 0)
      d->state.sample_mean[l] = mean_load(&d->state.sample_sum[l], d->state.sample_steps);
    d->state.sample_sum[l] = (tdm_wrench){0};
  }
  for (int c = 0; c < m->ncoupled && out->sample_load; c++)
    out->sample_load[j * m->ncoupled + c] = d->state.sample_mean[m->coupled_body[c]];
  dem_containers_sample(d, d->state.sample_steps * dt);
  d->state.sample_steps = 0;
  dem_screening_watch(d, t);
  if (!out->channel)
    return;
  double *values = &out->channel[j * e->channels.count];
  dem_channels_sample(&e->channels, d, values);
  if (share < 1)
    dem_channels_within(&e->channels, share, dt, e->before, values);
}

/* The step that ended at t is done: its loads into the means, and the output times up to t. The last step of a window
 * closes what is left. `fixed`: force on fixed particles before any came or went. */
static void sample_step(dem_engine *e, const dem_window *w, bool last, double t, double dt, tdm_vec3 fixed, int *sample,
                        const dem_outcome *out) {
  double from = 0;
  for (; *sample < w->nsample && (last || w->sample_time[*sample] <= t + 1e-6 * dt); ++*sample) {
    double share = dem_share_of_step(w->sample_time[*sample], t, dt);
    if (share > from)
      sum_loads(e->data, share - from, fixed);
    from = fmax(from, share);
    close_sample(e, *sample, share, t, dt, out);
  }
  if (from < 1)
    sum_loads(e->data, 1 - from, fixed);
}

/* ---- steps ---- */

/* the step of this window: the scene's, unless the window is no whole number of them */
static double step_length(const dem_model *m, const dem_window *w) {
  double own = (w->t1 - w->t0) / (double)w->nstep;
  return fabs(own - m->dt) <= 1e-6 * m->dt ? m->dt : own;
}

/* The time at which step k, the next one, ends: from the number of steps since the start, so that sources do not depend
 * on how the run is cut into windows; from the window when that is not cut into the scene's steps. */
static double step_time(const dem_data *d, const dem_window *w, uint64_t k, double dt) {
  double t = w->t0 + (double)k * dt, own = d->model->time_start + (double)(d->state.nstep + 1) * d->model->dt;
  return fabs(t - own) < 1e-3 * dt ? own : t;
}

/* ---- what a rank does (dem_engine_work) ---- */

static void count_work(dem_data *d) {
  dem_homes *s = &d->work.homes;
  const int first = dem_home_first(d), end = dem_home_end(d);
  if (dem_alone(d))
    return;
  s->work.steps++;
  s->work.particles += dem_home_end_particle(d) - dem_home_first_particle(d);
  s->work.near += (double)(d->lists.pairs.chunk[end] - d->lists.pairs.chunk[first]) +
                  (double)(d->lists.walls.chunk[end] - d->lists.walls.chunk[first]);
  s->work.contacts += (double)s->touching;
  s->work.visitors += s->visitors.first[s->ranks->size];
}

/* What was exchanged since `before`, and the time since `begin`. */
static void add_exchanged(dem_data *d, const dem_exchanged *before, double begin) {
  dem_exchanged *sum = &d->work.homes.work.exchanged;
  const dem_exchanged *now = d->work.homes.ranks->exchanged;
  sum->messages += now->messages - before->messages;
  sum->message_bytes += now->message_bytes - before->message_bytes;
  sum->gathers += now->gathers - before->gathers;
  sum->gathered_bytes += now->gathered_bytes - before->gathered_bytes;
  sum->reductions += now->reductions - before->reductions;
  sum->seconds += now->seconds - before->seconds;
  d->work.homes.work.seconds += tdm_clock() - begin;
}

/* ---- a window ---- */

static tdm_status run_steps(dem_engine *e, const dem_window *w, dem_step_task *task, const dem_outcome *out,
                            tdm_error *err) {
  dem_data *d = e->data;
  const double dt = task->dt;
  int sample = 0;
  for (task->k = 1; task->k <= w->nstep; task->k++) {
    const bool last = task->k == w->nstep;
    task->time = step_time(d, w, task->k, dt);
    if (sample < w->nsample && dem_share_of_step(w->sample_time[sample], task->time, dt) < 1)
      dem_channels_sample(&e->channels, d, e->before);
    d->work.traction.wanted = e->model->triangle_forces && last && w->seen;
    if (dem_step(d, task, err))
      return err->status;
    count_work(d);
    sample_step(e, w, last, task->time, dt, task->sums->fixed, &sample, out);
    if (dem_homes_alive(d, e->participant))
      return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted at t = %.9g s", task->time);
  }
  return TDM_OK;
}

/* what the window came to, after its last step */
static void conclude(dem_engine *e, const dem_window *w, const dem_outcome *out) {
  const dem_model *m = e->model;
  if (w->mechanism)
    dem_proxy_end(e->proxy, e->data, out->body, out->further);
  for (int c = 0; c < m->ncoupled && out->load; c++)
    out->load[c] = mean_load(&e->load[c], (double)w->nstep);
  if (out->energy)
    *out->energy = dem_energy_balance_look(e->data);
  if (w->t1 >= m->time_end - 1e-3 * m->dt) {
    dem_guard_end(e->data, w->t1);
    dem_flow_end(e->data, w->t1);
    if (!dem_alone(e->data))
      tdm_log(TDM_LOG_INFO, "ranks", "number=%d imbalance=%.3g moves=%d", e->data->work.homes.ranks->size,
              dem_homes_imbalance(e->data), e->data->work.homes.nmove);
  }
}

static tdm_status advance(dem_engine *e, const dem_window *w, const dem_outcome *out, tdm_error *err) {
  const double dt = step_length(e->model, w);
  const dem_proxy_window carried = {.t0 = w->t0, .nstep = w->nstep, .dt = dt, .contact_time = e->contact_time};
  if (w->mechanism &&
      (dem_engine_check_proxy(e, err) || dem_proxy_begin(e->proxy, e->data, w->mechanism, &carried, err)))
    return err->status;
  memset(e->load, 0, (size_t)e->model->ncoupled * sizeof *e->load);
  dem_window_sums sums = {.duration = w->t1 - w->t0, .load = e->load, .body = out->body};
  dem_step_task task = {.dt = dt,
                        .flow = true,
                        .guard = true,
                        .path = w->mechanism ? NULL : w->path,
                        .proxy = w->mechanism ? e->proxy : NULL,
                        .n = w->nstep,
                        .sums = &sums};
  if (run_steps(e, w, &task, out, err))
    return err->status;
  conclude(e, w, out);
  e->time = w->t1;
  if (dem_check_finite(e->data, w->t1, err))
    return err->status;
  return dem_view_watch(&e->view, e->data, err);
}

tdm_status dem_engine_advance(dem_engine *e, const dem_window *w, const dem_outcome *out, tdm_error *err) {
  dem_orders_advance(w, out, e->model->ncoupled);
  const unsigned long before = tdm_memory_notes();
  const dem_exchanged exchanged = dem_alone(e->data) ? (dem_exchanged){0} : *e->data->work.homes.ranks->exchanged;
  const double begin = tdm_clock();
  advance(e, w, out, err);
  if (!dem_alone(e->data))
    add_exchanged(e->data, &exchanged, begin);
  tdm_memory_since(before, "dem", err);
  return dem_orders_done(err);
}
