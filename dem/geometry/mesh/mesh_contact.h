/* Contacts of a sphere with a mesh.
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
#ifndef DEM_GEOMETRY_MESH_MESH_CONTACT_H
#define DEM_GEOMETRY_MESH_MESH_CONTACT_H

#include "dem/geometry/mesh/mesh_report.h"
#include "dem/geometry/touch.h"

#include <stddef.h>

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
