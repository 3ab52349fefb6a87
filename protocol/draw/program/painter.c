/* A picture of one state of a run: see painter.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/draw/program/painter.h"

#include "protocol/draw/color.h"

tdm_status tdm_painter_scenery(tdm_painter *p, const tdm_scenery *scenery, tdm_error *err) {
  if (!p->renderer)
    p->renderer = tdm_renderer_new(err);
  return p->renderer ? tdm_surface_make(&p->surface, scenery, err) : err->status;
}

void tdm_painter_free(tdm_painter *p) {
  tdm_renderer_free(p->renderer);
  tdm_drawing_free(&p->drawing);
  tdm_surface_free(&p->surface);
  *p = (tdm_painter){0};
}

/* The range of the colours: the picture's, that of all pictures, or that of this one. */
static tdm_status choose_range(double range[2], const tdm_content *c, const tdm_frame *frame, tdm_error *err) {
  const double *given = c->picture->range[0] < c->picture->range[1] ? c->picture->range : frame->range;
  range[0] = given[0];
  range[1] = given[1];
  if (range[0] <= range[1])
    return TDM_OK;
  tdm_status status = tdm_color_widen(range, c->picture->color, c->snapshot, c->camera, c->up, err);
  if (!(range[0] <= range[1]))
    range[0] = range[1] = 0;
  return status;
}

static bool beyond(const tdm_content *c) {
  bool found = false;
  for (int i = 0; i < tdm_color_count(c->picture->color, c->snapshot) && !found; i++)
    found =
        tdm_color_value(c->picture->color, c->snapshot, i, c->camera, c->up) > c->range[1] + 1e-6 * fabs(c->range[1]);
  return found;
}

tdm_status tdm_paint(tdm_painter *p, const tdm_picture *picture, const tdm_scenery *scenery,
                     const tdm_snapshot *snapshot, const tdm_frame *frame, const int size[2], cairo_surface_t **sheet,
                     tdm_error *err) {
  double low[2] = {0, 0}, high[2] = {1, 1};
  const uint32_t *pixel;
  if (picture->view.flat)
    tdm_camera_limits(&picture->view, &frame->bounds, low, high);
  const tdm_layout layout = tdm_layout_make(picture, size[0] ? size : picture->size, low, high);
  const tdm_vec3 up = tdm_scene_up(scenery);
  double aspect = (double)layout.image[0] / layout.image[1];
  const tdm_camera camera = tdm_camera_make(&picture->view, &frame->bounds, up, aspect);
  tdm_content content = {.picture = picture,
                         .scenery = scenery,
                         .surface = &p->surface,
                         .snapshot = snapshot,
                         .camera = &camera,
                         .up = up,
                         .height = layout.image[1]};
  if (choose_range(content.range, &content, frame, err) != TDM_OK ||
      tdm_content_make(&p->drawing, &content, err) != TDM_OK ||
      tdm_render(p->renderer, &p->drawing, &camera, up, layout.image[0], layout.image[1], &pixel, err) != TDM_OK)
    return err->status;
  const tdm_caption caption = {.picture = picture,
                               .scenery = scenery,
                               .camera = &camera,
                               .time = snapshot->time,
                               .range = {content.range[0], content.range[1]},
                               .beyond = beyond(&content),
                               .colored = snapshot->nparticle > 0};
  *sheet = tdm_sheet(&layout, pixel, &caption);
  return *sheet ? TDM_OK : tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for a picture");
}

/* ---- rows ---- */

tdm_status tdm_row_paint(tdm_row *row, tdm_painter *p, const tdm_picture *picture, const tdm_scenery *scenery,
                         const tdm_snapshot *snapshot, const tdm_frame *frame, int number, int planned,
                         tdm_error *err) {
  int every = (planned + TDM_ROW_PANELS - 1) / TDM_ROW_PANELS;
  if (planned < 2 || number % every != 0 || row->count == TDM_ROW_PANELS)
    return TDM_OK;
  int panels = (planned + every - 1) / every, size[2];
  double low[2] = {0, 0}, high[2] = {1, 1};
  if (picture->view.flat)
    tdm_camera_limits(&picture->view, &frame->bounds, low, high);
  const tdm_layout layout = tdm_layout_make(picture, picture->size, low, high);
  row->columns = tdm_layout_columns(&layout, panels);
  tdm_layout_panel(&layout, picture, row->columns, size);
  if (tdm_paint(p, picture, scenery, snapshot, frame, size, &row->panel[row->count], err) == TDM_OK)
    row->count++;
  return err->status;
}

tdm_status tdm_row_write(const tdm_row *row, const char *path, tdm_error *err) {
  if (row->count < 2)
    return TDM_OK;
  int columns = row->count < row->columns ? row->count : row->columns;
  cairo_surface_t *all = tdm_sheets_join(row->panel, row->count, columns);
  if (!all)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %s", path);
  tdm_sheet_write(all, path, err);
  cairo_surface_destroy(all);
  return err->status;
}

void tdm_row_free(tdm_row *row) {
  for (int i = 0; i < row->count; i++)
    cairo_surface_destroy(row->panel[i]);
  row->count = 0;
}
