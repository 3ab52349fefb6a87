/* Spheres sorted into cells of a grid that repeats in all directions.
 *
 * A position maps to the cell floor((x - low) / edge) modulo the grid's counts. So a sphere that flew far away costs
 * nothing: the grid stays as small as the number of spheres asks for, and cells that share a bin only add candidates,
 * which the distance refuses. A direction in which the box repeats has a whole number of cells to the box.
 *
 * The spheres are copied in the order of the cells: cells that are neighbours in x are neighbours in memory.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SEARCH_METHOD_BINS_H
#define DEM_SEARCH_METHOD_BINS_H

#include "dem/search/method/method.h"

enum { DEM_LANES = 8 }; /* spheres that are copied or compared at once; the arrays end in so many without meaning */

typedef struct {
  int count[3];              /* cells in each direction */
  double low[3], inverse[3]; /* of the grid [m], of a cell's edge [1/m] */
  int n;                     /* spheres */
  int *first;                /* (cells + 1) first sphere of each cell, in the order of the cells */
  int *index;                /* (n + DEM_LANES) number of the sphere in the input, in the order of the cells */
  double *x, *y, *z, *r;     /* (n + DEM_LANES) position and radius [m], in the order of the cells */
  int *cell;                 /* (n) cell of each sphere, in the order of the input */
} dem_bins;

/* from `begin` up to `end` in the order of the cells */
typedef struct {
  int begin, end;
} dem_run;

enum { DEM_MOST_RUNS = 18 }; /* nine rows of cells, each of which may cross the end of the grid */

/* Sort n spheres into cells of at least `edge` [m]; the arrays lie in the input's scratch memory. `member`: which of
 * the input's (n, ascending), NULL: all, n of them. Errors: TDM_ERR_MEMORY. */
tdm_status dem_bins_fill(dem_bins *bins, const dem_search_input *input, const int *member, int n, double edge);

/* The same without the spheres: as many cells as their extent asks for, but not many more than there are spheres. */
void dem_bins_grid(dem_bins *bins, const dem_search_input *input, const int *member, int n, double edge);

/* The cell of a position in each direction. */
void dem_bins_cell(const dem_bins *bins, const double x[3], int cell[3]);

/* The spheres in the cells x.begin ... x.end - 1, y, z and those around, each once, but only those from `from` on. */
int dem_bins_runs(const dem_bins *bins, dem_run x, int y, int z, int from, dem_run run[DEM_MOST_RUNS]);

/* Append the near pairs of the spheres `own` of bins `from` with the spheres of the runs of `bins`. `later`: the first
 * run is `own` itself, in which each sphere is paired with later ones only. */
void dem_bins_scan(const dem_bins *bins, const dem_run *run, int nrun, const dem_bins *from, dem_run own, bool later,
                   const dem_near *near, dem_found *found);

/* Append the near pairs among the spheres of the bins that part t of nthread finds. */
void dem_bins_pairs(const dem_bins *bins, const dem_near *near, int t, int nthread, dem_found *found);

#endif
