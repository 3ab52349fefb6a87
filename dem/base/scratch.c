/* Memory for one piece of work: see scratch.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/base/scratch.h"

#include <stdlib.h>

enum { LINE = 64 };

/* in front of a piece from the heap, a line of its own */
struct dem_scratch_piece {
  dem_scratch_piece *before;
};

static size_t whole_lines(size_t bytes) {
  return (bytes + LINE - 1) / LINE * LINE;
}

void *dem_scratch_take(dem_scratch *s, size_t bytes) {
  bytes = whole_lines(bytes > 0 ? bytes : 1);
  if (bytes <= s->size - s->used) {
    void *piece = s->block + s->used;
    s->used += bytes;
    s->most = s->used > s->most ? s->used : s->most;
    return piece;
  }
  dem_scratch_piece *piece = aligned_alloc(LINE, LINE + bytes);
  if (!piece)
    return NULL;
  piece->before = s->heap;
  s->heap = piece;
  return (char *)piece + LINE;
}

dem_scratch_mark dem_scratch_now(const dem_scratch *s) {
  return (dem_scratch_mark){s->used, s->heap};
}

void dem_scratch_back(dem_scratch *s, dem_scratch_mark mark) {
  s->used = mark.used;
  while (s->heap != mark.heap) {
    dem_scratch_piece *before = s->heap->before;
    free(s->heap);
    s->heap = before;
  }
}
