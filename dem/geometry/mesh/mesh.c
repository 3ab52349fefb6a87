/* Meshes: from loose triangles to vertices, edges and their neighbours; the report. See mesh.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/mesh/mesh.h"

#include "dem/geometry/mesh/mesh_data.h"
#include "dem/geometry/mesh/mesh_tree.h"
#include "protocol/math/hash.h"
#include "protocol/surface/surface.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static const double thin = 1e-6; /* height over longest edge of a triangle that has no area */

/* ---- triangles and vertices ---- */

static tdm_vec3 normal_of(const tdm_vec3 c[3]) {
  return tdm_cross(tdm_sub(c[1], c[0]), tdm_sub(c[2], c[0]));
}

static bool degenerate(const tdm_vec3 c[3]) {
  double longest2 = 0;
  for (int k = 0; k < 3; k++) {
    tdm_vec3 side = tdm_sub(c[(k + 1) % 3], c[k]);
    longest2 = fmax(longest2, tdm_dot(side, side));
  }
  return !(tdm_norm(normal_of(c)) > thin * longest2);
}

typedef struct {
  tdm_vec3 x;
  int face, k;
} corner;

static int by_place(const void *pa, const void *pb) {
  const corner *a = pa, *b = pb;
  const double d[3] = {a->x.x - b->x.x, a->x.y - b->x.y, a->x.z - b->x.z};
  for (int i = 0; i < 3; i++)
    if (d[i] != 0)
      return d[i] < 0 ? -1 : 1;
  return a->face != b->face ? (a->face < b->face ? -1 : 1) : a->k - b->k;
}

/* the triangles that have an area, their corners merged where equal */
static tdm_status make_vertices(dem_mesh *m, const tdm_stl *stl) {
  corner *all = malloc(3 * (size_t)stl->count * sizeof *all);
  if (!all)
    return TDM_ERR_MEMORY;
  for (int t = 0; t < stl->count; t++) {
    const tdm_vec3 *c = &stl->corner[3 * (size_t)t];
    if (degenerate(c)) {
      m->report.degenerate++;
      continue;
    }
    for (int k = 0; k < 3; k++)
      all[3 * (size_t)m->nface + (size_t)k] = (corner){c[k], m->nface, k};
    m->nface++;
  }
  size_t n = 3 * (size_t)m->nface;
  qsort(all, n, sizeof *all, by_place);
  for (size_t i = 0; i < n; i++) {
    tdm_vec3 x = all[i].x;
    if (i == 0 || x.x != all[i - 1].x.x || x.y != all[i - 1].x.y || x.z != all[i - 1].x.z)
      m->vertex[m->nvertex++] = x;
    m->face[all[i].face].vertex[all[i].k] = m->nvertex - 1;
  }
  free(all);
  return TDM_OK;
}

typedef struct {
  int vertex[3]; /* ascending */
  int face;
} triple;

static int by_triple(const void *pa, const void *pb) {
  const triple *a = pa, *b = pb;
  for (int k = 0; k < 3; k++)
    if (a->vertex[k] != b->vertex[k])
      return a->vertex[k] < b->vertex[k] ? -1 : 1;
  return a->face < b->face ? -1 : 1;
}

static triple triple_of(const dem_face *f, int face) {
  int a = f->vertex[0], b = f->vertex[1], c = f->vertex[2];
  int low = a < b ? (a < c ? a : c) : (b < c ? b : c), high = a > b ? (a > c ? a : c) : (b > c ? b : c);
  return (triple){{low, a ^ b ^ c ^ low ^ high, high}, face};
}

/* drop triangles with the corners of an earlier one */
static tdm_status drop_duplicates(dem_mesh *m) {
  triple *all = malloc((size_t)m->nface * sizeof *all);
  bool *drop = calloc((size_t)m->nface, sizeof *drop);
  bool good = all && drop;
  for (int t = 0; good && t < m->nface; t++)
    all[t] = triple_of(&m->face[t], t);
  if (good)
    qsort(all, (size_t)m->nface, sizeof *all, by_triple);
  for (int i = 1; good && i < m->nface; i++)
    drop[all[i].face] = memcmp(all[i].vertex, all[i - 1].vertex, sizeof all[i].vertex) == 0;
  int kept = 0;
  for (int t = 0; good && t < m->nface; t++)
    if (!drop[t])
      m->face[kept++] = m->face[t];
  m->report.duplicate = good ? m->nface - kept : 0;
  m->nface = good ? kept : m->nface;
  free(all);
  free(drop);
  return good ? TDM_OK : TDM_ERR_MEMORY;
}

