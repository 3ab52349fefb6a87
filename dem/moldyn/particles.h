/* Particle files of MOLDYN (.pin), [A07] Appendix A.1.1: their number, then a row each of 14 numbers: place, velocity,
 * angles, angular velocity, radius, and 1 for a particle that moves or 0 for one that never does. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_MOLDYN_PARTICLES_H
#define DEM_MOLDYN_PARTICLES_H

#include "protocol/base/status.h"
#include "protocol/math/pose.h"

#include <stdbool.h>

typedef struct {
  tdm_vec3 position; /* [m] */
  tdm_vec3 velocity; /* [m/s] */
  tdm_quat orientation;
  tdm_vec3 spin; /* angular velocity [rad/s] */
  double radius; /* [m] */
  bool moves;
} dem_pin_particle;

typedef struct {
  int count;
  dem_pin_particle *particle; /* (count) */
} dem_pin;

/* Read a file; *pin is to be freed, also after an error. The three angles are turns about x, then the new y, then the
 * new z: [A07] does not say which they are. In two dimensions only the one about y is not zero. path: JSON path for
 * errors, may be NULL. */
tdm_status dem_pin_read(dem_pin *pin, const char *file, const char *path, tdm_error *err);
void dem_pin_free(dem_pin *pin);

#endif
