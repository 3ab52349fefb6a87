/* The advice, and how it is told: see tell.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/advise/tell.h"

#include "protocol/parameters/load.h"
#include "protocol/scene/json.h"
#include "protocol/version.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

void cpl_because(cpl_advice *a, const char *format, ...) {
  char text[TDM_MESSAGE_MAX];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  tdm_utf8_clean(text);
  json_array_append_new(a->reasons, json_string(text));
  fprintf(stderr, "tandem: %s\n", text);
}

/* ---- the terminal ---- */

static void print_error(const char *what, double share) {
  if (!isnan(share))
    printf("  %-24s %.2g %%\n", what, 100 * share);
}

void cpl_advice_print(const cpl_advice *a, const json_t *root) {
  char set[CPL_CANDIDATE_SETTINGS + 1][CPL_SETTING_LENGTH];
  const int n = cpl_candidate_settings(&a->best, root, set);
  printf("settings\n");
  for (int k = 0; k < n; k++)
    printf("  %-24.*s %s\n", (int)strcspn(set[k], "="), set[k], strchr(set[k], '=') + 1);
  printf("error, of position and velocity beside their spread (wanted: %.2g %%)\n", 100 * a->wanted);
  print_error("of the exchange", a->coupling);
  print_error("of the DEM step", a->dem_step);
  print_error("of round-off", a->round_off);
  print_error("estimated by the run", a->estimate);
  printf("expected time of the run\n  %-24s %.3g s, %.3g s of it until the "
         "solvers are ready\n",
         "", a->wall, a->setup);
  printf("  %-24s %.3g s\n", "trials took", a->trials);
}

/* ---- JSON ---- */

static json_t *settings_json(const cpl_advice *a, const json_t *root) {
  char set[CPL_CANDIDATE_SETTINGS + 1][CPL_SETTING_LENGTH];
  json_t *settings = json_object();
  const int n = cpl_candidate_settings(&a->best, root, set);
  for (int k = 0; k < n; k++) {
    char *equals = strchr(set[k], '=');
    *equals = 0;
    json_object_set_new(settings, set[k], json_loads(equals + 1, JSON_DECODE_ANY, NULL));
  }
  return settings;
}

static json_t *limits_json(const cpl_advice *a) {
  json_t *limits = json_pack("{s:f, s:o, s:s}", "coordination", a->limits.coordination, "speed",
                             tdm_number_to_json(a->limits.speed), "decides", cpl_limit_names[a->step.by]);
  for (int k = 0; k < CPL_LIMITS; k++)
    json_object_set_new(
        limits, cpl_limit_names[k],
        json_pack("{s:o, s:f}", "time", tdm_number_to_json(a->limits.time[k]), "share", a->step.share[k]));
  return limits;
}

json_t *cpl_advice_to_json(const cpl_advice *a, const cpl_trials *t) {
  char scene[4096];
  snprintf(scene, sizeof scene, "%s", t->scene);
  tdm_utf8_clean(scene);
  return json_pack("{s:s, s:s, s:b, s:o, s:o, s:{s:f, s:o, s:o, s:o, s:o}, s:{s:o, s:o, "
                   "s:o, s:f}, s:O, s:O}",
                   "tandem", TDM_VERSION, "scene", scene, "found", (int)a->found, "settings",
                   settings_json(a, t->loaded.root), "limits", limits_json(a), "error", "wanted", a->wanted, "coupling",
                   tdm_number_to_json(a->coupling), "dem_step", tdm_number_to_json(a->dem_step), "round_off",
                   tdm_number_to_json(a->round_off), "estimate", tdm_number_to_json(a->estimate), "cost", "wall_s",
                   tdm_number_to_json(a->wall), "setup_s", tdm_number_to_json(a->setup), "loop_s",
                   tdm_number_to_json(a->loop), "trials_s", a->trials, "reasons", a->reasons, "trials", t->rows);
}

/* ---- the scene ---- */

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
  snprintf(path, sizeof path, "%.*s", (int)(equals - setting), setting);
  json_t *value = json_loads(equals + 1, JSON_DECODE_ANY, NULL), *word = value ? NULL : json_string(equals + 1);
  char *as_text = word ? json_dumps(word, JSON_ENCODE_ANY) : NULL;
  put(text, path, as_text ? as_text : equals + 1, err);
  json_decref(value);
  json_decref(word);
  free(as_text);
  return err->status;
}

/* Names of files that `read` has from the root, where the text has them from
 * the folder of the scene. */
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

static char *new_text(const cpl_advice *a, const cpl_trials *t, tdm_error *err) {
  char set[CPL_CANDIDATE_SETTINGS + 1][CPL_SETTING_LENGTH];
  tdm_scene scene = {0};
  char *text = NULL;
  if (tdm_scene_read(&scene, t->scene, err) == TDM_OK && (text = strdup(scene.text)) != NULL) {
    json_t *written = json_loads(scene.text, 0, NULL);
    put_files(&text, written, scene.root, "", err);
    json_decref(written);
    for (int k = 0; t->set && t->set[k] && err->status == TDM_OK; k++)
      put_setting(&text, t->set[k], err);
    const int n = cpl_candidate_settings(&a->best, t->loaded.root, set);
    for (int k = 0; k < n && err->status == TDM_OK; k++)
      put_setting(&text, set[k], err);
  } else {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  }
  tdm_scene_destroy(&scene);
  return text;
}

tdm_status cpl_advice_write(const cpl_advice *a, const cpl_trials *t, const char *file, tdm_error *err) {
  char *text = new_text(a, t, err);
  FILE *f = err->status == TDM_OK ? fopen(file, "w") : NULL;
  if (err->status == TDM_OK && (!f || fputs(text, f) < 0))
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno));
  if (f && fclose(f) != 0)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno));
  free(text);
  if (err->status == TDM_OK) {
    tdm_scene scene = {0};
    tdm_scene_load(&scene, file, NULL, err);
    tdm_scene_destroy(&scene);
  }
  return err->status;
}
