/* `tandem view DIR`: see view.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/page/view.h"

#include "coupler/page/channels.h"
#include "coupler/page/pack.h"
#include "coupler/page/page.h"
#include "protocol/results/results.h"
#include "protocol/version.h"
#include "protocol/view/frames.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* What the page is made of, so that one place can let go of it. */
typedef struct {
  const char *dir;
  json_t *summary; /* NULL: none that can be read */
  tdm_frames frames;
  cpl_channels channels;
  tdm_snapshot snapshot[2]; /* this one and the one before, for the roster */
  tdm_view_bytes bytes;
  int stride; /* frames 0, stride, 2 stride ... and the last one are shown */
  json_t *notes;
} view;

static void note(view *v, const char *text) {
  json_array_append_new(v->notes, json_string(text));
}

/* ---- what is there ---- */

static tdm_status load(view *v, tdm_error *err) {
  tdm_error lack = {0}, none = {0};
  char text[TDM_MESSAGE_MAX + 64];
  v->notes = json_array();
  if (cpl_channels_read(&v->channels, v->dir, err) != TDM_OK)
    return err->status;
  v->summary = tdm_results_read(v->dir, "summary.json", &none);
  if (tdm_frames_open(&v->frames, v->dir, &lack) != TDM_OK) {
    if (v->channels.nfile == 0)
      return tdm_fail(err, lack.status, NULL, "%s holds nothing to look at: no time histories (CSV), and %s", v->dir,
                      lack.message);
    fprintf(stderr, "tandem: notice: no pictures of the run: %s\n", lack.message);
    snprintf(text, sizeof text, "No frames. %s", lack.message);
    tdm_utf8_clean(text);
    note(v, text);
  }
  if (v->frames.cut)
    note(v, "The file of frames ends inside a frame: the run was ended by force, or goes on.");
  if (!v->summary)
    note(v, "There is no summary.json that can be read: how the run ended is not known.");
  return TDM_OK;
}

/* Leave out frames when all of them would take more than the budget: by the size of three of them, packed. */
static tdm_status choose_stride(view *v, double budget, tdm_error *err) {
  tdm_frames *f = &v->frames;
  double packed = 0, raw = 0, all = 0;
  for (int k = 0; k < f->count; k++)
    all += (double)f->size[k];
  for (int i = 0; i < 3 && f->count > 0; i++) {
    const int k = i * (f->count - 1) / 2;
    if (tdm_frames_load(f, k, &v->snapshot[0], err) != TDM_OK ||
        cpl_pack_frame(&f->scenery, &v->snapshot[0], 0, &v->bytes, err) != TDM_OK)
      return err->status;
    packed += (double)v->bytes.size;
    raw += (double)f->size[k];
  }
  v->stride = 1;
  if (raw > 0) /* base64 takes four bytes for three */
    v->stride = (int)fmin(fmax(1, ceil(4. / 3 * all * packed / raw / budget)), fmax(1, f->count));
  if (v->stride > 1) {
    char text[256];
    snprintf(text, sizeof text,
             "Every %d. frame of %d is here, so that the page stays below about %.0f MB (--budget MB).", v->stride,
             f->count, budget / 1e6);
    note(v, text);
    printf("%s\n", text);
  }
  return TDM_OK;
}

static bool shown(const view *v, int k) {
  return k % v->stride == 0 || k == v->frames.count - 1;
}

/* ---- the page ---- */

static void copy_key(json_t *to, const json_t *from, const char *key) {
  json_t *value = json_object_get(from, key);
  if (value)
    json_object_set(to, key, value);
}

static json_t *meta(const view *v) {
  static const char *const keys[] = {"scene",       "status",  "error",          "warnings", "notices",
                                     "simulated_s", "windows", "error_estimate", "wall_s"};
  json_t *m = cpl_page_scenery(&v->frames.scenery), *times = json_array();
  for (int k = 0; k < v->frames.count; k++)
    if (shown(v, k))
      json_array_append_new(times, json_real(v->frames.time[k]));
  json_object_set_new(m, "tandem", json_string(TDM_VERSION));
  json_object_set_new(m, "times", times);
  json_object_set_new(m, "channels", cpl_channels_to_json(&v->channels));
  json_object_set(m, "notes", v->notes);
  for (size_t k = 0; k < sizeof keys / sizeof keys[0]; k++)
    copy_key(m, v->summary, keys[k]);
  return m;
}

