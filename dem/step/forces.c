/* Forces: see forces.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/step/forces.h"
#include "dem/step/unsettled.h"

#include "dem/bodies/traction.h"
#include "dem/bodies/walls.h"
#include "dem/seam/crossings.h"
#include "dem/seam/notes.h"
#include "dem/seam/sums.h"
#include "dem/seam/visits.h"
#include "dem/search/pairs.h"
#include "dem/state/wall_gap.h"

#include <assert.h>
#include <string.h>

/* in the order of the chunks */
static void add_energy(dem_data *d, dem_share share, double dt) {
  dem_flux sum = {0};
  if (share == DEM_ALL)
    d->state.energy.fast = sum;
  for (int c = 0; c < d->lists.nchunk; c++)
    dem_flux_add(&sum, &d->work.chunk_flux[c]);
  dem_energy_step(&d->state.energy, share == DEM_FAST ? &d->state.energy.fast : &d->state.energy.now, &sum, dt);
}

/* A chunk's walls, geometry by geometry: what a body's load grows by is the load of the geometry. The same sums, in the
 * same order, as all walls at once. */
static void geometry_loads(dem_loop_task *task) {
  const dem_model *m = task->model;
  const dem_wall_entry *entry = task->data->lists.walls.entry;
  size_t last = task->wall_end;
  for (size_t k = task->wall_first; k < last; k = task->wall_end) {
    int g = m->wall[entry[k].wall].geometry, b = m->geometry[g].body;
    task->wall_first = k;
    for (task->wall_end = k + 1; task->wall_end < last && m->wall[entry[task->wall_end].wall].geometry == g;)
      task->wall_end++;
    tdm_wrench before = task->load[b], *grown = &task->load[m->nbody + g];
    m->wall_loops->walls(task);
    grown->force = tdm_sub(task->load[b].force, before.force);
    grown->moment = tdm_sub(task->load[b].moment, before.moment);
  }
}

static dem_loop_task task_of(dem_data *d, int chunk, bool settling) {
  return (dem_loop_task){.model = d->model,
                         .data = d,
                         .chunk = chunk,
                         .settling = settling,
                         .wall_first = d->lists.walls.chunk[chunk],
                         .wall_end = d->lists.walls.chunk[chunk + 1]};
}

/* ---- what contacts do to each other; settling: a bool ---- */

static void sum_own(dem_data *d, int chunk, void *settling) {
  dem_loop_task task = task_of(d, chunk, *(const bool *)settling);
  d->model->sum_loops->pairs(&task);
  d->model->sum_loops->walls(&task);
}

static void sum_crossings(dem_data *d, int chunk, void *settling) {
  const size_t nsum = (size_t)d->model->nsum;
  const dem_crossings *x = &d->lists.crossings;
  (void)settling;
  for (int k = x->chunk[chunk]; k < x->chunk[chunk + 1]; k++) {
    const size_t slot = (size_t)dem_crossing_slot(d, x->order[k]), particle = (size_t)x->particle[x->order[k]];
    for (size_t q = 0; q < nsum; q++)
      d->work.contact_sum[particle * nsum + q] += d->work.contact_sum[slot * nsum + q];
  }
}

/* between ranks, the sums of a place of push: of contacts with visitors, then those of immigrants */

static void copy_sums(const dem_data *d, int slot, double *entry, bool to_entry) {
  double *sums = d->work.contact_sum + (size_t)slot * (size_t)d->model->nsum;
  memcpy(to_entry ? entry : sums, to_entry ? sums : entry, (size_t)d->model->nsum * sizeof *sums);
}

static void write_crossing(dem_data *d, int k, double *entry) {
  copy_sums(d, dem_crossing_slot(d, d->work.homes.returning.item[k]), entry, true);
}

static void read_crossing(dem_data *d, int k, double *entry) {
  copy_sums(d, dem_crossing_slot(d, d->work.homes.returned.item[k]), entry, false);
}

static void write_immigrant(dem_data *d, int k, double *entry) {
  copy_sums(d, d->work.homes.immigrants.item[k], entry, true);
}

static void read_visitor(dem_data *d, int k, double *entry) {
  copy_sums(d, d->work.homes.visitors.item[k], entry, false);
}

/* Sums over the contacts of each particle, of laws that have them: of all contacts, with the geometry that the forces
 * will see. Reactions from other chunks come after those of the particle's own, as forces do. */
