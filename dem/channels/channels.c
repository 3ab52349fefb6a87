/* The output channels: see channels.h.
 *
 * To add a channel: a row, and its value, which all ranks ask for (dem/seam/homes.h). A * in the name stands for the
 * item's name (of a source, a sink or a body). Neighbouring rows with the same items make a block: all rows of the
 * first item, then those of the second.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/channels/channels.h"

#include "dem/base/energy.h"
#include "dem/bodies/walls.h"
#include "dem/channels/items.h"
#include "dem/flow/blocking.h"
#include "dem/flow/flow.h"
#include "dem/flow/screening.h"
#include "dem/flow/traces.h"
#include "dem/geometry/screen/screen.h"
#include "dem/particles/container.h"
#include "dem/particles/field.h"
#include "dem/seam/homes.h"
#include "dem/seam/sums.h"
#include "dem/watch/limits.h"
#include "protocol/math/hermite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What happens to a channel inside a step. */
typedef enum {
  HELD,   /* a number that changes at the ends of steps: counts, and sums over what came and went */
  LINEAR, /* a quantity of first order: velocities, energies */
  CUBIC,  /* a place; its velocity is the third channel from it */
  MEAN    /* of the output interval already */
} course;

/* A state, and sums over its particles. */
typedef struct {
  const dem_data *data;
  double mass, kinetic, potential; /* [kg], [J] */
  tdm_vec3 com, velocity;          /* [m], [m/s] */
  dem_screening_balance screening; /* only where the scene has one */
  dem_relative trace[DEM_TRACES_MAX];
} observation;

typedef struct dem_channel_row {
  const char *name, *unit;
  const dem_items *items; /* that have the channel */
  double (*value)(const observation *o, int item, int part);
  int part; /* of a vector, a load or a list */
  course course;
  bool gaps; /* NaN where it is not defined */
} row;

/* ---- values ---- */

#define VALUE(what) static double what(const observation *o, int item, int part)
#define UNUSED (void)item, (void)part

VALUE(particle_count) {
  UNUSED;
  return o->data->state.nparticle;
}

VALUE(com) {
  (void)item;
  return (&o->com.x)[part];
}

VALUE(velocity) {
  (void)item;
  return (&o->velocity.x)[part];
}

VALUE(kinetic_energy) {
  UNUSED;
  return o->kinetic;
}

VALUE(contacts) {
  UNUSED;
  return (double)o->data->state.ncontact;
}

VALUE(impact_speed) {
  UNUSED;
  return dem_impact_speed(o->data);
}

VALUE(lost) {
  UNUSED;
  return (double)dem_count_lost(o->data);
}

VALUE(mass) {
  UNUSED;
  return o->mass;
}

VALUE(potential_energy) {
  UNUSED;
  return o->potential;
}

VALUE(elastic_energy) {
  UNUSED;
  return dem_energy_elastic(&o->data->state.energy);
}

VALUE(wall_work) {
  UNUSED;
  return o->data->state.energy.wall_work;
}

VALUE(supplied_energy) {
  UNUSED;
  return o->data->state.energy.supplied;
}

VALUE(dissipated_energy) {
  (void)item;
  return o->data->state.energy.dissipated[part];
}

VALUE(created) {
  (void)part;
  return (double)o->data->state.source[item].made;
}

VALUE(waiting) {
  (void)part;
  return (double)(o->data->state.source[item].due - o->data->state.source[item].made);
}

VALUE(removed) {
  (void)part;
  const dem_sink_state *s = &o->data->state.sink[dem_sink_of(item)];
  const int class = dem_sink_class_of(item);
  return (double)(class < 0 ? s->removed : s->class_removed[class]);
}

VALUE(removed_mass) {
  (void)part;
  const dem_sink_state *s = &o->data->state.sink[dem_sink_of(item)];
  const int class = dem_sink_class_of(item);
  return class < 0 ? s->mass : s->class_mass[class];
}