static void set_normals(dem_mesh *m) {
  for (int t = 0; t < m->nface; t++) {
    const tdm_vec3 c[3] = {dem_corner(m, t, 0), dem_corner(m, t, 1), dem_corner(m, t, 2)};
    m->face[t].normal = tdm_unit(normal_of(c));
  }
}

static void join_vertices(dem_mesh *m) {
  for (int t = 0; t < m->nface; t++)
    for (int k = 0; k < 3; k++)
      m->vertex_first[m->face[t].vertex[k] + 1]++;
  for (int v = 0; v < m->nvertex; v++)
    m->vertex_first[v + 1] += m->vertex_first[v];
  /* fill upward, then the starts are one vertex too far */
  for (int t = 0; t < m->nface; t++)
    for (int k = 0; k < 3; k++)
      m->vertex_face[m->vertex_first[m->face[t].vertex[k]]++] = t;
  memmove(m->vertex_first + 1, m->vertex_first, (size_t)m->nvertex * sizeof *m->vertex_first);
  m->vertex_first[0] = 0;
}

/* ---- edges ---- */

typedef struct {
  int a, b, face, k;
} side;

static int by_edge(const void *pa, const void *pb) {
  const side *a = pa, *b = pb;
  if (a->a != b->a)
    return a->a < b->a ? -1 : 1;
  if (a->b != b->b)
    return a->b < b->b ? -1 : 1;
  return a->face < b->face ? -1 : 1;
}

/* the place of an edge in its triangle */
static int place_of(const dem_face *f, int edge) {
  return f->edge[0] == edge ? 0 : f->edge[1] == edge ? 1 : 2;
}

static void set_inward(dem_mesh *m, int edge, int face) {
  dem_face *f = &m->face[face];
  int k = place_of(f, edge);
  tdm_vec3 in = tdm_unit(tdm_cross(f->normal, m->edge[edge].along));
  tdm_vec3 to = tdm_sub(dem_corner(m, face, (k + 2) % 3), m->vertex[m->edge[edge].a]);
  f->inward[k] = tdm_dot(in, to) < 0 ? tdm_scale(-1, in) : in;
}

/* an edge of two triangles: its kind, and one boundary plane when it is flat */
static void set_kind(dem_mesh *m, int edge) {
  dem_edge *e = &m->edge[edge];
  dem_face *f = &m->face[m->edge_face[e->first]], *g = &m->face[m->edge_face[e->first + 1]];
  int kf = place_of(f, edge), kg = place_of(g, edge);
  if (tdm_norm(tdm_add(f->inward[kf], g->inward[kg])) <= DEM_MESH_FLAT) {
    e->kind = DEM_EDGE_FLAT;
    g->inward[kg] = tdm_scale(-1, f->inward[kf]);
    g->strict[kg] = true;
  } else {
    e->kind = tdm_dot(g->inward[kg], f->normal) > 0 ? DEM_EDGE_CONCAVE : DEM_EDGE_CONVEX;
  }
  m->report.flipped += (f->vertex[kf] == e->a) == (g->vertex[kg] == e->a);
}

static void finish_edge(dem_mesh *m, int edge) {
  dem_edge *e = &m->edge[edge];
  for (int i = 0; i < e->count; i++)
    set_inward(m, edge, m->edge_face[e->first + i]);
  e->kind = e->count == 1 ? DEM_EDGE_OPEN : DEM_EDGE_MANY;
  if (e->count == 2)
    set_kind(m, edge);
  int *count[] = {&m->report.open, &m->report.flat, &m->report.convex, &m->report.concave, &m->report.nonmanifold};
  ++*count[e->kind];
  if (e->kind == DEM_EDGE_OPEN)
    m->rim[e->a] = m->rim[e->b] = true;
  if (e->kind != DEM_EDGE_FLAT)
    m->flat[e->a] = m->flat[e->b] = false;
}

