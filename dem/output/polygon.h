/* Walls as polygons, for pictures and ParaView. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_OUTPUT_POLYGON_H
#define DEM_OUTPUT_POLYGON_H

#include "dem/output/snapshot.h"

/* The walls where they are now (freed by dem_polygons_free). */
tdm_status dem_polygons_make(dem_polygons *polygons, const dem_data *data, const dem_bounds *bounds, tdm_error *err);

#endif