static void sum_contacts(dem_data *d, bool settling) {
  memset(d->work.contact_sum, 0, dem_push_count(d) * (size_t)d->model->nsum * sizeof *d->work.contact_sum);
  dem_visitors_end(d);
  dem_each_chunk(d, sum_own, &settling);
  dem_homes_tell(d, DEM_TO_HOME, d->model->nsum, write_crossing, read_crossing);
  dem_each_chunk(d, sum_crossings, &settling);
  dem_homes_tell(d, DEM_TO_VISITED, d->model->nsum, write_immigrant, read_visitor);
}

static void write_notes(dem_data *d, int chunk, void *settling) {
  dem_loop_task task = task_of(d, chunk, *(const bool *)settling);
  d->model->noting->write.pairs(&task);
  d->model->noting->write.walls(&task);
}

static void share_notes(dem_data *d, int chunk, void *settling) {
  dem_loop_task task = task_of(d, chunk, *(const bool *)settling);
  d->model->noting->share(&task);
}

static void share_all(dem_data *d, bool settling) {
  dem_notes_send(d);
  dem_each_chunk(d, share_notes, &settling);
  dem_notes_return(d);
}

/* the notes anew from what came of them; by how much a force changed at most, share of the largest */
static double notes_again(dem_data *d, bool settling) {
  double change = 0, largest = 0;
#pragma omp parallel for schedule(static) num_threads(d->work.nthread) if (d->work.nthread > 1) \
    reduction(max                                                                               \
              : change, largest)
  for (int c = dem_home_first(d); c < dem_home_end(d); c++) {
    dem_loop_task task = task_of(d, c, settling);
    double most, changed = d->model->noting->again(&task, &most);
    change = changed > change ? changed : change;
    largest = most > largest ? most : largest;
  }
  double both[] = {change, largest};
  dem_homes_largest_of(d, both, 2);
  return both[1] > 0 ? both[0] / both[1] : both[0] > 0;
}

double dem_forces_unsettled(dem_data *d) {
  const dem_noting *noting = d->model->noting;
  return noting && noting->tolerance(d->model) > 0 && d->work.notes.valid ? notes_again(d, false) : 0;
}

/* What contacts tell the others of their particles, and what these make of it, so often as the law wants, or until no
 * force changes by more than its tolerance. */
static void take_notes(dem_data *d, bool settling) {
  const dem_noting *noting = d->model->noting;
  assert(d->work.notes.valid);
  dem_visitors_end(d);
  dem_each_chunk(d, write_notes, &settling);
  share_all(d, settling);
  for (long times = noting->iterations(d->model); times > 1 && notes_again(d, settling) > noting->tolerance(d->model);
       times--)
    share_all(d, settling);
}

/* A chunk's forces, by a task like `all`; how many of its contacts touch. */
static long chunk_forces(dem_data *d, int chunk, const dem_loop_task *all) {
  const dem_model *m = d->model;
  const double begin = dem_alone(d) ? 0 : dem_homes_clock();
  dem_loop_task task = *all;
  task.chunk = chunk;
  task.wall_first = d->lists.walls.chunk[chunk];
  task.wall_end = d->lists.walls.chunk[chunk + 1];
  task.load = &d->work.chunk_load[(size_t)chunk * (size_t)m->nload];
  memset(task.load, 0, (size_t)m->nload * sizeof *task.load);
  m->loops->pairs(&task);
  if (m->geometry_loads)
    geometry_loads(&task);
  else
    m->wall_loops->walls(&task);
  d->work.chunk_flux[chunk] = task.flux;
  if (!dem_alone(d))
    dem_home_took(d, chunk, begin);
  return task.touching;
}

/* Forces of all chunks on one thread, which starts no OpenMP, and the end of their step: of each at once, while it is
 * in the cache. What other chunks add to it came before. */
static long forces_alone(dem_data *d, const dem_loop_task *all, const dem_integrator *integrator) {
  long touching = 0;
  for (int c = 0; c < d->lists.nchunk; c++) {
    touching += chunk_forces(d, c, all);
    if (!integrator)
      continue;
    dem_time_spent(d->work.timers, DEM_PHASE_CONTACTS);
    integrator->end(d, c, all->dt);
    dem_time_spent(d->work.timers, DEM_PHASE_INTEGRATION);
  }
  return touching;
}

/* The end of the step of a home chunk. */
static void end_chunk(dem_data *d, int chunk, const dem_integrator *integrator, double dt) {
  const double begin = dem_alone(d) ? 0 : dem_homes_clock();
  integrator->end(d, chunk, dt);
  if (!dem_alone(d))
    dem_home_took(d, chunk, begin);
}