static tdm_status make_edges(dem_mesh *m) {
  size_t n = 3 * (size_t)m->nface;
  side *all = malloc(n * sizeof *all);
  if (!all)
    return TDM_ERR_MEMORY;
  for (int t = 0; t < m->nface; t++)
    for (int k = 0; k < 3; k++) {
      int a = m->face[t].vertex[k], b = m->face[t].vertex[(k + 1) % 3];
      all[3 * (size_t)t + (size_t)k] = (side){a < b ? a : b, a < b ? b : a, t, k};
    }
  qsort(all, n, sizeof *all, by_edge);
  for (size_t i = 0; i < n; i++) {
    if (i == 0 || all[i].a != all[i - 1].a || all[i].b != all[i - 1].b) {
      tdm_vec3 along = tdm_sub(m->vertex[all[i].b], m->vertex[all[i].a]);
      m->edge[m->nedge++] =
          (dem_edge){.a = all[i].a, .b = all[i].b, .first = (int)i, .along = along, .length2 = tdm_dot(along, along)};
    }
    m->edge[m->nedge - 1].count++;
    m->edge_face[i] = all[i].face;
    m->face[all[i].face].edge[all[i].k] = m->nedge - 1;
  }
  free(all);
  for (int v = 0; v < m->nvertex; v++)
    m->flat[v] = true;
  for (int e = 0; e < m->nedge; e++)
    finish_edge(m, e);
  return TDM_OK;
}

/* ---- for the contact loops ---- */

static dem_triangle triangle_of(const dem_mesh *m, int face) {
  const dem_face *f = &m->face[face];
  int place[3] = {0, 1, 2}; /* of the corners in the face, ascending by vertex */
  for (int i = 1; i < 3; i++)
    for (int k = i; k > 0 && f->vertex[place[k]] < f->vertex[place[k - 1]]; k--) {
      int swap = place[k];
      place[k] = place[k - 1];
      place[k - 1] = swap;
    }
  dem_triangle t = {.normal = f->normal, .unused = 0};
  for (int k = 0; k < 3; k++) {
    const int a = place[DEM_EDGE_FROM(k)], b = place[DEM_EDGE_TO(k)], at = (a + 1) % 3 == b ? a : b;
    const dem_edge *e = &m->edge[f->edge[at]];
    const int *sides = &m->edge_face[e->first];
    t.corner[k] = m->vertex[f->vertex[place[k]]];
    t.inward[k] = f->inward[at];
    t.beyond[k] = e->count != 2 ? -1 : sides[0] == face ? sides[1] : sides[0];
    t.origin = place[k] == 0 ? k : t.origin;
  }
  return t;
}

static tdm_status make_triangles(dem_mesh *m) {
  dem_triangle *all = aligned_alloc(64, (size_t)m->nface * sizeof *all);
  if (!all)
    return TDM_ERR_MEMORY;
  for (int t = 0; t < m->nface; t++)
    all[t] = triangle_of(m, t);
  m->triangle = all;
  m->triangles = (dem_triangles){all, m->facet_cos};
  return TDM_OK;
}

/* ---- the report ---- */

/* what the whole file says of the surface */
static tdm_status look_at_surface(dem_mesh *m, const tdm_stl *stl) {
  tdm_error none = {0};
  tdm_surface s;
  tdm_status status = tdm_surface_look(&s, stl, NULL, &none);
  m->report.closed = s.closed;
  m->report.oriented = s.oriented;
  m->report.parts = s.parts;
  m->report.inverted = s.inverted;
  m->report.volume = s.volume;
  m->report.centre = s.centre;
  tdm_surface_destroy(&s);
  return status;
}

static void set_report(dem_mesh *m) {
  dem_mesh_report *r = &m->report;
  r->triangles = m->nface;
  r->vertices = m->nvertex;
  r->edges = m->nedge;
  r->low = r->high = m->vertex[0];
  for (int v = 1; v < m->nvertex; v++) {
    tdm_vec3 x = m->vertex[v];
    r->low = tdm_v3(fmin(r->low.x, x.x), fmin(r->low.y, x.y), fmin(r->low.z, x.z));
    r->high = tdm_v3(fmax(r->high.x, x.x), fmax(r->high.y, x.y), fmax(r->high.z, x.z));
  }
  for (int t = 0; t < m->nface; t++) {
    const tdm_vec3 c[3] = {dem_corner(m, t, 0), dem_corner(m, t, 1), dem_corner(m, t, 2)};
    r->area += 0.5 * tdm_norm(normal_of(c));
  }
  m->crack = 2 * thin * tdm_norm(tdm_sub(r->high, r->low));
}

json_t *dem_mesh_report_json(const dem_mesh *m) {
  const dem_mesh_report *r = &m->report;
  json_t *json = json_pack("{s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:i}", "triangles", r->triangles, "vertices",
                           r->vertices, "edges", r->edges, "degenerate", r->degenerate, "duplicate", r->duplicate,
                           "open_edges", r->open, "nonmanifold_edges", r->nonmanifold, "flipped_edges", r->flipped);
  json_t *more = json_pack("{s:s?, s:i, s:i, s:i, s:b, s:f, s:[f,f,f], s:[f,f,f]}", "file", m->name, "flat_edges",
                           r->flat, "convex_edges", r->convex, "concave_edges", r->concave, "closed", r->closed, "area",
                           r->area, "min", r->low.x, r->low.y, r->low.z, "max", r->high.x, r->high.y, r->high.z);
  json_object_update(json, more);
  json_decref(more);
  if (!r->oriented)
    return json;
  more = json_pack("{s:i, s:i, s:f, s:[f,f,f]}", "parts", r->parts, "inverted_parts", r->inverted, "volume", r->volume,
                   "centre", r->centre.x, r->centre.y, r->centre.z);
  json_object_update(json, more);
  json_decref(more);
  return json;
}

