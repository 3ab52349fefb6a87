/* One DEM step: see step.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/step/step.h"

#include "dem/bodies/traction.h"
#include "dem/bodies/walls.h"
#include "dem/contact/loop/task.h"
#include "dem/flow/flow.h"
#include "dem/search/pairs.h"
#include "dem/state/domain.h"
#include "dem/step/integrate.h"
#include "dem/watch/energy_balance.h"
#include "dem/watch/guard.h"

#include <string.h>

/* every chunk on its own, on the threads there are */
#define EACH_CHUNK _Pragma("omp parallel for schedule(static) num_threads(d->nthread) if (d->nthread > 1)")

static double begin_step(dem_data *d, const dem_integrator *integrator, double dt, double lead) {
  dem_stride stride = {dt, lead, dem_lists_shift(d)};
  double moved2 = 0;
  bool numbers = true;
#pragma omp parallel for schedule(static) num_threads(d->nthread) if (d->nthread > 1) reduction(max : moved2) reduction(&& : numbers)
  for (int c = 0; c < d->nchunk; c++) {
    double r2 = integrator->begin(d, c, &stride);
    numbers = numbers && r2 >= 0;
    moved2 = r2 > moved2 ? r2 : moved2;
  }
  return numbers ? moved2 : NAN;
}

/* in the order of the chunks */
static void add_energy(dem_data *d, dem_share share, double dt) {
  dem_flux sum = {0};
  if (share == DEM_ALL)
    d->energy.fast = sum;
  for (int c = 0; c < d->nchunk; c++)
    dem_flux_add(&sum, &d->chunk_flux[c]);
  dem_energy_step(&d->energy, share == DEM_FAST ? &d->energy.fast : &d->energy.now, &sum, dt);
}

static void end_step(dem_data *d, const dem_integrator *integrator, double dt) {
  EACH_CHUNK
  for (int c = 0; c < d->nchunk; c++)
    integrator->end(d, c, dt);
}

/* A chunk's walls, geometry by geometry: what a body's load grows by is the load of the geometry. The same sums, in the
 * same order, as all walls at once. */
static void geometry_loads(dem_loop_task *task) {
  const dem_model *m = task->model;
  const dem_wall_entry *entry = task->data->walls.entry;
  size_t last = task->wall_end;
  for (size_t k = task->wall_first; k < last; k = task->wall_end) {
    int g = m->wall[entry[k].wall].geometry, b = m->geometry[g].body;
    task->wall_first = k;
    for (task->wall_end = k + 1; task->wall_end < last && m->wall[entry[task->wall_end].wall].geometry == g;)
      task->wall_end++;
    tdm_wrench before = task->load[b], *grown = &task->load[m->nbody + g];
    m->loops->walls(task);
    grown->force = tdm_sub(task->load[b].force, before.force);
    grown->moment = tdm_sub(task->load[b].moment, before.moment);
  }
}

/* Add up the forces of a share of the contacts on particles (zeroed before) and bodies; then, with an integrator, end
 * its step. One thread ends each chunk at once, while it is in the cache: what other chunks add to it came before. */
