/* What a run writes to be looked at: see outputs.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/output/outputs.h"

#include "protocol/scene/time_section.h"

#include <math.h>

/* ---- settings ---- */

/* forces on triangles have nowhere to go without files */
static void check_triangle_forces(const tdm_outputs_settings *s, tdm_object *output, const json_t *root) {
  const json_t *dem = json_object_get(root, "dem");
  if (json_is_true(json_object_get(dem, "triangle_forces")) && s->particles_interval == 0)
    tdm_object_fail(output, "particles_interval",
                    "missing: dem.triangle_forces go into the files for ParaView; give it, or remove that key");
}

void tdm_outputs_settings_read(tdm_outputs_settings *s, tdm_object *output, const json_t *root, double least) {
  *s = (tdm_outputs_settings){0};
  if (tdm_has(output, "particles_interval"))
    s->particles_interval = tdm_read_interval(output, "particles_interval", TDM_REQUIRED, least);
  check_triangle_forces(s, output, root);
}

bool tdm_outputs_doubt(const tdm_outputs_settings *s, double end, tdm_warning *warning) {
  if (s->particles_interval <= end * (1 + 1e-9))
    return false;
  *warning = (tdm_warning){.path = "output.particles_interval"};
  snprintf(warning->message, sizeof warning->message,
           "is %g s but the run ends at %g s: there will be frames of its start and its end only",
           s->particles_interval, end);
  return true;
}

double tdm_outputs_frames(const tdm_outputs_settings *s, double end) {
  return s->particles_interval > 0 ? ceil(end / s->particles_interval - 1e-6) + 1 : 0;
}

bool tdm_outputs_wanted(const tdm_outputs_settings *s) {
  return s->particles_interval > 0;
}

/* ---- when ---- */

double tdm_outputs_next(const tdm_outputs *o) {
  return o->frames ? o->next : INFINITY;
}

bool tdm_outputs_due(const tdm_outputs *o, double t) {
  return t >= tdm_outputs_next(o) - o->slack;
}

/* The state of time t is written. */
static void go_on(tdm_outputs *o, double t) {
  const double interval = o->settings->particles_interval;
  while ((double)o->grid * interval <= t + o->slack)
    o->grid++;
  o->next = t >= o->end - o->slack ? INFINITY : fmin((double)o->grid * interval, o->end);
}

/* ---- files ---- */

tdm_status tdm_outputs_begin(tdm_outputs *o, const tdm_outputs_settings *s, const tdm_results *results, double end,
                             double step, tdm_error *err) {
  o->settings = s;
  o->results = results;
  o->end = end;
  o->slack = 1e-6 * step;
  if (!tdm_outputs_wanted(s))
    return TDM_OK;
  o->parts = tdm_vtp_parts_of(&o->scenery);
  tdm_results_path(results, TDM_FRAMES_FILE, o->path, sizeof o->path);
  o->frames = tdm_results_file(results, TDM_FRAMES_FILE, err);
  if (!o->frames || tdm_frames_write_scenery(o->frames, o->path, &o->scenery, &o->bytes, err) != TDM_OK)
    return err->status;
  return tdm_pvd_open(&o->pvd, results, err);
}

tdm_status tdm_outputs_write(tdm_outputs *o, const tdm_snapshot *snapshot, tdm_error *err) {
  if (!tdm_outputs_due(o, snapshot->time))
    return TDM_OK;
  if (tdm_results_there(o->results, err) != TDM_OK ||
      tdm_vtp_write(o->results, o->pvd.number, &o->scenery, snapshot, err) != TDM_OK ||
      tdm_frames_write(o->frames, o->path, snapshot, &o->bytes, err) != TDM_OK ||
      tdm_pvd_add(&o->pvd, o->results, snapshot->time, o->parts, err) != TDM_OK)
    return err->status;
  go_on(o, snapshot->time);
  return TDM_OK;
}

void tdm_outputs_end(tdm_outputs *o) {
  if (o->frames)
    fclose(o->frames);
  tdm_pvd_close(&o->pvd);
  tdm_scenery_free(&o->scenery);
  tdm_snapshot_free(&o->snapshot);
  tdm_view_bytes_free(&o->bytes);
  *o = (tdm_outputs){0};
}