static tdm_status write_frames(view *v, FILE *page, tdm_error *err) {
  char id[32];
  int count = 0, serial = -1;
  for (int k = 0; k < v->frames.count; k++) {
    if (!shown(v, k))
      continue;
    tdm_snapshot *now = &v->snapshot[count % 2];
    if (tdm_frames_load(&v->frames, k, now, err) != TDM_OK)
      return err->status;
    if (count == 0 || !cpl_pack_same_roster(now, &v->snapshot[(count + 1) % 2])) {
      if (cpl_pack_roster(now, (uint32_t)++serial, &v->bytes, err) != TDM_OK)
        return err->status;
      snprintf(id, sizeof id, "roster%d", serial);
      cpl_page_bytes(page, id, &v->bytes);
    }
    if (cpl_pack_frame(&v->frames.scenery, now, (uint32_t)serial, &v->bytes, err) != TDM_OK)
      return err->status;
    snprintf(id, sizeof id, "frame%d", count++);
    cpl_page_bytes(page, id, &v->bytes);
  }
  return TDM_OK;
}

static tdm_status write_page(view *v, FILE *page, tdm_error *err) {
  char title[4096], id[32];
  const char *scene = json_string_value(json_object_get(v->summary, "scene"));
  snprintf(title, sizeof title, "tandem: %s", scene ? scene : v->dir);
  tdm_utf8_clean(title);
  cpl_page_begin(page, title);
  json_t *m = meta(v);
  cpl_page_json(page, "meta", m);
  json_decref(m);
  if (cpl_pack_surface(&v->frames.scenery, &v->bytes, err) != TDM_OK)
    return err->status;
  cpl_page_bytes(page, "surface", &v->bytes);
  for (int k = 0; k < v->channels.nfile; k++) {
    if (cpl_channels_pack(&v->channels, k, &v->bytes, err) != TDM_OK)
      return err->status;
    snprintf(id, sizeof id, "channels%d", k);
    cpl_page_bytes(page, id, &v->bytes);
  }
  if (write_frames(v, page, err) == TDM_OK)
    cpl_page_end(page);
  return err->status;
}

/* The page is there as a whole or not at all. */
static tdm_status write_file(view *v, const char *out, tdm_error *err) {
  char path[4352], part[4400];
  struct stat status;
  if (out)
    snprintf(path, sizeof path, "%s", out);
  else
    snprintf(path, sizeof path, "%s/view.html", v->dir);
  snprintf(part, sizeof part, "%s.part", path);
  FILE *page = fopen(part, "w");
  if (!page)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", path, strerror(errno));
  write_page(v, page, err);
  const bool bad = ferror(page) != 0;
  if ((fclose(page) != 0 || bad || (err->status == TDM_OK && rename(part, path) != 0)) && err->status == TDM_OK)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", path, strerror(errno));
  if (err->status != TDM_OK) {
    remove(part);
    return err->status;
  }
  if (!out)
    tdm_mark_add_in(v->dir, "view.html");
  printf("%s: %d frames, %d files of time histories, %.1f MB; open it in a browser\n", path,
         (v->frames.count + v->stride - 1) / v->stride, v->channels.nfile,
         stat(path, &status) == 0 ? (double)status.st_size / 1e6 : 0);
  return TDM_OK;
}

tdm_status cpl_view(const char *dir, const char *out, double budget, tdm_error *err) {
  view v = {.dir = dir, .stride = 1};
  if (load(&v, err) == TDM_OK && choose_stride(&v, budget, err) == TDM_OK)
    write_file(&v, out, err);
  json_decref(v.summary);
  json_decref(v.notes);
  tdm_frames_close(&v.frames);
  cpl_channels_free(&v.channels);
  for (int k = 0; k < 2; k++)
    tdm_snapshot_free(&v.snapshot[k]);
  tdm_view_bytes_free(&v.bytes);
  return err->status;
}
