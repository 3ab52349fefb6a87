/* The insides of a mesh, for the files mesh*.c. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_MESH_MESH_DATA_H
#define DEM_GEOMETRY_MESH_MESH_DATA_H

#include "dem/geometry/mesh/mesh_report.h"
#include "dem/geometry/triangle.h"

typedef enum { DEM_EDGE_OPEN, DEM_EDGE_FLAT, DEM_EDGE_CONVEX, DEM_EDGE_CONCAVE, DEM_EDGE_MANY } dem_edge_kind;

typedef struct {
  int vertex[3];
  int edge[3];        /* from vertex k to vertex k + 1 */
  bool strict[3];     /* what lies on this edge's boundary plane belongs to the other triangle */
  tdm_vec3 normal;    /* unit */
  tdm_vec3 inward[3]; /* unit, in the plane, perpendicular to the edge; one pair of opposites at a flat edge */
} dem_face;

typedef struct {
  int a, b;         /* vertices, a < b */
  int first, count; /* its triangles in edge_face, ascending */
  dem_edge_kind kind;
  tdm_vec3 along; /* from a to b [m] */
  double length2;
} dem_edge;

/* A node of the tree of boxes; the left child is the next node. */
typedef struct {
  tdm_vec3 low, high;
  int right;        /* child; of a leaf 0 */
  int first, count; /* leaf: its triangles in order */
} dem_mesh_node;

struct dem_mesh {
  char *name;
  int nface, nvertex, nedge;
  tdm_vec3 *vertex;        /* (nvertex) */
  dem_face *face;          /* (nface) */
  dem_edge *edge;          /* (nedge) */
  int *edge_face;          /* (3 nface) triangles of the edges */
  int *vertex_first;       /* (nvertex + 1) into vertex_face */
  int *vertex_face;        /* (3 nface) triangles of the vertices, ascending */
  bool *flat;              /* (nvertex) all edges of the vertex are flat */
  bool *rim;               /* (nvertex) the vertex has an open edge */
  dem_mesh_node *node;     /* (2 nface at most) */
  int *order;              /* (nface) triangles leaf by leaf */
  dem_triangle *triangle;  /* (nface) for the contact loops */
  dem_triangles triangles; /* these */
  double facet_angle;      /* [rad] */
  double facet_cos;        /* its cosine */
  double crack;            /* width of what counts as a crack of the surface [m] */
  dem_mesh_report report;
};

static inline tdm_vec3 dem_corner(const dem_mesh *mesh, int face, int k) {
  return mesh->vertex[mesh->face[face].vertex[k]];
}

#endif
