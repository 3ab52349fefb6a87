/* A picture of one state of a run, from what there is to see to a sheet that can be written as PNG. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_DRAW_PROGRAM_PAINTER_H
#define TDM_DRAW_PROGRAM_PAINTER_H

#include "protocol/draw/program/sheet.h"
#include "protocol/draw/space/content.h"

/* Zero-initialise; free with tdm_painter_free. */
typedef struct {
  tdm_renderer *renderer;
  tdm_drawing drawing;
  tdm_surface surface;
} tdm_painter;

/* Begin with a scenery, or go on with another one; OpenGL is started at the first. */
tdm_status tdm_painter_scenery(tdm_painter *painter, const tdm_scenery *scenery, tdm_error *err);
void tdm_painter_free(tdm_painter *painter);

/* What pictures of one view have in common, so that they can be compared. */
typedef struct {
  tdm_bounds bounds; /* of what is shown */
  double range[2];   /* of the colours, where the picture has none; low above high: each its own */
} tdm_frame;

/* Paint a state of the scenery that was given last. size [pixels]: {0, 0}: the picture's own. The caller destroys
 * *sheet. */
tdm_status tdm_paint(tdm_painter *painter, const tdm_picture *picture, const tdm_scenery *scenery,
                     const tdm_snapshot *snapshot, const tdm_frame *frame, const int size[2], cairo_surface_t **sheet,
                     tdm_error *err);

/* Pictures of a view that stand in one image, pictures.png: their number is known beforehand, and when there are many,
 * some are left out. Zero-initialise; free with tdm_row_free. */
enum { TDM_ROW_PANELS = 8 };
typedef struct {
  int count, columns;
  cairo_surface_t *panel[TDM_ROW_PANELS]; /* (count) */
} tdm_row;

/* Paint picture `number` of `planned` also for the row, if it belongs to it. */
tdm_status tdm_row_paint(tdm_row *row, tdm_painter *painter, const tdm_picture *picture, const tdm_scenery *scenery,
                         const tdm_snapshot *snapshot, const tdm_frame *frame, int number, int planned, tdm_error *err);
/* Write it, if it has more than one picture. */
tdm_status tdm_row_write(const tdm_row *row, const char *path, tdm_error *err);
void tdm_row_free(tdm_row *row);

#endif
