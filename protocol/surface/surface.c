/* Surfaces of STL files: see surface.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/surface/surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
  tdm_vec3 at;
  int corner;
} place;

typedef struct {
  int low, high; /* vertices */
  int face;
  int direction; /* 1: the face runs from low to high, -1: back */
} side;

typedef struct {
  int vertex[3]; /* ascending */
  int face;
} triple;

typedef struct {
  double volume;
  tdm_vec3 low, high; /* box around it */
  int first;          /* its first triangle */
} part;

typedef struct {
  const tdm_stl *stl;
  tdm_surface *out;
  place *place;   /* (3 n) */
  side *side;     /* (3 n) */
  triple *triple; /* (n) */
  int *id;        /* (3 n) vertex of each corner */
  int *joined;    /* (n) a triangle of the same part, the least at the end of the chain */
  int *number;    /* (n) the part of each triangle, -1: left out */
  part *part;     /* (parts) */
} work;

static int by_place(const void *a, const void *b) {
  const tdm_vec3 *p = &((const place *)a)->at, *q = &((const place *)b)->at;
  if (p->x != q->x)
    return p->x < q->x ? -1 : 1;
  if (p->y != q->y)
    return p->y < q->y ? -1 : 1;
  return (p->z > q->z) - (p->z < q->z);
}

static int by_ends(const void *a, const void *b) {
  const side *p = a, *q = b;
  return p->low != q->low ? (p->low > q->low) - (p->low < q->low) : (p->high > q->high) - (p->high < q->high);
}

static int by_vertices(const void *a, const void *b) {
  const triple *p = a, *q = b;
  for (int k = 0; k < 3; k++)
    if (p->vertex[k] != q->vertex[k])
      return p->vertex[k] < q->vertex[k] ? -1 : 1;
  return (p->face > q->face) - (p->face < q->face);
}

static int by_number(const void *a, const void *b) {
  return (*(const int *)a > *(const int *)b) - (*(const int *)a < *(const int *)b);
}

/* ---- vertices and edges ---- */

static void number_vertices(work *w) {
  const int n = 3 * w->stl->count;
  for (int i = 0; i < n; i++)
    w->place[i] = (place){w->stl->corner[i], i};
  qsort(w->place, (size_t)n, sizeof *w->place, by_place);
  for (int i = 0, k = 0; i < n; i++) {
    k += i > 0 && by_place(&w->place[i - 1], &w->place[i]) != 0;
    w->id[w->place[i].corner] = k;
  }
}

static void leave_out_repeated(work *w) {
  const int n = w->stl->count;
  for (int t = 0; t < n; t++) {
    triple *one = &w->triple[t];
    memcpy(one->vertex, &w->id[3 * t], sizeof one->vertex);
    qsort(one->vertex, 3, sizeof(int), by_number);
    one->face = t;
  }
  qsort(w->triple, (size_t)n, sizeof *w->triple, by_vertices);
  for (int i = 1; i < n; i++)
    if (memcmp(w->triple[i].vertex, w->triple[i - 1].vertex, sizeof w->triple[i].vertex) == 0) {
      w->out->left_out[w->triple[i].face] = true;
      w->out->repeated++;
    }
  w->out->triangles = n - w->out->repeated;
}

static int root_of(work *w, int t) {
  while (w->joined[t] != t)
    t = w->joined[t] = w->joined[w->joined[t]];
  return t;
}

static void join(work *w, int a, int b) {
  a = root_of(w, a);
  b = root_of(w, b);
  w->joined[a < b ? b : a] = a < b ? a : b;
}

static void look_at_edges(work *w) {
  tdm_surface *s = w->out;
  int n = 0;
  for (int t = 0; t < w->stl->count; t++) {
    w->joined[t] = t;
    for (int k = 0; k < 3 && !s->left_out[t]; k++) {
      int from = w->id[3 * t + k], to = w->id[3 * t + (k + 1) % 3];
      if (from != to)
        w->side[n++] = from < to ? (side){from, to, t, 1} : (side){to, from, t, -1};
    }
  }
  qsort(w->side, (size_t)n, sizeof *w->side, by_ends);
  for (int i = 0, next; i < n; i = next) {
    int balance = 0;
    for (next = i; next < n && by_ends(&w->side[i], &w->side[next]) == 0; next++)
      balance += w->side[next].direction;
    const bool odd = (next - i) % 2;
    s->edges++;
    s->open += odd;
    s->turned += !odd && balance != 0;
    if (next - i == 2)
      join(w, w->side[i].face, w->side[i + 1].face);
  }
  s->closed = s->open == 0;
  s->oriented = s->closed && s->turned == 0;
}

/* ---- parts ---- */

/* six times the volume of the tetrahedron from `base` */
static double six_volumes(const tdm_vec3 *corner, tdm_vec3 base) {
  return tdm_dot(tdm_sub(corner[0], base), tdm_cross(tdm_sub(corner[1], base), tdm_sub(corner[2], base)));
}

static tdm_vec3 least(tdm_vec3 a, tdm_vec3 b) {
  return tdm_v3(fmin(a.x, b.x), fmin(a.y, b.y), fmin(a.z, b.z));
}

static tdm_vec3 most(tdm_vec3 a, tdm_vec3 b) {
  return tdm_v3(fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z));
}

