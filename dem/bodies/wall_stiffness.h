/* How stiffly the particles hold the coupled bodies: the limit of the step for bodies that DEM moves itself. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_BODIES_WALL_STIFFNESS_H
#define DEM_BODIES_WALL_STIFFNESS_H

#include "dem/state/data.h"

/* Largest square of a frequency [1/s2] of the coupled bodies on the springs of their present contacts, the particles
 * held: the largest eigenvalue of B K J. K (6k x 6k) is the contacts' stiffness, 6 x 6 a body; with `nfree` independent
 * velocities J (6k x nfree) gives the k bodies' twists and B (nfree x 6k) what loads on the bodies (force, moment about
 * the centre of mass) add to their rates; both row by row, world axes, bodies in the order of the coupling. J B, the
 * mobility, is symmetric and positive semidefinite. An explicit step is stable below 2 over the root of this. 0 without
 * contacts; NAN: there are NaN or infinite numbers. All ranks ask for it. Errors: TDM_ERR_MEMORY. */
tdm_status dem_walls_rate2(dem_data *data, int nfree, const double *J, const double *B, double *rate2, tdm_error *err);

#endif
