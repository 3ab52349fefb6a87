/* Placing STL files: see part.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/part.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool same_file(const char *a, const char *b) {
  char *whole[2] = {realpath(a, NULL), realpath(b, NULL)};
  bool same = strcmp(whole[0] ? whole[0] : a, whole[1] ? whole[1] : b) == 0;
  free(whole[0]);
  free(whole[1]);
  return same;
}

/* the file's axes in the body's */
static tdm_pose read_place(tdm_object *o, const dem_part *part) {
  static const char *const frames[] = {"part", "body", "world"};
  enum { PART, BODY, WORLD };
  int frame = tdm_get_choice(o, "frame", frames, 3, PART);
  tdm_pose place = {.position = tdm_get_vec3(o, "position", &(tdm_vec3){0, 0, 0}),
                    .orientation = tdm_get_orientation(o, "orientation")};
  if (frame == PART && part->coupled)
    place.position = tdm_add(part->coupled->origin, place.position);
  if (frame == WORLD) {
    tdm_quat back = tdm_quat_conj(part->start.orientation);
    place.position = tdm_quat_rotate(back, tdm_sub(place.position, part->start.position));
    place.orientation = tdm_quat_mul(back, place.orientation);
  }
  return place;
}

/* the longest edge of the box around the corners [m] */
static double size_of(const tdm_stl *stl) {
  tdm_vec3 low = stl->corner[0], high = low;
  for (int k = 1; k < 3 * stl->count; k++) {
    tdm_vec3 x = stl->corner[k];
    low = tdm_v3(fmin(low.x, x.x), fmin(low.y, x.y), fmin(low.z, x.z));
    high = tdm_v3(fmax(high.x, x.x), fmax(high.y, x.y), fmax(high.z, x.z));
  }
  return fmax(high.x - low.x, fmax(high.y - low.y, high.z - low.z));
}

tdm_status dem_part_place(tdm_object *o, const dem_part *part, const char *file, double scale, tdm_stl *stl) {
  const double share = 1e-3; /* of the size: what counts as another place */
  tdm_pose place = read_place(o, part);
  bool elsewhere = tdm_get_bool(o, "elsewhere", false);
  const tdm_assigned_body *other = part->coupled;
  bool same = other && other->mesh && same_file(file, other->mesh);
  if (elsewhere && !same)
    tdm_object_fail(o, "elsewhere", "is for the file that mbd takes the mass of the coupled body from; remove it");
  if (o->err->status)
    return o->err->status;

  double size = size_of(stl), apart = 0;
  for (int k = 0; k < 3 * stl->count; k++) {
    tdm_vec3 drawn = stl->corner[k];
    stl->corner[k] = tdm_pose_point(place, drawn);
    if (same) {
      tdm_vec3 there = tdm_axpy(other->scale / scale, drawn, other->origin);
      apart = fmax(apart, tdm_norm(tdm_sub(stl->corner[k], there)));
    }
  }
  if (same && !elsewhere && apart > share * size)
    tdm_object_fail(o, NULL,
                    "stands up to %.3g m from where mbd has this body, whose mass it takes from the same file: remove "
                    "\"position\", \"orientation\" and \"frame\" and give the same \"scale\" (both sections have the "
                    "file's origin in one point then), or set \"elsewhere\": true if that is meant",
                    apart);
  return o->err->status;
}
