/* What a search is given. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SEARCH_INPUT_H
#define DEM_SEARCH_INPUT_H

#include "dem/state/near.h"
#include "dem/state/scratch.h"
#include "dem/state/sphere.h"

#include <stdbool.h>

typedef struct {
  const dem_sphere *sphere; /* (n) */
  int n;
  double skin; /* [m] */
  dem_domain domain;
  int nthread;          /* threads that may be used; the result does not depend on it */
  dem_scratch *scratch; /* for the rows and what it takes to find them; NULL: the search has its own */
} dem_search_input;

#endif
