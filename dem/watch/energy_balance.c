/* Stored and supplied energy of the particles: see energy_balance.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/watch/energy_balance.h"

#include "dem/bodies/walls.h"
#include "dem/contact/law/theory.h"
#include "dem/particles/domain.h"
#include "dem/particles/field.h"
#include "dem/seam/homes.h"
#include "dem/seam/notes.h"
#include "dem/seam/sums.h"
#include "dem/state/wall_gap.h"

#include <string.h>

/* ---- stored ---- */

/* A contact as its springs see it. */
typedef struct {
  const dem_pair *pair;
  dem_impact at;
  double overlap;
  const double *history; /* its first column */
  size_t stride;         /* from column to column */
  tdm_vec3 slip, roll;   /* tangent parts of the relative velocity at the contact and of the relative spin */
  double twist;          /* part of the relative spin along the normal */
  double dt;             /* by which half the springs of the history are ahead [s] */
} contact;

/* 0.5 f^2/k of a spring whose history (three columns from `first` on) is half a step ahead */
static double spring(const contact *c, int first, double k, tdm_vec3 rate) {
  const double *h = c->history + (size_t)first * c->stride;
  tdm_vec3 f = tdm_axpy(0.5 * c->dt * k, rate, tdm_v3(h[0], h[c->stride], h[2 * c->stride]));
  return k > 0 ? 0.5 * tdm_dot(f, f) / k : 0;
}

/* likewise of a couple about the normal, in one column */
static double twisted(const contact *c, int first, double k) {
  double couple = c->history[(size_t)first * c->stride] + 0.5 * c->dt * k * c->twist;
  return k > 0 ? 0.5 * couple * couple / k : 0;
}

/* of the tangential, rolling and twisting laws */
static double springs_of(const dem_model *m, const contact *c) {
  double e = 0;
  if (m->tangential->stiffness)
    e += spring(c, 0, dem_tangential_stiffness(m, c->pair, c->at, c->overlap), c->slip);
  if (m->rolling->stiffness)
    e += spring(c, m->columns.rolling, dem_rolling_stiffness(m, c->pair, c->at, c->overlap), c->roll);
  if (m->twisting->stiffness)
    e += twisted(c, m->columns.twisting, dem_twisting_stiffness(m, c->pair, c->at, c->overlap));
  return e;
}

static tdm_vec3 tangent(tdm_vec3 v, tdm_vec3 n) {
  return tdm_axpy(-tdm_dot(v, n), n, v);
}

/* the relative spin, apart */
static void set_spin(contact *c, tdm_vec3 spin, tdm_vec3 n) {
  c->roll = tangent(spin, n);
  c->twist = tdm_dot(spin, n);
}

static double step_ahead(const dem_data *d) {
  return d->state.nstep > 0 ? d->model->dt : 0; /* at the start forces were evaluated without a step */
}

static tdm_vec3 spin_of(const dem_rotor *r) {
  return tdm_scale(1 / r->radius, r->surface);
}

/* listed pair k; nothing holds two particles that are fixed together */
static double elastic_of_pair(const dem_data *d, int i, int k) {
  const dem_model *m = d->model;
  int j = d->lists.pairs.other[k];
  const dem_sphere *a = &d->state.sphere[i], *b = &d->state.sphere[j];
  tdm_vec3 x = dem_between(d, a->position, b->position);
  double sum = a->radius + b->radius, per_mass = a->inverse_mass + b->inverse_mass, r = tdm_norm(x);
  if (!(per_mass > 0) || !(r < sum))
    return 0;
  contact c = {.pair = &m->pair[d->state.material[i] * m->nmaterial + d->state.material[j]],
               .at = {.mass = 1 / per_mass, .radius = a->radius * b->radius / sum},
               .overlap = sum - r,
               .history = d->lists.pairs.history ? &d->lists.pairs.history[k] : NULL,
               .stride = d->lists.pairs.capacity,
               .dt = step_ahead(d)};
  if (m->normal->keeps_deepest)
    c.at.deepest = c.history[(size_t)m->columns.normal * c.stride];
  tdm_vec3 n = tdm_scale(1 / fmax(r, 1e-100), x),
           surface = tdm_add(d->state.rotor[i].surface, d->state.rotor[j].surface);
  tdm_vec3 v = tdm_axpy(-r / sum, tdm_cross(surface, n), tdm_sub(a->velocity, b->velocity));
  c.slip = tangent(v, n);
  set_spin(&c, tdm_sub(spin_of(&d->state.rotor[i]), spin_of(&d->state.rotor[j])), n);
  dem_among among = {c.pair, c.at, c.overlap, i, j, (size_t)k};
  c.overlap = dem_overlap_among(d, m, &among);
  return dem_elastic_among(d, m, &among) + springs_of(m, &c);
}

static bool same_contact(const dem_data *d, size_t k, size_t other) {
  const dem_wall_entry *a = &d->lists.walls.entry[k], *b = &d->lists.walls.entry[other];
  return a->wall == b->wall && a->particle == b->particle;
}

/* what the particle of entry k does at its wall, whose surface is at `gap` along n from its centre */
static void rates_at_wall(const dem_data *d, const dem_wall_entry *e, double gap, tdm_vec3 n, contact *c) {
  int body = d->model->wall[e->wall].body;
  const dem_sphere *s = &d->state.sphere[e->particle];
  const dem_rotor *rotor = &d->state.rotor[e->particle];
  tdm_vec3 lever = tdm_sub(tdm_axpy(-gap, n, s->position), d->state.pose[body].position);
  tdm_twist wall = d->state.twist[body];
  tdm_vec3 v = tdm_axpy(-gap / s->radius, tdm_cross(rotor->surface, n), s->velocity);
  c->slip = tangent(tdm_sub(v, tdm_add(wall.velocity, tdm_cross(wall.angular, lever))), n);
  set_spin(c, tdm_sub(spin_of(rotor), wall.angular), n);
  c->at.mass = 1 / dem_per_effective_mass(&d->state.mobility[body], s->inverse_mass, lever, n);
}

