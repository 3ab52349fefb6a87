/* The box dem.domain: open, periodic, strained.
 *
 * Open: a particle whose centre leaves the box is taken out at the end of the step and counted (ledger.left).
 * Periodic: positions are kept in [low, low + length); contacts are with the nearest image.
 * Strained: lengths are length_0 (1 + rate t), about the centre of the box, which stays; t is the time of the run. The
 * boundary so moves at a constant speed. Particles do not follow by themselves (no affine motion); the image that
 * stands k boxes away moves with k times the rate of the length more, and so does a particle that passes the boundary.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_PARTICLES_DOMAIN_H
#define DEM_PARTICLES_DOMAIN_H

#include "dem/state/data.h"

/* The box as at the start of the run. */
void dem_domain_begin(dem_data *data, int first, int end);

/* The box as it has been strained so far. */
void dem_domain_put(dem_data *data);

/* Strain the box for a further dt. */
void dem_domain_strain(dem_data *data, double dt);

/* Bring home particles back into the box along its periodic directions; of all ranks', count what that puts into them,
 * chunk by chunk. */
void dem_domain_wrap(dem_data *data);

/* a - b, or what it is to the nearest image of b */
static inline tdm_vec3 dem_between(const dem_data *d, tdm_vec3 a, tdm_vec3 b) {
  tdm_vec3 c = tdm_sub(a, b);
  if (d->model->domain.repeats)
    for (int k = 0; k < 3; k++)
      if (d->state.domain.periodic[k])
        (&c.x)[k] -= d->state.domain.length[k] * rint((&c.x)[k] / d->state.domain.length[k]);
  return c;
}

#endif
