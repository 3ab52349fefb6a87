/* Opening the files that a scene or a command names: whatever lies under the name, nothing hangs and nothing is
 * endless. */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_SCENE_INPUT_H
#define TDM_SCENE_INPUT_H

#include <stdbool.h>
#include <stdio.h>

/* Open `file` for reading: a regular file or, with `stream`, also a pipe or a terminal, which the caller reads up to a
 * limit. NULL and the reason in *why (it lives until the next call of the thread) when there is none. */
FILE *tdm_open_input(const char *file, bool stream, const char **why);

#endif
