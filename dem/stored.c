/* Stored energy: see stored.h. */
#include "dem/stored.h"

#include "dem/contact/theory.h"
#include "dem/domain.h"
#include "dem/extras.h"
#include "dem/geometry/walls.h"

static double elastic_of(const dem_data *d, int kind, int partner, dem_impact at, double overlap) {
  const dem_model *m = d->model;
  return overlap > 0 ? dem_normal_elastic(m, &m->pair[kind * m->nmaterial + partner], at, overlap) : 0;
}

/* listed pair k; nothing holds two particles that are fixed together */
static double elastic_of_pair(const dem_data *d, int i, int k) {
  const dem_model *m = d->model;
  int j = d->pairs.other[k];
  const dem_sphere *a = &d->sphere[i], *b = &d->sphere[j];
  double sum = a->radius + b->radius, per_mass = a->inverse_mass + b->inverse_mass;
  dem_impact at = {.mass = 1 / per_mass, .radius = a->radius * b->radius / sum};
  if (m->law->normal == DEM_NORMAL_hysteretic)
    at.deepest = d->pairs.history[(size_t)m->columns.normal * d->pairs.capacity + (size_t)k];
  double overlap = sum - tdm_norm(dem_between(d, a->position, b->position));
  return per_mass > 0 ? elastic_of(d, d->kind[i], d->kind[j], at, overlap) : 0;
}

static bool same_contact(const dem_data *d, size_t k, size_t other) {
  const dem_wall_entry *a = &d->walls.entry[k], *b = &d->walls.entry[other];
  return a->wall == b->wall && a->particle == b->particle;
}

/* listed wall k; of the triangles of a mesh the first that is listed stands for all */
static double elastic_of_wall(const dem_data *d, size_t k) {
  const dem_model *m = d->model;
  const dem_wall_entry *e = &d->walls.entry[k];
  if (k > 0 && same_contact(d, k - 1, k))
    return 0;
  const dem_sphere *s = &d->sphere[e->particle];
  tdm_vec3 n;
  double overlap = s->radius - dem_wall_gap(&m->wall[e->wall], &d->wall[e->wall], s->position, &n);
  dem_impact at = {.mass = 1 / s->inverse_mass, .radius = s->radius};
  for (size_t part = k; part < d->walls.count && same_contact(d, k, part); part++)
    at.deepest = fmax(at.deepest, dem_wall_deepest_so_far(d, part));
  bool held = s->inverse_mass == 0 || overlap >= 2 * s->radius;
  return held ? 0 : elastic_of(d, d->kind[e->particle], m->body[m->wall[e->wall].body].material, at, overlap);
}

double dem_particle_energy(const dem_data *d, int i, double *potential) {
  const dem_sphere *s = &d->sphere[i];
  const dem_pace *p = &d->pace[i];
  double inertia = 0.4 * d->mass[i] * s->radius * s->radius,
         kinetic = 0.5 * d->mass[i] * tdm_dot(p->velocity, p->velocity);
  *potential = -d->mass[i] * tdm_dot(dem_field(d, i), s->position);
  return kinetic + 0.5 * inertia * tdm_dot(p->spin, p->spin);
}

dem_stored dem_stored_now(const dem_data *d) {
  dem_stored e = {0};
  for (int i = 0; i < d->nparticle; i++) {
    double potential;
    e.kinetic += dem_particle_energy(d, i, &potential);
    e.potential += potential;
    e.magnitude += fabs(potential);
    for (int k = d->pairs.first[i]; k < d->pairs.first[i + 1] && d->pairs.other[k] < d->nparticle; k++)
      e.elastic += elastic_of_pair(d, i, k);
  }
  for (size_t k = 0; k < d->walls.count; k++)
    e.elastic += elastic_of_wall(d, k);
  return e;
}
