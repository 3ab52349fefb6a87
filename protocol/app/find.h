/* Where scenes are (a file, or the name of a scenario), and programs. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_APP_FIND_H
#define TDM_APP_FIND_H

#include "protocol/base/status.h"

#include <stdbool.h>
#include <stddef.h>

/* The scene file for `name`: a file of that name; one of the scenarios ("tumbler/five_deck.json"); or
 * GROUP/NAME/scene.json ("": NAME/scene.json). Scenarios are in --scenarios DIR (`dir`, may be NULL: then ./scenarios,
 * and share/tandem/scenarios beside the folder of the program). The error for a scenario of another group names the
 * program that runs it. */
tdm_status tdm_find_scene(char *out, size_t size, const char *group, const char *name, const char *dir, tdm_error *err);

/* A file of the scenarios, such as "tumbler/studies/speed.json": in --scenarios DIR (`dir`, may be NULL: where scenes
 * are looked for). */
tdm_status tdm_find_scenario_file(char *out, size_t size, const char *name, const char *dir, tdm_error *err);

/* The program `name` into out: a path as it is, else beside this program or in PATH. Returns whether there is one. */
bool tdm_find_program(char *out, size_t size, const char *name);

#endif
