/* Reading the scene section "dem": see docs/scene.md for its keys. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SCENE_SCENE_H
#define DEM_SCENE_SCENE_H

#include "dem/base/ranks.h"
#include "dem/model/model.h"

/* Read the assignment's section "dem". *model is set also after an error (the caller destroys it). */
tdm_status dem_model_read(dem_model **model, const tdm_assignment *assignment, tdm_error *err);

/* The same on one of several ranks (NULL: alone): of its home's particles alone it has places and motion. Of all, where
 * any are poured or read from a file of MOLDYN, or the scene has dem.start or dem.settle.store. */
tdm_status dem_model_read_on(dem_model **model, const tdm_assignment *assignment, const dem_ranks *ranks,
                             tdm_error *err);

#endif
