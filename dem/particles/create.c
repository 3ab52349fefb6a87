/* The state at the start of a scene: see create.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/particles/create.h"

#include "dem/particles/domain.h"
#include "dem/particles/field.h"
#include "dem/seam/homes.h"

#include <assert.h>

void dem_skin_begin(dem_data *d, double mean_radius) {
  d->lists.mean_radius = mean_radius;
  d->lists.skin = d->model->skin > 0 ? d->model->skin : 0.05 * mean_radius;
}

/* home particles, and bodies, as the model has them at the start */
static void begin(dem_data *d, const dem_ranks *ranks) {
  const dem_model *m = d->model;
  d->state.nparticle = m->nparticle - m->npoured;
  if (ranks)
    d->lists.nchunk = dem_chunks(d->state.nparticle);
  dem_homes_begin(d, ranks);
  dem_parted(d, DEM_WHOLE);
  const int first = dem_home_first_particle(d), end = dem_home_end_particle(d);
  assert(first >= m->first_here && end <= m->end_here);
  for (int i = first; i < end; i++) {
    d->state.id[i] = (uint64_t)i;
    d->state.mass[i] = m->mass[i];
    d->state.material[i] = m->particle_material[i];
    d->state.sphere[i] = (dem_sphere){m->position[i], m->radius[i], m->velocity[i], 1 / m->mass[i]};
    d->state.rotor[i] = (dem_rotor){tdm_scale(m->radius[i], m->spin[i]), m->radius[i]};
    d->state.pace[i] = (dem_pace){.velocity = m->velocity[i], .spin = m->spin[i]};
    if (m->oriented)
      d->state.orientation[i] = m->orientation[i];
  }
  for (int i = 0; i < d->state.nparticle; i++)
    dem_exact_sum_add(&d->state.ledger.mass, m->mass[i]);
  dem_drive_particles(d, first, end);
  dem_data_end(d);
  d->state.restart = true;
  dem_domain_begin(d, first, end);
  d->state.ledger.created = (uint64_t)d->state.nparticle;
  d->state.since_sort = DEM_SORT_STEPS;
  dem_skin_begin(d, m->mean_radius);
  for (int b = 0; b < m->nbody; b++) {
    d->state.pose[b] = m->body[b].start.pose;
    d->state.twist[b] = m->body[b].start.twist;
    d->state.mobility[b].per_mass = 1 / (m->wall_mass > 0 ? m->wall_mass : m->body[b].mass);
  }
}

dem_data *dem_data_create(const dem_model *model) {
  return dem_data_create_on(model, NULL);
}

dem_data *dem_data_create_on(const dem_model *model, const dem_ranks *ranks) {
  dem_data *d = dem_data_allocate(model);
  if (d)
    begin(d, ranks);
  return d;
}
