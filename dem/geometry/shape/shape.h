/* The shapes of a scene. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_SHAPE_SHAPE_H
#define DEM_GEOMETRY_SHAPE_SHAPE_H

#include "dem/geometry/wall/wall.h"

/* Read one entry of a body's "shapes", geometry `geometry`, and append its walls (the list and what its walls own is
 * the caller's to free). */
void dem_shape_read(json_t *json, const char *path, int body, int geometry, dem_wall_list *list, tdm_error *err);

/* Add a shape to those that scenes can name, before the first scene is read. `shape` must stay. TDM_ERR_ARGUMENT: its
 * type or its number is there already, or there are too many. */
tdm_status dem_shape_add(const dem_shape *shape, tdm_error *err);

#endif
