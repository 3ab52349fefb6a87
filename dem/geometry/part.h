/* Where an STL file stands in its body.
 *
 * A body's own axes have their origin in the centre of mass; a file is drawn from an origin of its own, that of the
 * part. Both meet where mbd takes the mass from a file: mbd computes the centre of mass c of the file, and the part's
 * origin is at -c in body axes. So the same file without any placement is the same part in both solvers:
 *
 *     x_body = origin + position + R x_file         "frame": "part" (default); origin = -c, or 0 without such a file
 *     x_body = position + R x_file                  "frame": "body": from the centre of mass
 *     x_body = R0^T (position + R x_file - r0)      "frame": "world": as drawn in the world; R0, r0: the body's start
 *
 * R is the shape's "orientation", x_file times "scale". A body that is not coupled has its part's origin at its
 * "position".
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_PART_H
#define DEM_GEOMETRY_PART_H

#include "protocol/surface/stl.h"
#include "protocol/wire/participant.h"

typedef struct {
  const tdm_assigned_body *coupled; /* what the other solver says of the body; NULL: not coupled */
  tdm_pose start;                   /* of the body's own axes, world */
} dem_part;

/* Read "frame", "position", "orientation" and "elsewhere" of the shape `o` and take the corners of `stl` from the axes
 * of the file, times `scale` already, to the body's. The file that mbd takes this body's mass from must come out where
 * mbd has it, to a thousandth of its size, unless "elsewhere" is true: else it is an error. */
tdm_status dem_part_place(tdm_object *o, const dem_part *part, const char *file, double scale, tdm_stl *stl);

#endif
