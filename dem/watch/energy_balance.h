/* The energy balance of the particles, for the server's ledger and the guard: what is stored in them, and what comes
 * in from elsewhere than the coupled bodies.
 *
 * Stored energy is taken from the present state alone: it costs nothing in the steps between. Elastic is all that the
 * scene's laws store: the normal part, tangential and rolling springs. What cohesion stores is left out.
 *
 * Supplied energy:
 *   flow    kinetic and potential energy of particles that came (sources) less that of those that went (sinks, an open
 *           dem.domain): noted when they come and go
 *   driven  work of the bodies that the scene moves, the sum of -load * twist over the steps, trapezoidal; only in
 *           scenes that have such bodies
 *
 * Constant forces have a potential and count as stored. Belts, a strained box, forces along a periodic direction and
 * cohesion, whose energy no one counts, cannot be accounted for: nothing is told then.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_WATCH_ENERGY_BALANCE_H
#define DEM_WATCH_ENERGY_BALANCE_H

#include "dem/state/data.h"

typedef struct {
  double kinetic;
  double potential; /* in gravity and the constant forces of groups, zero at the world's origin */
  double elastic;
  double magnitude;  /* sum of the potentials' magnitudes, for round-off */
  double mass;       /* [kg] */
} dem_stored_energy; /* [J], unless it says something else */

/* In all particles, and in the contacts of the lists. All ranks ask for it. */
dem_stored_energy dem_stored_energy_now(dem_data *data);

/* Of so much mass at the speed that counts as rest (dem.settle.speed) [J]: less than that is no motion to judge by. */
double dem_rest_energy(const dem_model *model, double mass);

/* Can the energy of this scene be accounted for? */
bool dem_energy_balance_known(const dem_model *model);

/* At the start of the run: nothing has been supplied. */
void dem_energy_balance_begin(dem_data *data);

/* After a step of dt, in scenes with driven bodies. */
void dem_energy_balance_step(dem_data *data, double dt);

/* Stored and supplied at the end of a window. Looked at every dem.guard.every steps at most (DEM_LOOK_STEPS if the
 * guard is off), else and in scenes that cannot be accounted for: stored NaN. All ranks ask for it. */
enum { DEM_LOOK_STEPS = 100 };
tdm_energy dem_energy_balance_look(dem_data *data);

#endif
