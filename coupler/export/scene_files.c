/* The scene as an FMU has it: see scene_files.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/export/scene_files.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

const char *cpl_scene_files_name(cpl_scene_files *made, const char *file) {
  static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";
  char name[128];
  const char *last = strrchr(file, '/');
  if (!json_object_get(made->source, file)) {
    snprintf(name, sizeof name, "files/%zu_%.100s", json_object_size(made->source), last ? last + 1 : file);
    for (char *c = name + strlen("files/"); *c; c++)
      *c = strchr(letters, *c) ? *c : '_';
    json_object_set_new(made->source, file, json_string(name));
  }
  return json_string_value(json_object_get(made->source, file));
}

static void add_file(cpl_scene_files *made, const char *path, const char *file, tdm_error *err) {
  if (access(file, R_OK) != 0)
    tdm_fail(err, TDM_ERR_FILE, path, "the file \"%s\" cannot be read, and the FMU is to have it", file);
  else
    json_object_set_new(made->files, path, json_string(cpl_scene_files_name(made, file)));
}

/* All keys "file" in what is below `path`. */
static void find_files(cpl_scene_files *made, const json_t *json, const char *path, tdm_error *err) {
  char below[TDM_PATH_MAX];
  const char *key;
  json_t *value;
  size_t i;
  if (json_is_array(json)) {
    json_array_foreach(json, i, value) {
      snprintf(below, sizeof below, "%s[%zu]", path, i);
      find_files(made, value, below, err);
    }
    return;
  }
  json_object_foreach((json_t *)json, key, value) {
    snprintf(below, sizeof below, "%s.%s", path, key);
    if (strcmp(key, "file") == 0 && json_is_string(value))
      add_file(made, below, json_string_value(value), err);
    else
      find_files(made, value, below, err);
  }
}

/* Stored particles. A bed that is not there yet stays away: the FMU settles one for itself. */
static void find_stored(cpl_scene_files *made, json_t *dem, tdm_error *err) {
  json_t *settle = json_object_get(dem, "settle");
  const char *start = json_string_value(json_object_get(dem, "start"));
  const char *store = json_string_value(json_object_get(settle, "store"));
  if (start)
    add_file(made, "dem.start", start, err);
  if (store && access(store, R_OK) == 0)
    add_file(made, "dem.settle.store", store, err);
  else if (store)
    json_object_del(settle, "store");
}

/* What is the FMU's own affair: who starts what, where results go. */
static void leave_out(json_t *root, cpl_export_side side) {
  static const char *const keys[] = {"$schema", "output", "scenario"};
  json_t *coupling = json_object_get(root, "coupling"), *solvers = json_object_get(coupling, "solvers");
  for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
    json_object_del(root, keys[i]);
  json_object_del(coupling, "transport");
  json_object_del(coupling, "address");
  if (!cpl_is_foreign(root, CPL_DEM))
    json_object_del(json_object_get(root, "dem"), "ranks"); /* one process in another program */
  for (int r = 0; r < CPL_NROLE; r++)
    if (!cpl_export_has(side, (cpl_role)r)) {
      json_object_set_new(root, cpl_role_names[r], json_object());
      json_object_del(solvers, cpl_role_names[r]);
    }
}

tdm_status cpl_scene_files_make(cpl_scene_files *made, cpl_export_side side, const json_t *root, tdm_error *err) {
  *made = (cpl_scene_files){.scene = json_deep_copy(root), .files = json_object(), .source = json_object()};
  if (!made->scene || !made->files || !made->source)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  leave_out(made->scene, side);
  for (int r = 0; r < CPL_NROLE; r++)
    find_files(made, json_object_get(made->scene, cpl_role_names[r]), cpl_role_names[r], err);
  if (cpl_export_has(side, CPL_DEM))
    find_stored(made, json_object_get(made->scene, "dem"), err);
  const char *path;
  json_t *name;
  json_object_foreach(made->files, path, name) { /* no paths of this machine */
    char key[TDM_PATH_MAX];
    snprintf(key, sizeof key, "%s", path);
    char *last = strrchr(key, '.');
    *last = 0;
    json_object_set((json_t *)tdm_scene_value(made->scene, key), last + 1, name);
  }
  return err->status;
}

void cpl_scene_files_free(cpl_scene_files *made) {
  json_decref(made->scene);
  json_decref(made->files);
  json_decref(made->source);
  *made = (cpl_scene_files){0};
}
