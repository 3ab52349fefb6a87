/* Walls as polygons, for pictures and ParaView: see polygon.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/output/polygon.h"

tdm_status dem_polygons_make(dem_polygons *all, const dem_data *d, const dem_bounds *bounds, tdm_error *err) {
  const dem_model *m = d->model;
  all->count = 0;
  all->forces = d->work.traction.force != NULL;
  for (int w = 0; w < m->nwall && err->status == TDM_OK; w++) {
    const dem_wall *wall = &m->wall[w];
    const dem_wall_view view = {.place = &d->state.wall[w],
                                .pose = &d->state.pose[wall->body],
                                .bounds = bounds,
                                .box = m->box,
                                .nbox = m->nbox,
                                .lid = d->state.lid[w],
                                .force = all->forces ? &d->work.traction.force[m->first_triangle[w]] : NULL};
    if (wall->shape->polygons)
      wall->shape->polygons(wall, &view, all, err);
  }
  return err->status;
}
