/* The seam between chunks: see crossings.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/seam/crossings.h"

#include "dem/base/pages.h"
#include "dem/seam/homes.h"

#include <limits.h>

static bool crosses(const dem_data *d, int chunk, int other) {
  return other < d->state.nparticle && other >= (chunk + 1) * DEM_CHUNK;
}

/* The places of the crossings of home chunks, and who they are on. `first` (nchunk + 1): those of each chunk begin */
static void place_home(dem_data *d, const size_t *first) {
  dem_pairs *list = &d->lists.pairs;
  for (int c = dem_home_first(d); c < dem_home_end(d); c++) {
    int place = (int)first[c];
    for (size_t k = list->chunk[c]; k < list->chunk[c + 1]; k++)
      if (crosses(d, c, list->other[k])) {
        d->lists.crossings.particle[place] = list->other[k];
        list->reaction_slot[k] = dem_crossing_slot(d, place++);
      }
  }
}

void dem_crossings_empty(const dem_data *d, dem_push *push) {
  const dem_crossings *x = &d->lists.crossings;
  if (!dem_alone(d) && d->work.homes.spread) /* others' go back to the system */
    dem_pages_zero(push + d->state.nparticle, (size_t)(x->count + 1) * sizeof *push);
  push[d->state.nparticle] = (dem_push){0};
  memset(push + dem_crossing_slot(d, x->first), 0, (size_t)(x->end - x->first) * sizeof *push);
}

tdm_status dem_crossings_place(dem_data *d) {
  dem_pairs *list = &d->lists.pairs;
  dem_crossings *x = &d->lists.crossings;
  size_t *first = d->work.chunk_spare;
  d->work.homes.planned = false;
  for (int c = dem_home_first(d); c < dem_home_end(d); c++) {
    first[c] = 0;
    for (size_t k = list->chunk[c]; k < list->chunk[c + 1]; k++)
      first[c] += crosses(d, c, list->other[k]);
  }
  dem_lay_out(d, first);
  const int count = (int)first[d->lists.nchunk];
  if (first[d->lists.nchunk] > (size_t)(INT_MAX - d->state.nparticle - 1) || dem_crossings_reserve(d, count))
    return TDM_ERR_MEMORY;
  x->count = count;
  x->first = (int)first[dem_home_first(d)];
  x->end = (int)first[dem_home_end(d)];
  place_home(d, first);
  dem_unite_entries(d, x->particle, sizeof *x->particle, first);
  memset(x->chunk, 0, (size_t)(d->lists.nchunk + 1) * sizeof *x->chunk);
  for (int p = 0; p < count; p++)
    x->chunk[x->particle[p] / DEM_CHUNK + 1]++;
  for (int c = 0; c < d->lists.nchunk; c++)
    x->chunk[c + 1] += x->chunk[c];
  for (int p = count - 1; p >= 0; p--) /* places of a chunk ascend: filled from its end */
    x->order[--x->chunk[x->particle[p] / DEM_CHUNK + 1]] = p;
  /* every entry but the first now stands at the start of its chunk: shift by one */
  for (int c = 0; c < d->lists.nchunk; c++)
    x->chunk[c] = x->chunk[c + 1];
  x->chunk[d->lists.nchunk] = count;
  dem_crossings_empty(d, d->state.push);
  if (d->state.spare_push)
    dem_crossings_empty(d, d->state.spare_push);
  return TDM_OK;
}
