/* The walls of a MOLDYN file as a shape: planes, or one-sided segments.
 *
 * Segments are one wall with a part each. A segment acts on spheres whose centre is in front of it, where its normal
 * looks; what is behind passes, and segments a -> b and b -> a make a wall with two sides. Its surface is half the
 * thickness in front of it and round about its ends. Where segments meet, a sphere over the face of one touches the
 * end of the other no second time.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/shape/plane.h"
#include "dem/moldyn/walls.h"
#include "protocol/math/hash.h"

#include <stdlib.h>

typedef struct {
  int count;
  double half;            /* thickness [m] */
  dem_win_wall segment[]; /* (count) normal, at: a, to: b */
} segments;

/* ---- distances ---- */

/* What of segment k is nearest to x, in the plane of x and z. */
typedef struct {
  double distance; /* [m] */
  double ahead;    /* of x in front of the line [m]; negative: behind */
  int end;         /* 0: the face, 1: a, 2: b */
  tdm_vec3 normal; /* unit, towards x */
} nearest;

static nearest nearest_to(const segments *s, int k, tdm_vec3 x) {
  const dem_win_wall *w = &s->segment[k];
  tdm_vec3 along = tdm_sub(w->to, w->at), from = tdm_sub(x, w->at);
  from.y = 0;
  double share = tdm_dot(from, along) / tdm_dot(along, along);
  nearest n = {.ahead = tdm_dot(from, w->normal), .end = share <= 0 ? 1 : share >= 1 ? 2 : 0};
  if (n.end == 0) {
    n.distance = fabs(n.ahead);
    n.normal = n.ahead < 0 ? tdm_scale(-1, w->normal) : w->normal;
    return n;
  }
  tdm_vec3 away = n.end == 1 ? from : tdm_sub(from, along);
  n.distance = tdm_norm(away);
  n.normal = n.distance > 0 ? tdm_scale(1 / n.distance, away) : w->normal;
  return n;
}

/* Is the contact of segment k at one of its ends that of a segment which meets it there? It is if x is over the face of
 * that segment, or if that one has the lower number. */
static bool of_another(const segments *s, int k, const nearest *at, tdm_vec3 x) {
  const dem_win_wall *w = &s->segment[k];
  tdm_vec3 corner = at->end == 1 ? w->at : w->to;
  double close = 1e-9 * tdm_norm(tdm_sub(w->to, w->at));
  for (int j = 0; j < s->count && at->end > 0; j++) {
    bool meets =
        tdm_norm(tdm_sub(s->segment[j].at, corner)) <= close || tdm_norm(tdm_sub(s->segment[j].to, corner)) <= close;
    if (j == k || !meets)
      continue;
    nearest other = nearest_to(s, j, x);
    if (other.ahead > 0 && (other.end == 0 || j < k))
      return true;
  }
  return false;
}

static double gap_of_segments(const dem_wall *wall, tdm_vec3 x, tdm_vec3 *normal) {
  const segments *s = wall->data;
  double gap = INFINITY;
  *normal = tdm_v3(0, 0, 1);
  for (int k = 0; k < s->count; k++) {
    nearest n = nearest_to(s, k, x);
    if (!(n.ahead > 0) || !(n.distance - s->half < gap))
      continue;
    gap = n.distance - s->half;
    *normal = n.normal;
  }
  return gap;
}

/* also those that x is behind: it may come before them */
static int near_segments(const dem_wall *wall, int from, tdm_vec3 x, double range, int *out, int max) {
  (void)from;
  const segments *s = wall->data;
  int n = 0;
  for (int k = 0; k < s->count; k++)
    if (nearest_to(s, k, x).distance - s->half < range) {
      if (n < max)
        out[n] = k;
      n++;
    }
  return n;
}

static int touches_of(const dem_wall *wall, const int *part, size_t stride, int n, tdm_vec3 x, double radius,
                      dem_touch out[DEM_TOUCHES_MAX]) {
  const segments *s = wall->data;
  int count = 0;
  for (int i = 0; i < n && count < DEM_TOUCHES_MAX; i++) {
    int k = part[(size_t)i * stride];
    nearest at = nearest_to(s, k, x);
    if (at.ahead > 0 && at.distance - s->half < radius && !of_another(s, k, &at, x))
      out[count++] = (dem_touch){.part = k, .gap = at.distance - s->half, .normal = at.normal};
  }
  return count;
}

/* the next segment of a chain goes on with a contact */
static bool passes(const dem_wall *wall, int from, int to) {
  const segments *s = wall->data;
  const dem_win_wall *a = &s->segment[from], *b = &s->segment[to];
  double close = 1e-9 * tdm_norm(tdm_sub(a->to, a->at));
  return tdm_norm(tdm_sub(a->to, b->at)) <= close || tdm_norm(tdm_sub(b->to, a->at)) <= close;
}

