/* Energy that comes into the particles from elsewhere than the coupled bodies, for the server's ledger.
 *
 *   flow    kinetic and potential energy of particles that came (sources) less that of those that went (sinks, an open
 *           dem.domain): noted when they come and go
 *   driven  work of the bodies that the scene moves, the sum of -load * twist over the steps, trapezoidal; only in
 * scenes that have such bodies
 *
 * Constant forces have a potential and count as stored. Belts, a strained box, forces along a periodic direction and
 * cohesion, whose energy no one counts, cannot be accounted for: nothing is told then.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_WATCH_SUPPLY_H
#define DEM_WATCH_SUPPLY_H

#include "dem/state/data.h"

/* Can the energy of this scene be accounted for? */
bool dem_supply_known(const dem_model *model);

/* At the start of the run: nothing has been supplied. */
void dem_supply_begin(dem_data *data);

/* After a step of dt, in scenes with driven bodies. */
void dem_supply_step(dem_data *data, double dt);

/* Particle i came (+1) or goes (-1). */
void dem_supply_flow(dem_data *data, int i, double sign);

/* Stored and supplied at the end of a window. Looked at every dem.guard.every steps at most (DEM_LOOK_STEPS if the
 * guard is off), else and in scenes that cannot be accounted for: stored NaN. */
enum { DEM_LOOK_STEPS = 100 };
tdm_energy dem_supply_look(dem_data *data);

#endif
