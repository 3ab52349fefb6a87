/* Cells of a region that particles are put into, one each. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_MODEL_CELLS_H
#define DEM_MODEL_CELLS_H

#include <math.h>

/* Of so many cells in each direction that looking at all of them would take for ever, leave `most`: the longest rows
 * get longer cells. Fewer stay as they are. */
static inline void dem_fewer_cells(double n[3], double most) {
  while (n[0] * n[1] * n[2] > most) {
    int a = n[0] >= n[1] && n[0] >= n[2] ? 0 : n[1] >= n[2] ? 1 : 2;
    double others = n[(a + 1) % 3] * n[(a + 2) % 3];
    n[a] = floor(fmax(most / others, 0.5 * n[a]));
  }
}

#endif
