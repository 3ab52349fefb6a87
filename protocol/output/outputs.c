/* What a run writes to be looked at: see outputs.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/output/outputs.h"

#include "protocol/scene/remark.h"
#include "protocol/scene/time_section.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <string.h>

/* ---- settings ---- */

/* forces on triangles have nowhere to go without files */
static void check_triangle_forces(const tdm_outputs_settings *s, tdm_object *output, const json_t *root) {
  const json_t *dem = json_object_get(root, "dem");
  if (json_is_true(json_object_get(dem, "triangle_forces")) && s->particles_interval == 0)
    tdm_object_fail(output, "particles_interval",
                    "missing: dem.triangle_forces go into the files for ParaView; give it, or remove that key");
}

static void check_contacts(const tdm_outputs_settings *s, tdm_object *output) {
  if (s->contacts && s->particles_interval == 0)
    tdm_object_fail(output, "contacts",
                    "goes into frames, of which there are none; give \"particles_interval\", or leave it out: pictures "
                    "whose color is \"contact_force\" do without");
}

void tdm_outputs_settings_read(tdm_outputs_settings *s, tdm_object *output, const json_t *root, double least,
                               double end) {
  *s = (tdm_outputs_settings){0};
  if (tdm_has(output, "particles_interval"))
    s->particles_interval = tdm_read_interval(output, "particles_interval", TDM_REQUIRED, least);
  s->contacts = tdm_get_bool(output, "contacts", false);
  tdm_pictures_read(&s->pictures, output, end);
  s->pictures_json = json_incref(json_object_get(output->json, "pictures"));
  check_triangle_forces(s, output, root);
  check_contacts(s, output);
}

void tdm_outputs_settings_free(tdm_outputs_settings *s) {
  tdm_pictures_free(&s->pictures);
  json_decref(s->pictures_json);
  s->pictures_json = NULL;
}

static bool frames_doubt(const tdm_outputs_settings *s, double end, tdm_warning *warning) {
  if (s->particles_interval <= end * (1 + 1e-9))
    return false;
  tdm_warning_set(warning, "output.particles_interval",
                  "is %g s but the run ends at %g s: there will be frames of its start and its end only",
                  s->particles_interval, end);
  return true;
}

/* times of view i after the end */
static bool times_doubt(const tdm_outputs_settings *s, double end, int i, tdm_warning *warning) {
  const tdm_picture *p = &s->pictures.picture[i];
  if (p->late == 0)
    return false;
  *warning = (tdm_warning){.path = "output.pictures.times"};
  if (json_is_array(s->pictures_json))
    snprintf(warning->path, sizeof warning->path, "output.pictures[%d].times", i);
  snprintf(warning->message, sizeof warning->message,
           "%d of %d are later than time.end = %g s: there will be no such pictures", p->late, p->late + p->ntime, end);
  return true;
}

bool tdm_outputs_doubt(const tdm_outputs_settings *s, double end, int k, tdm_warning *warning) {
  if (frames_doubt(s, end, warning) && k-- == 0)
    return true;
  for (int i = 0; i < s->pictures.count; i++)
    if (times_doubt(s, end, i, warning) && k-- == 0)
      return true;
  return false;
}

void tdm_outputs_print(const tdm_outputs_settings *s, double end) {
  if (s->particles_interval > 0)
    printf("  %-28s every %g s: %.0f\n", "frames for ParaView", s->particles_interval,
           ceil(end / s->particles_interval - 1e-6) + 1);
  for (int i = 0; i < s->pictures.count; i++) {
    const tdm_picture *p = &s->pictures.picture[i];
    printf("  %-28s %d%s%s\n", i ? "" : "pictures", p->ntime, *p->name ? ", " : "", p->name);
  }
}

bool tdm_outputs_wanted(const tdm_outputs_settings *s) {
  return s->particles_interval > 0 || s->pictures.count > 0;
}

/* ---- when ---- */

static double next_frame(const tdm_outputs *o) {
  return o->frames ? o->next : INFINITY;
}

/* of view i */
static double next_picture(const tdm_outputs *o, int i) {
  const tdm_picture *p = &o->settings->pictures.picture[i];
  return o->drawer.drawn && o->drawer.drawn[i] < p->ntime ? p->time[o->drawer.drawn[i]] : INFINITY;
}

double tdm_outputs_next(const tdm_outputs *o) {
  double next = next_frame(o);
  for (int i = 0; o->settings && i < o->settings->pictures.count; i++)
    next = fmin(next, next_picture(o, i));
  return next;
}

bool tdm_outputs_due(const tdm_outputs *o, double t) {
  return t >= tdm_outputs_next(o) - o->slack;
}

bool tdm_outputs_want_contacts(const tdm_outputs *o, double t) {
  if (!o->settings)
    return false; /* not begun */
  bool want = o->settings->contacts && t + o->slack >= next_frame(o);
  for (int i = 0; i < o->settings->pictures.count; i++)
    want =
        want || (tdm_color_of_contacts(o->settings->pictures.picture[i].color) && t + o->slack >= next_picture(o, i));
  return want;
}

bool tdm_outputs_want_all(const tdm_outputs *o, double t) {
  for (int i = 0; o->settings && i < o->settings->pictures.count; i++)
    if (t + o->slack >= next_picture(o, i))
      return true;
  return false;
}

