/* The angle of repose of a heap: the slope of its surface on both sides. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_OUTPUT_REPOSE_H
#define DEM_OUTPUT_REPOSE_H

#include "protocol/view/view.h"

typedef struct {
  double low, high; /* angles of the flanks towards -axis and +axis [deg]; NaN: too few particles there */
  double mean;      /* of both */
} dem_repose;

/* Of the profile over the axis `along` (0: x, 1: y), height along z: the highest particle top in each strip that is one
 * largest particle wide; a line is fitted to a flank's strips between 15 and 85 % of the heap's height. */
dem_repose dem_repose_of(const tdm_snapshot *snapshot, int along);

#endif
