/* Colours of particles: numbers, their range, and the map from numbers to colours. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_DRAW_COLOR_H
#define TDM_DRAW_COLOR_H

#include "protocol/draw/camera.h"
#include "protocol/view/view.h"

/* Colours that mean something of their own. */
typedef struct {
  uint8_t r, g, b;
} tdm_rgb;

/* Of a number between 0 (least) and 1 (greatest); outside, the nearest of the two. Dark blue, green, yellow; equal
 * steps look equal also to those who see no red or green. */
tdm_rgb tdm_color_map(double s);

/* Of a kind: materials, size classes (-1: none of them). */
tdm_rgb tdm_color_of_kind(int kind);

/* How many particles or contacts a snapshot has, whichever are coloured. */
int tdm_color_count(tdm_color color, const tdm_snapshot *snapshot);

/* Whether a way to colour has kinds instead of numbers, and how many a scenery has. */
bool tdm_color_has_kinds(tdm_color color);
int tdm_color_kinds(tdm_color color, const tdm_scenery *scenery);
/* The name of one; into out. Returns out. */
const char *tdm_color_kind_name(tdm_color color, const tdm_scenery *scenery, int kind, char *out, size_t size);

/* The number of particle or contact i, in the unit of the label. height0 and across0 are along the camera's axes, and
 * in space the height is along `up`. */
double tdm_color_value(tdm_color color, const tdm_snapshot *snapshot, int i, const tdm_camera *camera, tdm_vec3 up);

/* Widen range to hold the snapshot's numbers; of forces to hold 99 in 100, as single contacts can bear far more than
 * all others. Start with {INFINITY, -INFINITY}. */
tdm_status tdm_color_widen(double range[2], tdm_color color, const tdm_snapshot *snapshot, const tdm_camera *camera,
                           tdm_vec3 up, tdm_error *err);

#endif