/* The state of time t is written. */
static void go_on(tdm_outputs *o, double t) {
  const double interval = o->settings->particles_interval;
  while ((double)o->grid * interval <= t + o->slack)
    o->grid++;
  o->next = t >= o->end - o->slack ? INFINITY : fmin((double)o->grid * interval, o->end);
}

/* ---- files ---- */

static tdm_status begin_frames(tdm_outputs *o, tdm_error *err) {
  o->parts = tdm_vtp_parts_of(&o->scenery);
  o->parts.contacts = o->settings->contacts;
  tdm_results_path(o->results, TDM_FRAMES_FILE, o->path, sizeof o->path);
  o->frames = tdm_results_file(o->results, TDM_FRAMES_FILE, err);
  if (!o->frames || tdm_frames_write_scenery(o->frames, o->path, &o->scenery, &o->bytes, err) != TDM_OK)
    return err->status;
  if (o->settings->contacts && tdm_force_histogram_open(&o->histogram, o->results, err) != TDM_OK)
    return err->status;
  return tdm_pvd_open(&o->pvd, o->results, err);
}

tdm_status tdm_outputs_begin(tdm_outputs *o, const tdm_outputs_settings *s, const tdm_results *results, double end,
                             double step, tdm_error *err) {
  o->settings = s;
  o->results = results;
  o->end = end;
  o->slack = 1e-6 * step;
  if (tdm_drawer_begin(&o->drawer, &s->pictures, s->pictures_json, results->dir, err) != TDM_OK)
    return err->status;
  return s->particles_interval > 0 ? begin_frames(o, err) : TDM_OK;
}

/* The shares that others have. Meanwhile the file is closed here, since several machines see what one of them wrote
 * when it has closed the file, and may write over it when they have it open. */
static tdm_status write_shares(tdm_outputs *o, const tdm_frame_place *place, tdm_error *err) {
  tdm_shared_frame frame = {.number = o->pvd.number, .arrays = place->arrays};
  snprintf(frame.dir, sizeof frame.dir, "%s", o->results->dir);
  const int closed = fclose(o->frames);
  o->frames = NULL;
  if (closed != 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", o->path, strerror(errno));
  if (o->sharers.write(o->sharers.with, &frame, err) == TDM_OK)
    o->frames = tdm_share_open(o->path, err);
  return err->status;
}

static tdm_status write_frame(tdm_outputs *o, const tdm_snapshot *snapshot, tdm_error *err) {
  const bool shared = snapshot->nparticle < snapshot->nall;
  tdm_frame_place place;
  if (tdm_vtp_write(o->results, o->pvd.number, &o->scenery, snapshot, o->parts, err) != TDM_OK ||
      (o->settings->contacts && tdm_force_histogram_add(&o->histogram, snapshot, err) != TDM_OK) ||
      tdm_frames_write(o->frames, o->path, snapshot, &place, &o->bytes, err) != TDM_OK ||
      (shared && write_shares(o, &place, err) != TDM_OK)) {
    if (shared)
      tdm_vtp_finish_shares(o->results, o->pvd.number, false, err);
    return err->status;
  }
  if ((shared && tdm_vtp_finish_shares(o->results, o->pvd.number, true, err) != TDM_OK) ||
      tdm_frames_end(o->frames, o->path, &place, err) != TDM_OK ||
      tdm_pvd_add(&o->pvd, o->results, snapshot->time, o->parts, err) != TDM_OK)
    return err->status;
  go_on(o, snapshot->time);
  return TDM_OK;
}

tdm_status tdm_outputs_write(tdm_outputs *o, const tdm_snapshot *snapshot, tdm_error *err) {
  const double t = snapshot->time + o->slack;
  if (!tdm_outputs_due(o, snapshot->time))
    return TDM_OK;
  if (tdm_results_there(o->results, err) == TDM_OK && t >= next_frame(o))
    write_frame(o, snapshot, err);
  assert(snapshot->nparticle == snapshot->nall || !tdm_outputs_want_all(o, snapshot->time));
  for (int i = 0; i < o->settings->pictures.count; i++)
    while (err->status == TDM_OK && t >= next_picture(o, i))
      tdm_drawer_submit(&o->drawer, i, &o->scenery, snapshot, err);
  return err->status;
}

int tdm_outputs_pictures(const tdm_outputs *o) {
  int n = 0;
  for (int i = 0; o->drawer.drawn && i < o->settings->pictures.count; i++)
    n += o->drawer.drawn[i];
  return n;
}

void tdm_outputs_finish(tdm_outputs *o, double t) {
  tdm_error notice = {0};
  if (!o->settings)
    return;
  tdm_drawer_finish(&o->drawer, &notice);
  tdm_force_histogram_finish(&o->histogram);
  if (notice.status != TDM_OK && notice.status != TDM_ERR_INTERRUPTED)
    tdm_remark(TDM_NOTICE, "pictures", "output.pictures", t, "%s", notice.message);
}

void tdm_outputs_end(tdm_outputs *o) {
  if (o->frames)
    fclose(o->frames);
  if (o->settings)
    tdm_drawer_end(&o->drawer);
  tdm_force_histogram_close(&o->histogram);
  tdm_pvd_close(&o->pvd);
  tdm_scenery_free(&o->scenery);
  tdm_snapshot_free(&o->snapshot);
  tdm_view_bytes_free(&o->bytes);
  *o = (tdm_outputs){0};
}
