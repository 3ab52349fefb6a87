/* A solver's report, or another JSON object, for people. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_APP_PRINT_H
#define TDM_APP_PRINT_H

#include <jansson.h>

/* Print to standard output: a line a value, with its path. */
void tdm_print_json(const json_t *json);

#endif
