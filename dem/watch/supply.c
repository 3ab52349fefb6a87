/* Energy from elsewhere: see supply.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/watch/supply.h"

#include "dem/watch/stored.h"

bool dem_supply_known(const dem_model *m) {
  if (m->cohesion != DEM_COHESION_none || m->domain.strained || (m->domain.repeats && m->driven))
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
    const tdm_wrench *load = &d->body_load[b];
    const tdm_twist *twist = &d->twist[b];
    if (d->model->body[b].drive.given)
      power -= tdm_dot(load->force, twist->velocity) + tdm_dot(load->moment, twist->angular);
  }
  return power;
}

void dem_supply_begin(dem_data *d) {
  d->supply = (dem_supply){.power = power_of_bodies(d), .next_look = d->nstep};
}

void dem_supply_step(dem_data *d, double dt) {
  double power = power_of_bodies(d);
  d->supply.driven += 0.5 * dt * (d->supply.power + power);
  d->supply.power = power;
}

void dem_supply_flow(dem_data *d, int i, double sign) {
  double potential, kinetic = dem_particle_energy(d, i, &potential);
  d->supply.flow += sign * (kinetic + potential);
}

tdm_energy dem_supply_look(dem_data *d) {
  const dem_model *m = d->model;
  tdm_energy e = {.kinetic = NAN, .stored = NAN, .supplied = d->supply.flow + d->supply.driven};
  if (d->nstep < d->supply.next_look || !dem_supply_known(m))
    return e;
  dem_stored now = dem_stored_now(d);
  d->supply.next_look = d->nstep + (uint64_t)(m->guard.every > 0 ? m->guard.every : DEM_LOOK_STEPS);
  e.kinetic = now.kinetic;
  e.stored = now.kinetic + now.potential + now.elastic;
  return e;
}
