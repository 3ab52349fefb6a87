/* Windows in round walls: see windows.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/windows.h"

#include "dem/geometry/frustum.h"
#include "protocol/math/hash.h"

#include <stdlib.h>

static double turn_of(double angle) { /* in [0, 2 pi) */
  double turn = fmod(angle, 2 * M_PI);
  return turn < 0 ? turn + 2 * M_PI : turn;
}

/* ---- reading ---- */

static void read_angles(tdm_object *o, dem_window *w) {
  double angle[2] = {0, 0};
  if (!tdm_get_numbers(o, "angle", angle, 2, true))
    return;
  w->angle = angle[0];
  w->width = turn_of(angle[1] - angle[0]);
  if (!(fabs(angle[1] - angle[0]) < 2 * M_PI) || !(w->width > 0))
    tdm_object_fail(o, "angle",
                    "[%g, %g] rad is no part of a turn; a window reaches from the first angle anticlockwise to the "
                    "second, and one around the whole wall parts it: give two cylinders then",
                    angle[0], angle[1]);
  for (int e = 0; e < 2; e++) {
    w->side[e][0] = cos(angle[e]);
    w->side[e][1] = sin(angle[e]);
  }
  w->middle[0] = cos(w->angle + 0.5 * w->width);
  w->middle[1] = sin(w->angle + 0.5 * w->width);
  w->least = cos(0.5 * w->width);
}

static void read_heights(tdm_object *o, double length, dem_window *w) {
  if (!tdm_get_numbers(o, "height", w->height, 2, true))
    return;
  if (!(w->height[0] >= 0 && w->height[0] < w->height[1] && w->height[1] <= length))
    tdm_object_fail(o, "height",
                    "[%g, %g] m is not in the wall; give two heights that rise, from 0 to its length, %g m",
                    w->height[0], w->height[1], length);
  w->open[0] = w->height[0] == 0;
  w->open[1] = w->height[1] == length;
}

/* do two windows have a point in common, their edges included? */
static bool touch(const dem_window *a, const dem_window *b) {
  double apart = turn_of(b->angle - a->angle);
  return a->height[0] <= b->height[1] && b->height[0] <= a->height[1] &&
         (apart <= a->width || apart + b->width >= 2 * M_PI);
}

static void read_window(tdm_object *o, double length, dem_windows *all, int k) {
  read_angles(o, &all->window[k]);
  read_heights(o, length, &all->window[k]);
  tdm_object_close(o);
  for (int i = 0; i < k && !o->err->status; i++)
    if (touch(&all->window[i], &all->window[k]))
      tdm_object_fail(o, NULL, "touches windows[%d]; leave some wall between them, or make one window of both", i);
}

dem_windows *dem_windows_read(tdm_object *o, double length) {
  json_t *array = tdm_get_array(o, "windows", false);
  size_t n = json_array_size(array);
  if (o->err->status || n == 0)
    return NULL;
  if (n > DEM_WINDOWS_MAX) {
    tdm_object_fail(o, "windows", "has %zu entries; at most %d are supported", n, DEM_WINDOWS_MAX);
    return NULL;
  }
  dem_windows *all = calloc(1, sizeof *all + n * sizeof *all->window);
  if (!all) {
    tdm_fail(o->err, TDM_ERR_MEMORY, NULL, "no memory for windows");
    return NULL;
  }
  for (; all->count < (int)n && !o->err->status; all->count++) {
    char path[TDM_PATH_MAX];
    tdm_path(path, o, "windows", all->count);
    tdm_object one = tdm_object_open(json_array_get(array, (size_t)all->count), path, o->err);
    read_window(&one, length, all, all->count);
  }
  if (o->err->status) {
    free(all);
    return NULL;
  }
  return all;
}

/* ---- distance ---- */

/* is a point of the wall in the window? Its edges are wall. */
static bool has(const dem_window *w, tdm_vec3 foot, double from_axis) {
  return (foot.z > w->height[0] || w->open[0]) && (foot.z < w->height[1] || w->open[1]) &&
         foot.x * w->middle[0] + foot.y * w->middle[1] > from_axis * w->least;
}

