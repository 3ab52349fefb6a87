/* Limits of the DEM step: see limits.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/watch/limits.h"

#include "dem/particles/domain.h"
#include "dem/seam/notes.h"
#include "dem/seam/visits.h"
#include "dem/state/wall_gap.h"

#include <stdlib.h>

double dem_rayleigh(double radius, double density, double shear, double poisson) {
  return M_PI * radius * sqrt(density / shear) / (0.1631 * poisson + 0.8766);
}

/* how far x can fall until it meets a plane [m] */
static double fall_of(const dem_data *d, tdm_vec3 up, tdm_vec3 x) {
  double deepest = 0;
  for (int w = 0; w < d->model->nwall; w++) {
    if (!d->model->wall[w].shape->half_space)
      continue;
    tdm_vec3 n;
    double gap = dem_gap_at(d, w, x, &n), slope = tdm_dot(n, up);
    if (slope > 0.1 && gap > 0)
      deepest = fmax(deepest, gap / slope);
  }
  return deepest;
}

/* at which the particles of a pouring arrive at a plane, or at the lowest point of another wall */
static double poured_speed(const dem_data *d, const dem_pouring *p) {
  const dem_model *m = d->model;
  double g = tdm_norm(m->gravity), v = p->count > 0 ? tdm_norm(m->velocity[p->first]) : 0;
  if (p->count == 0 || g == 0)
    return v;
  tdm_vec3 up = tdm_scale(-1 / g, m->gravity), x = m->position[p->first];
  double fall = fall_of(d, up, x), low, high;
  for (int w = 0; w < m->nwall; w++)
    if (!m->wall[w].solid && dem_wall_extent(&m->wall[w], &d->state.wall[w], up, &low, &high))
      fall = fmax(fall, tdm_dot(x, up) - low);
  return sqrt(v * v + 2 * g * fall);
}

double dem_impact_speed(const dem_data *d) {
  const dem_model *m = d->model;
  double fastest = 0, largest = 0, body_speed = 0;
  for (int b = 0; b < m->nbody; b++)
    body_speed = fmax(body_speed, tdm_norm(d->state.twist[b].velocity));
  const int first = dem_home_first_particle(d), end = dem_home_end_particle(d);
#pragma omp parallel for schedule(static) num_threads(d->work.nthread) if (d->work.nthread > 1) \
    reduction(max                                                                               \
              : fastest, largest)
  for (int i = first; i < end; i++) {
    fastest = fmax(fastest, tdm_norm(d->state.pace[i].velocity));
    largest = fmax(largest, d->state.sphere[i].radius);
  }
  fastest = dem_homes_largest(d, fastest);
  largest = dem_homes_largest(d, largest);
  for (uint64_t i = d->state.ledger.created; i < (uint64_t)m->nparticle; i++) /* still to be poured */
    largest = fmax(largest, m->radius[i]);
  for (int k = 0; k < m->npouring && d->state.ledger.created < (uint64_t)m->nparticle; k++)
    fastest = fmax(fastest, poured_speed(d, &m->pouring[k]));
  return fmax(fastest + body_speed, sqrt(2 * tdm_norm(m->gravity) * 2 * largest));
}

/* ---- the speed to be expected ---- */

/* the lowest and highest of what is there, along `up` */
typedef struct {
  tdm_vec3 up;
  double low, high;
} extent;

static void include(extent *e, tdm_vec3 x) {
  double at = tdm_dot(x, e->up);
  e->low = fmin(e->low, at);
  e->high = fmax(e->high, at);
}

static void include_box(extent *e, const dem_box *box, tdm_pose pose) {
  for (int corner = 0; corner < 8; corner++) {
    tdm_vec3 to = tdm_v3(corner & 1 ? box->half.x : -box->half.x, corner & 2 ? box->half.y : -box->half.y,
                         corner & 4 ? box->half.z : -box->half.z);
    include(e, tdm_pose_point(pose, tdm_add(box->center, tdm_quat_rotate(box->turn, to))));
  }
}

