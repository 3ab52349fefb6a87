/* The list of particles near walls: making it, chunk by chunk on all threads, and taking histories over. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SEARCH_NEAR_WALLS_H
#define DEM_SEARCH_NEAR_WALLS_H

#include "dem/state/data.h"

/* List which home particles are nearer to walls than the skin, with the histories of `before`, whose entries ascend by
 * chunk, wall, particle and part (NULL: without), and lower the bodies' margins to the gap of what is not listed. stay:
 * particles are in the chunks in which they were. Errors: TDM_ERR_MEMORY. */
tdm_status dem_near_walls_build(dem_data *data, const dem_wall_contacts *before, bool stay);

/* Give the entries from `first` to before `end` of a list the numbers that particles have now (now[old], NULL: the
 * same), and let them ascend again. Errors: TDM_ERR_MEMORY. */
tdm_status dem_near_walls_renumber(const dem_data *data, dem_wall_contacts *list, size_t first, size_t end,
                                   const int *now);

#endif
