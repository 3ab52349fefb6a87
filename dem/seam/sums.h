/* Sums over all chunks, in the order of the chunks: the same bits for any number of threads and ranks. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SEAM_SUMS_H
#define DEM_SEAM_SUMS_H

#include "dem/state/data.h"

/* What a chunk adds to each sum, all zero before; of: what dem_sum_chunks was given. */
typedef void dem_chunk_sums(const dem_data *data, int chunk, const void *of, double *sums);

/* n <= DEM_CHUNK_SUMS sums over all chunks, the same on all ranks, which all ask for them. */
void dem_sum_chunks(dem_data *data, int n, dem_chunk_sums *of_chunk, const void *of, double *sums);

/* Room for the loads and energies of the chunks there are. Errors: TDM_ERR_MEMORY. */
tdm_status dem_sums_reserve(dem_data *data);

/* Loads and energies of the chunks in a step, on all ranks; returns the sum of `touching`. */
long dem_sums_of_step(dem_data *data, long touching);

#endif
