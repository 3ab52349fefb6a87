/* Energies of the contacts: see energy.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/base/energy.h"

void dem_flux_add(dem_flux *sum, const dem_flux *chunk) {
  for (int k = 0; k < DEM_ENERGIES; k++) {
    sum->power[k] += chunk->power[k];
    sum->elastic[k] += chunk->elastic[k];
  }
  sum->wall_power += chunk->wall_power;
  sum->box_power += chunk->box_power;
}

void dem_energy_step(dem_energy *e, dem_flux *of, const dem_flux *now, double dt) {
  if (dt > 0) {
    for (int k = 0; k < DEM_ENERGIES; k++)
      e->dissipated[k] += 0.5 * dt * (of->power[k] + now->power[k]) - (now->elastic[k] - of->elastic[k]);
    e->wall_work += 0.5 * dt * (of->wall_power + now->wall_power);
    e->supplied += 0.5 * dt * (of->box_power + now->box_power);
  }
  *of = *now;
}

void dem_energy_begin(dem_energy *e) {
  *e = (dem_energy){.now = e->now, .fast = e->fast};
}

double dem_energy_elastic(const dem_energy *e) {
  double sum = 0;
  for (int k = 0; k < DEM_ENERGIES; k++)
    sum += e->now.elastic[k] + e->fast.elastic[k];
  return sum;
}
