/* What the loads on the coupled bodies come to over a window: sums, moments and works. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_STEP_WINDOW_SUMS_H
#define DEM_STEP_WINDOW_SUMS_H

#include "dem/bodies/path.h"
#include "dem/state/data.h"

typedef struct {
  double duration;  /* of the window [s] */
  tdm_wrench *load; /* (ncoupled) sums of the loads after each step, world; zeroed by the owner before the window */
  tdm_interface
      *body;      /* (ncoupled) moments of the loads, and works along the path; zeroed likewise; NULL: not wanted */
  tdm_vec3 fixed; /* force on fixed particles at the last step, before any came or went, world [N] */
} dem_window_sums;

/* Step k of n is done, 0: the window begins. The loads are those of kicks: half of one at both ends. Works only with a
 * path (ncoupled); NULL: whoever carries the bodies knows them. */
void dem_window_sums_add(dem_window_sums *sums, dem_data *data, uint64_t k, uint64_t n, const dem_path *path);

#endif
