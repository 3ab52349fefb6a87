/* Memory for one piece of work: taken piece by piece, given back in the opposite order. The pieces lie in a block that
 * somebody lends; what does not fit there comes from the heap. All zero at first. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_BASE_SCRATCH_H
#define DEM_BASE_SCRATCH_H

#include <stddef.h>

typedef struct dem_scratch_piece dem_scratch_piece;

typedef struct {
  char *block;             /* (size) borrowed, aligned to 64 bytes; NULL: none */
  size_t size, used, most; /* [bytes]; most: that were ever used */
  dem_scratch_piece *heap; /* what did not fit, the last first */
} dem_scratch;

/* How much is taken. */
typedef struct {
  size_t used;
  dem_scratch_piece *heap;
} dem_scratch_mark;

/* `bytes` that mean nothing, aligned to 64. NULL: no memory. */
void *dem_scratch_take(dem_scratch *scratch, size_t bytes);

dem_scratch_mark dem_scratch_now(const dem_scratch *scratch);

/* Give back all that was taken since the mark; (dem_scratch_mark){0}: everything. */
void dem_scratch_back(dem_scratch *scratch, dem_scratch_mark mark);

#endif
