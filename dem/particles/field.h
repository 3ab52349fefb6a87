/* What acts on particles besides contacts: gravity, the forces of their groups, and that some never move. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_PARTICLES_FIELD_H
#define DEM_PARTICLES_FIELD_H

#include "dem/state/data.h"

/* Accelerations of their own, and infinite masses, of particles first ... end - 1 by the groups of their ids. */
void dem_drive_particles(dem_data *data, int first, int end);

/* What accelerates particle i besides contacts [m/s2]. */
static inline tdm_vec3 dem_field(const dem_data *d, int i) {
  return d->model->driven ? tdm_add(d->model->gravity, d->state.drive[i].velocity) : d->model->gravity;
}

/* Sum of the contact forces on all fixed particles at the last evaluation [N]; of multi-step at the last substep. All
 * ranks ask for it. */
tdm_vec3 dem_fixed_force(dem_data *data);

/* Kinetic energy of particle i, and its potential one [J]. */
double dem_particle_energy(const dem_data *data, int i, double *potential);

/* Kinetic energy of all particles, with rotation [J], in a process that is alone. */
double dem_kinetic_energy(const dem_data *data);

/* Mass of all particles [kg]. All ranks ask for it. */
double dem_total_mass(dem_data *data);

#endif
