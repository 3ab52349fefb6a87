/* Gravity, the forces of groups, fixed particles: see field.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/particles/field.h"

#include "dem/seam/homes.h"

#include <stdlib.h>

/* on a fixed particle, of either set of forces */
typedef struct {
  tdm_vec3 force, slow;
} fixed_force;

static tdm_vec3 add_fixed(const dem_data *d, tdm_vec3 sum, const fixed_force *f) {
  sum = tdm_add(sum, f->force);
  return d->state.spare_push ? tdm_add(sum, f->slow) : sum;
}

tdm_vec3 dem_fixed_force(const dem_data *d) {
  const int first = dem_home_first_particle(d), end = dem_home_end_particle(d);
  tdm_vec3 sum = {0, 0, 0};
  if (!d->model->fixes)
    return sum;
  fixed_force *own = dem_alone(d) ? NULL : malloc((size_t)(end - first + 1) * sizeof *own);
  int n = 0;
  if (!own && !dem_alone(d))
    d->work.homes.ranks->abandon("no memory for the forces on fixed particles");
  for (int i = first; i < end; i++)
    if (d->state.sphere[i].inverse_mass == 0) {
      const fixed_force f = {d->state.push[i].force, d->state.spare_push ? d->state.spare_push[i].force : sum};
      if (own)
        own[n++] = f;
      else
        sum = add_fixed(d, sum, &f);
    }
  if (!own)
    return sum;
  fixed_force *all = dem_homes_join(d, own, n, sizeof *own, &n);
  for (int k = 0; k < n; k++) /* in the order of the particles */
    sum = add_fixed(d, sum, &all[k]);
  free(own);
  free(all);
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