/* ---- life ---- */

static tdm_status allocate(dem_mesh *m, const char *name, int count) {
  size_t n = (size_t)count;
  m->name = strdup(name);
  m->vertex = malloc(3 * n * sizeof *m->vertex);
  m->face = calloc(n, sizeof *m->face);
  m->edge = malloc(3 * n * sizeof *m->edge);
  m->edge_face = malloc(3 * n * sizeof *m->edge_face);
  m->vertex_first = calloc(3 * n + 1, sizeof *m->vertex_first);
  m->vertex_face = malloc(3 * n * sizeof *m->vertex_face);
  m->flat = malloc(3 * n * sizeof *m->flat);
  m->rim = calloc(3 * n, sizeof *m->rim);
  m->node = malloc(2 * n * sizeof *m->node);
  m->order = malloc(n * sizeof *m->order);
  bool good = m->name && m->vertex && m->face && m->edge && m->edge_face && m->vertex_first && m->vertex_face &&
              m->flat && m->rim && m->node && m->order;
  return good ? TDM_OK : TDM_ERR_MEMORY;
}

static tdm_status build(dem_mesh *m, const tdm_stl *stl) {
  if (make_vertices(m, stl))
    return TDM_ERR_MEMORY;
  if (m->nface == 0)
    return TDM_OK;
  if (drop_duplicates(m))
    return TDM_ERR_MEMORY;
  set_normals(m);
  join_vertices(m);
  if (make_edges(m) || make_triangles(m))
    return TDM_ERR_MEMORY;
  set_report(m);
  return dem_mesh_plant(m);
}

dem_mesh *dem_mesh_make(const tdm_stl *stl, const char *name, double facet_angle, const char *path, tdm_error *err) {
  dem_mesh *m = calloc(1, sizeof *m);
  if (m) {
    m->facet_angle = facet_angle;
    m->facet_cos = cos(fmax(facet_angle, DEM_MESH_FLAT)); /* round-off is no angle */
  }
  if (!m || allocate(m, name, stl->count) || build(m, stl) || look_at_surface(m, stl))
    tdm_fail(err, TDM_ERR_MEMORY, path, "no memory for the %d triangles of \"%s\"", stl->count, name);
  else if (m->nface == 0)
    tdm_fail(err, TDM_ERR_FILE, path,
             "none of the %d triangles of \"%s\" has an area; export the part again, or check \"scale\"", stl->count,
             name);
  else
    return m;
  dem_mesh_destroy(&m);
  return NULL;
}

void dem_mesh_destroy(dem_mesh **mesh) {
  dem_mesh *m = *mesh;
  if (!m)
    return;
  void *arrays[] = {m->name,        m->vertex, m->face, m->edge, m->edge_face, m->vertex_first,
                    m->vertex_face, m->flat,   m->rim,  m->node, m->order,     m->triangle};
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
    free(arrays[i]);
  free(m);
  *mesh = NULL;
}

const char *dem_mesh_name(const dem_mesh *m) {
  return m->name;
}

const dem_triangles *dem_mesh_triangles(const dem_mesh *m) {
  return &m->triangles;
}

const dem_mesh_report *dem_mesh_figures(const dem_mesh *m) {
  return &m->report;
}

unsigned long long dem_mesh_hash(const dem_mesh *m) {
  uint64_t h = tdm_hash_bytes(TDM_HASH_START, &m->facet_angle, sizeof m->facet_angle);
  h = tdm_hash_bytes(h, m->vertex, (size_t)m->nvertex * sizeof *m->vertex);
  for (int t = 0; t < m->nface; t++)
    h = tdm_hash_bytes(h, m->face[t].vertex, sizeof m->face[t].vertex);
  return h;
}

void dem_mesh_triangle(const dem_mesh *m, int t, tdm_vec3 c[3], tdm_vec3 *normal) {
  for (int k = 0; k < 3; k++)
    c[k] = dem_corner(m, t, k);
  *normal = m->face[t].normal;
}
