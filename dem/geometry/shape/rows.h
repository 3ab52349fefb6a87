/* The shapes there are: one row each, the last part of the name of its dem_shape. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_SHAPE_ROWS_H
#define DEM_GEOMETRY_SHAPE_ROWS_H

#include "dem/geometry/wall/wall.h"

#define DEM_SHAPE_LIST(X) \
  X(plane)                \
  X(box)                  \
  X(cylinder)             \
  X(cone)                 \
  X(sphere)               \
  X(disc)                 \
  X(mesh)                 \
  X(screen)               \
  X(moldyn)

#define X(name) extern const dem_shape dem_shape_##name;
DEM_SHAPE_LIST(X)
#undef X

#endif
