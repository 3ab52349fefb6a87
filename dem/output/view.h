/* What there is to see of the engine, as protocol/view/view.h has it: the only place of the outputs that knows how the
 * engine keeps its particles and walls. Looking changes nothing of the run.
 *
 * On several ranks (seam/homes.h) all of them call dem_view_scenery, dem_view_watch, dem_view_share, dem_view_snapshot
 * and dem_scene_bounds together. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_OUTPUT_VIEW_H
#define DEM_OUTPUT_VIEW_H

#include "dem/state/data.h"
#include "protocol/view/view.h"

/* What a viewer remembers of a run. Zero-initialise; freed with dem_view_free. */
typedef struct {
  bool looks;    /* somebody has looked: new particles are to be noted from then on */
  int *triangle; /* (npolygon of the scenery) of model.ntriangle, -1: none; NULL: no forces are wanted */
  int npolygon;
  uint64_t nborn;  /* particles whose first place is known: ids below this */
  size_t capacity; /* of born */
  tdm_vec3 *born;  /* those that this rank keeps, of ids below nborn [m] */
} dem_view;

/* The walls as polygons in the axes of their bodies (freed by dem_polygons_free). What has no end is cut to `bounds`.
 */
tdm_status dem_polygons_make(dem_polygons *polygons, const dem_data *data, const dem_bounds *bounds, tdm_error *err);

/* Walls, materials and size classes as they are now, on rank 0: body k of the model is body k of the scenery. Planes
 * without end are cut to the bounds of the present scene. */
tdm_status dem_view_scenery(dem_view *view, const dem_data *data, tdm_scenery *scenery, tdm_error *err);

/* Note where new particles are, if somebody looks. To be called often: a particle's `born` is the place at which this
 * first sees it. */
tdm_status dem_view_watch(dem_view *view, const dem_data *data, tdm_error *err);

/* The state at time t [s]. Of particles each rank has a share: by their ids, wherever their home is, so that shares
 * are ranges of all particles in the order of the ids. On rank 0 there are also contacts, if snapshot->with_contacts,
 * and forces on triangles, those of the last step that was asked to find them (dem_traction.wanted). */
tdm_status dem_view_share(dem_view *view, const dem_data *data, double t, tdm_snapshot *snapshot, tdm_error *err);

/* The same with all particles, on rank 0. */
tdm_status dem_view_snapshot(dem_view *view, const dem_data *data, double t, tdm_snapshot *snapshot, tdm_error *err);

void dem_view_free(dem_view *view);

/* Around the walls that have a size, and the sources; low > high when there is none. */
dem_bounds dem_fixed_bounds(const dem_data *data);

/* The same with the particles; a cube of 1 m when there is none of these. */
dem_bounds dem_scene_bounds(const dem_data *data);

#endif
