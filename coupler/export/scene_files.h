/* The scene as an FMU has it: the sections that its side needs, resolved, with the files that they name. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_EXPORT_SCENE_FILES_H
#define CPL_EXPORT_SCENE_FILES_H

#include "coupler/export/serve/variables.h"

typedef struct {
  json_t *scene;  /* owned */
  json_t *files;  /* path in the scene -> "files/0_drum.stl"; owned */
  json_t *source; /* file -> "files/0_drum.stl"; owned */
} cpl_scene_files;

/* From the scene's root, which stays as it is. An error where a file that is named is not there. */
tdm_status cpl_scene_files_make(cpl_scene_files *made, cpl_export_side side, const json_t *root, tdm_error *err);
void cpl_scene_files_free(cpl_scene_files *made);

/* What a file is called in the FMU's resources; one that is new gets a name. Lives as long as `made`. */
const char *cpl_scene_files_name(cpl_scene_files *made, const char *file);

#endif
