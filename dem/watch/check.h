/* Checks of a state: particles that overlap at the start, and numbers that are no longer finite. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_WATCH_CHECK_H
#define DEM_WATCH_CHECK_H

#include "dem/state/data.h"

/* Refuse a start in which particles overlap each other or a wall by more than a tenth of a radius: they would fly
 * apart. Counts the particles that are behind a plane altogether in *nbehind: planes do not act on them. All
 * ranks check together, here and below. */
tdm_status dem_check_start(dem_data *data, int *nbehind, tdm_error *err);

/* Refuse a step of dt (at `path` of the scene) that is longer than half of the shortest contact: contacts would be over
 * between two steps. Not if the scene says dem.guard.action "warn"; if it says "stop", a twentieth is
 * the limit ([A07] Section 2.4.2). */
tdm_status dem_check_step(dem_data *data, double dt, const char *path, tdm_error *err);

/* The scene's entry that made particle i, and its number there (its id, if it came from a source). */
void dem_where(const dem_data *data, int i, char path[TDM_PATH_MAX], int *number);

/* TDM_ERR_NUMERIC when a particle's position or velocity is not finite at time t [s]. */
tdm_status dem_check_finite(dem_data *data, double t, tdm_error *err);

#endif
