/* A stored bed: what settling leaves, in a file that later runs start from (dem.settle.store). It is a stored state
 * (state_file.h) that is recognised by the fingerprint of everything that decides the bed, poses of the bodies
 * included. A run that starts from the file is bit-identical to the run that wrote it.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SETTLE_BED_H
#define DEM_SETTLE_BED_H

#include "dem/state/data.h"

/* How the settling of a bed went. */
typedef struct {
  bool rest;       /* the bed came to rest in time */
  bool pressed;    /* lids that are to be pressed reached their force in time, or there are none */
  bool stored;     /* it came from the file settle.store */
  double dt, time; /* step, and simulated time that it took [s] */
  double speed;    /* largest particle speed at the end, before velocities were set to 0 [m/s] */
} dem_settled;

/* Load settle.store into data, which is at the start; forces are not evaluated yet. *found is false when there is no
 * such file. Errors (path dem.settle.store): a file that is damaged or of another bed. */
tdm_status dem_bed_read(dem_data *data, dem_settled *settled, bool *found, tdm_error *err);

/* Refuse early what dem_bed_write could not write. */
tdm_status dem_bed_check_writable(const dem_model *model, tdm_error *err);

/* Write the bed to settle.store. */
tdm_status dem_bed_write(dem_data *data, const dem_settled *settled, tdm_error *err);

#endif