static void evaluate(dem_data *d, dem_share share, bool settling, double dt, const dem_integrator *integrator) {
  const dem_model *m = d->model;
  tdm_vec3 *entry_force = dem_traction_entries(d);
  long touching = 0;
#pragma omp parallel for schedule(static) num_threads(d->nthread) if (d->nthread > 1) reduction(+ : touching)
  for (int c = 0; c < d->nchunk; c++) {
    dem_loop_task task = {.model = m, .data = d, .chunk = c, .settling = settling, .dt = dt, .share = share};
    task.wall_first = d->walls.chunk[c];
    task.wall_end = d->walls.chunk[c + 1];
    task.load = &d->chunk_load[(size_t)c * (size_t)m->nload];
    task.entry_force = entry_force;
    memset(task.load, 0, (size_t)m->nload * sizeof *task.load);
    m->loops->pairs(&task);
    if (m->geometry_loads)
      geometry_loads(&task);
    else
      m->loops->walls(&task);
    touching += task.touching;
    d->chunk_flux[c] = task.flux;
    if (integrator && d->nthread == 1) {
      dem_time_spent(d->timers, DEM_PHASE_CONTACTS);
      integrator->end(d, c, dt);
      dem_time_spent(d->timers, DEM_PHASE_INTEGRATION);
    }
  }
  if (integrator && d->nthread > 1)
    end_step(d, integrator, dt);
  d->ncontact = touching;
  if (m->energy)
    add_energy(d, share, dt);
  for (int b = 0; b < m->nload; b++) {
    tdm_wrench sum = {0};
    for (int c = 0; c < d->nchunk; c++) {
      sum.force = tdm_add(sum.force, d->chunk_load[c * m->nload + b].force);
      sum.moment = tdm_add(sum.moment, d->chunk_load[c * m->nload + b].moment);
    }
    d->body_load[b] = sum;
  }
}

/* between drift and forces; false: no memory */
static bool find_contacts(dem_data *d, double moved2, double dt) {
  if (d->model->domain.repeats)
    dem_domain_wrap(d);
  uint64_t before = d->nrebuild;
  if (!dem_lists_update(d, moved2))
    return false;
  if (d->nrebuild != before) /* a particle that moves far in a step makes new lists */
    dem_guard_note_leap(d, dt);
  return dem_traction_reserve(d);
}

/* ---- several steps of the fast forces in one of the slow ones ---- */

static void swap_forces(dem_data *d) {
  dem_push *push = d->push;
  d->push = d->spare_push;
  d->spare_push = push;
}

static void kick(dem_data *d, double dt) {
  const dem_integrator *integrator = d->model->integrator;
  EACH_CHUNK
  for (int c = 0; c < d->nchunk; c++)
    integrator->kick(d, c, dt);
}

/* loads of the bodies: those of the slow contacts, and means of the fast ones over the substeps */
static void add_fast_loads(dem_data *d, double share, const tdm_wrench *from, tdm_wrench *to) {
  for (int b = 0; b < d->model->nload; b++) {
    to[b].force = tdm_axpy(share, from[b].force, to[b].force);
    to[b].moment = tdm_axpy(share, from[b].moment, to[b].moment);
  }
}

static void evaluate_slow(dem_data *d, bool settling, double dt) {
  long fast = d->ncontact;
  evaluate(d, DEM_SLOW, settling, dt, NULL);
  dem_traction_add(d, 1);
  d->ncontact += fast;
  add_fast_loads(d, 1, d->fast_load, d->body_load);
}

/* the forces of both kinds at the present state, each in its place; needs them zeroed */
static void evaluate_both(dem_data *d, bool settling, double dt) {
  memset(d->spare_push, 0, (size_t)d->nparticle * sizeof *d->push);
  swap_forces(d);
  evaluate(d, DEM_FAST, settling, dt, NULL);
  dem_traction_add(d, 1);
  end_step(d, d->model->integrator, 0);
  swap_forces(d);
  memcpy(d->fast_load, d->body_load, (size_t)d->model->nload * sizeof *d->body_load);
  evaluate_slow(d, settling, dt);
}

static bool multi_step(dem_data *d, const dem_path *motion, uint64_t k, uint64_t n, double dt) {
  const dem_model *m = d->model;
  uint64_t many = (uint64_t)m->multi_step.substeps;
  double h = dt / (double)many;
  kick(d, dt);
  memset(d->fast_load, 0, (size_t)m->nload * sizeof *d->fast_load);
  dem_traction_clear(d);
  for (uint64_t j = 1; j <= many; j++) {
    if (motion)
      dem_bodies_move(d, motion, (k - 1) * many + j, n * many);
    dem_bodies_drive(d, m->time_start + ((double)d->nstep + (double)j / (double)many) * m->dt);
    if (m->domain.strained)
      dem_domain_strain(d, h);
    swap_forces(d);
    double moved2 = begin_step(d, m->integrator, h, (double)j * h - 0.5 * dt);
    if (!find_contacts(d, moved2, h))
      return false;
    evaluate(d, DEM_FAST, false, h, NULL);
    dem_traction_add(d, 1 / (double)many);
    end_step(d, m->integrator, h);
    swap_forces(d);
    add_fast_loads(d, 1 / (double)many, d->body_load, d->fast_load);
  }
  memset(d->push, 0, (size_t)d->nparticle * sizeof *d->push);
  evaluate_slow(d, false, dt);
  kick(d, dt);
  return true;
}

