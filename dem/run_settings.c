/* The sections time and output of a scene of particles alone. */
#include "dem/run.h"

#include <stdarg.h>
#include <stdio.h>

static void refuse_coupling(tdm_object *root) {
  static const char *const sections[] = {"mbd", "coupling"};
  for (int k = 0; k < 2; k++)
    if (tdm_has(root, sections[k]))
      tdm_object_fail(root, sections[k],
                      "belongs to a co-simulation; run this scene with tandem run, or remove the section to run its "
                      "particles alone");
}

static void read_repose(dem_run_settings *s, tdm_object *output) {
  static const char *const axes[] = {"x", "y"};
  s->repose_along = -1;
  if (!tdm_has(output, "repose"))
    return;
  tdm_object o = tdm_get_object(output, "repose", true);
  s->repose_along = tdm_get_choice(&o, "along", axes, 2, 0);
  tdm_object_close(&o);
}

static void warn(dem_run_settings *s, const char *path, const char *format, ...) __attribute__((format(printf, 3, 4)));

static void warn(dem_run_settings *s, const char *path, const char *format, ...) {
  tdm_warning *w = &s->warning[s->nwarning++];
  snprintf(w->path, sizeof w->path, "%s", path);
  va_list args;
  va_start(args, format);
  vsnprintf(w->message, sizeof w->message, format, args);
  va_end(args);
}

static void doubt(dem_run_settings *s) {
  if (s->interval > s->time.end * (1 + 1e-9))
    warn(s, "output.interval", "is %g s but the run ends at %g s: the time histories have its start and its end only",
         s->interval, s->time.end);
  if (s->pictures.late > 0)
    warn(s, "output.pictures.times", "%d of %d are later than time.end = %g s: there will be no such pictures",
         s->pictures.late, s->pictures.late + s->pictures.ntime, s->time.end);
}

tdm_status dem_run_settings_read(dem_run_settings *s, const tdm_scene *scene, tdm_error *err) {
  *s = (dem_run_settings){0};
  tdm_object root = tdm_object_open(scene->root, "", err);
  tdm_has(&root, "$schema"); /* for editors */
  tdm_get_string(&root, "title", "");
  refuse_coupling(&root);
  s->time = tdm_read_time(&root);
  tdm_object o = tdm_get_object(&root, "output", false);
  s->interval = tdm_read_interval(&o, "interval", 1e-3, s->time.dt);
  if (tdm_has(&o, "particles_interval"))
    s->particles_interval = tdm_read_interval(&o, "particles_interval", TDM_REQUIRED, s->time.dt);
  dem_picture_settings_read(&s->pictures, &o, s->time.end);
  read_repose(s, &o);
  tdm_object_close(&o);
  tdm_get_object(&root, "dem", true);
  tdm_object_close(&root);
  if (!err->status)
    doubt(s);
  return err->status;
}

void dem_run_settings_free(dem_run_settings *s) {
  dem_picture_settings_free(&s->pictures);
}
