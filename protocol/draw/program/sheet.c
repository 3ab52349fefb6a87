/* The sheet that an image stands on: see sheet.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/draw/program/sheet.h"

#include "protocol/draw/color.h"

#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { AREA = 320000, SIDE_LEAST = 260, SIDE_MOST = 1200 }; /* of a flat view's image [pixels] */
enum { ROW = 1400 };                                        /* width of the images in a row [pixels] */
enum { NARROW = 560 };                                      /* in space: below, colours stand beside [pixels] */
enum { LEFT = 62, RIGHT = 16, TOP = 34, BOTTOM = 40, BAR = 104, FREE = 16 };
static const double text_size = 13;
static const double ink[3] = {0.13, 0.15, 0.18};

/* ---- layout ---- */

tdm_layout tdm_layout_make(const tdm_picture *p, const int size[2], const double low[2], const double high[2]) {
  tdm_layout l = {.x = 0, .y = 0};
  if (!p->view.flat) {
    l.width = size[0] ? size[0] : 1200;
    l.height = size[1] ? size[1] : 850;
    l.image[0] = l.width < NARROW && l.width > 2 * BAR ? l.width - BAR : l.width;
    l.image[1] = l.height;
    l.bar_x = l.width - BAR + FREE / 2;
    return l;
  }
  double width = high[0] - low[0], height = high[1] - low[1], scale = sqrt(AREA / (width * height));
  l.x = LEFT;
  l.y = TOP;
  l.image[0] = size[0] ? size[0] - LEFT - BAR - FREE : (int)fmin(SIDE_MOST, fmax(SIDE_LEAST, scale * width));
  l.image[1] = size[1] ? size[1] - TOP - BOTTOM : (int)fmin(SIDE_MOST, fmax(SIDE_LEAST, scale * height));
  l.image[0] = l.image[0] < 16 ? 16 : l.image[0];
  l.image[1] = l.image[1] < 16 ? 16 : l.image[1];
  l.width = size[0] ? size[0] : l.image[0] + LEFT + BAR + FREE;
  l.height = size[1] ? size[1] : l.image[1] + TOP + BOTTOM;
  l.bar_x = l.x + l.image[0] + FREE;
  return l;
}

int tdm_layout_columns(const tdm_layout *l, int count) {
  int best = 1;
  double least = INFINITY;
  for (int columns = 1; columns <= count; columns++) {
    int rows = (count + columns - 1) / columns;
    double wide = (double)(columns * l->width) / (rows * l->height);
    double cost = fabs(log(wide / 1.6)) + 0.5 * (columns * rows - count);
    if (cost < least) {
      best = columns;
      least = cost;
    }
  }
  return best;
}

void tdm_layout_panel(const tdm_layout *l, const tdm_picture *p, int columns, int size[2]) {
  double scale = fmin(1, ROW / ((double)columns * l->image[0]));
  const int around[2] = {p->view.flat ? LEFT + BAR + FREE : 0, p->view.flat ? TOP + BOTTOM : 0};
  scale = fmax(scale, fmin(1, (double)SIDE_LEAST / l->image[0]));
  for (int k = 0; k < 2; k++)
    size[k] = (int)(scale * l->image[k]) + around[k];
}

/* ---- text ---- */

typedef enum { AT_LEFT, AT_MIDDLE, AT_RIGHT } place;

static double text_width(cairo_t *c, const char *text) {
  cairo_text_extents_t size;
  cairo_text_extents(c, text, &size);
  return size.x_advance;
}

/* With a light edge: in pictures in space there may be anything behind it. */
static void text(cairo_t *c, double x, double y, place where, const char *words) {
  double w = where == AT_LEFT ? 0 : text_width(c, words);
  x = floor(x - (where == AT_MIDDLE ? 0.5 * w : w));
  y = floor(y + 0.5);
  cairo_save(c);
  cairo_set_source_rgba(c, 1, 1, 1, 0.75);
  cairo_set_line_width(c, 3);
  cairo_set_line_join(c, CAIRO_LINE_JOIN_ROUND);
  cairo_move_to(c, x, y);
  cairo_text_path(c, words);
  cairo_stroke(c);
  cairo_restore(c);
  cairo_set_source_rgb(c, ink[0], ink[1], ink[2]);
  cairo_move_to(c, x, y);
  cairo_show_text(c, words);
}

