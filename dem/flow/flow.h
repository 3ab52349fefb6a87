/* Sources and sinks: particles that come and go during the run.
 *
 * Particle k of a source is due at start + k/rate, exactly (by mass: when the masses before it are due). It appears at
 * the first step boundary at or after that, where free flight since then has brought it: x + v s + g s^2/2, v + g s. A
 * particle that would overlap another or a wall waits at its place, those behind it queue; it is tried again every step
 * (in a region, at other places). A source ends with its number, or before the particle that would exceed its mass.
 * Radius and place are drawn from the seed, the particle's number and the try alone, so a copy of the data needs no
 * generator.
 *
 * A sink takes a particle at a step boundary: when its centre is in the sink's zone (bodies/zone.h), or when it does
 * not touch a body any more that it has touched. The first sink that wants a particle gets it.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_FLOW_FLOW_H
#define DEM_FLOW_FLOW_H

#include "dem/state/data.h"

/* At the step boundary at time t [s], `dt` after the one before: sinks, then sources, in the order of the scene.
 * Errors: TDM_ERR_MEMORY. */
tdm_status dem_flow(dem_data *data, double t, double dt, tdm_error *err);

/* Between two steps: take out what has left the open box dem.domain, and count it (ledger.left). Errors:
 * TDM_ERR_MEMORY. */
tdm_status dem_flow_leave(dem_data *data);

/* At the end of the run, t [s]: remarks on sources whose particles still wait. */
void dem_flow_end(const dem_data *data, double t);

/* Created and initial particles less removed ones less those inside: 0, and 0 kg exactly. All ranks ask for it. */
double dem_balance_number(const dem_data *data);
double dem_balance_mass(const dem_data *data);

#endif
