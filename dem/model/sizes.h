/* Size distributions: the radii of the particles that an entry of the scene makes (its key "radius").
 *
 * A radius is the quantile of a number in [0, 1): the inverse of the distribution function, so that a draw takes one
 * number, always ends, and stays between min and max. The keys are in docs/scene.md.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_MODEL_SIZES_H
#define DEM_MODEL_SIZES_H

#include "protocol/scene/scene.h"

#include <stdint.h>

enum { DEM_SIZES_MAX = 64 }; /* radii in a list */

/* A plain value: it owns nothing. */
typedef struct {
  int distribution; /* row of the table in sizes.c */
  double min, max;  /* no radius is outside [m] */
  double mean;      /* normal: of the radius [m]; lognormal: of ln(radius/m); before it is cut to [min, max] */
  double deviation; /* likewise */
  int nradius;
  int total; /* list: particles in a lot that has exactly the counts of the scene; 0: each is drawn by itself */
  double radius[DEM_SIZES_MAX]; /* list: (nradius) [m] */
  double upto[DEM_SIZES_MAX];   /* list: (nradius) share by number of this radius and those before it */
} dem_sizes;

/* Read the key "radius" of an object: a number, [smallest, largest], or an object with a distribution. */
void dem_sizes_read(tdm_object *o, dem_sizes *sizes);

/* The radius that a share u of the particles, by number, does not exceed; 0 <= u < 1 [m]. */
double dem_sizes_quantile(const dem_sizes *sizes, double u);

/* The radius of particle k [m]. With counts, those of particles n total to (n + 1) total - 1 are a lot, in an order
 * mixed by the seed. */
double dem_sizes_draw(const dem_sizes *sizes, uint64_t seed, uint64_t k);

/* Mean radius by number [m]. */
double dem_sizes_mean(const dem_sizes *sizes);

#endif
