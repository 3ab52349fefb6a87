/* What there is to see of the engine, as protocol/view/view.h has it: the only place of the outputs that knows how the
 * engine keeps its particles and walls. Looking changes nothing of the run. */
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
  tdm_vec3 *born;  /* (nborn) [m] */
} dem_view;

/* The walls as polygons in the axes of their bodies (freed by dem_polygons_free). What has no end is cut to `bounds`.
 */
tdm_status dem_polygons_make(dem_polygons *polygons, const dem_data *data, const dem_bounds *bounds, tdm_error *err);

/* Walls, materials and size classes as they are now: body k of the model is body k of the scenery. Planes without end
 * are cut to the bounds of the present scene. */
tdm_status dem_view_scenery(dem_view *view, const dem_data *data, tdm_scenery *scenery, tdm_error *err);

/* Note where new particles are, if somebody looks. To be called often: a particle's `born` is the place at which this
 * first sees it. */
tdm_status dem_view_watch(dem_view *view, const dem_data *data, tdm_error *err);

/* The state at time t [s], with contacts if snapshot->with_contacts. Forces on triangles are those of the last step
 * that was asked to find them (dem_traction.wanted). */
tdm_status dem_view_snapshot(dem_view *view, const dem_data *data, double t, tdm_snapshot *snapshot, tdm_error *err);

void dem_view_free(dem_view *view);

/* Around the particles, the walls that have a size, and the sources; a cube of 1 m when there is none. */
dem_bounds dem_scene_bounds(const dem_data *data);

#endif