/* ---- what it is ---- */

static int parts_of(const dem_wall *wall) {
  return ((const segments *)wall->data)->count;
}

static tdm_vec3 middle_of(const dem_wall *wall, int part) {
  const segments *s = wall->data;
  return tdm_scale(0.5, tdm_add(s->segment[part].at, s->segment[part].to));
}

static void box_of(const dem_wall *wall, tdm_vec3 *low, tdm_vec3 *high) {
  const segments *s = wall->data;
  *low = *high = s->count > 0 ? s->segment[0].at : tdm_v3(0, 0, 0);
  for (int k = 0; k < 2 * s->count; k++) {
    tdm_vec3 x = k % 2 ? s->segment[k / 2].to : s->segment[k / 2].at;
    *low = tdm_v3(fmin(low->x, x.x), fmin(low->y, x.y), fmin(low->z, x.z));
    *high = tdm_v3(fmax(high->x, x.x), fmax(high->y, x.y), fmax(high->z, x.z));
  }
}

/* strips as wide, along y, as what is there */
static void draw_segments(const dem_wall *wall, const dem_wall_view *view, dem_polygons *all, tdm_error *err) {
  const segments *s = wall->data;
  double low = INFINITY, high = -INFINITY;
  for (int k = 0; k < 8; k++) {
    tdm_vec3 corner = {k & 1 ? view->bounds->high.x : view->bounds->low.x,
                       k & 2 ? view->bounds->high.y : view->bounds->low.y,
                       k & 4 ? view->bounds->high.z : view->bounds->low.z};
    double y = dem_wall_own(view->place, corner).y;
    low = fmin(low, y);
    high = fmax(high, y);
  }
  for (int k = 0; k < s->count && err->status == TDM_OK; k++) {
    dem_polygon p = {.body = wall->body, .ncorner = 4};
    for (int c = 0; c < 4; c++) {
      tdm_vec3 x = c % 3 == 0 ? s->segment[k].at : s->segment[k].to;
      x.y = c < 2 ? low : high;
      p.corner[c] = dem_wall_world(view->place, x);
    }
    dem_polygons_add(all, &p, err);
  }
}

static unsigned long long hash_of(const dem_wall *wall) {
  const segments *s = wall->data;
  unsigned long long h = tdm_hash_bytes(TDM_HASH_START, &s->half, sizeof s->half);
  for (int k = 0; k < s->count; k++) {
    const tdm_vec3 ends[2] = {s->segment[k].at, s->segment[k].to};
    h = tdm_hash_bytes(h, ends, sizeof ends);
  }
  return h;
}

static const dem_shape shape_segments = {
    .number = 10,
    .gap = gap_of_segments,
    .box = box_of,
    .polygons = draw_segments,
    .parts = parts_of,
    .middle = middle_of,
    .near = near_segments,
    .touches = touches_of,
    .passes = passes,
    .hash = hash_of,
    .destroy = free,
};

/* ---- reading ---- */

static void append_segments(const dem_win *win, int body, dem_wall_list *list, tdm_error *err) {
  segments *s = calloc(1, sizeof *s + (size_t)win->count * sizeof *s->segment);
  if (!s) {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %d walls", win->count);
    return;
  }
  s->count = win->count;
  s->half = 0.5 * win->thickness;
  for (int k = 0; k < win->count; k++)
    s->segment[k] = win->wall[k];
  dem_walls_append(list, (dem_wall){.shape = &shape_segments, .body = body, .data = s}, err);
}

static void read_moldyn(tdm_object *o, int body, dem_wall_list *list) {
  static const char *const forms[] = {"normals", "end_points"};
  const char *file = tdm_get_string(o, "file", NULL);
  int form = tdm_get_choice(o, "form", forms, 2, DEM_WIN_NORMALS);
  bool fits = tdm_get_bool(o, "fits", true);
  char path[TDM_PATH_MAX];
  dem_win win = {0};
  if (o->err->status ||
      dem_win_read(&win, file, (dem_win_form)form, fits, tdm_path(path, o, "file", -1), o->err) != TDM_OK) {
    dem_win_free(&win);
    return;
  }
  for (int k = 0; k < win.count && form == DEM_WIN_NORMALS; k++)
    dem_walls_append(
        list, dem_plane(body, tdm_axpy(0.5 * win.thickness, win.wall[k].normal, win.wall[k].at), win.wall[k].normal),
        o->err);
  if (form == DEM_WIN_END_POINTS && win.count > 0)
    append_segments(&win, body, list, o->err);
  dem_win_free(&win);
}

/* not a surface: what it reads are planes and segments */
const dem_shape dem_shape_moldyn = {.type = "moldyn", .number = 9, .read = read_moldyn};
