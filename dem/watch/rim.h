/* Particles that touch a wall of an open container beyond its rim, where a real one has no wall. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_WATCH_RIM_H
#define DEM_WATCH_RIM_H

#include "dem/state/data.h"

/* Look at the contacts with the planes of open containers that do not say that their walls are without end, and remark
 * on one that lies outside the box, over an open face or beside a wall, by more than the particle's radius. */
void dem_rim_look(dem_data *data, double t);

#endif
