/* Particles from a scene: single ones, blocks, random filling, and what is to be poured (pour.h). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SCENE_FILL_H
#define DEM_SCENE_FILL_H

#include "dem/model/model.h"

/* Read "particles" (an array, may be NULL) into the model, whose materials and bodies are there already. */
void dem_fill_read(dem_model *model, json_t *particles, tdm_error *err);

#endif
