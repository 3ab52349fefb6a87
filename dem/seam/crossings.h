/* The seam between chunks: all that one chunk needs of others, and gives to others. Chunks that live in other processes
 * meet here (homes.h).
 *
 * A contact belongs to the chunk of its first particle, i; its second, j > i, may belong to a later chunk: then the
 * contact crosses. Between two builds of the lists (search/pairs.c) the crossings are the same, unless particles go.
 *
 *   a chunk reads of others, before the forces    sphere[j], rotor[j], material[j] of its crossings' partners (those of
 *                                                 pairs.other in later chunks); the walls' places, which all have
 *   ... where laws have sums                      contact_sum[j] of the same, when all sums are complete
 *   ... where they take notes                     what j's contacts give this one (notes.h)
 *   it gives to others                            the reaction on j, in a place of its own behind the particles, until
 *                                                 j's chunk takes it (dem_crossing_slot, data.h); sums of laws likewise
 *   it gives to all                               chunk_load, chunk_flux and the largest way, added up in the order of
 *                                                 the chunks, so that the bits do not depend on who worked when
 *
 * Who does it: crossings.c numbers the crossings; the pair loops write by pairs.reaction_slot; step/integrate.c
 * takes reactions at the end of each chunk's step, step/forces.c takes sums of laws. Each of a chunk's takings is in
 * the order of crossings.order, ascending, so it may come from anywhere.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SEAM_CROSSINGS_H
#define DEM_SEAM_CROSSINGS_H

#include "dem/state/data.h"

#include <string.h>

/* Entries of push and contact_sum in use: particles, the dummy particle, crossings. */
static inline size_t dem_push_count(const dem_data *d) {
  return (size_t)dem_crossing_slot(d, d->lists.crossings.count);
}

/* Give each reaction on a particle of a later chunk a place of its own, behind the particles, and empty it. After a
 * change of the pairs, of their chunks or of the number of particles. Errors: TDM_ERR_MEMORY. */
tdm_status dem_crossings_place(dem_data *d);

/* No reaction of home chunks on others, nor on the dummy particle; push: state.push or state.spare_push. On several
 * ranks most places are others' and take no memory; they are empty, too, where memory is given back (homes.spread). */
void dem_crossings_empty(const dem_data *data, dem_push *push);

/* Who adds to whom in a step, on several ranks of one thread each, by the present crossings. Errors: TDM_ERR_MEMORY. */
tdm_status dem_givers_find(dem_data *data);

/* A step begins: nobody has given anything yet. */
void dem_givers_begin(dem_data *data);

/* A chunk that adds to chunk `to` is evaluated; true: it was the last one. */
bool dem_gave(dem_data *data, int to);

/* There are no crossings until the lists are built next. */
static inline void dem_crossings_forget(dem_data *d) {
  d->lists.crossings.count = d->lists.crossings.first = d->lists.crossings.end = 0;
  d->work.homes.planned = false;
  memset(d->lists.crossings.chunk, 0, (size_t)(d->lists.nchunk + 1) * sizeof *d->lists.crossings.chunk);
  memset(d->lists.crossings.from, 0, (size_t)(d->lists.nchunk + 1) * sizeof *d->lists.crossings.from);
}

#endif
