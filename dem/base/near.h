/* What a search for near pairs is given besides spheres, and what it finds. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_BASE_NEAR_H
#define DEM_BASE_NEAR_H

#include <stdbool.h>
#include <stddef.h>

/* The box that repeats. One image of a neighbour is enough: a length is at least 2 (2 r_max + skin), which whoever
 * makes the domain sees to. */
typedef struct {
  bool periodic[3];
  double low[3], length[3]; /* [m]; positions are kept in [low, low + length) in a periodic direction */
} dem_domain;

/* Pairs in CSR form: a row for each particle `begin` ... `end` - 1. The partners of i are other[dem_row(rows, i)] ...
 * other[dem_row(rows, i + 1) - 1], ascending, all greater than i. */
typedef struct {
  int begin, end;
  int *first; /* (end - begin + 1) */
  int *other; /* (count) */
  size_t count;
} dem_rows;

static inline int dem_row(const dem_rows *rows, int i) {
  return rows->first[i - rows->begin];
}

#endif
