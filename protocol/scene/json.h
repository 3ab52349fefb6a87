/* Numbers in JSON, which knows no infinity and no NaN. */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_SCENE_JSON_H
#define TDM_SCENE_JSON_H

#include <jansson.h>
#include <math.h>

/* The number, or null where it is not finite (new reference). */
static inline json_t *tdm_number_to_json(double x) {
  return isfinite(x) ? json_real(x) : json_null();
}

#endif