/* The radius at a height. */
static double radius_at(const double radius[2], double length, double height) {
  return radius[0] + (radius[1] - radius[0]) * (height / length);
}

/* the point of a straight edge that is nearest to x */
static tdm_vec3 nearest_on_side(const dem_window *w, int side, const double radius[2], double length, tdm_vec3 x) {
  tdm_vec3 end[2];
  for (int e = 0; e < 2; e++) {
    double r = radius_at(radius, length, w->height[e]);
    end[e] = tdm_v3(r * w->side[side][0], r * w->side[side][1], w->height[e]);
  }
  tdm_vec3 along = tdm_sub(end[1], end[0]);
  double share = tdm_dot(tdm_sub(x, end[0]), along) / tdm_dot(along, along);
  return tdm_axpy(fmax(0, fmin(1, share)), along, end[0]);
}

/* Distances grow with the angle from x and, along each line of the wall, with the distance from its own nearest point.
 * So of a window in which x has its foot the nearest points are those of the arcs at the angle of x, and of the
 * straight edges.
 *
 * In a corner that is one contact too, with the nearer edge. As far as places go that is right: a rigid sphere of
 * radius r is free exactly where the nearest point of what is solid is r away, whichever edge it belongs to. The force
 * is k (r
 * - distance) and the distance has no jump there, so elastic contacts keep their energy also across the corner's
 * bisector, where the normal turns from one edge to the other. What it is not: a sphere that is wedged into the corner
 * touches both edges at once; here it changes between them from step to step, so the corner is half as stiff as two
 * contacts, and friction follows one edge at a time. Those who leave by a window pass its corner, they do not rest in
 * it: the deck or floor that they lie on is a wall of its own. */
static double rim_gap(const dem_window *w, const double radius[2], double length, tdm_vec3 x, tdm_vec3 foot,
                      double from_axis, tdm_vec3 *normal) {
  double least = INFINITY;
  for (int k = 0; k < 4; k++) {
    tdm_vec3 at;
    if (k < 2 && w->open[k])
      continue;
    if (k < 2) {
      double share = radius_at(radius, length, w->height[k]) / from_axis;
      at = tdm_v3(share * foot.x, share * foot.y, w->height[k]);
    } else {
      at = nearest_on_side(w, k - 2, radius, length, x);
    }
    tdm_vec3 d = tdm_sub(x, at);
    double gap = tdm_norm(d);
    if (gap >= least)
      continue;
    least = gap;
    if (gap > 0)
      *normal = tdm_scale(1 / gap, d);
  }
  return least;
}

double dem_windows_gap(const dem_windows *windows, const double radius[2], double length, tdm_vec3 x,
                       tdm_vec3 *normal) {
  double gap = dem_shell_gap(radius, length, x, normal);
  tdm_vec3 foot = tdm_axpy(-gap, *normal, x);
  double from_axis = sqrt(foot.x * foot.x + foot.y * foot.y);
  for (int k = 0; k < windows->count; k++)
    if (has(&windows->window[k], foot, from_axis))
      return rim_gap(&windows->window[k], radius, length, x, foot, from_axis, normal);
  return gap;
}

/* ---- drawing ---- */

bool dem_windows_piece(const dem_windows *windows, double length, double angle, double *low, double *high) {
  *high = length;
  for (int k = 0; k < windows->count; k++) {
    const dem_window *w = &windows->window[k];
    if (!(turn_of(angle - w->angle) < w->width) || w->height[1] <= *low)
      continue;
    if (w->height[0] <= *low) { /* begin above it, and look again */
      *low = w->height[1];
      return dem_windows_piece(windows, length, angle, low, high);
    }
    *high = fmin(*high, w->height[0]);
  }
  return *low < *high;
}

unsigned long long dem_windows_hash(const dem_windows *windows) {
  unsigned long long hash = TDM_HASH_START;
  for (int k = 0; k < windows->count; k++) {
    const dem_window *w = &windows->window[k];
    const double numbers[] = {w->angle, w->width, w->height[0], w->height[1]};
    hash = tdm_hash_bytes(hash, numbers, sizeof numbers);
  }
  return hash;
}
