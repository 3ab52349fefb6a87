/* A solver's report, or another JSON object, for people: what is in it, row by row, and that as lines of a terminal. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_RESULTS_PRINT_H
#define TDM_RESULTS_PRINT_H

#include <jansson.h>

#include <stddef.h>

/* A value that is no object and no array as text; numbers are as short as they are read. Returns out. */
const char *tdm_json_text(const json_t *value, char *out, size_t size);

/* A row of a JSON value: the path of a value in it ("limits[0].step") that is neither an object nor an array of such;
 * an array of numbers or an empty one is one row. */
typedef void tdm_row_visitor(void *arg, const char *path, const json_t *value);

/* Go through all rows. */
void tdm_json_rows(const json_t *json, tdm_row_visitor *visit, void *arg);

/* Print to standard output: a line a row. */
void tdm_print_json(const json_t *json);

#endif
