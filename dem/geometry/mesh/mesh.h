/* Triangle meshes as walls: thin shells that particles feel from both sides.
 *
 * mesh_tree.h finds the triangles near a place, mesh_contact.h the contacts of a sphere, and says what counts as one.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_MESH_MESH_H
#define DEM_GEOMETRY_MESH_MESH_H

#include "dem/geometry/mesh/mesh_report.h"
#include "dem/geometry/triangle.h"
#include "protocol/surface/stl.h"

#include <jansson.h>

#define DEM_MESH_FLAT 1e-5        /* angle up to which an edge is flat [rad] */
#define DEM_MESH_FACET_ANGLE 0.35 /* default facet angle [rad]: 20 degrees */

/* Build a mesh. Vertices are merged when equal; triangles without area (height below 1e-6 of the longest edge) and
 * those with the corners of an earlier one are dropped and counted. NULL after an error (no memory, no triangle left);
 * `name` stands for it in errors and reports and is copied. */
dem_mesh *dem_mesh_make(const tdm_stl *stl, const char *name, double facet_angle, const char *path, tdm_error *err);

void dem_mesh_destroy(dem_mesh **mesh);

const char *dem_mesh_name(const dem_mesh *mesh);
const dem_mesh_report *dem_mesh_figures(const dem_mesh *mesh);
json_t *dem_mesh_report_json(const dem_mesh *mesh); /* new reference */

/* A number that depends on the surface: vertices, triangles, facet angle (FNV-1a). */
unsigned long long dem_mesh_hash(const dem_mesh *mesh);

/* All triangles, for the contact loops. */
const dem_triangles *dem_mesh_triangles(const dem_mesh *mesh);

/* Corners of a triangle and its unit normal. */
void dem_mesh_triangle(const dem_mesh *mesh, int triangle, tdm_vec3 corner[3], tdm_vec3 *normal);

#endif
