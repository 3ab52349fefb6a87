/* Memory for one piece of work: taken piece by piece, given back in the opposite order. The pieces lie in a block that
 * somebody lends; what does not fit there comes from the heap, and is kept for the next piece of work: pages that are
 * taken anew cost more than what is done with them. When a piece fits in nothing that is kept, all that is kept and not
 * in use goes first. All zero at first. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_BASE_SCRATCH_H
#define DEM_BASE_SCRATCH_H

#include <stddef.h>

typedef struct dem_scratch_piece dem_scratch_piece;

typedef struct {
  char *block;             /* (size) borrowed, aligned to 64 bytes; NULL: none */
  size_t size, used, most; /* [bytes]; most: that were ever used */
  dem_scratch_piece *heap; /* what did not fit, the last first */
  dem_scratch_piece *kept; /* what was given back of that */
} dem_scratch;

/* How much is taken. */
typedef struct {
  size_t used;
  dem_scratch_piece *heap;
} dem_scratch_mark;

/* `bytes` that mean nothing, aligned to 64. NULL: no memory. */
void *dem_scratch_take(dem_scratch *scratch, size_t bytes);

dem_scratch_mark dem_scratch_now(const dem_scratch *scratch);

/* Give back all that was taken since the mark. */
void dem_scratch_back(dem_scratch *scratch, dem_scratch_mark mark);

/* The work is done: give back everything. What is kept, but was not needed for it, goes back to the heap. */
void dem_scratch_done(dem_scratch *scratch);

/* Likewise, and all that is kept goes. */
void dem_scratch_free(dem_scratch *scratch);

#endif
