/* A scene's own text with other values in it: see rewrite.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/parameters/rewrite.h"

#include "protocol/parameters/load.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* *text becomes the text with a value at `path`. */
static tdm_status put(char **text, const char *path, const char *value, tdm_error *err) {
  char *next = tdm_scene_text_with(*text, path, value);
  if (!next)
    return tdm_fail(err, TDM_ERR_SCENE, path, "cannot be written into the scene's text");
  free(*text);
  *text = next;
  return TDM_OK;
}

/* One "path=value" as --set takes it. */
static tdm_status put_setting(char **text, const char *setting, tdm_error *err) {
  char path[TDM_PATH_MAX];
  const char *equals = strchr(setting, '=');
  if (!equals)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "--set %s: write PATH=VALUE", setting);
  snprintf(path, sizeof path, "%.*s", (int)(equals - setting), setting);
  json_t *value = json_loads(equals + 1, JSON_DECODE_ANY, NULL), *word = value ? NULL : json_string(equals + 1);
  char *as_text = word ? json_dumps(word, JSON_ENCODE_ANY) : NULL;
  put(text, path, as_text ? as_text : equals + 1, err);
  json_decref(value);
  json_decref(word);
  free(as_text);
  return err->status;
}

/* Names of files that `read` has from the root, where the text has them from the folder of the scene. */
static void put_files(char **text, const json_t *written, const json_t *read, const char *path, tdm_error *err) {
  char at[TDM_PATH_MAX];
  const char *key;
  json_t *value;
  size_t i;
  if (json_is_string(written) && json_is_string(read) && !json_equal(written, read)) {
    char *name = json_dumps(read, JSON_ENCODE_ANY);
    if (name)
      put(text, path, name, err);
    free(name);
  }
  json_object_foreach((json_t *)written, key, value) {
    snprintf(at, sizeof at, "%s%s%s", path, *path ? "." : "", key);
    put_files(text, value, json_object_get(read, key), at, err);
  }
  json_array_foreach((json_t *)written, i, value) {
    snprintf(at, sizeof at, "%s[%zu]", path, i);
    put_files(text, value, json_array_get(read, i), at, err);
  }
}

/* The new text, which the caller frees; what it is after an error is of no use. */
static char *new_text(const char *file, const char *const *set, tdm_error *err) {
  tdm_scene scene = {0};
  char *text = NULL;
  if (tdm_scene_read(&scene, file, err) == TDM_OK && (text = strdup(scene.text)) != NULL) {
    json_t *written = json_loads(scene.text, 0, NULL);
    put_files(&text, written, scene.root, "", err);
    json_decref(written);
    for (; set && *set && err->status == TDM_OK; set++)
      put_setting(&text, *set, err);
  } else {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  }
  tdm_scene_destroy(&scene);
  return text;
}

tdm_status tdm_scene_rewrite(const char *scene, const char *const *set, const char *file, tdm_error *err) {
  char *text = new_text(scene, set, err);
  FILE *f = err->status == TDM_OK ? fopen(file, "w") : NULL;
  if (err->status == TDM_OK && (!f || fputs(text, f) < 0))
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno));
  if (f && fclose(f) != 0)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno));
  free(text);
  if (err->status == TDM_OK) {
    tdm_scene written = {0};
    tdm_scene_load(&written, file, NULL, err);
    tdm_scene_destroy(&written);
  }
  return err->status;
}