/* volumes and boxes of the parts; false: no memory */
static bool make_parts(work *w) {
  const tdm_stl *stl = w->stl;
  tdm_surface *s = w->out;
  for (int t = 0; t < stl->count; t++) {
    w->number[t] = -1;
    if (!s->left_out[t]) /* a root comes before the others of its part */
      w->number[t] = root_of(w, t) == t ? s->parts++ : w->number[root_of(w, t)];
  }
  w->part = calloc((size_t)s->parts + 1, sizeof *w->part);
  if (!w->part)
    return false;
  tdm_vec3 first = {0, 0, 0};
  for (int t = 0; t < stl->count; t++) {
    if (w->number[t] < 0)
      continue;
    part *p = &w->part[w->number[t]];
    const tdm_vec3 *c = &stl->corner[3 * t], base = stl->corner[0];
    if (root_of(w, t) == t)
      *p = (part){.first = t, .low = c[0], .high = c[0]};
    for (int k = 0; k < 3; k++) {
      p->low = least(p->low, c[k]);
      p->high = most(p->high, c[k]);
    }
    const double volume = six_volumes(c, base) / 6;
    p->volume += volume;
    s->volume += volume;
    for (int k = 0; k < 3; k++)
      first = tdm_axpy(volume / 4, tdm_sub(c[k], base), first);
  }
  if (s->volume != 0)
    s->centre = tdm_axpy(1 / s->volume, first, stl->corner[0]);
  return true;
}

static bool box_in(const part *inner, const part *outer) {
  return inner->low.x >= outer->low.x && inner->low.y >= outer->low.y && inner->low.z >= outer->low.z &&
         inner->high.x <= outer->high.x && inner->high.y <= outer->high.y && inner->high.z <= outer->high.z;
}

/* The solid angle of a triangle seen from x, positive from behind (van Oosterom & Strackee 1983). */
static double solid_angle(const tdm_vec3 *corner, tdm_vec3 x) {
  tdm_vec3 a = tdm_sub(corner[0], x), b = tdm_sub(corner[1], x), c = tdm_sub(corner[2], x);
  double la = tdm_norm(a), lb = tdm_norm(b), lc = tdm_norm(c);
  return 2 * atan2(tdm_dot(a, tdm_cross(b, c)),
                   la * lb * lc + tdm_dot(a, b) * lc + tdm_dot(a, c) * lb + tdm_dot(b, c) * la);
}

/* how often the parts around part k wind around x: 1 inside a solid */
static double winding(const work *w, int k, tdm_vec3 x) {
  double angle = 0;
  for (int t = 0; t < w->stl->count; t++)
    if (w->number[t] >= 0 && w->number[t] != k && box_in(&w->part[k], &w->part[w->number[t]]))
      angle += solid_angle(&w->stl->corner[3 * t], x);
  return angle / (4 * M_PI);
}

/* Some corners of part k, or all of them, are inside other parts: of few, spread over the part. */
static void find_inside(const work *w, int k, bool *some, bool *all) {
  enum { LOOKS = 8 };
  int count = 0, seen = 0;
  for (int t = 0; t < w->stl->count; t++)
    count += w->number[t] == k;
  *some = false;
  *all = true;
  for (int t = w->part[k].first; t < w->stl->count; t++)
    if (w->number[t] == k && seen++ % (1 + count / LOOKS) == 0) {
      bool inside = winding(w, k, w->stl->corner[3 * t]) > 0.75;
      *some = *some || inside;
      *all = *all && inside;
    }
}

static void judge_parts(work *w) {
  tdm_surface *s = w->out;
  for (int k = 0; k < s->parts; k++) {
    bool some = false, all = false, around = false;
    for (int j = 0; j < s->parts && !around; j++)
      around = j != k && box_in(&w->part[k], &w->part[j]);
    if (around)
      find_inside(w, k, &some, &all);
    const bool inverted = w->part[k].volume < 0 && !some, nested = w->part[k].volume > 0 && all;
    if ((inverted || nested) && s->inverted + s->nested == 0)
      s->bad = w->stl->corner[3 * w->part[k].first];
    s->inverted += inverted;
    s->nested += nested;
  }
}

/* ---- all ---- */

tdm_status tdm_surface_look(tdm_surface *s, const tdm_stl *stl, const char *path, tdm_error *err) {
  const size_t n = (size_t)stl->count + 1;
  *s = (tdm_surface){.left_out = calloc(n, sizeof *s->left_out)};
  work w = {.stl = stl,
            .out = s,
            .place = malloc(3 * n * sizeof *w.place),
            .side = malloc(3 * n * sizeof *w.side),
            .triple = malloc(n * sizeof *w.triple),
            .id = malloc(3 * n * sizeof *w.id),
            .joined = malloc(n * sizeof *w.joined),
            .number = malloc(n * sizeof *w.number)};
  bool good = s->left_out && w.place && w.side && w.triple && w.id && w.joined && w.number;
  if (good) {
    number_vertices(&w);
    leave_out_repeated(&w);
    look_at_edges(&w);
  }
  if (good && s->oriented) {
    good = make_parts(&w);
    if (good)
      judge_parts(&w);
  }
  free(w.place);
  free(w.side);
  free(w.triple);
  free(w.id);
  free(w.joined);
  free(w.number);
  free(w.part);
  return good ? TDM_OK : tdm_fail(err, TDM_ERR_MEMORY, path, "no memory for the edges of %d triangles", stl->count);
}

void tdm_surface_destroy(tdm_surface *s) {
  free(s->left_out);
  *s = (tdm_surface){0};
}
