/* The loops over pairs and walls, one of each for every row of the table. */
#ifndef DEM_CONTACT_LOOP_H
#define DEM_CONTACT_LOOP_H

#include "dem/contact/table.h"

/* does a tail clip the normal force at 0? */
enum { DEM_TAIL_IS_keep = 0, DEM_TAIL_IS_clip = 1 };

#define X(normal, tangential, tail, history)           \
  dem_loop dem_pairs_##normal##_##tangential##_##tail; \
  dem_loop dem_walls_##normal##_##tangential##_##tail;
DEM_LAW_LIST(X)
#undef X

#endif
