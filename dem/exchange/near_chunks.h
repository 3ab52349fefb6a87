/* Which parts of later chunks may have particles near to those of a rank's home. Every rank tells the others the boxes
 * of its chunks and their parts; from these, each pair of ranks knows which parts the one has to send and the other
 * will get. Only these spheres go from rank to rank when lists are made. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_EXCHANGE_NEAR_CHUNKS_H
#define DEM_EXCHANGE_NEAR_CHUNKS_H

#include "dem/state/data.h"

/* Runs of particles of later chunks of other ranks: run[2 k] ... run[2 k + 1] - 1. */
typedef struct {
  int *run;
  int nrun;
} dem_near_runs;

/* The particles of other ranks, later than home, that may be within `skin` [m] of touching a home particle: their
 * spheres are here afterwards. In the data's scratch memory. All ranks call this. Errors: TDM_ERR_MEMORY. */
tdm_status dem_near_chunks(dem_data *data, double skin, dem_near_runs *runs);

#endif
