/* Results in the formats of MOLDYN's viewers, [A07] Appendix A.1.2: particles.xb for XBALLS, scene.str for ANIM.
 *
 * particles.xb, of two dimensions: for each time a row "N t x_low z_low x_high z_high", the box, then a row a particle,
 * "x z v_x v_z r phi": its angle about the axis out of the plane [rad].
 * scene.str: the row "dt count 12", dt between two times, then for each time a row a particle and a row a wall of the
 * twelve numbers of its rotation matrix, row by row, and its place. A wall has the matrix of its body.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_OUTPUT_MOLDYN_FILES_H
#define DEM_OUTPUT_MOLDYN_FILES_H

#include "dem/output/view.h"
#include "protocol/results/results.h"

#include <stdio.h>

/* Zero-initialise; a file is open while it is written. */
typedef struct {
  FILE *xb, *str;
  bool begun;
  dem_bounds bounds; /* of the scene when it was written first */
} dem_moldyn_files;

/* Open those that are wanted; refuse what they cannot show. interval: between two times [s]. */
tdm_status dem_moldyn_open(dem_moldyn_files *files, bool xb, bool str, const dem_data *data, double interval,
                           const tdm_results *results, tdm_error *err);

/* Whether one is open. */
bool dem_moldyn_wanted(const dem_moldyn_files *files);

/* Write the state that the snapshot shows, with all particles, into those that are open. */
tdm_status dem_moldyn_write(dem_moldyn_files *files, const dem_data *data, const tdm_snapshot *snapshot,
                            tdm_error *err);

void dem_moldyn_close(dem_moldyn_files *files, tdm_error *err);

#endif