/* what a deck has given: by number 0, by mass 1 */
VALUE(sorted) {
  const dem_deck_state *k = &o->data->state.deck[item];
  return part ? k->sorted_mass : (double)k->sorted;
}

VALUE(undersized) {
  const dem_deck_state *k = &o->data->state.deck[item];
  return part ? k->undersized_mass : (double)k->undersized;
}

VALUE(deck_efficiency) {
  return dem_deck_efficiency(&o->data->state.deck[item], part);
}

VALUE(deck_rate) {
  (void)part;
  return dem_deck_rate(o->data, item);
}

VALUE(deck_rate_now) {
  (void)part;
  return dem_deck_rate_now(o->data, item);
}

VALUE(deck_share) {
  (void)part;
  return dem_deck_share(&o->data->state.deck[item]);
}

VALUE(blocked) {
  (void)part;
  return (double)o->data->state.deck[item].blocked;
}

VALUE(blocked_most) {
  (void)part;
  return (double)o->data->state.deck[item].blocked_most;
}

VALUE(held) {
  (void)part;
  return (double)o->data->state.deck[item].held;
}

VALUE(blocked_share) {
  (void)part;
  return 100 * (double)o->data->state.deck[item].blocked / (double)o->data->model->screening.deck[item].holes;
}

VALUE(trace) {
  const dem_relative *now = &o->trace[item];
  return part < 3 ? (&now->position.x)[part] : (&now->velocity.x)[part - 3];
}

VALUE(screening_efficiency) {
  (void)item;
  return dem_screening_efficiency(o->data, part);
}

VALUE(fed) {
  UNUSED;
  return (double)o->screening.fed;
}

VALUE(inside) {
  UNUSED;
  return (double)o->screening.inside;
}

VALUE(out) {
  UNUSED;
  return (double)o->screening.out;
}

VALUE(screening_lost) {
  UNUSED;
  return (double)o->screening.lost;
}

VALUE(content) {
  (void)part;
  return (double)o->data->state.container[item].number;
}

VALUE(content_mass) {
  (void)part;
  return o->data->state.container[item].mass;
}

VALUE(left_container) {
  (void)part;
  return (double)o->data->state.container[item].left;
}

VALUE(outflow) {
  (void)part;
  return o->data->state.container[item].rate;
}

VALUE(mean_outflow) {
  (void)part;
  return dem_container_mean_rate(&o->data->state.container[item]);
}

VALUE(jams) {
  (void)part;
  return (double)o->data->state.container[item].jams;
}

VALUE(left) {
  UNUSED;
  return (double)o->data->state.ledger.left;
}

VALUE(balance_number) {
  UNUSED;
  return dem_balance_number(o->data);
}

VALUE(balance_mass) {
  UNUSED;
  return dem_balance_mass(o->data);
}

/* from where the body was at the start, then its velocity */
VALUE(way) {
  const tdm_vec3 u = tdm_sub(o->data->state.pose[item].position, o->data->model->body[item].start.pose.position);
  return part < 3 ? (&u.x)[part] : (&o->data->state.twist[item].velocity.x)[part - 3];
}

static double component(const tdm_wrench *w, int part) {
  return part < 3 ? (&w->force.x)[part] : (&w->moment.x)[part - 3];
}

VALUE(load) {
  return component(&o->data->state.sample_mean[item], part);
}

VALUE(fixed_load) {
  (void)item;
  return component(&o->data->state.sample_mean[o->data->model->nload], part);
}

/* ---- the table ---- */

