/* What a scene chooses as its integrator: a row of functions. The integrators are in step/integrate.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_MODEL_INTEGRATOR_H
#define DEM_MODEL_INTEGRATOR_H

#include <stdbool.h>

struct dem_data;
struct dem_stride;

/* What an integrator keeps besides positions and velocities. */
typedef enum { DEM_KEEPS_NOTHING, DEM_KEEPS_VELOCITY, DEM_KEEPS_PLACE, DEM_KEEPS_FAST_FORCES } dem_keeping;

typedef struct dem_integrator {
  const char *name;
  bool driven; /* with body forces, fixed particles and two dimensions */
  dem_keeping keeps;
  /* First half of a step for chunk c: kick, drift, forces zeroed. Returns the largest |x - x_list - shift|^2 [m2], NaN
   * when a position is no number. */
  double (*begin)(struct dem_data *data, int chunk, const struct dem_stride *stride);
  /* Second half: reactions from other chunks added, kick. */
  void (*end)(struct dem_data *data, int chunk, double dt);
  /* What is kept for steps of dt, made from velocities and forces, for particles first ... end - 1; NULL: nothing. */
  void (*remember)(struct dem_data *data, int first, int end, double dt);
  /* multi-step: half a kick of the slow forces, which are in push; NULL: none */
  void (*kick)(struct dem_data *data, int chunk, double dt);
} dem_integrator;

extern const char *const dem_integrator_names[]; /* NULL-terminated */

/* The one of this name compiled for an instruction set of dem_simd_names; NULL: no such name. */
const dem_integrator *dem_integrator_find(const char *simd, const char *name, bool driven);

#endif
