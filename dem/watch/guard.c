/* The guard: see guard.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/watch/guard.h"

#include "dem/bodies/walls.h"
#include "dem/particles/domain.h"
#include "dem/seam/homes.h"
#include "dem/state/wall_gap.h"
#include "dem/watch/check.h"
#include "dem/watch/energy_balance.h"
#include "dem/watch/limits.h"
#include "dem/watch/rim.h"
#include "protocol/scene/remark.h"

#include <stdio.h>
#include <string.h>

enum { STEP_LOOKS = 10, PACE_STEPS = 10 };

static tdm_status tell(dem_data *d, dem_guard_kind kind, const char *path, const char *text, double t, tdm_error *err) {
  static const char *const events[DEM_GUARD_KINDS] = {[DEM_GUARD_LEAP] = "guard.leap",
                                                      [DEM_GUARD_OVERLAP] = "guard.overlap",
                                                      [DEM_GUARD_LOST] = "guard.lost",
                                                      [DEM_GUARD_STEP] = "guard.step",
                                                      [DEM_GUARD_ENERGY] = "guard.energy"};
  if (d->model->guard.action == DEM_GUARD_STOP)
    return tdm_fail(err, TDM_ERR_NUMERIC, path, "%s", text);
  d->state.guard.told[kind]++;
  tdm_remark(TDM_WARNING, events[kind], path, t, "%s", text);
  return TDM_OK;
}

/* ---- leaps ---- */

/* Does particle i leap farther than any since they were told? How far. */
static bool leaps(const dem_data *d, int i, double dt, double *way) {
  *way = dt * tdm_norm(d->state.pace[i].velocity);
  return *way > d->state.sphere[i].radius && *way > d->state.guard.leap;
}

void dem_guard_note_leap(dem_data *d, double dt) {
  const int first = dem_home_first_particle(d), end = dem_home_end_particle(d);
  double way;
  bool any = false;
#pragma omp parallel for schedule(static) num_threads(d->work.nthread) if (d->work.nthread > 1) reduction(|| : any)
  for (int i = first; i < end; i++) {
    double by;
    any = any || leaps(d, i, dt, &by);
  }
  if (!dem_homes_any(d, any))
    return;
  dem_unite(d, DEM_PLACES | DEM_MOTION);
  for (int i = 0; i < d->state.nparticle; i++)
    if (leaps(d, i, dt, &way)) {
      d->state.guard.leaper = d->state.id[i] + 1;
      d->state.guard.leap = way;
    }
}

static tdm_status look_at_leap(dem_data *d, double t, tdm_error *err) {
  char path[TDM_PATH_MAX] = "dem", text[TDM_MESSAGE_MAX];
  int n = 0, i = 0;
  dem_unite(d, DEM_PLACES | DEM_MOTION);
  while (i < d->state.nparticle && d->state.id[i] + 1 != d->state.guard.leaper)
    i++;
  tdm_vec3 x = {NAN, NAN, NAN};
  double radius = NAN;
  if (i < d->state.nparticle) {
    dem_where(d, i, path, &n);
    x = d->state.sphere[i].position;
    radius = d->state.sphere[i].radius;
  }
  snprintf(text, sizeof text,
           "particle %d (id %llu) moved %.3g m in a step, more than its radius %.3g m, to [%.6g, %.6g, %.6g] m at "
           "t = %.9g s, step %llu: it may pass through walls and particles; reduce time.dt or its speed",
           n, (unsigned long long)(d->state.guard.leaper - 1), d->state.guard.leap, radius, x.x, x.y, x.z, t,
           (unsigned long long)d->state.nstep);
  d->state.guard.leaper = 0;
  d->state.guard.leap = 0;
  return tell(d, DEM_GUARD_LEAP, path, text, t, err);
}

/* ---- overlaps ---- */

typedef struct {
  double share; /* of the smaller radius */
  int particle, other, wall;
} deepest;

static const deepest none = {.particle = -1, .other = -1, .wall = -1};

/* the deeper of two; of equals the one of the earlier particle, whoever found it */
static deepest deeper(deepest a, deepest b) {
  return b.share > a.share || (b.share == a.share && b.particle < a.particle) ? b : a;
}

