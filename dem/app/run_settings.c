/* The sections time and output of a scene of particles alone. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/app/run.h"

#include <string.h>

static void read_repose(dem_run_settings *s, tdm_object *output) {
  static const char *const axes[] = {"x", "y"};
  s->repose_along = -1;
  if (!tdm_has(output, "repose"))
    return;
  tdm_object o = tdm_get_object(output, "repose", true);
  s->repose_along = tdm_get_choice(&o, "along", axes, 2, 0);
  tdm_object_close(&o);
}

/* "moldyn": files for the viewers of MOLDYN, written with each frame */
static void read_moldyn(dem_run_settings *s, tdm_object *output) {
  json_t *files = tdm_get_array(output, "moldyn", false);
  if (json_array_size(files) > 0 && s->outputs.particles_interval == 0)
    tdm_object_fail(output, "particles_interval", "missing: the files of output.moldyn are written at this interval");
  for (size_t i = 0; i < json_array_size(files) && !output->err->status; i++) {
    const char *name = json_string_value(json_array_get(files, i));
    bool xb = name && strcmp(name, "xb") == 0, str = name && strcmp(name, "str") == 0;
    char path[TDM_PATH_MAX];
    s->xb = s->xb || xb;
    s->str = s->str || str;
    if (!xb && !str)
      tdm_fail(output->err, TDM_ERR_SCENE, tdm_path(path, output, "moldyn", (int)i),
               "is no file of MOLDYN's viewers; give \"xb\" or \"str\"");
  }
}

tdm_status dem_run_settings_read(dem_run_settings *s, const tdm_scene *scene, tdm_error *err) {
  *s = (dem_run_settings){0};
  tdm_object root = tdm_object_open(scene->root, "", err);
  tdm_has(&root, "$schema");    /* for editors */
  tdm_has(&root, "parameters"); /* which expressions have used */
  tdm_get_string(&root, "title", "");
  tdm_standalone_refuse_coupling(&root, "mbd", "particles");
  tdm_check_gravity(&root);
  s->time = tdm_read_time(&root);
  tdm_object o = tdm_get_object(&root, "output", false);
  s->interval = tdm_read_interval(&o, "interval", 1e-3, s->time.dt);
  tdm_outputs_settings_read(&s->outputs, &o, scene->root, s->time.dt, s->time.end);
  read_moldyn(s, &o);
  read_repose(s, &o);
  tdm_object_close(&o);
  s->ranks = tdm_section_ranks(tdm_get_object(&root, "dem", true).json);
  tdm_object_close(&root);
  return err->status;
}

void dem_run_settings_free(dem_run_settings *s) {
  tdm_outputs_settings_free(&s->outputs);
}
