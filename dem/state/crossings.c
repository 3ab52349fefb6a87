/* The seam between chunks: see crossings.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/state/crossings.h"

tdm_status dem_crossings_place(dem_data *d) {
  dem_pairs *list = &d->lists.pairs;
  dem_crossings *x = &d->lists.crossings;
  int count = 0;
  d->work.homes.planned = false;
  for (int c = 0; c < d->lists.nchunk - 1; c++)
    for (size_t k = list->chunk[c]; k < list->chunk[c + 1]; k++)
      count += list->other[k] < d->state.nparticle && list->other[k] >= (c + 1) * DEM_CHUNK;
  if (dem_crossings_reserve(d, count))
    return TDM_ERR_MEMORY;
  x->count = count;
  memset(x->chunk, 0, (size_t)(d->lists.nchunk + 1) * sizeof *x->chunk);
  int place = 0;
  for (int c = 0; c < d->lists.nchunk - 1; c++)
    for (size_t k = list->chunk[c]; k < list->chunk[c + 1]; k++)
      if (list->other[k] < d->state.nparticle && list->other[k] >= (c + 1) * DEM_CHUNK) {
        x->particle[place] = list->other[k];
        list->reaction_slot[k] = dem_crossing_slot(d, place++);
        x->chunk[list->other[k] / DEM_CHUNK + 1]++;
      }
  for (int c = 0; c < d->lists.nchunk; c++)
    x->chunk[c + 1] += x->chunk[c];
  for (int p = count - 1; p >= 0; p--) /* places of a chunk ascend: filled from its end */
    x->order[--x->chunk[x->particle[p] / DEM_CHUNK + 1]] = p;
  /* every entry but the first now stands at the start of its chunk: shift by one */
  for (int c = 0; c < d->lists.nchunk; c++)
    x->chunk[c] = x->chunk[c + 1];
  x->chunk[d->lists.nchunk] = count;
  memset(d->state.push + d->state.nparticle, 0, (size_t)(count + 1) * sizeof *d->state.push);
  if (d->state.spare_push)
    memset(d->state.spare_push + d->state.nparticle, 0, (size_t)(count + 1) * sizeof *d->state.push);
  return TDM_OK;
}