static double fall_height(const dem_data *d) {
  const dem_model *m = d->model;
  if (tdm_norm(m->gravity) == 0)
    return 0;
  extent e = {tdm_scale(-1, tdm_unit(m->gravity)), INFINITY, -INFINITY};
  double deepest = 0;
  for (int i = dem_home_first_particle(d); i < dem_home_end_particle(d); i++) {
    include(&e, d->state.sphere[i].position);
    deepest = fmax(deepest, fall_of(d, e.up, d->state.sphere[i].position));
  }
  e.low = dem_homes_smallest(d, e.low);
  e.high = dem_homes_largest(d, e.high);
  deepest = dem_homes_largest(d, deepest);
  for (int s = 0; s < m->nsource; s++) {
    include(&e, m->source[s].low);
    include(&e, m->source[s].high);
    deepest = fmax(deepest, fall_of(d, e.up, m->source[s].low));
    deepest = fmax(deepest, fall_of(d, e.up, m->source[s].high));
  }
  for (int k = 0; k < m->nbox; k++)
    include_box(&e, &m->box[k], d->state.pose[m->box[k].body]);
  for (int w = 0; w < m->nwall; w++) {
    double low, high;
    if (!m->wall[w].solid && dem_wall_extent(&m->wall[w], &d->state.wall[w], e.up, &low, &high)) {
      e.low = fmin(e.low, low);
      e.high = fmax(e.high, high);
    }
  }
  return fmax(deepest, e.high > e.low ? e.high - e.low : 0);
}

/* the fastest that a driven body or a moving surface gets at a particle [m/s] */
static double driven_speed(const dem_data *d) {
  const dem_model *m = d->model;
  double fastest = 0;
  for (int b = 0; b < m->nbody; b++) {
    double reach = 0;
    if (!m->body[b].drive.given)
      continue;
    for (int i = dem_home_first_particle(d); i < dem_home_end_particle(d); i++)
      reach = fmax(reach, tdm_norm(tdm_sub(d->state.sphere[i].position, m->body[b].drive.center)));
    fastest = fmax(fastest, dem_drive_speed(&m->body[b].drive, dem_homes_largest(d, reach)));
  }
  for (int w = 0; w < m->nwall; w++) {
    const dem_wall *wall = &m->wall[w];
    if (!wall->moves)
      continue;
    bool ends = dem_wall_ends(wall);
    fastest = fmax(fastest, ends ? dem_wall_belt_speed(wall) : tdm_norm(wall->surface.velocity));
    for (int i = dem_home_first_particle(d); i < dem_home_end_particle(d) && !ends; i++) {
      tdm_vec3 n;
      double gap = dem_gap(d, i, w, &n);
      tdm_vec3 below = tdm_axpy(-gap, n, d->state.sphere[i].position); /* on the surface */
      fastest = fmax(fastest, tdm_norm(dem_wall_belt(wall, dem_wall_own(&d->state.wall[w], below))));
    }
  }
  return dem_homes_largest(d, fastest);
}

double dem_expected_speed(const dem_data *d) {
  const dem_model *m = d->model;
  if (m->expected_speed > 0)
    return m->expected_speed;
  double speed = fmax(dem_impact_speed(d), driven_speed(d));
  for (int s = 0; s < m->nsource; s++) {
    const dem_source *source = &m->source[s];
    tdm_vec3 v = source->velocity;
    if (source->relative >= 0)
      v = tdm_axpy(source->factor, d->state.twist[source->relative].velocity, v);
    for (int b = 0; b < m->nbody; b++)
      speed = fmax(speed, tdm_norm(tdm_sub(v, d->state.twist[b].velocity)));
    speed = fmax(speed, tdm_norm(v));
  }
  return sqrt(speed * speed + 2 * tdm_norm(m->gravity) * fall_height(d));
}

/* ---- the three limits ---- */

/* How often contacts of this effective mass are taken in a step: a limit of theirs allows a step so many times as long.
 */
static double takes(const dem_model *m, double mass) {
  return m->multi_step.substeps > 0 && mass < m->multi_step.mass ? (double)m->multi_step.substeps : 1;
}

