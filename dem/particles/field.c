/* Gravity, the forces of groups, fixed particles: see field.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/particles/field.h"

#include "dem/seam/homes.h"
#include "dem/seam/sums.h"

#include <string.h>

static void add_fixed_force(const dem_data *d, int chunk, const void *of, double *sum) {
  tdm_vec3 force = {0, 0, 0};
  (void)of;
  for (int i = dem_chunk_start(d, chunk); i < dem_chunk_start(d, chunk + 1); i++)
    if (d->state.sphere[i].inverse_mass == 0) {
      force = tdm_add(force, d->state.push[i].force);
      force = d->state.spare_push ? tdm_add(force, d->state.spare_push[i].force) : force;
    }
  memcpy(sum, &force, sizeof force);
}

tdm_vec3 dem_fixed_force(dem_data *d) {
  tdm_vec3 sum = {0, 0, 0};
  if (d->model->fixes)
    dem_sum_chunks(d, 3, add_fixed_force, NULL, &sum.x);
  return sum;
}

/* it never moves: nothing is left of gravity, exactly */
static void hold(dem_data *d, int i) {
  d->state.drive[i].velocity = tdm_scale(-1, d->model->gravity);
  d->state.sphere[i].inverse_mass = 0;
}

void dem_drive_particles(dem_data *d, int first, int end) {
  const dem_model *m = d->model;
  for (int i = first; m->driven && i < end; i++) {
    d->state.drive[i] = (dem_pace){0};
    d->state.sphere[i].inverse_mass = 1 / d->state.mass[i];
    for (int g = 0; g < m->ngroup; g++) {
      const dem_group *group = &m->group[g];
      if (d->state.id[i] < (uint64_t)group->first || d->state.id[i] >= (uint64_t)(group->first + group->count))
        continue;
      d->state.drive[i].velocity = tdm_axpy(1 / d->state.mass[i], group->force, group->acceleration);
      if (group->fixed)
        hold(d, i);
    }
    if (m->still && d->state.id[i] < (uint64_t)m->nparticle && m->still[d->state.id[i]])
      hold(d, i);
  }
}

double dem_particle_energy(const dem_data *d, int i, double *potential) {
  const dem_sphere *s = &d->state.sphere[i];
  const dem_pace *p = &d->state.pace[i];
  double inertia = 0.4 * d->state.mass[i] * s->radius * s->radius,
         kinetic = 0.5 * d->state.mass[i] * tdm_dot(p->velocity, p->velocity);
  *potential = -d->state.mass[i] * tdm_dot(dem_field(d, i), s->position);
  return kinetic + 0.5 * inertia * tdm_dot(p->spin, p->spin);
}

double dem_kinetic_energy(const dem_data *d) {
  double sum = 0, potential;
  for (int i = 0; i < d->state.nparticle; i++)
    sum += dem_particle_energy(d, i, &potential);
  return sum;
}

static void add_mass(const dem_data *d, int chunk, const void *of, double *sum) {
  (void)of;
  for (int i = dem_chunk_start(d, chunk); i < dem_chunk_start(d, chunk + 1); i++)
    *sum += d->state.mass[i];
}

double dem_total_mass(dem_data *d) {
  double mass;
  dem_sum_chunks(d, 1, add_mass, NULL, &mass);
  return mass;
}
