/* The order of particles in memory: along a space-filling curve, so that what is near in space is near in memory; or in
 * slices across an axis ([A07] Section 3.3), if the scene asks for them. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SEARCH_ORDER_H
#define DEM_SEARCH_ORDER_H

#include "dem/state/data.h"

/* from[p] (nparticle): the particle that comes to place p. By the cell of two largest radii that it lies in: its Morton
 * code, or its numbers along the axis and the two after it. Those of one cell keep their order. Errors:
 * TDM_ERR_MEMORY. */
tdm_status dem_order(dem_data *data, int *from);

/* What decides that order, of home particles: in it, codes ascend. All ranks call this. */
void dem_order_codes(const dem_data *data, uint64_t *code);

#endif