static const row rows[] = {
    {.name = "particles.count", .unit = "1", .items = &dem_items_all, .value = particle_count, .course = HELD},
    {.name = "particles.com.x", .unit = "m", .items = &dem_items_all, .value = com, .course = CUBIC},
    {.name = "particles.com.y", .unit = "m", .items = &dem_items_all, .value = com, .part = 1, .course = CUBIC},
    {.name = "particles.com.z", .unit = "m", .items = &dem_items_all, .value = com, .part = 2, .course = CUBIC},
    {.name = "particles.velocity.x", .unit = "m/s", .items = &dem_items_all, .value = velocity, .course = LINEAR},
    {.name = "particles.velocity.y",
     .unit = "m/s",
     .items = &dem_items_all,
     .value = velocity,
     .part = 1,
     .course = LINEAR},
    {.name = "particles.velocity.z",
     .unit = "m/s",
     .items = &dem_items_all,
     .value = velocity,
     .part = 2,
     .course = LINEAR},
    {.name = "particles.kinetic_energy",
     .unit = "J",
     .items = &dem_items_all,
     .value = kinetic_energy,
     .course = LINEAR},
    {.name = "particles.contacts", .unit = "1", .items = &dem_items_all, .value = contacts, .course = HELD},
    {.name = "particles.lost", .unit = "1", .items = &dem_items_all, .value = lost, .course = HELD},
    {.name = "particles.mass", .unit = "kg", .items = &dem_items_all, .value = mass, .course = HELD},
    {.name = "particles.impact_speed", .unit = "m/s", .items = &dem_items_all, .value = impact_speed, .course = LINEAR},

    {.name = "energy.potential", .unit = "J", .items = &dem_items_energy, .value = potential_energy, .course = LINEAR},
    {.name = "energy.elastic", .unit = "J", .items = &dem_items_energy, .value = elastic_energy, .course = LINEAR},
    {.name = "energy.wall_work", .unit = "J", .items = &dem_items_energy, .value = wall_work, .course = LINEAR},
    {.name = "energy.supplied", .unit = "J", .items = &dem_items_energy, .value = supplied_energy, .course = LINEAR},
#define X(mechanism, of)            \
  {.name = "energy.dissipated." of, \
   .unit = "J",                     \
   .items = &dem_items_energy,      \
   .value = dissipated_energy,      \
   .part = DEM_ENERGY_##mechanism,  \
   .course = LINEAR},
    DEM_ENERGY_LIST(X)
#undef X

        {.name = "source.*.created", .unit = "1", .items = &dem_items_sources, .value = created},
    {.name = "source.*.waiting", .unit = "1", .items = &dem_items_sources, .value = waiting},

    {.name = "sink.*.removed", .unit = "1", .items = &dem_items_sinks, .value = removed},
    {.name = "sink.*.mass", .unit = "kg", .items = &dem_items_sinks, .value = removed_mass},

#define DECK(of, in, what, ...) \
  { .name = "screening.*." of, .unit = in, .items = &dem_items_decks, .value = what, __VA_ARGS__ }
    DECK("sorted", "1", sorted, .part = 0),
    DECK("undersized", "1", undersized, .part = 0),
    DECK("sorted_mass", "kg", sorted, .part = 1),
    DECK("undersized_mass", "kg", undersized, .part = 1),
    DECK("efficiency", "%", deck_efficiency, .part = 0, .gaps = true),
    DECK("efficiency_mass", "%", deck_efficiency, .part = 1, .gaps = true),
    DECK("rate", "kg/s", deck_rate, .gaps = true),
    DECK("rate_now", "kg/s", deck_rate_now, .gaps = false),
    DECK("share", "%", deck_share, .gaps = true),
#undef DECK
#define SCREEN(of, in, what) \
  { .name = "screening.*." of, .unit = in, .items = &dem_items_screens, .value = what }
    SCREEN("blocked", "1", blocked),
    SCREEN("blocked_most", "1", blocked_most),
    SCREEN("blocked_share", "%", blocked_share),
    SCREEN("held", "1", held),
#undef SCREEN
#define SCREENING(of, in, what, ...) \
  { .name = "screening." of, .unit = in, .items = &dem_items_screening, .value = what, __VA_ARGS__ }
    SCREENING("efficiency", "%", screening_efficiency, .part = 0, .gaps = true),
    SCREENING("efficiency_mass", "%", screening_efficiency, .part = 1, .gaps = true),
    SCREENING("fed", "1", fed, .part = 0),
    SCREENING("inside", "1", inside, .part = 0),
    SCREENING("out", "1", out, .part = 0),
    SCREENING("lost", "1", screening_lost, .part = 0),
#undef SCREENING

#define PATH(of, in, k, goes)                                                                                \
  {                                                                                                          \
    .name = "path.*." of, .unit = in, .items = &dem_items_traces, .value = trace, .part = k, .course = goes, \
    .gaps = true                                                                                             \
  }
    PATH("x", "m", 0, CUBIC),
    PATH("y", "m", 1, CUBIC),
    PATH("z", "m", 2, CUBIC),
    PATH("vx", "m/s", 3, LINEAR),
    PATH("vy", "m/s", 4, LINEAR),
    PATH("vz", "m/s", 5, LINEAR),
#undef PATH

#define CONTAINER(of, in, what, ...) \
  { .name = "container.*." of, .unit = in, .items = &dem_items_containers, .value = what, __VA_ARGS__ }
    CONTAINER("number", "1", content, .course = HELD),
    CONTAINER("mass", "kg", content_mass, .course = HELD),
    CONTAINER("left", "1", left_container, .course = HELD),
    CONTAINER("rate", "1/s", outflow, .course = MEAN),
    CONTAINER("mean_rate", "1/s", mean_outflow, .course = HELD, .gaps = true),
    CONTAINER("jams", "1", jams, .course = HELD),
#undef CONTAINER

    {.name = "particles.left", .unit = "1", .items = &dem_items_domain, .value = left, .course = HELD},
    {.name = "balance.number", .unit = "1", .items = &dem_items_balance, .value = balance_number, .course = HELD},
    {.name = "balance.mass", .unit = "kg", .items = &dem_items_balance, .value = balance_mass, .course = HELD},

#define LOAD(component, of, k) \
  { .name = "body.*." component, .unit = of, .items = &dem_items_loads, .value = load, .part = k, .course = MEAN }
    LOAD("fx", "N", 0),
    LOAD("fy", "N", 1),
    LOAD("fz", "N", 2),
    LOAD("mx", "N m", 3),
    LOAD("my", "N m", 4),
    LOAD("mz", "N m", 5),
#undef LOAD

#define WAY(component, of, k, goes) \
  { .name = "body.*." component, .unit = of, .items = &dem_items_movers, .value = way, .part = k, .course = goes }
    WAY("ux", "m", 0, CUBIC),
    WAY("uy", "m", 1, CUBIC),
    WAY("uz", "m", 2, CUBIC),
    WAY("vx", "m/s", 3, LINEAR),
    WAY("vy", "m/s", 4, LINEAR),
    WAY("vz", "m/s", 5, LINEAR),
#undef WAY

    {.name = "fixed.fx", .unit = "N", .items = &dem_items_fixed, .value = fixed_load, .course = MEAN},
    {.name = "fixed.fy", .unit = "N", .items = &dem_items_fixed, .value = fixed_load, .part = 1, .course = MEAN},
    {.name = "fixed.fz", .unit = "N", .items = &dem_items_fixed, .value = fixed_load, .part = 2, .course = MEAN},
};
enum { NROW = sizeof rows / sizeof rows[0] };

