/* Forces on the triangles of meshes: see traction.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/bodies/traction.h"

#include "dem/seam/homes.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

tdm_status dem_traction_reserve(dem_data *d) {
  dem_traction *t = &d->work.traction;
  if (!t->wanted)
    return TDM_OK;
  if (!t->force)
    t->force = calloc((size_t)d->model->ntriangle, sizeof *t->force);
  if (!t->entry_force || t->capacity < d->lists.walls.count) {
    free(t->entry_force);
    t->capacity = d->lists.walls.capacity + 1;
    t->entry_force = malloc(t->capacity * sizeof *t->entry_force);
  }
  return t->force && t->entry_force ? TDM_OK : TDM_ERR_MEMORY;
}

tdm_vec3 *dem_traction_entries(dem_data *d) {
  dem_traction *t = &d->work.traction;
  if (!t->wanted)
    return NULL;
  assert(t->capacity >= d->lists.walls.count);
  memset(t->entry_force, 0, d->lists.walls.count * sizeof *t->entry_force);
  return t->entry_force;
}

void dem_traction_clear(dem_data *d) {
  if (d->work.traction.wanted)
    memset(d->work.traction.force, 0, (size_t)d->model->ntriangle * sizeof *d->work.traction.force);
}

void dem_traction_add(dem_data *d, double share) {
  const dem_traction *t = &d->work.traction;
  if (t->wanted)
    dem_unite(d, DEM_LISTS);
  for (size_t k = 0; t->wanted && k < d->lists.walls.count; k++) {
    const dem_wall_entry *e = &d->lists.walls.entry[k];
    if (!d->model->wall[e->wall].shape->parts)
      continue;
    tdm_vec3 *sum = &t->force[d->model->first_triangle[e->wall] + e->part];
    *sum = tdm_axpy(-share, t->entry_force[k], *sum);
  }
}
