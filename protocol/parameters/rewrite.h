/* A scene's own text with other values in it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_PARAMETERS_REWRITE_H
#define TDM_PARAMETERS_REWRITE_H

#include "protocol/base/status.h"

/* Write the scene of `scene` (a file) to `file` with the values of `set` ("path=value" as --set takes them,
 * NULL-terminated, may be NULL); all else stays as it is written, but names of files, which start at the folder of the
 * scene and become absolute. What was written is read again: an error of that names its place. */
tdm_status tdm_scene_rewrite(const char *scene, const char *const *set, const char *file, tdm_error *err);

#endif
