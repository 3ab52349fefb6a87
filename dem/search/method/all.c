/* Every pair is looked at: the reference that the other searches are tested against. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/search/method/method.h"

static tdm_status find_all(void *state, const dem_search_input *input, dem_found *found) {
  (void)state;
  dem_near near = dem_near_make(input);
  for (int i = 0; i < input->n; i++)
    for (int j = i + 1; j < input->n; j++)
      if (dem_spheres_near(&near, dem_search_sphere(input, i), dem_search_sphere(input, j))) {
        if (dem_found_reserve(found, 1))
          return TDM_ERR_MEMORY;
        found->pair[found->count++] = (dem_found_pair){i, j};
      }
  return TDM_OK;
}

const dem_search_method dem_search_all = {.find = find_all};
