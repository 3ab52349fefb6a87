/* Contacts of a sphere with a mesh: local minima of the distance. See mesh_contact.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/mesh/mesh_contact.h"

#include "dem/geometry/mesh/mesh_nearest.h"

/* ---- local minima ---- */

typedef struct {
  int face;
  dem_nearest at;
} claim;

static claim claim_of(const dem_mesh *m, int face, tdm_vec3 x) {
  return (claim){face, dem_mesh_nearest(m, face, x)};
}

static bool nearer(const claim *a, const claim *b) {
  return a->at.distance2 != b->at.distance2 ? a->at.distance2 < b->at.distance2 : a->face < b->face;
}

/* Of the triangles that meet where the claim's point lies: the nearest of those whose own nearest point is another
 * one; if there is none, the lowest (which may be the claim's own). True: the claim is no local minimum. */
static bool better(const dem_mesh *m, tdm_vec3 x, const claim *c, claim *best) {
  *best = *c;
  if (c->at.on == DEM_ON_FACE)
    return false;
  int f = c->at.feature;
  bool edge = c->at.on == DEM_ON_EDGE, other = false;
  int first = edge ? m->edge[f].first : m->vertex_first[f];
  int end = edge ? first + m->edge[f].count : m->vertex_first[f + 1];
  const int *faces = edge ? m->edge_face : m->vertex_face;
  for (int i = first; i < end; i++) {
    claim now = claim_of(m, faces[i], x);
    bool same = now.at.on == c->at.on && now.at.feature == f;
    if (same ? !other && now.face < best->face : !other || nearer(&now, best))
      *best = now;
    other = other || !same;
  }
  return best->face != c->face;
}

/* Go to nearer neighbours until there is none. Where round-off makes the neighbours disagree (a point exactly over a
 * vertex) the steps get no nearer; one of them is taken then, and `merge` sees to it that it is one only. */
static claim descend(const dem_mesh *m, tdm_vec3 x, claim c) {
  claim next, beyond;
  while (better(m, x, &c, &next)) {
    if (!nearer(&next, &c) && better(m, x, &next, &beyond))
      break;
    c = next;
  }
  return c;
}

/* ---- merging ---- */

typedef struct {
  claim claim;
  double gap;
  tdm_vec3 normal;
  int group; /* the contact that this one is merged into */
} touch;

static bool deeper(const touch *a, const touch *b) {
  return a->gap != b->gap ? a->gap < b->gap : a->claim.face < b->claim.face;
}

/* number of common vertices */
static int common(const dem_face *f, const dem_face *g) {
  int n = 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      n += f->vertex[i] == g->vertex[j];
  return n;
}

/* facets of one curved wall */
static bool facets(const dem_mesh *m, int a, int b) {
  const dem_face *f = &m->face[a], *g = &m->face[b];
  return a == b || (fabs(tdm_dot(f->normal, g->normal)) >= m->facet_cos && common(f, g) > 0);
}

bool dem_mesh_passes(const dem_mesh *m, int from, int to) {
  return facets(m, from, to) || common(&m->face[from], &m->face[to]) > 1;
}

/* does `b` belong to the contact `kept`, whose member `a` is? */
static bool belongs(const dem_mesh *m, const touch *kept, const touch *a, const touch *b, double crack) {
  if (tdm_dot(kept->normal, b->normal) < m->facet_cos)
    return false;
  tdm_vec3 d = tdm_sub(a->claim.at.point, b->claim.at.point);
  return facets(m, a->claim.face, b->claim.face) || tdm_dot(d, d) <= crack * crack;
}

