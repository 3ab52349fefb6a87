/* Edges and normals of polygons: see surface.h. Corners of one body that lie in one place are one point of its surface;
 * polygons that share an edge and hardly turn there are one piece of it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/draw/space/surface.h"

#include "protocol/math/hash.h"

#include <stdlib.h>
#include <string.h>

static const double smooth = 0.82; /* cosine of the largest angle at which two polygons are one surface: 35 degrees */

/* A point of a body's surface: the corners that are there, as a list. */
typedef struct {
  int body, first; /* first: index of a corner, -1: free place of the table */
  int64_t cell[3]; /* of a grid much finer than anything that is seen */
} point;

typedef struct {
  const tdm_scenery *scenery;
  int ncorner;
  int *owner; /* (ncorner) polygon */
  int *place; /* (ncorner) index of the point */
  int *next;  /* (ncorner) further corner at the same point, -1: none */
  point *table;
  size_t size; /* of the table, a power of two */
  double cell; /* [m] */
} maker;

static tdm_vec3 normal_of(const tdm_view_polygon *p) {
  tdm_vec3 area = {0, 0, 0};
  for (int c = 2; c < p->ncorner; c++)
    area = tdm_add(area, tdm_cross(tdm_sub(p->corner[c - 1], p->corner[0]), tdm_sub(p->corner[c], p->corner[0])));
  tdm_vec3 n = tdm_unit(area);
  return isfinite(n.x + n.y + n.z) ? n : (tdm_vec3){0, 0, 0};
}

static void find_cell(const maker *m, tdm_vec3 x, int64_t cell[3]) {
  const double v[3] = {x.x, x.y, x.z};
  for (int k = 0; k < 3; k++) {
    double c = v[k] / m->cell;
    cell[k] = fabs(c) < 9e15 ? (int64_t)floor(c + 0.5) : 0;
  }
}

static int find_point(maker *m, int body, const int64_t cell[3]) {
  uint64_t h = tdm_hash_words(TDM_HASH_START ^ (uint64_t)body, cell, 3 * sizeof *cell);
  size_t i = (size_t)(h ^ h >> 32) & (m->size - 1);
  while (m->table[i].first >= 0 &&
         (m->table[i].body != body || memcmp(m->table[i].cell, cell, sizeof m->table[i].cell)))
    i = (i + 1) & (m->size - 1);
  return (int)i;
}

static void find_points(maker *m) {
  const tdm_scenery *s = m->scenery;
  int corner = 0;
  for (int k = 0; k < s->npolygon; k++)
    for (int c = 0; c < s->polygon[k].ncorner; c++, corner++) {
      int64_t cell[3];
      find_cell(m, s->polygon[k].corner[c], cell);
      int i = find_point(m, s->polygon[k].body, cell);
      point *p = &m->table[i];
      m->owner[corner] = k;
      m->place[corner] = i;
      m->next[corner] = p->first;
      p->body = s->polygon[k].body;
      memcpy(p->cell, cell, sizeof cell);
      p->first = corner;
    }
}

/* A corner's normal: that of the polygons around it which hardly turn against its own. */
static tdm_vec3 round_normal(const maker *m, const tdm_surface *surface, int corner) {
  tdm_vec3 own = surface->flat[m->owner[corner]], sum = {0, 0, 0};
  for (int c = m->table[m->place[corner]].first; c >= 0; c = m->next[c]) {
    tdm_vec3 n = surface->flat[m->owner[c]];
    double turn = tdm_dot(n, own);
    if (fabs(turn) > smooth)
      sum = tdm_axpy(turn > 0 ? 1 : -1, n, sum);
  }
  return tdm_unit(sum);
}

/* whether polygon k has an edge between the points a and b */
static bool has_edge(const maker *m, const tdm_surface *surface, int k, int a, int b) {
  int n = m->scenery->polygon[k].ncorner, first = surface->first[k];
  for (int c = 0; c < n; c++) {
    int from = m->place[first + c], to = m->place[first + (c + 1) % n];
    if ((from == a && to == b) || (from == b && to == a))
      return true;
  }
  return false;
}

