/* One DEM step: see step.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/step/step.h"

#include "dem/bodies/traction.h"
#include "dem/bodies/walls.h"
#include "dem/flow/flow.h"
#include "dem/particles/domain.h"
#include "dem/seam/notes.h"
#include "dem/seam/visits.h"
#include "dem/search/pairs.h"
#include "dem/step/unsettled.h"
#include "dem/watch/energy_balance.h"
#include "dem/watch/guard.h"
#include "protocol/scene/remark.h"

#include <stdio.h>
#include <string.h>

/* How a step goes: all forces at once, or, with multi-step, `many` substeps of h under the fast forces between two half
 * kicks of the slow ones. */
typedef struct {
  const dem_integrator *integrator;
  bool two;      /* sets of forces */
  uint64_t many; /* 1 without two */
  double h;      /* [s] */
} substeps;

static substeps substeps_of(const dem_data *d, const dem_step_task *s) {
  const dem_model *m = d->model;
  substeps p = {.integrator = s->settling ? m->settler : m->integrator, .many = 1, .h = s->dt};
  p.two = p.integrator->kick != NULL;
  if (p.two) {
    p.many = (uint64_t)m->multi_step.substeps;
    p.h = s->dt / (double)p.many;
  }
  return p;
}

/* half a kick of the slow forces */
static void kick(dem_data *d, const substeps *p, double dt) {
#pragma omp parallel for schedule(static) num_threads(d->work.nthread) if (d->work.nthread > 1)
  for (int c = dem_home_first(d); c < dem_home_end(d); c++)
    p->integrator->kick(d, c, dt);
}

/* What the integrator keeps is made anew after a change from outside, or for another step. */
static void begin(dem_data *d, const dem_step_task *s, const substeps *p) {
  if (s->sums && s->k == 1)
    dem_window_sums_add(s->sums, d, 0, s->n, s->path);
  if (!s->settling) {
    if ((d->state.restart || s->dt != d->state.memory_dt) && p->integrator->remember)
      p->integrator->remember(d, dem_home_first_particle(d), dem_home_end_particle(d), s->dt);
    d->state.restart = false;
    d->state.memory_dt = s->dt;
  }
  if (p->two) {
    kick(d, p, s->dt);
    memset(d->work.fast_load, 0, (size_t)d->model->nload * sizeof *d->work.fast_load);
  }
  dem_traction_clear(d);
}

/* the coupled bodies, the driven ones and the box, to the end of substep j (1 ... many) */
static void move_bodies(dem_data *d, const dem_step_task *s, const substeps *p, uint64_t j) {
  const dem_model *m = d->model;
  if (s->proxy)
    dem_proxy_drift(s->proxy, d);
  else if (s->path)
    dem_bodies_move(d, s->path, (s->k - 1) * p->many + j, s->n * p->many);
  if (s->settling)
    return;
  dem_bodies_drive(d, m->time_start + ((double)d->state.nstep + (double)j / (double)p->many) * m->dt);
  if (m->domain.strained)
    dem_domain_strain(d, p->h);
}

/* The particles of a chunk turn with the spin that they have in the middle of the substep. */
static void turn_particles(dem_data *d, int chunk, double h) {
  for (int i = chunk * DEM_CHUNK, last = dem_chunk_end(d, chunk); i < last; i++)
    d->state.orientation[i] = tdm_quat_turned(d->state.orientation[i], tdm_scale(h, d->state.pace[i].spin));
}

/* Kick and drift of a chunk, forces zeroed; the largest way since the lists were made, squared [m2]. */
static double move_chunk(dem_data *d, const substeps *p, const dem_stride *stride, int chunk) {
  const double moved2 = p->integrator->begin(d, chunk, stride);
  if (d->model->oriented)
    turn_particles(d, chunk, p->h);
  return moved2;
}

/* The same of all; NaN: a position is no number. One thread does not start OpenMP, which takes a microsecond. */
static double move_particles(dem_data *d, const dem_step_task *s, const substeps *p, uint64_t j) {
  if (p->two)
    dem_forces_swap(d);
  dem_stride stride = {p->h, p->two ? (double)j * p->h - 0.5 * s->dt : 0, dem_lists_shift(d)};
  double moved2 = 0;
  bool numbers = true;
  const int first = dem_home_first(d), end = dem_home_end(d);
  if (d->work.nthread == 1)
    for (int c = first; c < end; c++) {
      const double r2 = move_chunk(d, p, &stride, c);
      numbers = numbers && r2 >= 0;
      moved2 = r2 > moved2 ? r2 : moved2;
    }
  else
#pragma omp parallel for schedule(static) num_threads(d->work.nthread) reduction(max : moved2) reduction(&& : numbers)
    for (int c = first; c < end; c++) {
      const double r2 = move_chunk(d, p, &stride, c);
      numbers = numbers && r2 >= 0;
      moved2 = r2 > moved2 ? r2 : moved2;
    }
  dem_parted(d, DEM_STATE);
  dem_time_spent(d->work.timers, DEM_PHASE_INTEGRATION);
  moved2 = dem_homes_largest(d, numbers ? moved2 : INFINITY); /* a way has no infinite square: farthest() */
  return isfinite(moved2) ? moved2 : NAN;
}

