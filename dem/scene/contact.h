/* Reading the scene's materials, contact laws and pairs: keys in docs/scene.md. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SCENE_CONTACT_H
#define DEM_SCENE_CONTACT_H

#include "dem/model/model.h"
#include "protocol/scene/scene.h"

/* dem.simd and dem.contact: the laws of the model; first, for what follows asks only for what they need. */
void dem_contact_read(dem_model *model, tdm_object *section);

void dem_materials_read(dem_model *model, json_t *array, tdm_error *err);

/* Fills model->pair. */
void dem_pairs_read(dem_model *model, json_t *array, tdm_error *err);

/* Every pair that can meet must be given. When particles, sources and bodies are there. */
void dem_pairs_check(const dem_model *model, tdm_error *err);

/* model->settle_pair: the pairs with dem.settle's restitution and friction, read here. */
void dem_settle_pairs_read(dem_model *model, tdm_object *settle);

/* Last: the loops, columns and reach that follow from all of it. TDM_ERR_SCENE: the laws remember more than a contact
 * has room for. */
void dem_contact_finish(dem_model *model, tdm_error *err);

#endif
