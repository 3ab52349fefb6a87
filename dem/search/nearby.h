/* Which spheres the rows of a part of them can name: those of the part, and those of the input's runs, or all later
 * ones, that may be near to one. So a rank searches among its home particles and what may cross into later homes. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SEARCH_NEARBY_H
#define DEM_SEARCH_NEARBY_H

#include "dem/search/method/method.h"

/* The input becomes one among these: `number`, in its scratch memory, names them, first all of the part. Errors:
 * TDM_ERR_MEMORY. */
tdm_status dem_nearby_choose(dem_search_input *input);

#endif