/* Merge contacts that belong to a deeper one; `t` is sorted, deepest first. Returns how many are left, in front. */
static int merge(const dem_mesh *m, touch *t, int n, double crack) {
  int left = 0;
  for (int i = 0; i < n; i++)
    t[i].group = -1;
  for (int k = 0; k < n; k++) {
    if (t[k].group >= 0)
      continue;
    t[k].group = k;
    /* chains of neighbours: until none comes in */
    for (bool more = true; more;) {
      more = false;
      for (int b = k + 1; b < n; b++)
        for (int a = k; a < n && t[b].group < 0; a++)
          if (t[a].group == k && belongs(m, &t[k], &t[a], &t[b], crack)) {
            t[b].group = k;
            more = true;
          }
    }
  }
  for (int k = 0; k < n; k++)
    if (t[k].group == k)
      t[left++] = t[k];
  return left;
}

/* put a contact in its place among the deepest; one that is there already is left out */
static void insert(touch *t, int *n, touch now) {
  int place = *n;
  for (int i = 0; i < *n; i++)
    if (t[i].claim.face == now.claim.face)
      return;
  while (place > 0 && deeper(&now, &t[place - 1]))
    place--;
  if (place == DEM_TOUCHES_MAX)
    return;
  *n += *n < DEM_TOUCHES_MAX;
  for (int i = *n - 1; i > place; i--)
    t[i] = t[i - 1];
  t[place] = now;
}

/* what the caller takes for near: number i is at i * stride */
typedef struct {
  const int *number;
  size_t stride;
  int n;
} candidates;

static int candidate_of(const candidates *near, int i) {
  return near->number[(size_t)i * near->stride];
}

/* Does the claim's point on the rim of the mesh lie on a triangle that does not belong to it by its vertices, and is
 * nearer to x? */
static bool bridged(const dem_mesh *m, const candidates *near, tdm_vec3 x, const claim *c, double crack) {
  bool open = c->at.on == DEM_ON_EDGE ? m->edge[c->at.feature].kind == DEM_EDGE_OPEN
                                      : c->at.on == DEM_ON_VERTEX && m->rim[c->at.feature];
  for (int i = 0; open && i < near->n; i++)
    if (dem_mesh_nearest(m, candidate_of(near, i), x).distance2 < c->at.distance2 &&
        dem_mesh_nearest(m, candidate_of(near, i), c->at.point).distance2 <= crack * crack)
      return true;
  return false;
}

enum { VERTICES_SEEN = 16 };

/* From a vertex one goes on to the same place, whichever of its triangles one comes from: once is enough, and vertices
 * of large fans stay cheap. */
static bool first_time(int seen[VERTICES_SEEN], int *n, int vertex) {
  for (int i = 0; i < *n; i++)
    if (seen[i] == vertex)
      return false;
  if (*n < VERTICES_SEEN)
    seen[(*n)++] = vertex;
  return true;
}

int dem_mesh_contacts(const dem_mesh *m, const int *candidate, size_t stride, int n, tdm_vec3 x, double radius,
                      dem_touch *out, int max) {
  const candidates near = {candidate, stride, n};
  touch t[DEM_TOUCHES_MAX];
  int count = 0, seen[VERTICES_SEEN], nseen = 0;
  double crack = fmin(m->crack, 1e-3 * radius);
  for (int i = 0; i < n; i++) {
    claim c = claim_of(m, candidate_of(&near, i), x);
    if (!(c.at.distance2 < radius * radius))
      continue;
    if (c.at.on == DEM_ON_VERTEX && !first_time(seen, &nseen, c.at.feature))
      continue;
    touch now = {.claim = descend(m, x, c)};
    if (bridged(m, &near, x, &now.claim, crack))
      continue;
    now.gap = dem_mesh_normal(m, now.claim.face, &now.claim.at, x, &now.normal);
    insert(t, &count, now);
  }
  if (count > 1)
    count = merge(m, t, count, crack);
  count = count < max ? count : max;
  for (int i = 0; i < count; i++) {
    int place = i;
    for (; place > 0 && out[place - 1].part > t[i].claim.face; place--)
      out[place] = out[place - 1];
    out[place] = (dem_touch){t[i].claim.face, t[i].gap, t[i].normal};
  }
  return count;
}
