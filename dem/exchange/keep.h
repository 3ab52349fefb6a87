/* What a rank keeps. Arrays have places for all particles and for the entries of all lists, so that numbers mean the
 * same on all ranks; but only the pages take memory in which something of its home lies, or of what is or was near to
 * it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_EXCHANGE_KEEP_H
#define DEM_EXCHANGE_KEEP_H

#include "dem/state/data.h"

/* Forget what is not of home particles and their entries, when the lists are those of home and some of the rest may be
 * there (homes.spread); visitors come after. */
void dem_keep_home(dem_data *data);

/* For tests: write what is no number over all that is forgotten, so that it shows where it is used. */
extern bool dem_keep_poisons;

#endif
