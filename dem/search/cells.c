/* Linked cells: see cells.h. */
#include "dem/search/cells.h"

#include <stdlib.h>
#include <string.h>

/* bin of a coordinate; a coordinate without meaning (not finite, absurdly far) goes to bin 0 */
static int bin(double x, double size, int count) {
  double cell = floor(x / size);
  if (!(fabs(cell) < 1e15))
    return 0;
  long long r = (long long)cell % count;
  return (int)(r < 0 ? r + count : r);
}

static void bins(const dem_cells *cells, tdm_vec3 x, int out[3]) {
  out[0] = bin(x.x, cells->size, cells->count[0]);
  out[1] = bin(x.y, cells->size, cells->count[1]);
  out[2] = bin(x.z, cells->size, cells->count[2]);
}

/* as many cells as the particles' extent asks for, but not many more than there are particles */
static void choose_counts(dem_cells *cells, const dem_data *d) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  int np = d->nparticle;
  for (int i = 0; i < np; i++) {
    const double x[3] = {d->position[i].x, d->position[i].y, d->position[i].z};
    for (int a = 0; a < 3; a++) {
      low[a] = fmin(low[a], x[a]);
      high[a] = fmax(high[a], x[a]);
    }
  }
  for (int a = 0; a < 3; a++) {
    double n = (high[a] - low[a]) / cells->size + 2;
    cells->count[a] = n >= 1 && n < 1024 ? (int)n : n >= 1024 ? 1024 : 1;
  }
  const double most = 2.0 * np + 64;
  while ((double)cells->count[0] * cells->count[1] * cells->count[2] > most) {
    int a = cells->count[0] >= cells->count[1] && cells->count[0] >= cells->count[2] ? 0
            : cells->count[1] >= cells->count[2]                                     ? 1
                                                                                     : 2;
    cells->count[a] = (cells->count[a] + 1) / 2;
  }
}

bool dem_cells_fill(dem_cells *cells, dem_data *d, double size) {
  cells->size = size;
  choose_counts(cells, d);
  size_t ncell = (size_t)cells->count[0] * (size_t)cells->count[1] * (size_t)cells->count[2];
  dem_cell_grid *grid = &d->grid;
  if (grid->capacity < ncell) {
    int *first = realloc(grid->first, (2 * ncell + 1) * sizeof *first);
    if (!first)
      return false;
    grid->first = first;
    grid->capacity = 2 * ncell;
    d->ngrow++;
  }

  /* counting sort, which keeps the order */
  memset(grid->first, 0, (ncell + 1) * sizeof *grid->first);
  int np = d->nparticle;
  for (int i = 0; i < np; i++) {
    int b[3];
    bins(cells, d->position[i], b);
    grid->cell[i] = (b[2] * cells->count[1] + b[1]) * cells->count[0] + b[0];
    grid->first[grid->cell[i] + 1]++;
  }
  for (size_t c = 0; c < ncell; c++)
    grid->first[c + 1] += grid->first[c];
  for (int i = np - 1; i >= 0; i--)
    grid->particle[--grid->first[grid->cell[i] + 1]] = i;
  /* every entry but the first now stands at the start of its cell: shift by one */
  for (size_t c = 0; c < ncell; c++)
    grid->first[c] = grid->first[c + 1];
  grid->first[ncell] = np;
  return true;
}

/* the bins next to b in a direction of n bins, without repeating one */
static int beside(int b, int n, int out[3]) {
  int many = n < 3 ? n : 3;
  for (int k = 0; k < many; k++)
    out[k] = (b + (n < 3 ? k : k - 1) + n) % n;
  return many;
}

int dem_cells_near(const dem_cells *cells, const dem_data *d, int i, int near[27]) {
  int b[3], x[3], y[3], z[3], n = 0;
  bins(cells, d->position[i], b);
  int nx = beside(b[0], cells->count[0], x), ny = beside(b[1], cells->count[1], y);
  int nz = beside(b[2], cells->count[2], z);
  for (int c = 0; c < nz; c++)
    for (int e = 0; e < ny; e++)
      for (int a = 0; a < nx; a++)
        near[n++] = (z[c] * cells->count[1] + y[e]) * cells->count[0] + x[a];
  return n;
}
