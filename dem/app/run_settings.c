/* The sections time and output of a scene of particles alone. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/app/run.h"

static void read_repose(dem_run_settings *s, tdm_object *output) {
  static const char *const axes[] = {"x", "y"};
  s->repose_along = -1;
  if (!tdm_has(output, "repose"))
    return;
  tdm_object o = tdm_get_object(output, "repose", true);
  s->repose_along = tdm_get_choice(&o, "along", axes, 2, 0);
  tdm_object_close(&o);
}

tdm_status dem_run_settings_read(dem_run_settings *s, const tdm_scene *scene, tdm_error *err) {
  *s = (dem_run_settings){0};
  tdm_object root = tdm_object_open(scene->root, "", err);
  tdm_has(&root, "$schema"); /* for editors */
  tdm_get_string(&root, "title", "");
  tdm_standalone_refuse_coupling(&root, "mbd", "particles");
  tdm_check_gravity(&root);
  s->time = tdm_read_time(&root);
  tdm_object o = tdm_get_object(&root, "output", false);
  s->interval = tdm_read_interval(&o, "interval", 1e-3, s->time.dt);
  tdm_outputs_settings_read(&s->outputs, &o, scene->root, s->time.dt, s->time.end);
  read_repose(s, &o);
  tdm_object_close(&o);
  tdm_get_object(&root, "dem", true);
  tdm_object_close(&root);
  return err->status;
}

void dem_run_settings_free(dem_run_settings *s) {
  tdm_outputs_settings_free(&s->outputs);
}
