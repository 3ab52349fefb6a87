/* Linked cells: all spheres in cells of the largest diameter and the skin; neighbours are in the cells around. The
 * search for spheres of like size. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/search/method/bins.h"

static double largest_radius(const dem_search_input *input) {
  const int nthread = dem_search_threads(input, input->n);
  double largest = 0;
#pragma omp parallel for schedule(static) num_threads(nthread) if (nthread > 1) reduction(max : largest)
  for (int i = 0; i < input->n; i++)
    largest = dem_search_sphere(input, i)->radius > largest ? dem_search_sphere(input, i)->radius : largest;
  return largest;
}

typedef struct {
  const dem_bins *bins;
  dem_near near;
  int nthread;
  dem_found *found;
} finding;

static void find_part(void *context, int t) {
  const finding *f = context;
  dem_bins_pairs(f->bins, &f->near, t, f->nthread, &f->found[t]);
}

static tdm_status find(void *state, const dem_search_input *input, dem_found *found) {
  (void)state;
  dem_bins bins;
  if (input->n < 2)
    return TDM_OK;
  if (dem_bins_fill(&bins, input, NULL, input->n, 2 * largest_radius(input) + input->skin))
    return TDM_ERR_MEMORY;
  dem_search_parallel(input->nthread, find_part, &(finding){&bins, dem_near_make(input), input->nthread, found});
  return TDM_OK;
}

const dem_search_method dem_search_cells = {.find = find};
