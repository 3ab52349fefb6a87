/* The records of a particle that the contact loops gather whole: one cache line, or half of one, a load; and what a
 * sphere weighs. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_BASE_SPHERE_H
#define DEM_BASE_SPHERE_H

#include "protocol/math/vec3.h"

#include <math.h>

/* What every contact looks at (64 bytes). */
typedef struct {
  tdm_vec3 position;   /* [m] */
  double radius;       /* [m] */
  tdm_vec3 velocity;   /* predicted for the end of the step [m/s] */
  double inverse_mass; /* [1/kg] */
} dem_sphere;

/* What a contact with friction looks at besides (32 bytes). */
typedef struct {
  tdm_vec3 surface; /* angular velocity, predicted for the end of the step, times the radius [m/s] */
  double radius;    /* [m] */
} dem_rotor;

/* How a particle moves (64 bytes). */
typedef struct {
  tdm_vec3 velocity; /* [m/s] */
  double unused;
  tdm_vec3 spin; /* angular velocity [rad/s] */
  double unused2;
} dem_pace;

/* The sums of a particle's contacts (64 bytes). */
typedef struct {
  tdm_vec3 force; /* [N] */
  double unused;
  tdm_vec3 twist; /* torque about the centre is -radius times this [N] */
  double unused2;
} dem_push;

/* Mass of a sphere [kg] of this density [kg/m3] and radius [m]. */
static inline double dem_sphere_mass(double density, double radius) {
  return density * 4.0 / 3 * M_PI * radius * radius * radius;
}

#endif
