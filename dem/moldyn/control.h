/* Control files of MOLDYN (.cin), [A07] Appendix A.1.1, as scenes. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_MOLDYN_CONTROL_H
#define DEM_MOLDYN_CONTROL_H

#include "dem/moldyn/walls.h"

#include <jansson.h>

/* What a control file does not say. */
typedef struct {
  const char *particles, *walls; /* names of the .pin and .win files as the scene is to give them; walls: NULL: none */
  dem_win_form form;
  bool flat; /* two dimensions, in the plane of x and z */
} dem_cin_options;

/* A scene (a new reference) of a control file: its times, gravity, materials "particle" and "wall", contact laws and
 * pairs, with the particles and walls of the other two files, which are not read here. NULL: an error.
 *
 * Particles are hysteretic ([A07] Eq. 2.47) where sd.stiff_k_un is greater than sd.stiff_lo, and spring and dashpot
 * otherwise, with the damping sd.damp_particle, or the restitution sd.e where that is 0. Walls are spring and dashpot
 * (Eq. 2.61) of stiffness sd.stiff_lo with sd.damp_wall, or sd.e where that is 0. *notes: a new array of strings: what
 * of the file has no effect, and what was chosen. */
json_t *dem_cin_read(const char *file, const dem_cin_options *options, json_t **notes, tdm_error *err);

#endif