/* ---- one step ---- */

static bool single_step(dem_data *d, const dem_path *motion, uint64_t k, uint64_t n, bool settling, double dt) {
  const dem_model *m = d->model;
  const dem_integrator *integrator = settling ? m->settler : m->integrator;
  if (motion)
    dem_bodies_move(d, motion, k, n);
  if (!settling)
    dem_bodies_drive(d, m->time_start + (double)(d->nstep + 1) * m->dt);
  if (m->domain.strained && !settling)
    dem_domain_strain(d, dt);
  double moved2 = begin_step(d, integrator, dt, 0);
  dem_time_spent(d->timers, DEM_PHASE_INTEGRATION);
  if (!find_contacts(d, moved2, dt))
    return false;
  dem_time_spent(d->timers, DEM_PHASE_LIST);
  dem_traction_clear(d);
  evaluate(d, DEM_ALL, settling, dt, integrator);
  dem_traction_add(d, 1);
  return true;
}

/* what the integrator keeps, after a change from outside or for another step */
static void remember(dem_data *d, double dt) {
  if ((d->restart || dt != d->memory_dt) && d->model->integrator->remember)
    d->model->integrator->remember(d, 0, d->nparticle, dt);
  d->restart = false;
  d->memory_dt = dt;
}

bool dem_step(dem_data *d, const dem_path *motion, uint64_t k, uint64_t n, bool settling, double dt) {
  bool multi = !settling && d->model->integrator->kick;
  if (!settling)
    remember(d, dt);
  if (!(multi ? multi_step(d, motion, k, n, dt) : single_step(d, motion, k, n, settling, dt)))
    return false;
  if (d->model->domain.open)
    dem_flow_leave(d);
  if (d->model->ndriven > 0 && !settling)
    dem_energy_balance_step(d, dt);
  d->restart = d->restart || settling;
  dem_time_spent(d->timers, DEM_PHASE_INTEGRATION);
  d->nstep++;
  d->since_sort++;
  d->since_list++;
  return true;
}

void dem_forces_frozen(dem_data *d, double dt) {
  memset(d->push, 0, (size_t)(d->nparticle + 1 + d->crossings.count) * sizeof *d->push);
  evaluate(d, DEM_ALL, false, dt, NULL);
}

void dem_forces_again(dem_data *d, bool settling, double dt) {
  memset(d->push + d->nparticle, 0, (size_t)(1 + d->crossings.count) * sizeof *d->push);
  for (int i = 0; i < d->nparticle; i++) {
    d->sphere[i].velocity = d->pace[i].velocity;
    d->rotor[i].surface = tdm_scale(d->sphere[i].radius, d->pace[i].spin);
    d->push[i] = (dem_push){0};
  }
  dem_traction_clear(d);
  if (d->model->integrator->kick && !settling) {
    evaluate_both(d, settling, dt);
  } else {
    evaluate(d, DEM_ALL, settling, dt, NULL);
    dem_traction_add(d, 1);
  }
  end_step(d, d->model->settler, 0);
  d->restart = true;
}

bool dem_forces_now(dem_data *d, bool settling) {
  dem_walls_put(d);
  if (!dem_lists_build(d) || !dem_traction_reserve(d))
    return false;
  dem_forces_again(d, settling, 0);
  return true;
}