static tdm_status find_contacts(dem_data *d, double moved2, double h) {
  if (d->model->domain.repeats)
    dem_domain_wrap(d);
  uint64_t before = d->lists.nrebuild;
  if (dem_lists_update(d, moved2) || dem_homes_plan(d))
    return TDM_ERR_MEMORY;
  dem_visitors_begin(d);
  if (d->lists.nrebuild != before) /* a particle that moves far in a step makes new lists */
    dem_guard_note_leap(d, h);
  tdm_status status = dem_traction_reserve(d);
  if (!status && d->model->noting)
    status = dem_notes_reserve(d);
  dem_time_spent(d->work.timers, DEM_PHASE_LIST);
  return status;
}

/* the forces, and the kick that ends the substep */
static void evaluate_and_kick(dem_data *d, const dem_step_task *s, const substeps *p) {
  dem_forces_add(d, p->two ? DEM_FAST : DEM_ALL, s->settling, p->h, p->integrator);
  dem_traction_add(d, 1 / (double)p->many);
  if (!p->two)
    return;
  dem_forces_swap(d);
  dem_loads_add(d, 1 / (double)p->many, d->state.body_load, d->work.fast_load);
}

/* the slow forces, and the other half of their kick */
static void end(dem_data *d, const dem_step_task *s, const substeps *p) {
  if (!p->two)
    return;
  dem_forces_clear(d, d->state.push);
  dem_forces_add_slow(d, s->settling, s->dt);
  kick(d, p, s->dt);
}

static void count_step(dem_data *d, const dem_step_task *s) {
  d->state.restart = d->state.restart || s->settling;
  d->state.nstep++;
  d->state.since_sort++;
  d->lists.since_list++;
  dem_time_spent(d->work.timers, DEM_PHASE_INTEGRATION);
}

/* Forces that still change by more than the tolerance they are iterated to: remark "guard.iterations", or an error. */
static tdm_status look_at_iterations(dem_data *d, double t, tdm_error *err) {
  const dem_guard_def *guard = &d->model->guard;
  const dem_noting *noting = d->model->noting;
  const double change = dem_forces_unsettled(d);
  if (!(change > 0) || !(change > noting->tolerance(d->model)))
    return TDM_OK;
  char text[TDM_MESSAGE_MAX];
  snprintf(
      text, sizeof text,
      "after dem.contact.iterations = %ld one more would still change forces by %.3g of the largest, more than "
      "dem.contact.tolerance = %g, at t = %.9g s, step %llu; raise either, or, where forces grow without end, press "
      "less or take a smaller gamma",
      noting->iterations(d->model), change, noting->tolerance(d->model), t, (unsigned long long)d->state.nstep);
  if (guard->action == DEM_GUARD_STOP)
    return tdm_fail(err, TDM_ERR_NUMERIC, "dem.contact.iterations", "%s", text);
  tdm_remark(TDM_WARNING, "guard.iterations", "dem.contact.iterations", t, "%s", text);
  return TDM_OK;
}

static tdm_status watch(dem_data *d, const dem_step_task *s, tdm_error *err) {
  if (dem_guard(d, s->time, s->dt, err) == TDM_OK && s->proxy)
    dem_guard_proxy(d, s->proxy, s->time, s->dt, err);
  const uint64_t every = (uint64_t)d->model->guard.every;
  if (err->status == TDM_OK && every > 0 && d->state.nstep % every == 0)
    look_at_iterations(d, s->time, err);
  return err->status;
}

tdm_status dem_step(dem_data *d, const dem_step_task *s, tdm_error *err) {
  const substeps p = substeps_of(d, s);

  /* bodies and particles move, and contacts push them */
  begin(d, s, &p);
  for (uint64_t j = 1; j <= p.many; j++) {
    move_bodies(d, s, &p, j);
    double moved2 = move_particles(d, s, &p, j);
    if (find_contacts(d, moved2, p.h))
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the neighbour lists");
    evaluate_and_kick(d, s, &p);
  }
  end(d, s, &p);

  /* the bodies that the step carries feel the new loads, the box loses what left it */
  if (s->proxy)
    dem_proxy_kick(s->proxy, d);
  if (d->model->domain.open && dem_flow_leave(d))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the contacts of the particles that stay");
  if (d->model->ndriven > 0 && !s->settling)
    dem_energy_balance_step(d, s->dt);
  count_step(d, s);

  /* what others want of the step: sums over the window, the guard, sources and sinks */
  if (s->sums)
    dem_window_sums_add(s->sums, d, s->k, s->n, s->path);
  if (s->guard && watch(d, s, err))
    return err->status;
  return s->flow ? dem_flow(d, s->time, s->dt, err) : TDM_OK;
}
