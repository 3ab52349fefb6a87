/* The seam between chunks: see crossings.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/seam/crossings.h"

#include "dem/base/pages.h"
#include "dem/seam/homes.h"

#include <limits.h>
#include <stdlib.h>

static bool crosses(const dem_data *d, int chunk, int other) {
  return other < d->state.nparticle && other >= (chunk + 1) * DEM_CHUNK;
}

/* how many there are of a chunk; count: (nchunk) */
static void count_chunk(dem_data *d, int c, void *count) {
  const dem_pairs *list = &d->lists.pairs;
  size_t n = 0;
  for (size_t k = list->chunk[c]; k < list->chunk[c + 1]; k++)
    n += crosses(d, c, list->other[k]);
  ((size_t *)count)[c] = n;
}

/* The places of those of a home chunk, and who they are on. `first` (nchunk + 1): those of each chunk begin */
static void place_chunk(dem_data *d, int c, void *first) {
  dem_pairs *list = &d->lists.pairs;
  int place = d->lists.crossings.from[c] = (int)((const size_t *)first)[c];
  for (size_t k = list->chunk[c]; k < list->chunk[c + 1]; k++)
    if (crosses(d, c, list->other[k])) {
      d->lists.crossings.particle[place] = list->other[k];
      list->reaction_slot[k] = dem_crossing_slot(d, place++);
    }
}

/* places by the chunk of the particle, of home chunks */
static void order_home(dem_data *d) {
  dem_crossings *x = &d->lists.crossings;
  const int nchunk = d->lists.nchunk, first = dem_home_first(d), end = dem_home_end(d);
  memset(x->chunk, 0, (size_t)(nchunk + 1) * sizeof *x->chunk);
  for (int p = 0; p < x->count; p++) {
    const int c = x->particle[p] / DEM_CHUNK;
    if (c >= first && c < end)
      x->chunk[c + 1]++;
  }
  for (int c = 0; c < nchunk; c++)
    x->chunk[c + 1] += x->chunk[c];
  const int all = x->chunk[nchunk];
  for (int p = x->count - 1; p >= 0; p--) { /* places of a chunk ascend: filled from its end */
    const int c = x->particle[p] / DEM_CHUNK;
    if (c >= first && c < end)
      x->order[--x->chunk[c + 1]] = p;
  }
  /* every entry but the first now stands at the start of its chunk: shift by one */
  for (int c = 0; c < nchunk; c++)
    x->chunk[c] = x->chunk[c + 1];
  x->chunk[nchunk] = all;
}

void dem_crossings_empty(const dem_data *d, dem_push *push) {
  const dem_crossings *x = &d->lists.crossings;
  if (!dem_alone(d) && d->work.homes.spread) /* others' go back to the system */
    dem_pages_zero(push + d->state.nparticle, (size_t)(x->count + 1) * sizeof *push);
  push[d->state.nparticle] = (dem_push){0};
  dem_zero(d, push + dem_crossing_slot(d, x->first), (size_t)(x->end - x->first) * sizeof *push);
}

tdm_status dem_crossings_place(dem_data *d) {
  dem_crossings *x = &d->lists.crossings;
  size_t *first = d->work.chunk_spare;
  d->work.homes.planned = false;
  dem_each_chunk(d, count_chunk, first);
  dem_lay_out(d, first);
  const int count = (int)first[d->lists.nchunk];
  if (first[d->lists.nchunk] > (size_t)(INT_MAX - d->state.nparticle - 1) || dem_crossings_reserve(d, count))
    return TDM_ERR_MEMORY;
  x->count = count;
  x->first = (int)first[dem_home_first(d)];
  x->end = (int)first[dem_home_end(d)];
  x->from[dem_home_end(d)] = x->end;
  dem_each_chunk(d, place_chunk, first);
  dem_unite_entries(d, x->particle, sizeof *x->particle, first);
  order_home(d);
  dem_crossings_empty(d, d->state.push);
  if (d->state.spare_push)
    dem_crossings_empty(d, d->state.spare_push);
  return TDM_OK;
}

static tdm_status reserve_givers(dem_givers *g, int need) {
  if (need <= g->capacity)
    return TDM_OK;
  const int capacity = need + need / 2 + 64;
  int *to = realloc(g->to, (size_t)capacity * sizeof *to);
  if (!to)
    return TDM_ERR_MEMORY;
  g->to = to;
  g->capacity = capacity;
  return TDM_OK;
}

tdm_status dem_givers_find(dem_data *d) {
  dem_givers *g = &d->work.givers;
  const dem_crossings *x = &d->lists.crossings;
  const dem_parcels *returned = &d->work.homes.returned;
  const int first = dem_home_first(d), end = dem_home_end(d), nchunk = d->lists.nchunk;
  int n = 0;
  for (int c = 0; c < nchunk; c++) {
    g->all[c] = 0;
    g->seen[c] = -1;
  }
  for (int c = first; c < end; c++) {
    const int count = x->from[c + 1] - x->from[c];
    if (reserve_givers(g, n + 1 + (count < nchunk ? count : nchunk)))
      return TDM_ERR_MEMORY;
    g->first[c] = n;
    g->to[n++] = c;
    g->all[c]++;
    for (int p = x->from[c]; p < x->from[c + 1]; p++) {
      const int other = x->particle[p] / DEM_CHUNK;
      if (other >= end || g->seen[other] == c)
        continue;
      g->seen[other] = c;
      g->to[n++] = other;
      g->all[other]++;
    }
  }
  g->first[end] = n;
  for (int k = 0; k < returned->first[d->work.homes.ranks->size]; k++) {
    const int c = x->particle[returned->item[k]] / DEM_CHUNK;
    g->all[c] += g->seen[c] != nchunk;
    g->seen[c] = nchunk;
  }
  return TDM_OK;
}

void dem_givers_begin(dem_data *d) {
  const int first = dem_home_first(d);
  memcpy(d->work.givers.left + first, d->work.givers.all + first,
         (size_t)(dem_home_end(d) - first) * sizeof *d->work.givers.left);
}

bool dem_gave(dem_data *d, int to) {
  return --d->work.givers.left[to] == 0;
}
