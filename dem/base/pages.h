/* Pages of memory that go back to the system: they are zero when they are touched again, and take no memory before. For
 * memory of malloc and its like, in which a process may leave pages untouched. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_BASE_PAGES_H
#define DEM_BASE_PAGES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* Give back the whole pages among so many bytes: from *begin to *end. False: there are none, or another system than
 * Linux, which alone says that they are zero then. */
static inline bool dem_pages_release(void *array, size_t bytes, char **begin, char **end) {
  const uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE), from = (uintptr_t)array, to = from + bytes;
  const uintptr_t first = (from + page - 1) / page * page, last = to / page * page;
  if (first >= last)
    return false;
  *begin = (char *)array + (first - from);
  *end = *begin + (last - first);
#ifdef __linux__
  return madvise(*begin, (size_t)(last - first), MADV_DONTNEED) == 0;
#else
  return false;
#endif
}

/* Zero so many bytes, whole pages by giving them back. */
static inline void dem_pages_zero(void *array, size_t bytes) {
  char *begin, *end;
  if (bytes == 0)
    return;
  if (!dem_pages_release(array, bytes, &begin, &end)) {
    memset(array, 0, bytes);
    return;
  }
  memset(array, 0, (size_t)(begin - (char *)array));
  memset(end, 0, (size_t)((char *)array + bytes - end));
}

/* memcpy, after which no more takes memory than has to: pieces that are zero are given back. */
static inline void dem_pages_copy(void *to, const void *from, size_t bytes) {
  enum { PIECE = 1 << 14 };
  char *t = to;
  const char *f = from;
  size_t zero = 0; /* from there on all is zero */
  for (size_t at = 0, n; at < bytes; at += n) {
    n = bytes - at < PIECE ? bytes - at : PIECE;
    if (f[at] == 0 && memcmp(f + at, f + at + 1, n - 1) == 0)
      continue;
    dem_pages_zero(t + zero, at - zero);
    memcpy(t + at, f + at, n);
    zero = at + n;
  }
  dem_pages_zero(t + zero, bytes - zero);
}

#endif
