/* What of a scenery's polygons is worked out once: which edges are drawn, and normals that make round things look
 * round.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_DRAW_SPACE_SURFACE_H
#define TDM_DRAW_SPACE_SURFACE_H

#include "protocol/view/view.h"

/* Zero-initialise; free with tdm_surface_free. */
typedef struct {
  int npolygon;
  tdm_vec3 *flat;  /* (npolygon) unit normals, body axes; zero for a polygon without area */
  int *first;      /* (npolygon) index of a polygon's first corner */
  tdm_vec3 *round; /* (corners) unit normals at the corners */
  float *edge; /* (corners) of the edge from this corner to the next one, if it is drawn, as an outline or a sharp edge:
                  the width of the widest polygon at it [m]; else 0 */
} tdm_surface;

tdm_status tdm_surface_make(tdm_surface *surface, const tdm_scenery *scenery, tdm_error *err);
void tdm_surface_free(tdm_surface *surface);

#endif
