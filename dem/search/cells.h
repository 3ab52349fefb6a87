/* Linked cells: particles binned in a grid of cells that repeats in all directions.
 *
 * A position maps to the cell floor(x/size) modulo the grid's counts. So a particle that flew far away costs nothing:
 * the grid stays as small as the number of particles asks for, and cells that share a bin only add candidates, which
 * the distance check refuses.
 */
#ifndef DEM_SEARCH_CELLS_H
#define DEM_SEARCH_CELLS_H

#include "dem/data.h"

typedef struct {
  double size;  /* edge of a cell [m] */
  int count[3]; /* cells in each direction */
} dem_cells;

/* Bin all particles in cells of at least `size` [m]; within a cell in ascending order. False: no memory. */
bool dem_cells_fill(dem_cells *cells, dem_data *data, double size);

/* The bins that can hold a neighbour of particle i within one cell size; returns their number. */
int dem_cells_near(const dem_cells *cells, const dem_data *data, int i, int near[27]);

#endif
