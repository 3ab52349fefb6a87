/* Sources and sinks: see flow.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/flow/flow.h"

#include "dem/bodies/walls.h"
#include "dem/bodies/zone.h"
#include "dem/flow/blocking.h"
#include "dem/flow/free_space.h"
#include "dem/flow/screening.h"
#include "dem/flow/traces.h"
#include "dem/particles/container.h"
#include "dem/particles/particles.h"
#include "dem/seam/homes.h"
#include "dem/state/wall_gap.h"
#include "protocol/base/log.h"
#include "protocol/math/random.h"
#include "protocol/scene/remark.h"

#include <stdio.h>

enum {
  TRIES = 20,       /* places tried in a region in one step */
  LOGGED_WAITS = 10 /* of a source; the channel tells the rest */
};

static const double ROUND_OFF = 1e-6; /* of a step: times on the grid of steps are on it */

/* ---- drawing ---- */

static double mass_of(const dem_model *m, const dem_source *s, uint64_t particle) {
  double r = dem_sizes_draw(&s->sizes, s->seed, particle);
  return s->mass > 0 ? s->mass : dem_sphere_mass(m->material[s->material].density, r);
}

static tdm_vec3 place_of(const dem_source *s, uint64_t particle, uint64_t attempt) {
  tdm_vec3 size = tdm_sub(s->high, s->low);
  const double u[3] = {tdm_random(s->seed, particle, 3 * attempt + 1), tdm_random(s->seed, particle, 3 * attempt + 2),
                       tdm_random(s->seed, particle, 3 * attempt + 3)};
  return tdm_add(s->low, tdm_v3(size.x * u[0], size.y * u[1], size.z * u[2]));
}

/* ---- sources ---- */

/* when the particle with `number` and `mass` before it is due */
static double due_time(const dem_source *s, uint64_t number, double mass) {
  return s->start + (s->mass_rate > 0 ? mass / s->mass_rate : (double)number / s->rate);
}

/* count the particles that should be there at time t */
static void advance_due(const dem_model *m, const dem_source *s, dem_source_state *now, double t, double round_off) {
  while (now->due < s->count) {
    double due = due_time(s, now->due, now->due_mass);
    if (!(due <= t + round_off) || !(due < s->end - round_off))
      return;
    double mass = mass_of(m, s, now->due);
    if (now->due_mass + mass > s->total_mass * (1 + 1e-9)) /* sums are not exact */
      return;
    now->due_mass += mass;
    now->due++;
  }
}

static tdm_vec3 velocity_of(const dem_data *d, const dem_source *s) {
  return s->relative >= 0 ? tdm_axpy(s->factor, d->state.twist[s->relative].velocity, s->velocity) : s->velocity;
}

/* the places that the source's particles can take in this step, of length dt */
static tdm_status open_space(dem_free_space *space, const dem_data *d, const dem_source *s, double dt) {
  double flight = dt * (tdm_norm(velocity_of(d, s)) + 0.5 * dt * tdm_norm(d->model->gravity));
  tdm_vec3 margin = tdm_v3(flight, flight, flight);
  return dem_free_space_open(space, d, tdm_sub(s->low, margin), tdm_add(s->high, margin), s->sizes.max);
}

/* The source's next particle, which was due `late` [s] ago, if there is room for it. */
static bool find_place(const dem_data *d, dem_free_space *space, const dem_source *s, dem_source_state *now,
                       double late, dem_newcomer *out) {
  const dem_model *m = d->model;
  bool point = s->low.x == s->high.x && s->low.y == s->high.y && s->low.z == s->high.z;
  out->radius = dem_sizes_draw(&s->sizes, s->seed, now->made);
  out->mass = mass_of(m, s, now->made);
  out->material = s->material;
  tdm_vec3 v = velocity_of(d, s);
  out->velocity = tdm_axpy(late, m->gravity, v);
  for (int k = 0; k < (point ? 1 : TRIES); k++) {
    tdm_vec3 x = point ? s->low : place_of(s, now->made, now->tried);
    out->position = tdm_axpy(0.5 * late * late, m->gravity, tdm_axpy(late, v, x));
    out->position = dem_flatten(m, out->position, m->flat_at);
    now->tried++;
    if (dem_free_space_free(space, d, out->position, out->radius))
      return true;
  }
  return false;
}

static void note_wait(const dem_source *s, dem_source_state *now, double t) {
  char event[96];
  if (now->blocked)
    return;
  now->blocked = 1;
  now->waits++;
  snprintf(event, sizeof event, "source_waits.%s", s->name);
  tdm_remark(
      TDM_NOTICE, event, "dem.sources", t,
      "the source \"%s\" waits with particle %llu from t = %.9g s on: its place is taken by a particle or a wall",
      s->name, (unsigned long long)now->made, t);
}

