/* Limits of the DEM step: see limits.h. */
#include "dem/limits.h"

#include <stdlib.h>

double dem_rayleigh(double radius, double density, double shear, double poisson) {
  return M_PI * radius * sqrt(density / shear) / (0.1631 * poisson + 0.8766);
}

double dem_contact_time(double mass, double radius, double young, double speed) {
  /* 4 sqrt(pi) Gamma(2/5) / (5 Gamma(9/10)) (15/16)^(2/5) */
  return 2.8682656992 * pow(mass * mass / (radius * young * young * speed), 0.2);
}

/* the speed at which the contact time is taken */
static double impact_speed(const dem_data *d) {
  const dem_model *m = d->model;
  double fastest = 0, largest = 0, body_speed = 0;
  for (int b = 0; b < m->nbody; b++)
    body_speed = fmax(body_speed, tdm_norm(d->twist[b].velocity));
  for (int i = 0; i < m->nparticle; i++) {
    fastest = fmax(fastest, tdm_norm(d->velocity[i]));
    largest = fmax(largest, m->radius[i]);
  }
  return fmax(fastest + body_speed, sqrt(2 * tdm_norm(m->gravity) * 2 * largest));
}

/* shortest contact of particle i, with its like or with a wall */
static double shortest_contact(const dem_model *m, int i, double speed) {
  double shortest = INFINITY;
  const dem_pair *row = &m->pair[m->kind[i] * m->nmaterial];
  for (int k = 0; k < m->nmaterial; k++)
    if (row[k].given)
      shortest = fmin(shortest, dem_contact_time(m->mass[i] / 2, m->radius[i] / 2, row[k].young, speed));
  return shortest;
}

/* stiffness that a contact of this overlap adds at a particle [N/m] */
static double stiffness(const dem_model *m, const dem_pair *pair, double radius, double overlap) {
  double circle = sqrt(radius * overlap), normal = 2 * pair->young * circle;
  return m->law->history ? fmax(normal, 3.5 * 8 * pair->shear * circle) : normal;
}

/* sum of the stiffnesses at particle i over its listed pairs (added to both) and walls; `sum` (nparticle) */
static void add_stiffness(const dem_data *d, int i, double *sum) {
  const dem_model *m = d->model;
  for (int k = d->pairs.first[i]; k < d->pairs.first[i + 1]; k++) {
    int j = d->pairs.other[k];
    double both = m->radius[i] + m->radius[j];
    double overlap = both - tdm_norm(tdm_sub(d->position[i], d->position[j]));
    if (overlap <= 0)
      continue;
    const dem_pair *pair = &m->pair[m->kind[i] * m->nmaterial + m->kind[j]];
    double s = stiffness(m, pair, m->radius[i] * m->radius[j] / both, overlap);
    sum[i] += s;
    sum[j] += s;
  }
  for (int k = d->walls.first[i]; k < d->walls.first[i + 1]; k++) {
    int w = d->walls.other[k];
    tdm_vec3 n;
    double gap = dem_wall_gap(&m->wall[w], &d->wall[w], d->position[i], &n);
    if (gap >= m->radius[i] || gap <= -m->radius[i])
      continue;
    const dem_pair *pair = &m->pair[m->kind[i] * m->nmaterial + m->body[m->wall[w].body].material];
    sum[i] += stiffness(m, pair, m->radius[i], m->radius[i] - gap);
  }
}

static double smallest_eigen(const dem_data *d) {
  const dem_model *m = d->model;
  double *sum = calloc((size_t)m->nparticle + 1, sizeof *sum), smallest = INFINITY;
  if (!sum)
    return smallest;
  for (int i = 0; i < m->nparticle; i++)
    add_stiffness(d, i, sum);
  for (int i = 0; i < m->nparticle; i++)
    if (sum[i] > 0)
      smallest = fmin(smallest, 2 / sqrt(2 * sum[i] / m->mass[i]));
  free(sum);
  return smallest;
}

dem_limits dem_limits_now(const dem_data *d) {
  const dem_model *m = d->model;
  dem_limits l = {.rayleigh = INFINITY, .contact = INFINITY};
  l.speed = impact_speed(d);
  for (int i = 0; i < m->nparticle; i++) {
    double r = m->radius[i], density = m->mass[i] / (4.0 / 3 * M_PI * r * r * r);
    const dem_material *material = &m->material[m->kind[i]];
    l.rayleigh = fmin(l.rayleigh, dem_rayleigh(r, density, material->shear, material->poisson));
    l.contact = fmin(l.contact, shortest_contact(m, i, l.speed));
  }
  l.eigen = smallest_eigen(d);
  l.step = 0.4 * l.rayleigh;
  l.by = "0.4 of the Rayleigh step";
  if (l.contact / 10 < l.step) {
    l.step = l.contact / 10;
    l.by = "a tenth of the shortest contact time";
  }
  if (0.8 * l.eigen < l.step) {
    l.step = 0.8 * l.eigen;
    l.by = "0.8 of the stable step of the stiffest particle";
  }
  return l;
}
