/* Sums over all chunks, in the order of the chunks: the same bits for any number of threads and ranks. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SEAM_SUMS_H
#define DEM_SEAM_SUMS_H

#include "dem/state/data.h"

/* Room for the loads and energies of the chunks there are. Errors: TDM_ERR_MEMORY. */
tdm_status dem_sums_reserve(dem_data *data);

/* Loads and energies of all chunks, on all ranks; returns the sum of `touching`. */
long dem_sums_of_step(dem_data *data, long touching);

#endif
