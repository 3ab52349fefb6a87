/* Triangle meshes as walls: thin shells that particles feel from both sides.
 *
 * A sphere touches a mesh where the distance from its centre to the surface has a local minimum that is smaller than
 * its radius. So a triangle's nearest point counts when it lies inside the triangle; on an edge or at a vertex it
 * counts when it is the nearest point of every triangle that meets there, and then once. Over a flat part of the mesh
 * one contact is left, over a convex edge one, in a concave corner one a face.
 *
 * Edges, seen from the front of their first triangle (corners run anticlockwise): flat when the triangles' planes
 * differ by less than DEM_MESH_FLAT, else convex or concave. At a flat edge both triangles use one boundary plane, so
 * a point over it belongs to exactly one of them, and contacts at flat edges and vertices take the triangle's normal.
 *
 * Facets of a curved wall (a drum): where two triangles meet at an angle of less than `facet_angle` in a concave edge,
 * a sphere in the crease would touch both and feel the wall twice. Contacts on such neighbours (a common edge or
 * vertex, or a chain of them; planes and contact normals closer than the angle) are merged into the deepest, at equal
 * depth that of the lower triangle. Passing a crease the overlap is continuous and the normal jumps by the angle.
 *
 * Where a file has vertices that differ in the last digit or lie on the middle of another edge, the topology has
 * cracks: a contact on an open edge whose point lies on a triangle that is nearer is dropped, too.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_MESH_H
#define DEM_GEOMETRY_MESH_H

#include "dem/geometry/touch.h"
#include "protocol/base/stl.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

#define DEM_MESH_FLAT 1e-5        /* angle up to which an edge is flat [rad] */
#define DEM_MESH_FACET_ANGLE 0.35 /* default facet angle [rad]: 20 degrees */

typedef enum { DEM_EDGE_OPEN, DEM_EDGE_FLAT, DEM_EDGE_CONVEX, DEM_EDGE_CONCAVE, DEM_EDGE_MANY } dem_edge_kind;

/* What a mesh is like. */
typedef struct {
  int triangles, vertices, edges;
  int degenerate, duplicate; /* triangles of the file that were dropped */
  int open, nonmanifold;     /* edges of one triangle, of more than two */
  int flat, convex, concave; /* edges of two triangles */
  int flipped;               /* edges whose two triangles face opposite sides */
  bool closed;               /* as tdm_surface_look finds it, of all triangles of the file; so the next four */
  bool oriented;             /* closed, and its triangles face one side */
  int parts, inverted;       /* that hang together; that are inside out: if oriented, else 0 */
  double volume;             /* [m3], positive when the triangles face outward; if oriented, else 0 */
  tdm_vec3 centre;           /* of the volume, body axes [m] */
  double area;               /* [m2] */
  tdm_vec3 low, high;        /* bounding box [m] */
} dem_mesh_report;

/* Body axes, from the centre of mass. Immutable after it was made. */
typedef struct dem_mesh dem_mesh;

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

/* Corners of a triangle and its unit normal. */
void dem_mesh_triangle(const dem_mesh *mesh, int triangle, tdm_vec3 corner[3], tdm_vec3 *normal);

/* The triangles nearer to x than `range`, ascending. Returns how many there are; if that is more than `max`, out
 * holds nothing useful: call again with more room. */
int dem_mesh_near(const dem_mesh *mesh, tdm_vec3 x, double range, int *out, int max);

/* Distance of x from the nearest point of the mesh and the unit normal from there towards x. */
double dem_mesh_gap(const dem_mesh *mesh, tdm_vec3 x, tdm_vec3 *normal);

/* The contacts of a sphere at x, ascending by their part, the lowest triangle that has the contact point; gaps are >=
 * 0. The candidates, candidate[0], candidate[stride] ... candidate[(n - 1) * stride], must have all triangles nearer
 * than the radius, in any order, and may have others. Returns the number of contacts, at most `max`, which is at most
 * DEM_TOUCHES_MAX: of more the deepest are kept. */
int dem_mesh_contacts(const dem_mesh *mesh, const int *candidate, size_t stride, int n, tdm_vec3 x, double radius,
                      dem_touch *out, int max);

/* Does a contact that ended on triangle `from` go on as one that begins on `to`? True for a triangle itself, for
 * facets (a common vertex, planes closer than the facet angle), and over a common edge at any angle: a sphere rolls
 * over a sharp edge without losing its grip. Two contacts that have nothing to do with each other hardly change in one
 * step, and one that opens has no tangential force left to hand over. */
bool dem_mesh_passes(const dem_mesh *mesh, int from, int to);

#endif