/* among the contacts that are listed in a chunk */
static deepest deepest_of(const dem_data *d, int chunk) {
  const dem_model *m = d->model;
  deepest worst = none;
  for (int i = dem_chunk_start(d, chunk); i < dem_chunk_start(d, chunk + 1); i++)
    for (int k = d->lists.pairs.first[i]; k < d->lists.pairs.first[i + 1]; k++) {
      int j = d->lists.pairs.other[k];
      if (j >= d->state.nparticle)
        break;
      const dem_sphere *a = &d->state.sphere[i], *b = &d->state.sphere[j];
      tdm_vec3 c = dem_between(d, a->position, b->position);
      double sum = a->radius + b->radius, r2 = tdm_dot(c, c), smaller = fmin(a->radius, b->radius);
      double near = sum - worst.share * smaller;
      if (near > 0 && r2 < near * near)
        worst = (deepest){(sum - sqrt(r2)) / smaller, i, j, -1};
    }
  for (size_t k = d->lists.walls.chunk[chunk]; k < d->lists.walls.chunk[chunk + 1]; k++) {
    const dem_wall_entry *e = &d->lists.walls.entry[k];
    const dem_sphere *s = &d->state.sphere[e->particle];
    double share = 1 - dem_gap(d, e->particle, e->wall, NULL) / s->radius;
    if (share > worst.share && !(m->wall[e->wall].shape->half_space && share >= 2))
      worst = (deepest){share, e->particle, -1, e->wall};
  }
  return worst;
}

/* in chunks first ... end - 1 */
static deepest find_deepest(const dem_data *d, int first, int end) {
  deepest worst = none;
#pragma omp declare reduction(deeper:deepest : omp_out = deeper(omp_out, omp_in)) initializer(omp_priv = omp_orig)
#pragma omp parallel for schedule(static) num_threads(d->work.nthread) if (d->work.nthread > 1) reduction(deeper \
                                                                                                          : worst)
  for (int c = first; c < end; c++)
    worst = deeper(worst, deepest_of(d, c));
  return worst;
}

static tdm_status look_at_overlaps(dem_data *d, double t, tdm_error *err) {
  deepest worst = find_deepest(d, dem_home_first(d), dem_home_end(d));
  if (!dem_homes_any(d, worst.share > d->model->guard.overlap))
    return TDM_OK;
  if (!dem_alone(d)) {
    dem_unite(d, DEM_PLACES | DEM_MOTION | DEM_LISTS);
    worst = find_deepest(d, 0, d->lists.nchunk);
  }
  char path[TDM_PATH_MAX], text[TDM_MESSAGE_MAX], partner[256];
  int n;
  dem_where(d, worst.particle, path, &n);
  if (worst.wall >= 0)
    snprintf(partner, sizeof partner, "a wall of \"%s\"", d->model->body[d->model->wall[worst.wall].body].name);
  else
    snprintf(partner, sizeof partner, "particle id %llu", (unsigned long long)d->state.id[worst.other]);
  tdm_vec3 x = d->state.sphere[worst.particle].position;
  snprintf(text, sizeof text,
           "particle %d (id %llu) at [%.6g, %.6g, %.6g] m overlaps %s by %.3g of the smaller radius, more than "
           "dem.guard.overlap = %g, at t = %.9g s, step %llu; use a stiffer material or a smaller time.dt",
           n, (unsigned long long)d->state.id[worst.particle], x.x, x.y, x.z, partner, worst.share,
           d->model->guard.overlap, t, (unsigned long long)d->state.nstep);
  return tell(d, DEM_GUARD_OVERLAP, path, text, t, err);
}

/* ---- particles behind planes ---- */

void dem_guard_begin(dem_data *d) {
  d->state.guard = (dem_guard_state){.leaper = d->state.guard.leaper,
                                     .leap = d->state.guard.leap,
                                     .lost = (uint64_t)dem_count_lost(d)}; /* leaps: of settling */
}

static tdm_status look_at_lost(dem_data *d, double t, tdm_error *err) {
  const dem_model *m = d->model;
  uint64_t lost = (uint64_t)dem_count_lost(d), known = d->state.guard.lost;
  d->state.guard.lost = lost;
  if (lost <= known)
    return TDM_OK;
  dem_unite(d, DEM_PLACES | DEM_MOTION);
  char path[TDM_PATH_MAX] = "dem", text[TDM_MESSAGE_MAX];
  int n = 0, i = 0, w = m->nwall;
  for (; i < d->state.nparticle; i++) {
    for (w = 0; w < m->nwall && !dem_through(d, i, w);)
      w++;
    if (w < m->nwall)
      break;
  }
  dem_where(d, i, path, &n);
  tdm_vec3 x = d->state.sphere[i].position;
  snprintf(text, sizeof text,
           "particle %d (id %llu) went through a plane of \"%s\" to [%.6g, %.6g, %.6g] m, and %llu in all did, at "
           "t = %.9g s, step %llu; use a stiffer material, a smaller time.dt or lower speeds",
           n, (unsigned long long)d->state.id[i], m->body[m->wall[w].body].name, x.x, x.y, x.z,
           (unsigned long long)lost, t, (unsigned long long)d->state.nstep);
  return tell(d, DEM_GUARD_LOST, path, text, t, err);
}

/* ---- how often ---- */

