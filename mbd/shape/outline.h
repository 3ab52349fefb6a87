/* The surfaces of primitive shapes, for pictures: polygons in the shape's axes, which are the body's, from the centre
 * of mass. Round ones are drawn with 24 sides. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_SHAPE_OUTLINE_H
#define MBD_SHAPE_OUTLINE_H

#include "protocol/view/view.h"

/* A primitive: what draws it, with its sizes [m]: a box's edges; else outer radius, inner radius, length. */
typedef struct mbd_outline {
  tdm_status (*draw)(const struct mbd_outline *outline, int body, tdm_scenery *scenery, tdm_error *err);
  double size[3];
} mbd_outline;

/* Append the polygons as those of scenery body `body`. */
tdm_status mbd_outline_sphere(const mbd_outline *outline, int body, tdm_scenery *scenery, tdm_error *err);
tdm_status mbd_outline_box(const mbd_outline *outline, int body, tdm_scenery *scenery, tdm_error *err);
tdm_status mbd_outline_cylinder(const mbd_outline *outline, int body, tdm_scenery *scenery, tdm_error *err);
tdm_status mbd_outline_tube(const mbd_outline *outline, int body, tdm_scenery *scenery, tdm_error *err);
tdm_status mbd_outline_cone(const mbd_outline *outline, int body, tdm_scenery *scenery, tdm_error *err);
tdm_status mbd_outline_capsule(const mbd_outline *outline, int body, tdm_scenery *scenery, tdm_error *err);

#endif
