/* Mass, centre of mass and inertia of shapes of one density: primitives and closed triangle meshes.
 *
 * To add a primitive: a function and a row in the table of inertia.c, and its surface in outline.c.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_SHAPE_INERTIA_H
#define MBD_SHAPE_INERTIA_H

#include "mbd/shape/outline.h"
#include "protocol/scene/scene.h"
#include "protocol/surface/stl.h"

typedef struct {
  double volume;       /* [m3] */
  tdm_vec3 centre;     /* of mass, axes of the shape [m] */
  tdm_mat3 gyration;   /* inertia about the centre divided by the mass [m2] */
  double density;      /* [kg/m3], 0: not given */
  const char *file;    /* of a mesh, whose axes the shape's are; the JSON's own string. NULL: a primitive */
  double scale;        /* metres a unit of the file */
  mbd_outline outline; /* of a primitive */
} mbd_shape;

/* Read the object "shape". Primitives stand with their axis along z and their centre of mass at zero. */
mbd_shape mbd_shape_read(tdm_object *owner);

/* Integrals over the inside of a mesh, exact for its triangles. Refuses a mesh that is open or whose triangles do not
 * all have their outer side outside; errors are at `path` and name `file`. */
tdm_status mbd_shape_of_mesh(mbd_shape *shape, const tdm_stl *stl, const char *file, const char *path, tdm_error *err);

#endif
