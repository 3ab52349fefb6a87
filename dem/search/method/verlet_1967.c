/* Verlet's lists as [A07] Section 2.3.1 describes them: every pair is looked at, and listed if the centres are nearer
 * than r_v = 5 r_max, whatever the two radii (Eq. 2.64); made anew every 20 steps. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/search/method/method.h"

#include <math.h>

/* in a circle of 2 r_max and the skin, which is 3 r_max and over what gaps contacts act */
static tdm_status find(void *state, const dem_search_input *input, dem_found *found) {
  (void)state;
  double largest = 0;
  for (int i = 0; i < input->n; i++)
    largest = fmax(largest, dem_search_sphere(input, i)->radius);
  dem_near near = dem_near_make(input);
  near.skin += 2 * largest;
  for (int i = 0; i < input->n; i++)
    for (int j = i + 1; j < input->n; j++) {
      const tdm_vec3 a = dem_search_sphere(input, i)->position, b = dem_search_sphere(input, j)->position;
      if (!(dem_excess(&near, near.periodic, a.x - b.x, a.y - b.y, a.z - b.z, 0) < 0))
        continue;
      if (dem_found_reserve(found, 1))
        return TDM_ERR_MEMORY;
      found->pair[found->count++] = (dem_found_pair){i, j};
    }
  return TDM_OK;
}

const dem_search_method dem_search_verlet_1967 = {.find = find, .skin_radii = 3, .interval = 20};