void dem_flow_end(const dem_data *d, double t) {
  for (int s = 0; s < d->model->nsource; s++) {
    const dem_source *source = &d->model->source[s];
    const dem_source_state *now = &d->state.source[s];
    char event[96], path[TDM_PATH_MAX];
    if (now->made == now->due)
      continue;
    snprintf(event, sizeof event, "source_behind.%s", source->name);
    snprintf(path, sizeof path, "dem.sources[%d]", s);
    tdm_remark(TDM_WARNING, event, path, t,
               "%llu of the %llu particles that the source \"%s\" should have made still wait at the end, t = %.9g s: "
               "their place is taken; lower its rate, enlarge its region, or give the particles a velocity that makes "
               "room",
               (unsigned long long)(now->due - now->made), (unsigned long long)now->due, source->name, t);
  }
}

static void note_room(const dem_source *s, dem_source_state *now, double t) {
  if (now->blocked && now->waits <= LOGGED_WAITS)
    tdm_log(TDM_LOG_INFO, "source_resumes", "t=%.9g source=%s particle=%llu", t, s->name,
            (unsigned long long)now->made);
  now->blocked = 0;
}

/* make what is due, as far as there is room */
static tdm_status make_due(dem_data *d, dem_free_space *space, const dem_source *s, dem_source_state *now, double t,
                           double dt) {
  const double round_off = ROUND_OFF * dt;
  while (now->made < now->due) {
    /* one that waited, or queued behind one, starts where the source is */
    double late = t - due_time(s, now->made, now->made_mass);
    if (now->blocked || late < round_off || late > dt - round_off)
      late = 0;
    dem_newcomer newcomer;
    if (!find_place(d, space, s, now, late, &newcomer)) {
      note_wait(s, now, t);
      return TDM_OK;
    }
    note_room(s, now, t);
    if (dem_data_add(d, &newcomer) || dem_free_space_add(space, d, d->state.nparticle - 1))
      return TDM_ERR_MEMORY;
    dem_traces_made(d, (int)(s - d->model->source), now->made++);
    now->made_mass += newcomer.mass;
    now->tried = 0;
  }
  return TDM_OK;
}

static tdm_status run_source(dem_data *d, const dem_source *s, dem_source_state *now, double t, double dt) {
  advance_due(d->model, s, now, t, ROUND_OFF * dt);
  if (now->made == now->due)
    return TDM_OK;
  dem_unite(d, DEM_PLACES);
  dem_free_space space;
  if (open_space(&space, d, s, dt))
    return TDM_ERR_MEMORY;
  tdm_status status = make_due(d, &space, s, now, t, dt);
  dem_free_space_close(&space);
  return status;
}

/* ---- sinks ---- */

static bool touches(const dem_data *d, int i, int w) {
  return dem_touches_at(d, w, d->state.sphere[i].position, d->state.sphere[i].radius);
}

/* Has particle i rebounded from the body of sink s? One that went through a wall has not: it is lost. */
static bool rebounded(dem_data *d, int s, int i) {
  const dem_model *m = d->model;
  uint32_t bit = (uint32_t)1 << s;
  int body = m->sink[s].body;
  for (int w = 0; w < m->nwall; w++)
    if (m->wall[w].body == body && touches(d, i, w)) {
      d->state.touched[i] |= bit;
      return false;
    }
  if (!(d->state.touched[i] & bit))
    return false;
  for (int w = 0; w < m->nwall; w++)
    if (m->wall[w].body == body && dem_through(d, i, w))
      return false;
  return true;
}

/* the sink that takes particle i, -1: none */
static int taker(dem_data *d, const dem_zone *zone, int i) {
  const dem_model *m = d->model;
  const tdm_vec3 x = d->state.sphere[i].position;
  int first = -1;
  for (int s = 0; s < m->nsink; s++) { /* all of them, so that each notes its contacts */
    bool takes = m->sink[s].type == DEM_SINK_AFTER_CONTACT ? rebounded(d, s, i)
                                                           : dem_zone_near(&zone[s], x) && dem_zone_inside(&zone[s], x);
    if (takes && first < 0)
      first = s;
  }
  return first;
}

