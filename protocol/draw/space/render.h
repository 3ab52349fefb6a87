/* Triangles, balls and thin lines as an image, by OpenGL without a display (OSMesa): exact depths, light, shaded
 * crevices, translucent surfaces in front of what is solid. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_DRAW_SPACE_RENDER_H
#define TDM_DRAW_SPACE_RENDER_H

#include "protocol/draw/camera.h"

#include <stdint.h>

/* The corner of a triangle or the end of a line, in the camera's axes, lengths divided by tdm_drawing.unit. */
typedef struct {
  float position[3], normal[3]; /* normal zero: drawn without light */
  uint8_t color[4];             /* red, green, blue, opacity */
} tdm_vertex;

typedef struct {
  float center[3], radius;
  uint8_t color[4];
} tdm_ball;

typedef struct {
  tdm_vertex *vertex;
  size_t count, capacity;
} tdm_vertices;

typedef struct {
  tdm_ball *ball;
  size_t count, capacity;
} tdm_balls;

/* What is to be drawn. Zero-initialise; free with tdm_drawing_free. */
typedef struct {
  double unit;                     /* what the lengths are divided by [m] */
  tdm_vertices solid, edges;       /* triangles; lines of those */
  tdm_balls balls;                 /* particles */
  tdm_vertices glass, glass_edges; /* translucent triangles, in any order; lines of those */
  tdm_vertices lines;              /* triangles of the mechanism's lines and marks, seen through what is solid */
  tdm_balls dots;                  /* balls of the same */
  bool behind;                     /* flat views: particles in front of all surfaces, lines in front of particles */
} tdm_drawing;

tdm_status tdm_vertices_add(tdm_vertices *list, const tdm_vertex *vertex, int count, tdm_error *err);
tdm_status tdm_balls_add(tdm_balls *list, const tdm_ball *ball, tdm_error *err);
void tdm_drawing_clear(tdm_drawing *drawing);
void tdm_drawing_free(tdm_drawing *drawing);

typedef struct tdm_renderer tdm_renderer;

/* NULL and an error when OpenGL does not work here. */
tdm_renderer *tdm_renderer_new(tdm_error *err);
void tdm_renderer_free(tdm_renderer *renderer);

/* An image of the drawing: (width x height) of red, green, blue, 255 in the order of a cairo surface
 * CAIRO_FORMAT_RGB24, rows from the top, without padding; borrowed until the next call. The drawing's lists are sorted.
 * `up` is the scene's, from where the sky is bright. */
tdm_status tdm_render(tdm_renderer *renderer, tdm_drawing *drawing, const tdm_camera *camera, tdm_vec3 up, int width,
                      int height, const uint32_t **pixel, tdm_error *err);

#endif