/* ---- the channels of a scene ---- */

static void name_channel(tdm_channel *channel, const row *r, const dem_model *m, int item) {
  char of[64] = "";
  if (r->items->name)
    r->items->name(m, item, of);
  size_t before = strcspn(r->name, "*");
  snprintf(channel->name, sizeof channel->name, "%.*s%s%s", (int)before, r->name, of,
           r->name[before] ? r->name + before + 1 : "");
  snprintf(channel->unit, sizeof channel->unit, "%s", r->unit);
  channel->gaps = r->gaps;
}

/* Put the channels of this scene in their places (NULL: only count them); returns how many there are. */
static int lay_out(const dem_channels *to, const dem_model *m) {
  int n = 0;
  for (int first = 0, end; first < NROW; first = end) {
    for (end = first + 1; end < NROW && rows[end].items == rows[first].items;)
      end++;
    for (int item = rows[first].items->next(m, -1); item >= 0; item = rows[first].items->next(m, item))
      for (int r = first; r < end; r++, n++)
        if (to) {
          to->place[n] = (struct dem_channel_place){&rows[r], item};
          name_channel(&to->channel[n], &rows[r], m, item);
        }
  }
  return n;
}

tdm_status dem_channels_make(dem_channels *c, const dem_model *m, tdm_error *err) {
  *c = (dem_channels){.count = lay_out(NULL, m)};
  c->channel = calloc((size_t)c->count, sizeof *c->channel);
  c->place = calloc((size_t)c->count, sizeof *c->place);
  if (!c->channel || !c->place)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %d output channels", c->count);
  lay_out(c, m);
  return TDM_OK;
}

