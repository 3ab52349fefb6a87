/* Neighbour lists: Verlet lists with a skin, of pairs of particles and of particles with walls.
 *
 * Listed is what is nearer than the radii and the skin. The lists hold until something may have come nearer unlisted:
 * with u any common displacement (that of the first coupled body, so that a bed that moves with its box costs nothing),
 *   pairs:          2 max_i |dx_i - u| < skin
 *   walls, body b:  max_i |dx_i - u| + |dX_b - u| + chord(b) * reach_b < margin_b
 * where dx, dX are displacements since the lists were built, chord the length 2 sin(angle/2) of the body's turn, reach
 * the largest distance of a particle from the body's centre of mass, and margin the smallest gap of an unlisted
 * particle to this body's walls (at least the skin). The skin changes the speed, never a result. Checked every step,
 * after the drift: no contact is ever missed.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SEARCH_PAIRS_H
#define DEM_SEARCH_PAIRS_H

#include "dem/state/data.h"

/* The common displacement u since the lists were built [m]. */
tdm_vec3 dem_lists_shift(const dem_data *data);

/* How far a body may have moved since, besides u, where particles are [m]: |dX_b - u| + chord(b) * reach_b. */
double dem_lists_way_of_body(const dem_data *data, int body);

/* Rebuild the lists if something may have come too near; `moved2` = max_i |dx_i - u|^2 [m2]. Errors: TDM_ERR_MEMORY. */
tdm_status dem_lists_update(dem_data *data, double moved2);

/* Rebuild the lists; contact histories are carried over. The memory of the forces (dem_state.push) is used meanwhile
 * and zero afterwards: so lists are built where forces are about to be evaluated anyway, between drift and forces.
 * Errors: TDM_ERR_MEMORY. */
tdm_status dem_lists_build(dem_data *data);

#endif
