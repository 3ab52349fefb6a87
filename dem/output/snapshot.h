/* The particles at one instant, as outputs need them: the only place of the outputs that knows how the engine keeps
 * its particles. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_OUTPUT_SNAPSHOT_H
#define DEM_OUTPUT_SNAPSHOT_H

#include "dem/state/data.h"

typedef struct {
  int count, capacity;
  int64_t *id;        /* (count) ascending */
  int32_t *material;  /* (count) */
  double *radius;     /* (count) [m] */
  tdm_vec3 *position; /* (count) [m] */
  tdm_vec3 *velocity; /* (count) [m/s] */
  tdm_vec3 *spin;     /* (count) [rad/s] */
} dem_snapshot;

/* Take one; arrays are reused and grown. */
tdm_status dem_snapshot_take(dem_snapshot *snapshot, const dem_data *data, tdm_error *err);
void dem_snapshot_free(dem_snapshot *snapshot);

/* Around the particles, the walls that have a size, and the sources; a cube of 1 m when there is none. */
dem_bounds dem_scene_bounds(const dem_data *data, const dem_snapshot *snapshot);

#endif
