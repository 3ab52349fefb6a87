/* Containers: places whose content is counted, and watched for jams.
 *
 * A container is a box, at rest or in the axes of a body, and a particle is inside while its centre is. Each particle
 * that has been inside is known (dem_state.held), so that what has left is what has been inside less what is: one that
 * hangs in the outlet, or comes back, counts once. `left` of the state is the most of that so far.
 *
 *   jam             particles are inside, and none has left for jam_time; watched from the first that leaves on, or
 *                   from jam_start, and while anything is inside. It ends with the next that leaves
 *   mean rate       of the discharge of what is inside when the first particle leaves: from the tenth to the nine
 * tenths of that number, over the time between
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_PARTICLES_CONTAINER_H
#define DEM_PARTICLES_CONTAINER_H

#include "dem/state/data.h"

/* At a step boundary, time t [s], when particles have come and gone: count, and warn of jams. */
void dem_containers_step(dem_data *data, double t);

/* Close an output interval of so many seconds; 0: the rates stay. */
void dem_containers_sample(dem_data *data, double duration);

/* Mean rate of a container's discharge between a tenth and nine tenths of its content [1/s]; NaN: not yet, or both were
 * reached in one step. */
double dem_container_mean_rate(const dem_container_state *container);

#endif