/* A polygon's area over its longest edge [m]: of a strip its width. */
static float width_of(const tdm_view_polygon *p) {
  double longest = 0;
  tdm_vec3 area = {0, 0, 0};
  for (int c = 0; c < p->ncorner; c++) {
    longest = fmax(longest, tdm_norm(tdm_sub(p->corner[(c + 1) % p->ncorner], p->corner[c])));
    if (c > 1)
      area = tdm_add(area, tdm_cross(tdm_sub(p->corner[c - 1], p->corner[0]), tdm_sub(p->corner[c], p->corner[0])));
  }
  return longest > 0 ? (float)(0.5 * tdm_norm(area) / longest) : 0;
}

/* An edge is drawn unless another polygon goes on there smoothly; of two that meet at it, by the first. */
static float drawn_edge(const maker *m, const tdm_surface *surface, int corner, int after) {
  int k = m->owner[corner], a = m->place[corner], b = m->place[after];
  float wide = width_of(&m->scenery->polygon[k]);
  if (a == b)
    return 0;
  for (int c = m->table[a].first; c >= 0; c = m->next[c]) {
    int other = m->owner[c];
    if (other == k || !has_edge(m, surface, other, a, b))
      continue;
    if (fabs(tdm_dot(surface->flat[other], surface->flat[k])) > smooth || other < k)
      return 0;
    wide = fmaxf(wide, width_of(&m->scenery->polygon[other]));
  }
  return wide;
}

static tdm_status allocate(maker *m, tdm_surface *surface, tdm_error *err) {
  const size_t n = (size_t)m->ncorner + 1;
  for (m->size = 64; m->size < 2 * n; m->size *= 2)
    ;
  m->owner = malloc(n * sizeof *m->owner);
  m->place = malloc(n * sizeof *m->place);
  m->next = malloc(n * sizeof *m->next);
  m->table = malloc(m->size * sizeof *m->table);
  surface->flat = malloc(((size_t)surface->npolygon + 1) * sizeof *surface->flat);
  surface->first = malloc(((size_t)surface->npolygon + 1) * sizeof *surface->first);
  surface->round = malloc(n * sizeof *surface->round);
  surface->edge = malloc(n * sizeof *surface->edge);
  if (!m->owner || !m->place || !m->next || !m->table || !surface->flat || !surface->first || !surface->round ||
      !surface->edge)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for a picture of %d polygons", surface->npolygon);
  for (size_t i = 0; i < m->size; i++)
    m->table[i].first = -1;
  return TDM_OK;
}

/* the largest length that a corner is away from its body's middle */
static double size_of(const tdm_scenery *s) {
  double size = 0;
  for (int k = 0; k < s->npolygon; k++)
    for (int c = 0; c < s->polygon[k].ncorner; c++) {
      double r = tdm_norm(s->polygon[k].corner[c]);
      if (isfinite(r))
        size = fmax(size, r);
    }
  return size > 0 ? size : 1;
}

tdm_status tdm_surface_make(tdm_surface *surface, const tdm_scenery *s, tdm_error *err) {
  maker m = {.scenery = s, .cell = 1e-6 * size_of(s)};
  tdm_surface_free(surface);
  surface->npolygon = s->npolygon;
  for (int k = 0; k < s->npolygon; k++)
    m.ncorner += s->polygon[k].ncorner;
  if (allocate(&m, surface, err) == TDM_OK) {
    int corner = 0;
    for (int k = 0; k < s->npolygon; k++) {
      surface->flat[k] = normal_of(&s->polygon[k]);
      surface->first[k] = corner;
      corner += s->polygon[k].ncorner;
    }
    find_points(&m);
    for (int k = 0; k < s->npolygon; k++)
      for (int c = 0; c < s->polygon[k].ncorner; c++) {
        int at = surface->first[k] + c, after = surface->first[k] + (c + 1) % s->polygon[k].ncorner;
        surface->round[at] = round_normal(&m, surface, at);
        surface->edge[at] = drawn_edge(&m, surface, at, after);
      }
  }
  free(m.owner);
  free(m.place);
  free(m.next);
  free(m.table);
  return err->status;
}

void tdm_surface_free(tdm_surface *s) {
  free(s->flat);
  free(s->first);
  free(s->round);
  free(s->edge);
  *s = (tdm_surface){0};
}