static void end_chunks(dem_data *d, const dem_integrator *integrator, double dt) {
#pragma omp parallel for schedule(static) num_threads(d->work.nthread)
  for (int c = dem_home_first(d); c < dem_home_end(d); c++)
    end_chunk(d, c, integrator, dt);
}

/* A chunk's forces on one of several ranks; how many of its contacts touch. integrator: and the end of the step of
 * those chunks that nothing will be added to any more, while they are in the cache; NULL: of none. */
static long chunk_step(dem_data *d, int chunk, const dem_loop_task *all, const dem_integrator *integrator) {
  const dem_givers *givers = &d->work.givers;
  const long touching = chunk_forces(d, chunk, all);
  if (!integrator)
    return touching;
  for (int k = givers->first[chunk]; k < givers->first[chunk + 1]; k++)
    if (dem_gave(d, givers->to[k]))
      end_chunk(d, givers->to[k], integrator, all->dt);
  return touching;
}

/* The next chunk of a section, -1: none is left. */
static int take(dem_section *from) {
  int c;
#pragma omp atomic capture
  c = from->next++;
  return c < from->end ? c : -1;
}

/* Of all chunks, on several threads. Each begins with the chunks that it moves, too, which are in its core's cache; who
 * has done these helps the others. */
static long forces_shared(dem_data *d, const dem_loop_task *all, const dem_integrator *integrator) {
  const int n = d->work.nthread;
  dem_section *section = d->work.section;
  long touching = 0;
  for (int t = 0; t < n; t++)
    section[t] =
        (dem_section){.next = (int)((long)d->lists.nchunk * t / n), .end = (int)((long)d->lists.nchunk * (t + 1) / n)};
#pragma omp parallel for schedule(static, 1) num_threads(n) reduction(+ : touching)
  for (int t = 0; t < n; t++)
    for (int k = 0; k < n; k++)
      for (int c; (c = take(&section[(t + k) % n])) >= 0;)
        touching += chunk_forces(d, c, all);
  if (integrator)
    end_chunks(d, integrator, all->dt);
  return touching;
}

/* Of the chunks homes.chunk[first ... end - 1] of this rank. */
static long some_forces(dem_data *d, int first, int end, const dem_loop_task *all, const dem_integrator *integrator) {
  long touching = 0;
#pragma omp parallel for schedule(static) num_threads(d->work.nthread) if (d->work.nthread > 1) reduction(+ : touching)
  for (int k = first; k < end; k++)
    touching += chunk_step(d, d->work.homes.chunk[k], all, integrator);
  return touching;
}

/* The end of the step of the chunks that waited for reactions of other ranks. */
static void end_last(dem_data *d, const dem_integrator *integrator, double dt) {
  for (int c = dem_home_first(d); c < dem_home_end(d); c++)
    if (d->work.givers.left[c] > 0 && dem_gave(d, c))
      end_chunk(d, c, integrator, dt);
}

/* Of the chunks of this rank: visitors come meanwhile, and reactions go. Several threads end all chunks afterwards: the
 * step of those that another thread's chunks add to would end late, out of the cache, which took longer in all. */
static long home_forces(dem_data *d, const dem_loop_task *all, const dem_integrator *integrator) {
  const dem_homes *s = &d->work.homes;
  const dem_integrator *now = d->work.nthread == 1 ? integrator : NULL;
  if (now)
    dem_givers_begin(d);
  long touching = some_forces(d, 0, s->first_outer, all, now);
  dem_visitors_end(d);
  touching += some_forces(d, s->first_outer, s->end_outer, all, now);
  dem_reactions_begin(d);
  touching += some_forces(d, s->end_outer, dem_home_end(d) - dem_home_first(d), all, now);
  dem_parted(d, DEM_MOTION | DEM_FORCES | DEM_CONTACTS);
  dem_reactions_end(d);
  if (now)
    end_last(d, now, all->dt);
  else if (integrator)
    end_chunks(d, integrator, all->dt);
  if (all->entry_force)
    dem_unite_entries(d, all->entry_force, sizeof *all->entry_force, d->lists.walls.chunk);
  return dem_sums_of_step(d, touching);
}

/* Forces of all chunks, and the end of their step. */
static long all_forces(dem_data *d, const dem_loop_task *all, const dem_integrator *integrator) {
  if (!dem_alone(d))
    return home_forces(d, all, integrator);
  return d->work.nthread == 1 ? forces_alone(d, all, integrator) : forces_shared(d, all, integrator);
}

