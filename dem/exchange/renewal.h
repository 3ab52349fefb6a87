/* Particles go to new homes, with their histories and entries: when they come in another order, and when homes move. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_EXCHANGE_RENEWAL_H
#define DEM_EXCHANGE_RENEWAL_H

#include "dem/state/data.h"

/* Each rank has its home's particles, and where lists are valid their entries, by its old home; then by the shares
 * `home` (ranks + 1). code (home particles): particles come in the order of their codes, with one code in the order
 * they had; NULL: they keep their numbers. Entries of pairs are then in rows, each from the lesser number, those of
 * walls in no order. No forces are there (push). All ranks call this. Errors: TDM_ERR_MEMORY. */
tdm_status dem_renew_homes(dem_data *data, const uint64_t *code, const double *home);

#endif
