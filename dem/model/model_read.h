/* Reading the scene section "dem" into a model. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_MODEL_MODEL_READ_H
#define DEM_MODEL_MODEL_READ_H

#include "dem/model/model.h"

/* Fill *model (zeroed) from the assignment. The first error is left in err. */
void dem_model_read(dem_model *model, const tdm_assignment *assignment, tdm_error *err);

/* Three numbers whose square is a number too: of what is squared or divided by on the way. */
tdm_vec3 dem_read_vector(tdm_object *o, const char *key, const tdm_vec3 *fallback);

/* Refuse a mass [kg] whose square or inverse square double precision does not hold; `key` gives it. */
void dem_check_mass(tdm_object *o, const char *key, double mass);

/* Refuse a place [m] where neighbouring numbers are more than 1e-6 of the radius [m] apart: no contact could be told
 * there. `key` gives it. */
void dem_check_place(tdm_object *o, const char *key, tdm_vec3 place, double radius);

/* The key "material" of an object as an index; 0 after an error. */
int dem_read_material(const dem_model *model, tdm_object *o);

/* The key `key` of an object as the index of a body; 0 after an error. */
int dem_read_body(const dem_model *model, tdm_object *o, const char *key);

/* The arrays "sources" and "sinks" (may be NULL; flow_read.c). Materials and bodies are there already. */
void dem_sources_read(dem_model *model, json_t *sources, tdm_error *err);
void dem_sinks_read(dem_model *model, json_t *sinks, tdm_error *err);

#endif
