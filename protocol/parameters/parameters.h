/* The parameters of a scene: names and their values, numbers or expressions of each other in any order. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_PARAMETERS_PARAMETERS_H
#define TDM_PARAMETERS_PARAMETERS_H

#include "protocol/base/status.h"

#include <jansson.h>

typedef struct tdm_parameters tdm_parameters;

/* Read the section and compute all values. `section`: borrowed while they live, NULL: there are none. The caller
 * destroys *parameters, also after an error: what is no name, no number and no expression, names that are not there,
 * and parameters that need themselves (TDM_ERR_SCENE, at "parameters.NAME"). */
tdm_status tdm_parameters_read(tdm_parameters **parameters, const json_t *section, tdm_error *err);

/* Free them; *parameters is NULL then. */
void tdm_parameters_destroy(tdm_parameters **parameters);

/* The value of an expression (with its "=") that stands at `path`; 0 after an error. */
double tdm_parameters_evaluate(tdm_parameters *parameters, const char *expression, const char *path, tdm_error *err);

/* All of them, computed: an object of names to numbers (new reference). */
json_t *tdm_parameters_values(const tdm_parameters *parameters);

/* A number as JSON (new reference): whole ones without a decimal point. */
json_t *tdm_value_to_json(double value);

#endif