static void line(cairo_t *c, double x0, double y0, double x1, double y1) {
  cairo_move_to(c, floor(x0) + 0.5, floor(y0) + 0.5);
  cairo_line_to(c, floor(x1) + 0.5, floor(y1) + 0.5);
  cairo_stroke(c);
}

/* ---- ticks ---- */

/* A step of 1, 2 or 5 times a power of ten that makes at most `most` parts of the span. */
static double tick_step(double span, double most) {
  double least = span / fmax(1, most), ten = pow(10, floor(log10(least)));
  return least <= ten ? ten : least <= 2 * ten ? 2 * ten : least <= 5 * ten ? 5 * ten : 10 * ten;
}

/* A tick's number, with as many digits as tell it from its neighbours. */
static const char *tick_text(double value, double step, char *out, size_t size) {
  if (fabs(value) < 1e-6 * step)
    value = 0;
  double most = fmax(fabs(value), step);
  int digits = (int)fmax(0, -floor(log10(step) + 1e-9));
  if (most >= 1e6 || most < 1e-3)
    snprintf(out, size, "%.*g", (int)fmax(1, fmin(12, 1 + floor(log10(most)) - floor(log10(step) + 1e-9))), value);
  else
    snprintf(out, size, "%.*f", digits, value);
  return out;
}

/* what is shown of a flat view, across and up: the camera's axes are the world's [m] */
static void axis(cairo_t *c, const tdm_layout *l, const tdm_caption *k, int which) {
  double at = tdm_dot(k->camera->at, which ? k->camera->up : k->camera->right);
  double low = at - k->camera->half[which], high = at + k->camera->half[which];
  double span = high - low, room = l->image[which];
  double step = tick_step(span, room / (which ? 45 : 75));
  double bottom = l->y + l->image[1];
  if (!(span > 0) || !(step > 0))
    return;
  for (double n = ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; n++) {
    char words[48];
    double s = (n * step - low) / span * room;
    tick_text(n * step, step, words, sizeof words);
    if (which == 0) {
      line(c, l->x + s, bottom, l->x + s, bottom + 5);
      text(c, l->x + s, bottom + 19, AT_MIDDLE, words);
    } else {
      line(c, l->x - 5, bottom - s, l->x, bottom - s);
      text(c, l->x - 8, bottom - s + 4, AT_RIGHT, words);
    }
    if (n + 1 == n)
      return;
  }
}

static void axes(cairo_t *c, const tdm_layout *l, const tdm_caption *k) {
  char words[32];
  cairo_set_source_rgb(c, ink[0], ink[1], ink[2]);
  cairo_set_line_width(c, 1);
  cairo_rectangle(c, l->x - 0.5, l->y - 0.5, l->image[0] + 1, l->image[1] + 1);
  cairo_stroke(c);
  axis(c, l, k, 0);
  axis(c, l, k, 1);
  snprintf(words, sizeof words, "%c [m]", "xyz"[k->picture->view.across]);
  text(c, l->x + 0.5 * l->image[0], l->height - 5, AT_MIDDLE, words);
  snprintf(words, sizeof words, "%c [m]", "xyz"[k->picture->view.up_axis]);
  text(c, 8, l->y - 12, AT_LEFT, words);
}

/* ---- in space ---- */

/* A length of 1, 2 or 5 times a power of ten, at most a fifth of the width; in perspective it is true at the middle. */
static void scale_bar(cairo_t *c, const tdm_layout *l, const tdm_caption *k, double x, double y) {
  double per_metre = 0.5 * l->image[1] / k->camera->half[1], length = tick_step(0.1 * l->width / per_metre, 1);
  char words[64];
  if (length * per_metre > 0.25 * l->width)
    length = tick_step(0.04 * l->width / per_metre, 1);
  double w = length * per_metre;
  snprintf(words, sizeof words, "%g m", length);
  cairo_set_source_rgb(c, ink[0], ink[1], ink[2]);
  cairo_set_line_width(c, 2);
  cairo_move_to(c, x, y - 5);
  cairo_line_to(c, x, y);
  cairo_line_to(c, x + w, y);
  cairo_line_to(c, x + w, y - 5);
  cairo_stroke(c);
  text(c, x + 0.5 * w, y - 9, AT_MIDDLE, words);
}

