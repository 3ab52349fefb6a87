/* What of walls is drawn: see outline.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/wall/outline.h"

#include <stdlib.h>

void dem_bounds_add(dem_bounds *b, tdm_vec3 x, double margin) {
  b->low = tdm_v3(fmin(b->low.x, x.x - margin), fmin(b->low.y, x.y - margin), fmin(b->low.z, x.z - margin));
  b->high = tdm_v3(fmax(b->high.x, x.x + margin), fmax(b->high.y, x.y + margin), fmax(b->high.z, x.z + margin));
}

void dem_bounds_add_box(dem_bounds *b, tdm_pose frame, tdm_vec3 half) {
  for (int k = 0; k < 8; k++) {
    tdm_vec3 corner = tdm_v3(k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z);
    dem_bounds_add(b, tdm_pose_point(frame, corner), 0);
  }
}

tdm_pose dem_frame_at(const tdm_pose *frame, tdm_vec3 point, tdm_quat turn) {
  bool turned = turn.w != 0 || turn.x != 0 || turn.y != 0 || turn.z != 0;
  return (tdm_pose){tdm_pose_point(*frame, point),
                    turned ? tdm_quat_mul(frame->orientation, turn) : frame->orientation};
}

tdm_status dem_polygons_add(dem_polygons *all, const dem_polygon *polygon, tdm_error *err) {
  if (all->count == all->capacity) {
    int room = 2 * all->capacity + 16;
    dem_polygon *grown = realloc(all->polygon, (size_t)room * sizeof *grown);
    if (!grown)
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d walls", all->count);
    all->polygon = grown;
    all->capacity = room;
  }
  all->polygon[all->count++] = *polygon;
  return TDM_OK;
}

void dem_polygons_free(dem_polygons *p) {
  free(p->polygon);
  *p = (dem_polygons){0};
}
