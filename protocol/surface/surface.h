/* Is the surface of an STL file closed, and does it bound solids? The one check of mbd, which takes masses from files,
 * and of dem, which takes walls from them.
 *
 * Corners at the same place are one vertex; a triangle with the vertices of an earlier one is left out. The surface is
 * closed when every edge belongs to an even number of triangles, and one sheet when as many run along it one way as the
 * other. Triangles that hang together over edges of two are a solid, when its volume is positive, or a cavity, when it
 * is negative and lies inside a solid. What is negative elsewhere is inside out; a positive one inside another one
 * would count twice.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_SURFACE_SURFACE_H
#define TDM_SURFACE_SURFACE_H

#include "protocol/surface/stl.h"

#include <stdbool.h>

typedef struct {
  int triangles, edges;  /* without those left out */
  int repeated;          /* triangles left out */
  int open;              /* edges that an odd number of triangles have */
  int turned;            /* others, along which not as many triangles run one way as the other */
  bool closed, oriented; /* no edge is open; closed, and none turned */
  double volume;         /* [m3], if oriented; else 0 */
  tdm_vec3 centre;       /* of the volume [m]; 0 without one */
  int parts;             /* that hang together, if oriented; else 0 */
  int inverted, nested;  /* parts that are inside out; that lie inside another without being its cavity */
  tdm_vec3 bad;          /* a corner of the first of these [m] */
  bool *left_out;        /* (triangles of the file) */
} tdm_surface;

/* Look at a surface. The caller destroys *surface (also after an error, which is TDM_ERR_MEMORY at `path`). */
tdm_status tdm_surface_look(tdm_surface *surface, const tdm_stl *stl, const char *path, tdm_error *err);

void tdm_surface_destroy(tdm_surface *surface);

#endif
