/* Where a sphere touches a wall. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_TOUCH_H
#define DEM_GEOMETRY_TOUCH_H

#include "protocol/math/vec3.h"

enum { DEM_TOUCHES_MAX = 32 }; /* of one sphere with one wall; of more the deepest are kept */

typedef struct {
  int part;        /* of the wall: the triangle of a mesh; 0 of a wall without parts */
  double gap;      /* of the sphere's centre from the surface [m] */
  tdm_vec3 normal; /* unit, from the surface towards the centre */
} dem_touch;

#endif
