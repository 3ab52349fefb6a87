/* Which spheres the rows of a part of them can name: those of the part, and those of the input's runs, or all later
 * ones, that may be near to one. So a rank searches among its home particles and what may cross into later homes. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SEARCH_NEARBY_H
#define DEM_SEARCH_NEARBY_H

#include "dem/search/method/method.h"

typedef struct {
  int n;
  int *number;        /* (n) in the input, ascending; first all of the part */
  dem_sphere *sphere; /* (n) copies */
} dem_nearby;

/* Choose from the input's spheres by its begin and end, in its scratch memory. Errors: TDM_ERR_MEMORY. */
tdm_status dem_nearby_choose(dem_nearby *nearby, const dem_search_input *input);

#endif
