/* The order of particles in memory: along a space-filling curve, so that what is near in space is near in memory. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SEARCH_ORDER_H
#define DEM_SEARCH_ORDER_H

#include "dem/state/data.h"

/* from[p] (nparticle): the particle that comes to place p. By the Morton code of the cell of two largest radii that it
 * lies in; those of one cell keep their order. Errors: TDM_ERR_MEMORY. */
tdm_status dem_order(dem_data *data, int *from);

#endif
