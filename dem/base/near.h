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

/* Pairs in CSR form: the partners of i are other[first[i]] ... other[first[i+1] - 1], ascending, all greater than i. */
typedef struct {
  int *first; /* (n + 1) */
  int *other; /* (count) */
  size_t count;
} dem_rows;

#endif
