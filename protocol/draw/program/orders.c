/* What tandem-draw does while a run goes on: see orders.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE /* getline */
#include "protocol/draw/program/orders.h"

#include "protocol/draw/program/painter.h"
#include "protocol/view/frames.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The pictures of one view. */
typedef struct {
  tdm_picture picture;
  int planned;
  tdm_bounds start; /* of the first picture */
  tdm_row row;
} view;

typedef struct {
  int nview;
  view *view; /* (nview) */
  tdm_painter painter;
  bool failed;
} work;

static void say(work *w, const char *what, const tdm_error *err) {
  fprintf(stderr, "%s%s%s\n", what, *what ? ": " : "", err->message);
  fflush(stderr);
  w->failed = true;
}

/* The first line. */
static tdm_status read_settings(work *w, const char *line, tdm_error *err) {
  json_t *json = json_loads(line, 0, NULL), *pictures = json_object_get(json, "pictures");
  size_t n = json_array_size(pictures);
  w->view = calloc(n ? n : 1, sizeof *w->view);
  if (!json || n == 0 || !w->view)
    tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "not an order: \"%.60s\"", line);
  for (size_t k = 0; k < n && err->status == TDM_OK; k++) {
    view *v = &w->view[w->nview++];
    tdm_picture_read(&v->picture, json_array_get(pictures, k), "output.pictures", err);
    v->planned = (int)json_integer_value(json_array_get(json_object_get(json, "planned"), k));
    v->start = tdm_bounds_empty();
  }
  json_decref(json);
  return err->status;
}

/* What the picture shows: what the first one did, and further bodies and lines that went out of that. */
static tdm_status frame_of(view *v, const tdm_frames *frames, const tdm_snapshot *snapshot, tdm_frame *frame,
                           tdm_error *err) {
  bool first = tdm_bounds_are_empty(&v->start);
  *frame = (tdm_frame){.bounds = v->start, .range = {INFINITY, -INFINITY}};
  if (tdm_content_bounds(&frame->bounds, &v->picture, &frames->scenery, snapshot, first, err) == TDM_OK && first)
    v->start = frame->bounds;
  return err->status;
}

static tdm_status draw(work *w, view *v, int number, const char *path, tdm_error *err) {
  char png[128], prefix[96];
  tdm_frames frames;
  tdm_frame frame;
  tdm_snapshot snapshot = {0};
  cairo_surface_t *sheet = NULL;
  const int own[2] = {0, 0};
  snprintf(png, sizeof png, "%s_%03d.png", tdm_picture_prefix(&v->picture, prefix, sizeof prefix), number);
  if (tdm_frames_open_file(&frames, path, err) == TDM_OK && frames.count == 0)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: has no snapshot", path);
  if (err->status == TDM_OK && tdm_frames_load(&frames, 0, &snapshot, err) == TDM_OK &&
      tdm_painter_scenery(&w->painter, &frames.scenery, err) == TDM_OK &&
      frame_of(v, &frames, &snapshot, &frame, err) == TDM_OK &&
      tdm_paint(&w->painter, &v->picture, &frames.scenery, &snapshot, &frame, own, &sheet, err) == TDM_OK &&
      tdm_sheet_write(sheet, png, err) == TDM_OK)
    tdm_row_paint(&v->row, &w->painter, &v->picture, &frames.scenery, &snapshot, &frame, number, v->planned, err);
  if (sheet)
    cairo_surface_destroy(sheet);
  tdm_snapshot_free(&snapshot);
  tdm_frames_close(&frames);
  return err->status;
}

static void obey(work *w, const char *line) {
  int k, number;
  char path[128], prefix[96];
  tdm_error err = {0};
  if (sscanf(line, "%d %d", &k, &number) != 2 || k < 0 || k >= w->nview) {
    tdm_fail(&err, TDM_ERR_PROTOCOL, NULL, "not an order: \"%.60s\"", line);
    say(w, "", &err);
    return;
  }
  view *v = &w->view[k];
  snprintf(path, sizeof path, "%s_%03d.frame", tdm_picture_prefix(&v->picture, prefix, sizeof prefix), number);
  if (draw(w, v, number, path, &err) == TDM_OK)
    unlink(path);
  else
    say(w, path, &err);
}

static void write_rows(work *w) {
  for (int k = 0; k < w->nview; k++) {
    char name[128];
    tdm_error err = {0};
    if (tdm_row_write(&w->view[k].row, tdm_picture_row_name(&w->view[k].picture, name, sizeof name), &err) != TDM_OK)
      say(w, "", &err);
  }
}

int draw_orders(FILE *orders) {
  work w = {0};
  char *line = NULL;
  size_t room = 0;
  tdm_error err = {0};
  if (getline(&line, &room, orders) > 0) {
    if (read_settings(&w, line, &err) != TDM_OK)
      say(&w, err.path, &err);
    while (err.status == TDM_OK && getline(&line, &room, orders) > 0)
      obey(&w, line);
    write_rows(&w);
  }
  free(line);
  for (int k = 0; k < w.nview; k++)
    tdm_row_free(&w.view[k].row);
  free(w.view);
  tdm_painter_free(&w.painter);
  return w.failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
