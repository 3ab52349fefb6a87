/* Forces on the triangles of meshes, for outputs: taken in the steps that a run asks for (dem_traction.wanted), from
 * the contacts of that step themselves, so that they add up to the load on the body. A contact on an edge or at a
 * vertex counts for the lowest of its triangles.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_BODIES_TRACTION_H
#define DEM_BODIES_TRACTION_H

#include "dem/state/data.h"

/* Room for the present walls' list, before an evaluation. Errors: TDM_ERR_MEMORY. */
tdm_status dem_traction_reserve(dem_data *data);

/* Where the loops put the forces of entries, zeroed; NULL: they are not wanted. */
tdm_vec3 *dem_traction_entries(dem_data *data);

/* Forget the forces of the step before. */
void dem_traction_clear(dem_data *data);

/* Add a share of the forces of the entries to those of their triangles, in the order of the list. */
void dem_traction_add(dem_data *data, double share);

#endif