/* Listed wall k, of a chunk's entries begin ... end - 1; of the parts of a wall the first that is listed stands for the
 * normal law of all, and each has the springs of its own history. */
static double elastic_of_wall(const dem_data *d, size_t k, size_t begin, size_t end) {
  const dem_model *m = d->model;
  const dem_wall_entry *e = &d->lists.walls.entry[k];
  const dem_sphere *s = &d->state.sphere[e->particle];
  const bool first = k == begin || !same_contact(d, k - 1, k), alone = first && !m->wall[e->wall].shape->parts;
  tdm_vec3 n;
  double gap = dem_gap(d, e->particle, e->wall, &n), overlap = s->radius - gap;
  if (s->inverse_mass == 0 || !(overlap > 0) || overlap >= 2 * s->radius)
    return 0;
  contact c = {.pair = &m->pair[d->state.material[e->particle] * m->nmaterial + m->wall[e->wall].material],
               .at = {.mass = 1 / s->inverse_mass, .radius = s->radius},
               .overlap = overlap,
               .history = d->lists.walls.history ? &d->lists.walls.history[k] : NULL,
               .stride = d->lists.walls.capacity,
               .dt = alone ? step_ahead(d) : 0}; /* the normal at a part is not known here */
  rates_at_wall(d, e, gap, n, &c);
  for (size_t part = k; part < end && same_contact(d, k, part); part++)
    c.at.deepest = fmax(c.at.deepest, dem_wall_deepest_so_far(d, part));
  dem_among among = {c.pair, c.at, overlap, e->particle, -1, dem_note_of_contact(d, k)};
  c.overlap = dem_overlap_among(d, m, &among);
  return (first ? dem_elastic_among(d, m, &among) : 0) + springs_of(m, &c);
}

double dem_rest_energy(const dem_model *m, double mass) {
  return 0.5 * mass * m->settle.speed * m->settle.speed;
}

/* what a chunk adds to each member of dem_stored_energy */
static void add_stored(const dem_data *d, int chunk, const void *of, double *sums) {
  dem_stored_energy e = {0};
  (void)of;
  for (int i = dem_chunk_start(d, chunk); i < dem_chunk_start(d, chunk + 1); i++) {
    double potential;
    e.kinetic += dem_particle_energy(d, i, &potential);
    e.potential += potential;
    e.magnitude += fabs(potential);
    e.mass += d->state.mass[i];
    for (int k = d->lists.pairs.first[i];
         k < d->lists.pairs.first[i + 1] && d->lists.pairs.other[k] < d->state.nparticle; k++)
      e.elastic += elastic_of_pair(d, i, k);
  }
  for (size_t k = d->lists.walls.chunk[chunk]; k < d->lists.walls.chunk[chunk + 1]; k++)
    e.elastic += elastic_of_wall(d, k, d->lists.walls.chunk[chunk], d->lists.walls.chunk[chunk + 1]);
  memcpy(sums, &e, sizeof e);
}

dem_stored_energy dem_stored_energy_now(dem_data *d) {
  dem_stored_energy e;
  enum { N = sizeof e / sizeof(double) };
  double sums[N];
  dem_sum_chunks(d, N, add_stored, NULL, sums);
  memcpy(&e, sums, sizeof e);
  return e;
}

/* ---- supplied ---- */

bool dem_energy_balance_known(const dem_model *m) {
  if (!m->cohesion->head.none || m->domain.strained || (m->domain.repeats && m->driven))
    return false;
  for (int a = 0; a < 3; a++)
    if (m->domain.periodic[a] && (&m->gravity.x)[a] != 0)
      return false;
  for (int w = 0; w < m->nwall; w++) /* belts */
    if (m->wall[w].moves)
      return false;
  return true;
}

/* of the driven bodies on the particles [W] */
static double power_of_bodies(const dem_data *d) {
  double power = 0;
  for (int b = 0; b < d->model->nbody; b++) {
    const tdm_wrench *load = &d->state.body_load[b];
    const tdm_twist *twist = &d->state.twist[b];
    if (d->model->body[b].drive.given)
      power -= tdm_dot(load->force, twist->velocity) + tdm_dot(load->moment, twist->angular);
  }
  return power;
}

void dem_energy_balance_begin(dem_data *d) {
  d->state.energy_balance = (dem_energy_balance){.power = power_of_bodies(d), .next_look = d->state.nstep};
}

void dem_energy_balance_step(dem_data *d, double dt) {
  double power = power_of_bodies(d);
  d->state.energy_balance.driven += 0.5 * dt * (d->state.energy_balance.power + power);
  d->state.energy_balance.power = power;
}

tdm_energy dem_energy_balance_look(dem_data *d) {
  const dem_model *m = d->model;
  tdm_energy e = {
      .kinetic = NAN, .stored = NAN, .supplied = d->state.energy_balance.flow + d->state.energy_balance.driven};
  if (d->state.nstep < d->state.energy_balance.next_look || !dem_energy_balance_known(m))
    return e;
  const dem_stored_energy now = dem_stored_energy_now(d);
  d->state.energy_balance.next_look = d->state.nstep + (uint64_t)(m->guard.every > 0 ? m->guard.every : DEM_LOOK_STEPS);
  e.kinetic = now.kinetic;
  e.stored = now.kinetic + now.potential + now.elastic;
  return e;
}
