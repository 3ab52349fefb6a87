/* From where a picture is taken: axes, perspective, and what is seen when nobody says so. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_DRAW_CAMERA_H
#define TDM_DRAW_CAMERA_H

#include "protocol/draw/settings.h"

/* A box in world axes; empty: low above high. */
typedef struct {
  tdm_vec3 low, high; /* [m] */
} tdm_bounds;

typedef struct {
  bool flat, perspective;
  tdm_vec3 at;              /* the middle of the picture [m] */
  tdm_vec3 right, up, back; /* orthonormal; back points from `at` to the eye */
  double distance;          /* of the eye from `at`, also without perspective [m] */
  double half[2];           /* half of what is seen at `at`, across and up [m] */
} tdm_camera;

tdm_bounds tdm_bounds_empty(void);
bool tdm_bounds_are_empty(const tdm_bounds *bounds);
/* Grow to hold a ball; what is not finite is left out. */
void tdm_bounds_add(tdm_bounds *bounds, tdm_vec3 point, double radius);

/* The camera for a view of what lies in `bounds`; `up` is the scene's (against gravity), aspect is width over height
 * of the part of the picture that it fills. A flat view shows at least its limits. */
tdm_camera tdm_camera_make(const tdm_view *view, const tdm_bounds *bounds, tdm_vec3 up, double aspect);

/* What a flat view shows [m]: its limits, or the bounds with a margin. */
void tdm_camera_limits(const tdm_view *view, const tdm_bounds *bounds, double low[2], double high[2]);

/* A world point in the camera's axes, from the eye: x across, y up, z backwards (what is seen has z < 0) [m]. */
tdm_vec3 tdm_camera_see(const tdm_camera *camera, tdm_vec3 point);

/* Where a point that is given in the camera's axes lies in the picture: -1 to 1 across and up. */
void tdm_camera_project(const tdm_camera *camera, tdm_vec3 seen, double out[2]);

#endif
