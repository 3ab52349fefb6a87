/* The advice, and how it is told: see tell.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/advise/tell.h"

#include "protocol/parameters/rewrite.h"
#include "protocol/scene/json.h"
#include "protocol/version.h"

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
  printf("  %-24s %.3g s\n", "of processor time", a->processor);
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
                   "s:o, s:o, s:f}, s:O, s:O}",
                   "tandem", TDM_VERSION, "scene", scene, "found", (int)a->found, "settings",
                   settings_json(a, t->loaded.root), "limits", limits_json(a), "error", "wanted", a->wanted, "coupling",
                   tdm_number_to_json(a->coupling), "dem_step", tdm_number_to_json(a->dem_step), "round_off",
                   tdm_number_to_json(a->round_off), "estimate", tdm_number_to_json(a->estimate), "cost", "wall_s",
                   tdm_number_to_json(a->wall), "setup_s", tdm_number_to_json(a->setup), "loop_s",
                   tdm_number_to_json(a->loop), "processor_s", tdm_number_to_json(a->processor), "trials_s", a->trials,
                   "reasons", a->reasons, "trials", t->rows);
}

/* ---- the scene ---- */

tdm_status cpl_advice_write(const cpl_advice *a, const cpl_trials *t, const char *file, tdm_error *err) {
  char set[CPL_CANDIDATE_SETTINGS + 1][CPL_SETTING_LENGTH];
  const char **all = NULL;
  const int n = cpl_candidate_settings(&a->best, t->loaded.root, set);
  int given = 0;
  while (t->set && t->set[given])
    given++;
  all = calloc((size_t)(given + n) + 1, sizeof *all);
  if (!all)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int k = 0; k < given; k++)
    all[k] = t->set[k];
  for (int k = 0; k < n; k++)
    all[given + k] = set[k];
  tdm_scene_rewrite(t->scene, all, file, err);
  free(all);
  return err->status;
}
