/* Finding the triangles of a mesh near a place: a tree of boxes. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_MESH_MESH_TREE_H
#define DEM_GEOMETRY_MESH_MESH_TREE_H

#include "dem/geometry/mesh/mesh_report.h"
#include "protocol/base/status.h"

/* Build the tree. Errors: TDM_ERR_MEMORY. */
tdm_status dem_mesh_plant(dem_mesh *mesh);

/* A part of the tree that has all triangles in the box, for dem_mesh_near; -1: there are none. */
int dem_mesh_within(const dem_mesh *mesh, tdm_vec3 low, tdm_vec3 high);

/* The triangles nearer to x than `range`, ascending. Returns how many there are; if that is more than `max`, out holds
 * nothing useful: call again with more room. from: 0, or what dem_mesh_within gave for a box that has the place and its
 * range. */
int dem_mesh_near(const dem_mesh *mesh, int from, tdm_vec3 x, double range, int *out, int max);

/* Distance of x from the nearest point of the mesh and the unit normal from there towards x. */
double dem_mesh_gap(const dem_mesh *mesh, tdm_vec3 x, tdm_vec3 *normal);

#endif