/* Rayleigh step and shortest contact (with its like or with a wall) of a particle */
static void add_particle(dem_limits *l, const dem_model *m, int material, double radius, double mass) {
  double density = mass / dem_sphere_mass(1, radius);
  const dem_material *elastic = &m->material[material];
  double often = takes(m, mass);
  l->rayleigh = fmin(l->rayleigh, often * dem_rayleigh(radius, density, elastic->shear, elastic->poisson));
  const dem_pair *row = &m->pair[material * m->nmaterial];
  for (int k = 0; k < m->nmaterial; k++)
    if (row[k].given)
      l->contact = fmin(
          l->contact, often * dem_normal_step_time(
                                  m, &row[k], (dem_impact){.mass = mass / 2, .radius = radius / 2, .speed = l->speed}));
}

/* stiffness that a contact adds at a particle [N/m] */
static double stiffness(const dem_data *d, const dem_among *c) {
  const dem_model *m = d->model;
  return fmax(dem_stiffness_among(d, m, c),
              3.5 * dem_tangential_stiffness(m, c->pair, c->at, dem_overlap_among(d, m, c)));
}

/* Stiffness of the listed pair k of particle i, 0: it does not touch, or neither can move. */
static double pair_stiffness(const dem_data *d, int i, int k) {
  const dem_model *m = d->model;
  const int j = d->lists.pairs.other[k];
  const dem_sphere *a = &d->state.sphere[i], *b = &d->state.sphere[j];
  const double both = a->radius + b->radius, per_mass = a->inverse_mass + b->inverse_mass;
  const double overlap = both - tdm_norm(dem_between(d, a->position, b->position));
  if (!(overlap > 0) || !(per_mass > 0))
    return 0;
  return stiffness(d, &(dem_among){.pair = &m->pair[d->state.material[i] * m->nmaterial + d->state.material[j]],
                                   .at = {.mass = 1 / per_mass, .radius = a->radius * b->radius / both},
                                   .overlap = overlap,
                                   .particle = i,
                                   .other = j,
                                   .place = (size_t)k});
}

/* What other ranks' contacts add to the sums of home particles, in the order of one process: before their own. It goes
 * as reactions do. */
static void add_from_others(dem_data *d, double *sum) {
  const dem_pairs *list = &d->lists.pairs;
  const dem_parcels *returned = &d->work.homes.returned;
  const int end = dem_home_end_particle(d);
  if (dem_alone(d))
    return;
  for (int i = dem_home_first_particle(d); i < end; i++)
    for (int k = list->first[i]; k < list->first[i + 1]; k++)
      if (list->other[k] >= end && list->other[k] < d->state.nparticle)
        d->state.push[list->reaction_slot[k]].force.x = pair_stiffness(d, i, k);
  dem_reactions_begin(d);
  dem_reactions_end(d);
  for (int q = 0; q < returned->first[d->work.homes.ranks->size]; q++) {
    dem_push *came = &d->state.push[dem_crossing_slot(d, returned->item[q])];
    sum[d->lists.crossings.particle[returned->item[q]]] += came->force.x;
    *came = (dem_push){0};
  }
}

/* Sum of the stiffnesses at home particle i over its listed pairs (added to both). Returns how many of them touch. */
static int add_stiffness(const dem_data *d, int i, double *sum) {
  const dem_pairs *list = &d->lists.pairs;
  int touching = 0;
  for (int k = list->first[i]; k < list->first[i + 1] && list->other[k] < d->state.nparticle; k++) {
    const double s = pair_stiffness(d, i, k);
    touching += s > 0;
    sum[i] += s;
    sum[list->other[k]] += s;
  }
  return touching;
}

/* The same of a wall; returns whether it touches. */
static bool add_wall_stiffness(const dem_data *d, size_t k, double *sum) {
  const dem_model *m = d->model;
  const dem_wall_entry *e = &d->lists.walls.entry[k];
  int i = e->particle;
  double radius = d->state.sphere[i].radius, gap = dem_gap(d, i, e->wall, NULL);
  const dem_pair *pair = &m->pair[d->state.material[i] * m->nmaterial + m->wall[e->wall].material];
  const bool touches = dem_surface_cuts(gap, radius);
  if (touches)
    sum[i] += stiffness(d, &(dem_among){.pair = pair,
                                        .at = {.mass = d->state.mass[i], .radius = radius},
                                        .overlap = radius - gap,
                                        .particle = i,
                                        .other = -1,
                                        .place = dem_note_of_contact(d, k)});
  return touches;
}

