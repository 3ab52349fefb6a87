/* Memory for one piece of work: see scratch.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/base/scratch.h"

#include <stdbool.h>
#include <stdlib.h>

enum { LINE = 64 };

/* in front of a piece from the heap, a line of its own */
struct dem_scratch_piece {
  dem_scratch_piece *before;
  size_t size; /* [bytes] */
  bool taken;  /* since everything was given back last */
};

static size_t whole_lines(size_t bytes) {
  return (bytes + LINE - 1) / LINE * LINE;
}

/* a kept piece of at least so many bytes, but not of more than twice as many; NULL: there is none */
static dem_scratch_piece *take_kept(dem_scratch *s, size_t bytes) {
  for (dem_scratch_piece **at = &s->kept; *at; at = &(*at)->before)
    if ((*at)->size >= bytes && (*at)->size / 2 <= bytes) {
      dem_scratch_piece *piece = *at;
      *at = piece->before;
      return piece;
    }
  return NULL;
}

/* Pieces that were not taken since the last piece of work was done go back to the heap. `done`: so is this one. */
static void free_idle(dem_scratch *s, bool done) {
  for (dem_scratch_piece **at = &s->kept; *at;) {
    dem_scratch_piece *piece = *at;
    if (piece->taken) {
      piece->taken = !done;
      at = &piece->before;
    } else {
      *at = piece->before;
      free(piece);
    }
  }
}

void *dem_scratch_take(dem_scratch *s, size_t bytes) {
  bytes = whole_lines(bytes > 0 ? bytes : 1);
  if (bytes <= s->size - s->used) {
    void *piece = s->block + s->used;
    s->used += bytes;
    s->most = s->used > s->most ? s->used : s->most;
    return piece;
  }
  dem_scratch_piece *piece = take_kept(s, bytes);
  if (!piece) {
    free_idle(s, false);                                 /* the work has changed: they may not fit either */
    const size_t size = whole_lines(bytes + bytes / 16); /* the next time it may be a little more */
    piece = aligned_alloc(LINE, LINE + size);
    if (!piece)
      return NULL;
    piece->size = size;
  }
  piece->taken = true;
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
    dem_scratch_piece *piece = s->heap;
    s->heap = piece->before;
    piece->before = s->kept;
    s->kept = piece;
  }
}

void dem_scratch_done(dem_scratch *s) {
  dem_scratch_back(s, (dem_scratch_mark){0});
  free_idle(s, true);
}

void dem_scratch_free(dem_scratch *s) {
  dem_scratch_done(s);
  free_idle(s, true); /* all of them: none was taken in between */
}