/* the fastest a body moves where particles are near its walls [m/s]: of a driven one what its motion gets to, which
 * an oscillation need not show at the ends of steps */
static double speed_of_bodies(const dem_data *d, double t, int *which) {
  const dem_model *m = d->model;
  const dem_wall_contacts *list = &d->lists.walls;
  double fastest = 0;
  for (int b = 0; b < m->nbody; b++) {
    const dem_drive *drive = &m->body[b].drive;
    bool moves = drive->given && t > drive->start && t <= drive->end;
    double speed = moves ? dem_drive_speed(drive, 0) : tdm_norm(d->state.twist[b].velocity);
    double spin = tdm_norm(moves ? drive->angular : d->state.twist[b].angular), reach = 0;
    for (size_t k = list->chunk[dem_home_first(d)]; spin > 0 && k < list->chunk[dem_home_end(d)]; k++)
      if (m->wall[d->lists.walls.entry[k].wall].body == b)
        reach = fmax(reach, tdm_norm(tdm_sub(d->state.sphere[d->lists.walls.entry[k].particle].position,
                                             d->state.pose[b].position)));
    if (spin > 0)
      reach = dem_homes_largest(d, reach);
    if (speed + spin * reach > fastest) {
      fastest = speed + spin * reach;
      *which = b;
    }
  }
  return fastest;
}

static tdm_status tell_body(dem_data *d, int body, double way, double radius, double t, tdm_error *err) {
  char text[TDM_MESSAGE_MAX];
  snprintf(
      text, sizeof text,
      "\"%s\" moves up to %.3g m in a step, more than the smallest radius %.3g m, at t = %.9g s, step %llu: it may "
      "pass through particles; reduce time.dt or its speed",
      d->model->body[body].name, way, radius, t, (unsigned long long)d->state.nstep);
  return tell(d, DEM_GUARD_LEAP, "dem.bodies", text, t, err);
}

/* Add up how far a particle and its partner can have gone towards each other. *due: so far that one may have begun to
 * pass through the other since the last look at overlaps. */
static tdm_status look_at_pace(dem_data *d, double t, double dt, bool *due, tdm_error *err) {
  dem_guard_state *g = &d->state.guard;
  *due = false;
  if (d->state.nstep < g->pace_next)
    return TDM_OK;
  const int first = dem_home_first_particle(d), end = dem_home_end_particle(d);
  double fastest2 = 0, smallest = INFINITY;
#pragma omp parallel for schedule(static) num_threads(d->work.nthread) if (d->work.nthread > 1) reduction(max         \
                                                                                                          : fastest2) \
    reduction(min                                                                                                     \
              : smallest)
  for (int i = first; i < end; i++) {
    const double v2 = tdm_dot(d->state.sphere[i].velocity, d->state.sphere[i].velocity), r = d->state.sphere[i].radius;
    fastest2 = v2 > fastest2 ? v2 : fastest2;
    smallest = r < smallest ? r : smallest;
  }
  int body = 0;
  fastest2 = dem_homes_largest(d, fastest2);
  smallest = -dem_homes_largest(d, -smallest);
  double fastest = sqrt(fastest2), bodies = speed_of_bodies(d, t, &body);
  double speed = fastest + fmax(fastest, bodies), unseen = fmax(0.1, 1 - d->model->guard.overlap) * smallest;
  g->way += (double)(d->state.nstep - g->pace_step) * dt * speed;
  g->pace_step = d->state.nstep;
  g->pace_next = d->state.nstep + (uint64_t)fmax(1, fmin(PACE_STEPS, floor(unseen / 3 / (speed * dt))));
  *due = g->way > unseen;
  return bodies * dt > smallest ? tell_body(d, body, bodies * dt, smallest, t, err) : TDM_OK;
}

/* ---- the step ---- */

static tdm_status look_at_step(dem_data *d, double t, double dt, tdm_error *err) {
  dem_limits now;
  if (dem_limits_now(d, &now, err))
    return err->status;
  double eigen = DEM_EIGEN_SHARE * now.eigen, contact = DEM_CONTACT_SHARE_MOST * now.contact;
  if (!(dt > fmin(eigen, contact)))
    return TDM_OK;
  char text[TDM_MESSAGE_MAX];
  snprintf(text, sizeof text, "a step of %g s is above %s, %.3g s, at t = %.9g s, step %llu; reduce time.dt", dt,
           eigen < contact ? "0.8 of the stable step of the stiffest particle" : "a tenth of the shortest contact time",
           fmin(eigen, contact), t, (unsigned long long)d->state.nstep);
  return tell(d, DEM_GUARD_STEP, "time.dt", text, t, err);
}

/* ---- energy ---- */

