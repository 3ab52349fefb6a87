/* The sheet that an image stands on: where what goes, time, colour bar, axes or scale; PNG files. By cairo. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_DRAW_PROGRAM_SHEET_H
#define TDM_DRAW_PROGRAM_SHEET_H

#include "protocol/draw/camera.h"
#include "protocol/view/view.h"

#include <cairo.h>

/* Where things are [pixels]. */
typedef struct {
  int width, height;  /* of the sheet */
  int x, y, image[2]; /* of the image: left, top; width, height */
  int bar_x;          /* left edge of the colour bar */
} tdm_layout;

/* What is said about an image. */
typedef struct {
  const tdm_picture *picture;
  const tdm_scenery *scenery;
  const tdm_camera *camera;
  double time;     /* [s] */
  double range[2]; /* of the colours */
  bool beyond;     /* there are numbers above it */
  bool colored;    /* there are particles: with a colour bar */
} tdm_caption;

/* The layout of a sheet of this size (0: chosen; flat views: by low and high [m]). */
tdm_layout tdm_layout_make(const tdm_picture *picture, const int size[2], const double low[2], const double high[2]);

/* In how many columns so many sheets of this layout stand: few empty places, and altogether about 8 : 5. */
int tdm_layout_columns(const tdm_layout *layout, int count);

/* The size of one of the sheets that stand beside each other in so many columns, like a single one but smaller. */
void tdm_layout_panel(const tdm_layout *layout, const tdm_picture *picture, int columns, int size[2]);

/* A sheet with the image (image[0] x image[1]) and what is said about it; the caller destroys it. NULL: no memory. */
cairo_surface_t *tdm_sheet(const tdm_layout *layout, const uint32_t *pixel, const tdm_caption *caption);

/* Sheets of one size in rows; NULL: no memory. */
cairo_surface_t *tdm_sheets_join(cairo_surface_t *const *sheet, int count, int columns);

tdm_status tdm_sheet_write(cairo_surface_t *sheet, const char *path, tdm_error *err);

#endif