void dem_forces_add(dem_data *d, dem_share share, bool settling, double dt, const dem_integrator *integrator) {
  const dem_model *m = d->model;
  if (m->sum_loops)
    sum_contacts(d, settling);
  if (m->noting)
    take_notes(d, settling);
  d->work.among = true;
  const dem_loop_task all = {
      .model = m, .data = d, .settling = settling, .dt = dt, .share = share, .entry_force = dem_traction_entries(d)};
  d->state.ncontact = all_forces(d, &all, integrator);
  if (m->energy)
    add_energy(d, share, dt);
  for (int b = 0; b < m->nload; b++) {
    tdm_wrench sum = {0};
    for (int c = 0; c < d->lists.nchunk; c++) {
      sum.force = tdm_add(sum.force, d->work.chunk_load[c * m->nload + b].force);
      sum.moment = tdm_add(sum.moment, d->work.chunk_load[c * m->nload + b].moment);
    }
    d->state.body_load[b] = sum;
  }
}

/* ---- two sets of forces ---- */

void dem_forces_clear(const dem_data *d, dem_push *push) {
  const int first = dem_home_first_particle(d);
  memset(push + first, 0, (size_t)(dem_home_end_particle(d) - first) * sizeof *push);
}

void dem_forces_swap(dem_data *d) {
  dem_push *push = d->state.push;
  d->state.push = d->state.spare_push;
  d->state.spare_push = push;
}

void dem_loads_add(const dem_data *d, double share, const tdm_wrench *from, tdm_wrench *to) {
  for (int b = 0; b < d->model->nload; b++) {
    to[b].force = tdm_axpy(share, from[b].force, to[b].force);
    to[b].moment = tdm_axpy(share, from[b].moment, to[b].moment);
  }
}

void dem_forces_add_slow(dem_data *d, bool settling, double dt) {
  long fast = d->state.ncontact;
  dem_forces_add(d, DEM_SLOW, settling, dt, NULL);
  dem_traction_add(d, 1);
  d->state.ncontact += fast;
  dem_loads_add(d, 1, d->work.fast_load, d->state.body_load);
}

/* the forces of both kinds at the present state, each in its place; needs them zeroed */
static void add_both(dem_data *d, bool settling, double dt) {
  dem_forces_clear(d, d->state.spare_push);
  dem_forces_swap(d);
  dem_forces_add(d, DEM_FAST, settling, dt, NULL);
  dem_traction_add(d, 1);
  end_chunks(d, d->model->integrator, 0);
  dem_forces_swap(d);
  memcpy(d->work.fast_load, d->state.body_load, (size_t)d->model->nload * sizeof *d->state.body_load);
  dem_forces_add_slow(d, settling, dt);
}

/* ---- without a step ---- */

void dem_forces_frozen(dem_data *d, double dt) {
  memset(d->state.push, 0, dem_push_count(d) * sizeof *d->state.push);
  dem_forces_add(d, DEM_ALL, false, dt, NULL);
}

void dem_forces_again(dem_data *d, bool settling, double dt) {
  dem_crossings_empty(d, d->state.push);
  for (int i = dem_home_first_particle(d), last = dem_home_end_particle(d); i < last; i++) {
    d->state.sphere[i].velocity = d->state.pace[i].velocity;
    d->state.rotor[i].surface = tdm_scale(d->state.sphere[i].radius, d->state.pace[i].spin);
    d->state.push[i] = (dem_push){0};
  }
  dem_parted(d, DEM_STATE);
  dem_visitors_begin(d);
  dem_traction_clear(d);
  if (d->model->integrator->kick && !settling) {
    add_both(d, settling, dt);
  } else {
    dem_forces_add(d, DEM_ALL, settling, dt, NULL);
    dem_traction_add(d, 1);
  }
  end_chunks(d, d->model->settler, 0);
  d->state.restart = true;
}

tdm_status dem_forces_now(dem_data *d, bool settling, tdm_error *err) {
  dem_walls_put(d);
  if (dem_lists_build(d) || dem_homes_plan(d) || dem_traction_reserve(d) || dem_notes_reserve(d))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the neighbour lists");
  dem_forces_again(d, settling, 0);
  return TDM_OK;
}

tdm_status dem_forces_begin(dem_data *d, tdm_error *err) {
  dem_bodies_drive(d, d->model->time_start);
  dem_lids_away(d);
  if (dem_forces_now(d, false, err))
    return err->status;
  dem_mark_front(d, dem_home_first_particle(d), dem_home_end_particle(d));
  return TDM_OK;
}