void dem_channels_free(dem_channels *c) {
  free(c->channel);
  free(c->place);
  *c = (dem_channels){0};
}

/* ---- values of a state ---- */

/* what a chunk adds to the sums over the particles: mass; times position, velocity; kinetic and potential energy */
static void add_particles(const dem_data *d, int chunk, const void *of, double *sums) {
  tdm_vec3 com = {0, 0, 0}, velocity = {0, 0, 0};
  double mass = 0, kinetic = 0, potential = 0;
  (void)of;
  for (int i = dem_chunk_start(d, chunk); i < dem_chunk_start(d, chunk + 1); i++) {
    double of_place;
    mass += d->state.mass[i];
    com = tdm_axpy(d->state.mass[i], d->state.sphere[i].position, com);
    velocity = tdm_axpy(d->state.mass[i], d->state.pace[i].velocity, velocity);
    kinetic += dem_particle_energy(d, i, &of_place);
    potential += of_place;
  }
  memcpy(sums, (double[]){mass, com.x, com.y, com.z, velocity.x, velocity.y, velocity.z, kinetic, potential},
         9 * sizeof *sums);
}

static observation observe(dem_data *d) {
  double sum[9];
  dem_sum_chunks(d, 9, add_particles, NULL, sum);
  observation o = {.data = d, .mass = sum[0], .kinetic = sum[7], .potential = sum[8]};
  for (int k = 0; k < d->model->ntrace; k++)
    o.trace[k] = dem_trace_now(d, k);
  if (d->model->screening.ndeck > 0)
    o.screening = dem_screening_balance_of(d);
  const double per_mass = o.mass > 0 ? 1 / o.mass : 0;
  o.com = tdm_scale(per_mass, tdm_v3(sum[1], sum[2], sum[3]));
  o.velocity = tdm_scale(per_mass, tdm_v3(sum[4], sum[5], sum[6]));
  return o;
}

void dem_channels_sample(const dem_channels *c, dem_data *d, double *out) {
  const observation o = observe(d);
  for (int k = 0; k < c->count; k++)
    out[k] = c->place[k].row->value(&o, c->place[k].item, c->place[k].row->part);
}

/* ---- inside a step ---- */

void dem_channels_within(const dem_channels *channels, double share, double dt, const double *before, double *now) {
  const bool same = now[0] == before[0]; /* number of particles */
  for (int c = 0; c < channels->count; c++)
    switch (channels->place[c].row->course) {
    case CUBIC: /* exact under constant forces */
      now[c] = same ? tdm_hermite(share, dt, before[c], before[c + 3], now[c], now[c + 3])
                    : before[c] + share * dt * before[c + 3];
      break;
    case LINEAR:
      now[c] = same ? before[c] + share * (now[c] - before[c]) : before[c];
      break;
    case HELD:
      now[c] = before[c];
      break;
    case MEAN:
      break;
    }
}

double dem_share_of_step(double time, double t, double dt) {
  double share = 1 - (t - time) / dt;
  return share > 1 - 1e-6 ? 1 : fmax(share, 0);
}
