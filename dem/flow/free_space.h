/* Is there room for a sphere? The particles near a box, for a source or a filling that tries places between two steps:
 * a list, and when many places are tried, cells. The answer does not depend on them. In periodic directions a particle
 * is a member once for each of its images that is near the box.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_FLOW_FREE_SPACE_H
#define DEM_FLOW_FREE_SPACE_H

#include "dem/state/data.h"

/* A particle, or an image of it. */
typedef struct {
  tdm_vec3 position; /* [m] */
  double radius;     /* [m] */
} dem_occupant;

typedef struct {
  tdm_vec3 low, high;   /* box of the centres that are tried [m] */
  double radius;        /* largest that is tried [m] */
  double largest;       /* of those and the members [m] */
  dem_occupant *member; /* (capacity) what is near the box */
  int count, capacity;
  long looked; /* at members so far, without cells */

  double edge, per_edge; /* of a cell: what lies two cells away touches nothing [m]; 1/edge */
  int n[3];              /* cells in each direction; those at the rim reach to infinity */
  int *first;            /* (cells) first member of a cell, -1: none; NULL: no cells yet */
  int *next;             /* (capacity) the next member of its cell, -1: none */
} dem_free_space;

/* For spheres of up to `radius` with centres in the box [low, high]. TDM_ERR_MEMORY (then there is nothing to
 * close). */
tdm_status dem_free_space_open(dem_free_space *space, const dem_data *data, tdm_vec3 low, tdm_vec3 high, double radius);
void dem_free_space_close(dem_free_space *space);

/* Has a sphere at x, in the box, room: does it overlap neither a particle nor a wall? One that is altogether behind a
 * plane is not in it. */
bool dem_free_space_free(dem_free_space *space, const dem_data *data, tdm_vec3 x, double radius);

/* Particle i, of no more than the radius of dem_free_space_open, has come. Errors: TDM_ERR_MEMORY. */
tdm_status dem_free_space_add(dem_free_space *space, const dem_data *data, int i);

#endif
