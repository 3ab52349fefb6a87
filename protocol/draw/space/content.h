/* From what there is to see to what is drawn: particles, surfaces, lines and marks, with their colours, in the camera's
 * axes. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_DRAW_SPACE_CONTENT_H
#define TDM_DRAW_SPACE_CONTENT_H

#include "protocol/draw/space/render.h"
#include "protocol/draw/space/surface.h"
#include "protocol/view/view.h"

/* One state of a run, and how to draw it; all borrowed. */
typedef struct {
  const tdm_picture *picture;
  const tdm_scenery *scenery;
  const tdm_surface *surface; /* of the scenery */
  const tdm_snapshot *snapshot;
  const tdm_camera *camera;
  tdm_vec3 up;     /* of the scene, unit */
  double range[2]; /* of the colours; equal: one number for all */
  int height;      /* of the picture [pixels] */
} tdm_content;

/* Up in a scene: against gravity, else z. Unit. */
tdm_vec3 tdm_scene_up(const tdm_scenery *scenery);

/* Widen bounds to hold what the picture shows of a snapshot: particles if `particles`, surfaces, lines. */
tdm_status tdm_content_bounds(tdm_bounds *bounds, const tdm_picture *picture, const tdm_scenery *scenery,
                              const tdm_snapshot *snapshot, bool particles, tdm_error *err);

/* Fill the drawing, which is emptied first. Whatever has a coordinate that is not finite is left out. */
tdm_status tdm_content_make(tdm_drawing *drawing, const tdm_content *content, tdm_error *err);

#endif