/* the smallest 2/omega [s], inf when nothing touches; and the coordination number */
static tdm_status look_at_contacts(dem_data *d, dem_limits *l, tdm_error *err) {
  const int first = dem_home_first_particle(d), end = dem_home_end_particle(d);
  double *sum = calloc((size_t)d->state.nparticle + 1, sizeof *sum); /* others' places take no memory */
  if (!sum || dem_homes_plan(d)) {
    free(sum);
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the limits of the step of %d particles",
                    d->state.nparticle);
  }
  long touching = 0;
  double eigen = INFINITY;
  add_from_others(d, sum);
  for (int i = first; i < end; i++)
    touching += 2 * add_stiffness(d, i, sum);
  for (size_t k = d->lists.walls.chunk[dem_home_first(d)]; k < d->lists.walls.chunk[dem_home_end(d)]; k++)
    touching += add_wall_stiffness(d, k, sum);
  for (int i = first; i < end; i++)
    if (sum[i] > 0)
      eigen = fmin(eigen, takes(d->model, d->state.mass[i]) * 2 / sqrt(2 * sum[i] * d->state.sphere[i].inverse_mass));
  l->eigen = dem_homes_smallest(d, eigen);
  touching = dem_homes_sum(d, touching);
  l->coordination = d->state.nparticle > 0 ? (double)touching / d->state.nparticle : 0;
  free(sum);
  return TDM_OK;
}

static tdm_status limits_at(dem_data *d, double speed, dem_limits *l, tdm_error *err) {
  const dem_model *m = d->model;
  *l = (dem_limits){.rayleigh = INFINITY, .contact = INFINITY, .speed = speed};
  for (int i = dem_home_first_particle(d); i < dem_home_end_particle(d); i++)
    add_particle(l, m, d->state.material[i], d->state.sphere[i].radius, d->state.mass[i]);
  l->rayleigh = dem_homes_smallest(d, l->rayleigh);
  l->contact = dem_homes_smallest(d, l->contact);
  for (uint64_t i = d->state.ledger.created; i < (uint64_t)m->nparticle; i++) /* still to be poured */
    add_particle(l, m, m->particle_material[i], m->radius[i], m->mass[i]);
  return look_at_contacts(d, l, err);
}

static void choose_step(dem_limits *l) {
  double least = fmin(DEM_RAYLEIGH_SHARE * l->rayleigh, DEM_EIGEN_SHARE * l->eigen);
  l->step = fmin(least, DEM_CONTACT_SHARE * l->contact);
  l->most = fmin(least, DEM_CONTACT_SHARE_MOST * l->contact);
  l->by = l->most < least                            ? "a tenth of the shortest contact time"
          : least < DEM_RAYLEIGH_SHARE * l->rayleigh ? "0.8 of the stable step of the stiffest particle"
                                                     : "0.4 of the Rayleigh step";
}

tdm_status dem_limits_now(dem_data *d, dem_limits *l, tdm_error *err) {
  if (limits_at(d, dem_impact_speed(d), l, err))
    return err->status;
  choose_step(l);
  return TDM_OK;
}

tdm_status dem_limits_expected(dem_data *d, dem_limits *l, tdm_error *err) {
  const dem_model *m = d->model;
  if (limits_at(d, dem_expected_speed(d), l, err))
    return err->status;
  for (int s = 0; s < m->nsource; s++) {
    const dem_source *source = &m->source[s];
    for (int k = 0; k < 2; k++) {
      double r = k ? source->sizes.max : source->sizes.min;
      double full = dem_sphere_mass(m->material[source->material].density, r);
      add_particle(l, m, source->material, r, source->mass > 0 ? source->mass : full);
    }
  }
  choose_step(l);
  return TDM_OK;
}
