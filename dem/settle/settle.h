/* Settling: letting the particles come to rest before the run, with the bodies held at their start poses.
 *
 * What is to be poured comes first (pour.h). Settling has its own restitution and friction, because a bed with e = 1
 * never comes to rest, and a weak drag on velocities and spins, because without rolling resistance a sphere may roll
 * for ever. At rest means that no particle was faster than settle.speed for a while, longer than a particle lingers at
 * the top of a bounce. What stays of the settling is the positions and the contact histories; velocities and spins are
 * 0 afterwards.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SETTLE_SETTLE_H
#define DEM_SETTLE_SETTLE_H

#include "dem/settle/bed.h"

/* Settle `data`, which is at the start, or take the bed from settle.store; then lids are in place. `participant` is
 * told that the solver lives (NULL: a signal may end it). Errors: TDM_ERR_INTERRUPTED, TDM_ERR_NUMERIC, TDM_ERR_MEMORY,
 * TDM_ERR_FILE, TDM_ERR_SCENE (no room for all that is to be poured); not coming to rest is none. */
tdm_status dem_settle(dem_data *data, tdm_participant *participant, dem_settled *settled, tdm_error *err);

#endif