/* The world's axes, as they are turned in the picture. */
static void triad(cairo_t *c, const tdm_camera *camera, double x, double y) {
  static const double colors[3][3] = {{0.75, 0.15, 0.15}, {0.13, 0.52, 0.18}, {0.12, 0.32, 0.72}};
  const tdm_vec3 r = camera->right, u = camera->up, b = camera->back;
  const double across[3] = {r.x, r.y, r.z}, up[3] = {u.x, u.y, u.z}, toward[3] = {b.x, b.y, b.z};
  int order[3] = {0, 1, 2};
  for (int i = 0; i < 2; i++) /* those that point away first */
    for (int j = 0; j < 2 - i; j++)
      if (toward[order[j]] > toward[order[j + 1]]) {
        int swap = order[j];
        order[j] = order[j + 1];
        order[j + 1] = swap;
      }
  for (int i = 0; i < 3; i++) {
    int a = order[i];
    const char name[2] = {"xyz"[a], 0};
    double dx = 30 * across[a], dy = -30 * up[a];
    cairo_set_source_rgb(c, colors[a][0], colors[a][1], colors[a][2]);
    cairo_set_line_width(c, 2.5);
    cairo_move_to(c, x, y);
    cairo_line_to(c, x + dx, y + dy);
    cairo_stroke(c);
    cairo_move_to(c, x + 1.35 * dx - 3.5, y + 1.35 * dy + 4);
    cairo_show_text(c, name);
  }
}

/* ---- colours ---- */

static void color_box(cairo_t *c, double x, double y, double w, double h, tdm_rgb rgb) {
  cairo_set_source_rgb(c, rgb.r / 255.0, rgb.g / 255.0, rgb.b / 255.0);
  cairo_rectangle(c, x, y, w, h);
  cairo_fill(c);
}

static void kinds(cairo_t *c, const tdm_layout *l, const tdm_caption *k, double top) {
  int n = tdm_color_kinds(k->picture->color, k->scenery);
  double x = l->bar_x;
  for (int i = 0; i < n; i++) {
    char name[128];
    tdm_color_kind_name(k->picture->color, k->scenery, i, name, sizeof name);
    x = fmin(x, l->width - text_width(c, name) - 28);
  }
  for (int i = 0; i < n && top + 20 * i < l->height - 20; i++) {
    char name[128];
    tdm_color_kind_name(k->picture->color, k->scenery, i, name, sizeof name);
    color_box(c, x, top + 20 * i, 14, 14, tdm_color_of_kind(i));
    text(c, x + 20, top + 20 * i + 12, AT_LEFT, name);
  }
}

/* A triangle on top: numbers beyond the range have its colour. */
static void bar(cairo_t *c, const tdm_layout *l, const tdm_caption *k, double top, double height) {
  double span = k->range[1] - k->range[0], step = tick_step(span, height / 40);
  for (int i = 0; i < (int)height; i++)
    color_box(c, l->bar_x, top + i, 16, 1, tdm_color_map(1 - i / height));
  if (k->beyond) {
    tdm_rgb last = tdm_color_map(1);
    cairo_set_source_rgb(c, last.r / 255.0, last.g / 255.0, last.b / 255.0);
    cairo_move_to(c, l->bar_x, top);
    cairo_line_to(c, l->bar_x + 8, top - 9);
    cairo_line_to(c, l->bar_x + 16, top);
    cairo_fill(c);
  }
  cairo_set_line_width(c, 1);
  for (double n = ceil(k->range[0] / step - 1e-9); n * step <= k->range[1] + 1e-9 * step && n + 1 > n; n++) {
    char words[48];
    double y = top + height - (n * step - k->range[0]) / span * height;
    cairo_set_source_rgb(c, ink[0], ink[1], ink[2]);
    line(c, l->bar_x + 16, y, l->bar_x + 20, y);
    text(c, l->bar_x + 24, y + 4, AT_LEFT, tick_text(n * step, step, words, sizeof words));
  }
}

static void colors(cairo_t *c, const tdm_layout *l, const tdm_caption *k) {
  const char *label = tdm_color_label(k->picture->color);
  double w = text_width(c, label), top = k->picture->view.flat ? l->y : 44;
  double height = fmin(k->picture->view.flat ? l->image[1] : 0.5 * l->height, 420);
  char words[64];
  text(c, fmin(l->bar_x, l->width - w - 8), top - 14, AT_LEFT, label);
  if (tdm_color_has_kinds(k->picture->color))
    kinds(c, l, k, top);
  else if (k->range[1] - k->range[0] > 1e-9 * fmax(fabs(k->range[0]), fabs(k->range[1])))
    bar(c, l, k, top, height);
  else {
    color_box(c, l->bar_x, top, 14, 14, tdm_color_map(0.5));
    snprintf(words, sizeof words, "%.4g", k->range[0]);
    text(c, l->bar_x + 20, top + 12, AT_LEFT, words);
  }
}

