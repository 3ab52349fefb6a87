/* A scene as programs get it: read, overridden, its parameters put in. The one place where expressions become numbers.
 *
 *   "parameters": {"rpm": 50, "omega": "=rpm*2*pi/60"}   names and numbers
 *   "rate": "=omega"                                      an expression, wherever a number stands
 *   {"if": "=mode == 1", "name": …}                       in a list: an object that is left out where `if` is 0 or
 * false
 *
 * Afterwards scene->root has numbers alone, also under "parameters", and no "if"; scene->written is what the file and
 * the overrides say. A scene that uses none of this is the same as it was read.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_PARAMETERS_LOAD_H
#define TDM_PARAMETERS_LOAD_H

#include "protocol/scene/scene.h"

/* Read a scene file, apply overrides "path=value" (NULL-terminated, may be NULL), and resolve it. The caller destroys
 * *scene, also after an error; tdm_scene_locate names the place of that. */
tdm_status tdm_scene_load(tdm_scene *scene, const char *file, const char *const *set, tdm_error *err);

/* Put in the parameters of a scene that was read; one that is resolved stays. */
tdm_status tdm_scene_resolve(tdm_scene *scene, tdm_error *err);

/* The stored scene of a run, as it ran: `written` (stolen) with its parameters put in (new reference). NULL stays NULL,
 * what cannot be resolved stays as it is. */
json_t *tdm_scene_as_run(json_t *written);

/* The parameters of a scene that is resolved, and their values (borrowed); NULL: it has none. */
const json_t *tdm_scene_parameters(const tdm_scene *scene);

/* A notice if the scene has parameters that nothing uses. */
void tdm_scene_remark_unused(const tdm_scene *scene);

/* Print the parameters with their values and expressions, if there are some. */
void tdm_scene_print_parameters(const tdm_scene *scene);

#endif