/* t, dt: of the step that ended */
static bool can_judge(const dem_data *d, double t, double dt) {
  const dem_model *m = d->model;
  if (!dem_energy_balance_known(m))
    return false;
  double before = t - (double)m->guard.every * dt; /* the last look */
  for (int b = 0; b < m->nbody; b++)
    if (m->body[b].coupled >= 0 ||
        (m->body[b].drive.given && m->body[b].drive.start < t && m->body[b].drive.end > before) ||
        tdm_norm(d->state.twist[b].velocity) + tdm_norm(d->state.twist[b].angular) > 0)
      return false;
  return true;
}

static tdm_status look_at_energy(dem_data *d, double t, tdm_error *err) {
  dem_guard_state *g = &d->state.guard;
  uint64_t flow = d->state.ledger.created + d->state.ledger.removed;
  const dem_stored_energy e = dem_stored_energy_now(d);
  double all = e.kinetic + e.potential + e.elastic;
  if (!g->judging || g->flow != flow) {
    g->judging = 1;
    g->flow = flow;
    g->lowest = all;
    g->start = e.kinetic + e.elastic + e.potential;
    g->potential = e.potential;
    return TDM_OK;
  }
  g->lowest = fmin(g->lowest, all);
  g->potential = fmin(g->potential, e.potential);
  double there = fmax(g->start - g->potential, dem_rest_energy(d->model, e.mass)), rise = all - g->lowest;
  if (!(rise > d->model->guard.energy * there + 1e-9 * (e.magnitude + there)))
    return TDM_OK;
  char text[TDM_MESSAGE_MAX];
  snprintf(text, sizeof text,
           "the energy of the particles rose by %.3g J without a source, more than dem.guard.energy = %g of the %.3g J "
           "there were, at t = %.9g s, step %llu; reduce time.dt, or look for particles that are pressed together",
           rise, d->model->guard.energy, there, t, (unsigned long long)d->state.nstep);
  g->judging = 0; /* from here anew */
  return tell(d, DEM_GUARD_ENERGY, "dem", text, t, err);
}

tdm_status dem_guard_proxy(dem_data *d, const dem_proxy *proxy, double t, double dt, tdm_error *err) {
  uint64_t every = (uint64_t)d->model->guard.every;
  double rate2;
  if (every == 0 || d->state.nstep % every != 0)
    return TDM_OK;
  if (dem_proxy_rate2(proxy, d, &rate2, err))
    return err->status;
  double limit = DEM_EIGEN_SHARE * 2 / sqrt(rate2);
  if (!(dt > limit))
    return TDM_OK;
  char text[TDM_MESSAGE_MAX];
  snprintf(text, sizeof text,
           "a step of %g s is above 0.8 of the stable step of the coupled bodies on the springs of their contacts, "
           "%.3g s, at t = %.9g s, step %llu; reduce time.dt",
           dt, limit, t, (unsigned long long)d->state.nstep);
  return tell(d, DEM_GUARD_STEP, "time.dt", text, t, err);
}

tdm_status dem_guard(dem_data *d, double t, double dt, tdm_error *err) {
  uint64_t every = (uint64_t)d->model->guard.every;
  if (every == 0)
    return TDM_OK;
  if (d->state.guard.leaper && look_at_leap(d, t, err))
    return err->status;
  bool due, look = d->state.nstep % every == 0;
  if (look_at_pace(d, t, dt, &due, err))
    return err->status;
  if (look && dem_check_finite(d, t, err))
    return err->status;
  if (look || due) {
    d->state.guard.way = 0;
    dem_rim_look(d, t);
    if (look_at_overlaps(d, t, err) || look_at_lost(d, t, err))
      return err->status;
  }
  if (!look)
    return TDM_OK;
  if (d->state.nstep % (STEP_LOOKS * every) == 0 && look_at_step(d, t, dt, err))
    return err->status;
  if (can_judge(d, t, dt))
    return look_at_energy(d, t, err);
  d->state.guard.judging = 0;
  return TDM_OK;
}

void dem_guard_end(dem_data *d, double t) {
  long lost = dem_count_lost(d);
  if (lost > 0)
    tdm_remark(
        TDM_WARNING, "lost", "dem", t,
        "%ld particles are behind a plane at the end (particles.lost); reduce time.dt or their speed if they went "
        "through it",
        lost);
  int i = 0;
  long fallen = dem_count_fallen(d, &i);
  if (fallen > 0) {
    tdm_vec3 x = d->state.sphere[i].position;
    tdm_remark(TDM_WARNING, "fallen", "dem", t,
               "%ld particles fall below every wall at the end, one of them (id %llu) at [%g, %g, %g] m: they went "
               "through a hole or over an edge; close it, or give what is meant to fall a sink (dem.sinks)",
               fallen, (unsigned long long)d->state.id[i], x.x, x.y, x.z);
  }
}
