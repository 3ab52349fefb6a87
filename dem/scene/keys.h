/* What the readers of the scene section "dem" share. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SCENE_KEYS_H
#define DEM_SCENE_KEYS_H

#include "dem/base/ranks.h"
#include "dem/model/model.h"

/* Three numbers whose square is a number too: of what is squared or divided by on the way. */
tdm_vec3 dem_read_vector(tdm_object *o, const char *key, const tdm_vec3 *fallback);

/* Refuse a mass [kg] whose square or inverse square double precision does not hold; `key` gives it. */
void dem_check_mass(tdm_object *o, const char *key, double mass);

/* Refuse a place [m] where neighbouring numbers are more than 1e-6 of the radius [m] apart: no contact could be told
 * there. `key` gives it. */
void dem_check_place(tdm_object *o, const char *key, tdm_vec3 place, double radius);

/* Unit vector across a unit axis at which angles about it begin: along x as far as that goes, where the axis is x
 * itself (to 1e-6) along y. */
tdm_vec3 dem_zero_angle(tdm_vec3 axis);

/* n items of `size` bytes, zeroed, the caller's to free; NULL and an error when memory runs out. */
void *dem_allocate(size_t n, size_t size, tdm_error *err);

/* A copy of a text, the caller's to free; NULL and an error when memory runs out. */
char *dem_copy_text(const char *text, tdm_error *err);

/* The key "name", at most so long, of what has channels of its own, which are named by it. The caller's to free; NULL
 * and an error when memory runs out. */
char *dem_read_name(tdm_object *o, size_t most);

/* The key "material" of an object as an index; 0 after an error. */
int dem_read_material(const dem_model *model, tdm_object *o);

/* The key `key` of an object as the index of a body; 0 after an error. */
int dem_read_body(const dem_model *model, tdm_object *o, const char *key);

/* Fail at `path` because dem.bodies has no body `name`; the nearest name is suggested. */
void dem_fail_unknown_body(const dem_model *model, const char *path, const char *name, tdm_error *err);

/* "particles" (an array, may be NULL; fill.c). Materials, bodies, plane and rotation are there already. ranks: as in
 * dem_model_read_on. */
void dem_fill_read(dem_model *model, json_t *particles, const dem_ranks *ranks, tdm_error *err);

/* The arrays "sources", "sinks" and "containers" (may be NULL; flow.c). Materials and bodies are there already. */
void dem_sources_read(dem_model *model, json_t *sources, tdm_error *err);
void dem_sinks_read(dem_model *model, json_t *sinks, tdm_error *err);
void dem_containers_read(dem_model *model, json_t *containers, tdm_error *err);

/* The key "screening" of the section, and the array "paths" (may be NULL; measures.c). Materials, bodies, sources and
 * sinks are there already. */
void dem_screening_read(dem_model *model, tdm_object *section);
void dem_traces_read(dem_model *model, json_t *paths, tdm_error *err);

/* The key "domain" of the section (domain.c). */
void dem_domain_read(dem_model *model, tdm_object *section);

/* Refuse a box that at any time of the run is too narrow for the images of particles up to this radius [m], planes
 * across a periodic direction, and sources outside. */
void dem_domain_check(const dem_model *model, double largest_radius, tdm_error *err);

/* Read "dimension", "plane" and "plane_at" (domain.c). */
void dem_read_dimension(dem_model *model, tdm_object *section);

#endif
