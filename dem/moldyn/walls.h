/* Wall files of MOLDYN (.win), [A07] Appendix A.1.1: their number and thickness d_w, then a row each.
 *
 * By normals: the unit normal towards the particles and a point, the wall's centre. The wall is a plane, whose surface
 * is d_w/2 in front of that point ([A07] Eq. 2.60 with the wall's own normal).
 * By end points: two points a and b in the plane of x and z, of three coordinates each with the same y, or of two. The
 * wall reaches from a to b and, along y, without end; its normal is to the left of a -> b as seen with x to the right
 * and z up, so that b -> a has the opposite one.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_MOLDYN_WALLS_H
#define DEM_MOLDYN_WALLS_H

#include "protocol/base/status.h"
#include "protocol/math/vec3.h"

#include <stdbool.h>

typedef enum { DEM_WIN_NORMALS, DEM_WIN_END_POINTS } dem_win_form;

typedef struct {
  tdm_vec3 normal; /* unit; by end points: of a -> b */
  tdm_vec3 at;     /* centre, or a [m] */
  tdm_vec3 to;     /* by end points: b [m] */
  long line;       /* of the file */
} dem_win_wall;

typedef struct {
  int count;
  double thickness;   /* d_w [m] */
  dem_win_wall *wall; /* (count) */
} dem_win;

/* Read a file; *win is to be freed, also after an error. path: JSON path for errors, may be NULL.
 * fits: refuse walls that do not fit each other. By normals: two that face each other are one as far as the other from
 * the centres of the walls across, or the box is not the one that is meant; two that face away from each other leave
 * no room. By end points: ends that nearly meet, and neighbours that run against each other. */
tdm_status dem_win_read(dem_win *win, const char *file, dem_win_form form, bool fits, const char *path, tdm_error *err);
void dem_win_free(dem_win *win);

#endif
