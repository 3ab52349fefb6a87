/* What the searches share: see method.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/search/method/method.h"

#include <stdlib.h>
#include <string.h>

tdm_status dem_found_grow(dem_found *pairs, size_t more) {
  size_t capacity = (pairs->count + more) + (pairs->count + more) / 4 + 64;
  dem_found_pair *pair = realloc(pairs->own, capacity * sizeof *pair);
  if (!pair) {
    pairs->failed = true;
    return TDM_ERR_MEMORY;
  }
  if (!pairs->own && pairs->count > 0)
    memcpy(pair, pairs->pair, pairs->count * sizeof *pair);
  pairs->pair = pairs->own = pair;
  pairs->capacity = capacity;
  return TDM_OK;
}

void dem_search_parallel(int nthread, void (*work)(void *context, int t), void *context) {
  if (nthread == 1) {
    work(context, 0);
    return;
  }
#ifdef _OPENMP
#pragma omp parallel for num_threads(nthread) schedule(static, 1)
#endif
  for (int t = 0; t < nthread; t++)
    work(context, t);
}

bool dem_cells_fit(int n, double largest, double cubes, double worth) {
  return n * largest * largest * largest <= worth * cubes;
}