static void count_out(dem_data *d, int s, int i) {
  const dem_sink *sink = &d->model->sink[s];
  dem_sink_state *now = &d->state.sink[s];
  int k = 0;
  while (k < sink->nedge && d->state.sphere[i].radius >= sink->edge[k])
    k++;
  now->removed++;
  now->mass += d->state.mass[i];
  now->class_removed[k]++;
  now->class_mass[k] += d->state.mass[i];
  dem_screening_count(d, s, i);
}

/* Home particles are looked at; are there any to go on any rank? Then all of the state is known to all. */
static bool any_gone(dem_data *d, int *gone, bool here) {
  if (!dem_homes_any(d, here))
    return false;
  dem_unite(d, DEM_WHOLE);
  dem_unite_particles(d, gone, sizeof *gone);
  return true;
}

/* Which particles go? */
typedef struct {
  const dem_zone *zone; /* of each sink */
  int *gone;            /* (nparticle) where to, -1: it stays */
  bool any;             /* goes */
} leaving;

static void note_any(leaving *l, bool any) {
  if (any)
#pragma omp atomic write
    l->any = true;
}

static void sink_chunk(dem_data *d, int chunk, void *context) {
  leaving *l = context;
  bool any = false;
  for (int i = dem_chunk_start(d, chunk), end = dem_chunk_start(d, chunk + 1); i < end; i++) {
    l->gone[i] = taker(d, l->zone, i);
    any = any || l->gone[i] >= 0;
  }
  note_any(l, any);
}

static tdm_status run_sinks(dem_data *d) {
  dem_zone zone[DEM_SINKS_MAX];
  leaving l = {.zone = zone, .gone = d->work.number}; /* scratch */
  for (int s = 0; s < d->model->nsink; s++)
    zone[s] = dem_zone_now(d, s);
  dem_parted(d, DEM_MOTION); /* sinks note contacts of home particles */
  dem_each_chunk(d, sink_chunk, &l);
  if (!any_gone(d, l.gone, l.any))
    return TDM_OK;
  for (int i = 0; i < d->state.nparticle; i++)
    if (l.gone[i] >= 0)
      count_out(d, l.gone[i], i);
  return dem_data_remove(d, l.gone);
}

tdm_status dem_flow(dem_data *d, double t, double dt, tdm_error *err) {
  const dem_model *m = d->model;
  dem_screening_step(d, t);
  dem_blocking_look(d, t);
  if (m->nsink > 0 && run_sinks(d))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the contacts of the particles that stay");
  for (int s = 0; s < m->nsource; s++)
    if (run_source(d, &m->source[s], &d->state.source[s], t, dt))
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for particles of a source");
  if (m->ncontainer > 0)
    dem_containers_step(d, t);
  return TDM_OK;
}

/* ---- the open box ---- */

static void leave_chunk(dem_data *d, int chunk, void *context) {
  leaving *l = context;
  bool any = false;
  for (int i = dem_chunk_start(d, chunk), end = dem_chunk_start(d, chunk + 1); i < end; i++) {
    bool out = false;
    for (int a = 0; a < 3; a++) {
      double x = (&d->state.sphere[i].position.x)[a] - d->state.domain.low[a];
      out = out || (!d->state.domain.periodic[a] && (x < 0 || x > d->state.domain.length[a]));
    }
    l->gone[i] = out ? 0 : -1;
    any = any || out;
  }
  note_any(l, any);
}

tdm_status dem_flow_leave(dem_data *d) {
  leaving l = {.gone = d->work.number}; /* scratch */
  dem_each_chunk(d, leave_chunk, &l);
  if (!any_gone(d, l.gone, l.any))
    return TDM_OK;
  for (int i = 0; i < d->state.nparticle; i++)
    d->state.ledger.left += l.gone[i] >= 0;
  return dem_data_remove(d, l.gone);
}

/* ---- balances ---- */

double dem_balance_number(const dem_data *d) {
  return (double)d->state.ledger.created - (double)d->state.ledger.removed - (double)d->state.nparticle;
}

double dem_balance_mass(const dem_data *d) {
  dem_exact_sum rest = d->state.ledger.mass, home = {0};
  for (int i = dem_home_first_particle(d); i < dem_home_end_particle(d); i++)
    dem_exact_sum_add(dem_alone(d) ? &rest : &home, -d->state.mass[i]);
  if (dem_alone(d))
    return dem_exact_sum_value(&rest);
  int n;
  dem_exact_sum *all = dem_homes_join(d, &home, 1, sizeof home, &n);
  for (int r = 0; r < n; r++)
    for (int k = 0; k < all[r].n; k++)
      dem_exact_sum_add(&rest, all[r].part[k]);
  free(all);
  return dem_exact_sum_value(&rest);
}