/* ---- sheets ---- */

static void image(cairo_surface_t *sheet, const tdm_layout *l, const uint32_t *pixel) {
  cairo_surface_flush(sheet);
  unsigned char *data = cairo_image_surface_get_data(sheet);
  int stride = cairo_image_surface_get_stride(sheet);
  for (int y = 0; y < l->image[1]; y++)
    memcpy(data + (size_t)(l->y + y) * (size_t)stride + (size_t)l->x * sizeof *pixel,
           pixel + (size_t)y * (size_t)l->image[0], (size_t)l->image[0] * sizeof *pixel);
  cairo_surface_mark_dirty(sheet);
}

static cairo_t *blank(cairo_surface_t **sheet, int width, int height) {
  *sheet = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
  cairo_t *c = cairo_create(*sheet);
  if (cairo_status(c) != CAIRO_STATUS_SUCCESS) {
    cairo_destroy(c);
    cairo_surface_destroy(*sheet);
    return NULL;
  }
  cairo_set_source_rgb(c, 1, 1, 1);
  cairo_paint(c);
  return c;
}

cairo_surface_t *tdm_sheet(const tdm_layout *l, const uint32_t *pixel, const tdm_caption *k) {
  cairo_surface_t *sheet;
  char words[64];
  cairo_t *c = blank(&sheet, l->width, l->height);
  if (!c)
    return NULL;
  image(sheet, l, pixel);
  cairo_select_font_face(c, "sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(c, text_size);
  if (k->picture->view.flat)
    axes(c, l, k);
  else {
    triad(c, k->camera, 58, l->height - 58);
    scale_bar(c, l, k, 120, l->height - 24);
  }
  if (k->colored)
    colors(c, l, k);
  cairo_set_font_size(c, text_size + 2);
  snprintf(words, sizeof words, "t = %.6g s", k->time);
  text(c, k->picture->view.flat ? l->x + 0.5 * l->image[0] : 20, k->picture->view.flat ? l->y - 12 : 30,
       k->picture->view.flat ? AT_MIDDLE : AT_LEFT, words);
  cairo_destroy(c);
  return sheet;
}

cairo_surface_t *tdm_sheets_join(cairo_surface_t *const *sheet, int count, int columns) {
  int width = cairo_image_surface_get_width(sheet[0]), height = cairo_image_surface_get_height(sheet[0]);
  int rows = (count + columns - 1) / columns;
  cairo_surface_t *all;
  cairo_t *c = blank(&all, columns * width, rows * height);
  if (!c)
    return NULL;
  for (int i = 0; i < count; i++) {
    cairo_set_source_surface(c, sheet[i], i % columns * width, i / columns * height);
    cairo_paint(c);
  }
  cairo_destroy(c);
  return all;
}

/* libpng's fast way: files a little larger in a fifth of the time of cairo's own, which counts where a run makes many.
 */
tdm_status tdm_sheet_write(cairo_surface_t *sheet, const char *path, tdm_error *err) {
  const int width = cairo_image_surface_get_width(sheet), height = cairo_image_surface_get_height(sheet);
  const size_t row = 3 * (size_t)width;
  png_image image = {.version = PNG_IMAGE_VERSION,
                     .width = (png_uint_32)width,
                     .height = (png_uint_32)height,
                     .format = PNG_FORMAT_RGB,
                     .flags = PNG_IMAGE_FLAG_FAST};
  uint8_t *bytes = malloc(row * (size_t)height + 1);
  if (!bytes)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for a picture of %d x %d pixels", width, height);
  cairo_surface_flush(sheet);
  for (int y = 0; y < height; y++) {
    const unsigned char *from =
        cairo_image_surface_get_data(sheet) + (ptrdiff_t)y * cairo_image_surface_get_stride(sheet);
    for (int x = 0; x < width; x++) {
      uint32_t pixel; /* 0x..RRGGBB */
      memcpy(&pixel, from + 4 * x, sizeof pixel);
      uint8_t *to = bytes + (size_t)y * row + 3 * (size_t)x;
      to[0] = (uint8_t)(pixel >> 16);
      to[1] = (uint8_t)(pixel >> 8);
      to[2] = (uint8_t)pixel;
    }
  }
  if (!png_image_write_to_file(&image, path, 0, bytes, (png_int_32)row, NULL))
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", path, image.message);
  png_image_free(&image);
  free(bytes);
  return err->status;
}
