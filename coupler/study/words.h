/* Parts of a study from the words of a command line: lists of values, measures. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_STUDY_WORDS_H
#define CPL_STUDY_WORDS_H

#include "protocol/scene/scene.h"

enum { CPL_VALUES_MAX = 64 };

/* A path of the scene and the values that it takes. */
typedef struct {
  char path[TDM_PATH_MAX];
  int nvalue;
  char *value[CPL_VALUES_MAX]; /* owned, as --set takes them */
} cpl_axis;

/* Cut "1e-5,1e-4" (commas inside brackets, braces, parentheses and quotes do not count) into an axis without values.
 * Errors begin with the name of the command. The caller frees also after an error. */
tdm_status cpl_axis_read(cpl_axis *axis, const char *command, const char *path, const char *list, tdm_error *err);
void cpl_axis_free(cpl_axis *axis);

/* As an entry of a study's "axes", or its "seeds" (new reference). */
json_t *cpl_axis_to_json(const cpl_axis *axis);

/* A measure as an entry of a study's "measures" (new reference). A channel has a colon in it, and may say when:
 * "dem:particles.count@mean". All else is a path of summary.json. */
json_t *cpl_measure_to_json(const char *text);

#endif
