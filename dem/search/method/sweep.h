/* The linked linear list of [A07] Section 2.3.2: bounding boxes projected on the axes, their ends kept in order. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SEARCH_METHOD_SWEEP_H
#define DEM_SEARCH_METHOD_SWEEP_H

#include "dem/search/method/method.h"

#include <stdint.h>

/* The end of a bounding box on an axis. With an axis that repeats, each box is there twice, a length apart. */
typedef struct {
  double x;      /* [m] */
  int particle;  /* 0 ... n - 1 */
  uint8_t image; /* 0, or 1: one length further on */
  bool end;      /* +i of [A07]; else the beginning, -i */
} dem_mark;

/* What an exchange of two neighbouring marks means, as numbered in [A07] Table 2.1. */
typedef enum {
  DEM_RULE_BEGINS = 1, /* -i -j => -j -i: the overlap, if any, is kept */
  DEM_RULE_ENDS,       /* +i +j => +j +i: the overlap is kept */
  DEM_RULE_REMOVE,     /* -i +j => +j -i: the overlap on this axis ends */
  DEM_RULE_ADD         /* +i -j => -j +i: an overlap on this axis begins */
} dem_rule;

/* The rule by which `left`, `right` become `right`, `left`. */
dem_rule dem_sweep_rule(const dem_mark *left, const dem_mark *right);

/* One box that overlaps that of a particle of lower number. */
typedef struct {
  int other;
  int next; /* link to the next of the same particle, -1: the last */
} dem_link;

typedef struct {
  int n;
  int copies[3];      /* of each box on an axis: 2 where the box of the domain repeats */
  double *low, *high; /* (n x 3) ends of the boxes [m] */
  dem_mark *mark[3];  /* (2 n copies) in ascending order */
  int *head;          /* (n) first overlapping box of a greater number, -1: none */
  dem_link *link;     /* (link_capacity) overlaps, chained by particle; the free ones chained from free_link */
  int nlink, link_capacity, free_link;
  size_t capacity;  /* particles that there is memory for */
  long long anew;   /* comparisons of boxes when all was last made anew */
  double length[3]; /* of the domain where it repeats [m], else 0 */
} dem_sweep;

/* Bring the lists of marks and of overlaps up to date. Errors: TDM_ERR_MEMORY. */
tdm_status dem_sweep_update(dem_sweep *sweep, const dem_search_input *input);

/* Is the pair among the stored overlaps of bounding boxes? */
bool dem_sweep_stored(const dem_sweep *sweep, int i, int j);

void dem_sweep_free(dem_sweep *sweep);

#endif
