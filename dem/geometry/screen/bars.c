/* The bars of wires and plates: see screen.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/screen/screen.h"

#include <math.h>

static double within(double x, double low, double high) {
  return fmin(fmax(x, low), high);
}

/* ---- one bar ---- */

/* A part by its family (0: along x, 1: along y), its bar and its piece of it. */
typedef struct {
  int family, bar, piece;
} bar_place;

static bar_place place_of(const dem_screen *s, int part) {
  int bar = part / s->pieces, count = 2 * s->aisles;
  return (bar_place){bar / count, bar % count, part % s->pieces};
}

static int part_of(const dem_screen *s, bar_place at) {
  return (at.family * 2 * s->aisles + at.bar) * s->pieces + at.piece;
}

static double across_of(const dem_screen *s, int bar) {
  return (bar - s->aisles + 0.5) * dem_screen_pitch(s);
}

int dem_screen_parts(const dem_screen *s) {
  return 4 * s->aisles * s->pieces;
}

static double half_chord(double radius, double across) {
  return sqrt(fmax(0, radius * radius - across * across));
}

bool dem_screen_bar(const dem_screen *s, int part, double ends[2], double *across) {
  bar_place at = place_of(s, part);
  *across = across_of(s, at.bar);
  double outer = half_chord(s->radius, *across), inner = half_chord(s->inner, *across);
  bool cut = fabs(*across) < s->inner;
  ends[0] = cut && at.piece == 1 ? inner : -outer;
  ends[1] = cut && at.piece == 0 ? -inner : outer;
  return cut || at.piece == 0;
}

/* x beside a bar: how far beyond its ends (0: beside it), across and above its axis */
typedef struct {
  double beyond, across, above;
} bar_view;

static bar_view view_of(const dem_screen *s, int part, tdm_vec3 x) {
  double ends[2], at;
  dem_screen_bar(s, part, ends, &at);
  bool second = place_of(s, part).family == 1;
  double along = second ? x.y : x.x;
  return (bar_view){along - within(along, ends[0], ends[1]), (second ? x.x : x.y) - at,
                    x.z - (second ? -s->layer : s->layer)};
}

/* from the axes of a bar */
static tdm_vec3 from_bar(const dem_screen *s, int part, double along, double across, double above) {
  return place_of(s, part).family == 1 ? tdm_v3(across, along, above) : tdm_v3(along, across, above);
}

double dem_screen_bar_gap(const dem_screen *s, int part, tdm_vec3 x, tdm_vec3 *normal) {
  bar_view v = view_of(s, part, x);
  bool wire = s->deck == DEM_DECK_WIRES;
  double side = v.across, height = v.above;
  if (!wire) { /* from the nearest point of the section */
    side -= within(v.across, -0.5 * s->bar, 0.5 * s->bar);
    height -= within(v.above, -0.5 * s->thickness, 0.5 * s->thickness);
  }
  double from = sqrt(v.beyond * v.beyond + side * side + height * height);
  if (from > 0) {
    *normal = from_bar(s, part, v.beyond / from, side / from, height / from);
    return wire ? from - 0.5 * s->thickness : from;
  }
  double beside = fabs(v.across) - 0.5 * s->bar, over = fabs(v.above) - 0.5 * s->thickness;
  if (wire || over >= beside) {
    *normal = from_bar(s, part, 0, 0, copysign(1, v.above));
    return wire ? -0.5 * s->thickness : over;
  }
  *normal = from_bar(s, part, 0, copysign(1, v.across), 0);
  return beside;
}

/* ---- finding bars ---- */

/* the bars whose axes are from `low` to `high` across them, as far as there are such: from first to last */
static void bars_between(const dem_screen *s, double low, double high, int *first, int *last) {
  double pitch = dem_screen_pitch(s), shift = s->aisles - 0.5;
  *first = (int)within(ceil(low / pitch + shift), 0, 2 * s->aisles);
  *last = (int)within(floor(high / pitch + shift), -1, 2 * s->aisles - 1);
}

static bool is_there(const dem_screen *s, int part) {
  double ends[2], across;
  return dem_screen_bar(s, part, ends, &across);
}

/* The nearest bar is among those beside the point of the disc that is nearest to x. */
double dem_screen_gap(const dem_screen *s, tdm_vec3 x, tdm_vec3 *normal) {
  double rho = hypot(x.x, x.y), share = rho > s->radius ? s->radius / rho : 1, least = INFINITY;
  double near = 1.5 * dem_screen_pitch(s);
  for (int family = 0; family < 2; family++) {
    double across = share * (family ? x.x : x.y);
    int first, last;
    bars_between(s, across - near, across + near, &first, &last);
    for (int bar = first; bar <= last; bar++)
      for (int piece = 0; piece < s->pieces; piece++) {
        int part = part_of(s, (bar_place){family, bar, piece});
        tdm_vec3 n;
        double gap = is_there(s, part) ? dem_screen_bar_gap(s, part, x, &n) : INFINITY;
        if (gap < least) {
          least = gap;
          *normal = n;
        }
      }
  }
  return least;
}

int dem_screen_near(const dem_screen *s, tdm_vec3 x, double range, int *out, int max) {
  int n = 0;
  double wide = range + 0.5 * fmax(s->bar, s->thickness);
  if (fabs(x.z) > wide + fabs(s->layer))
    return 0;
  for (int family = 0; family < 2; family++) {
    double across = family ? x.x : x.y;
    int first, last;
    bars_between(s, across - wide, across + wide, &first, &last);
    for (int bar = first; bar <= last; bar++)
      for (int piece = 0; piece < s->pieces; piece++) {
        int part = part_of(s, (bar_place){family, bar, piece});
        tdm_vec3 normal;
        if (!is_there(s, part) || !(dem_screen_bar_gap(s, part, x, &normal) < range))
          continue;
        if (n < max)
          out[n] = part;
        n++;
      }
  }
  return n;
}

/* ---- touches ---- */

/* is x over a bar of the family, or under it? */
static bool over_family(const dem_screen *s, tdm_vec3 x, int family) {
  double across = family ? x.x : x.y;
  int first, last;
  bars_between(s, across - 0.5 * s->bar, across + 0.5 * s->bar, &first, &last);
  for (int bar = first; bar <= last; bar++)
    for (int piece = 0; piece < s->pieces; piece++) {
      int part = part_of(s, (bar_place){family, bar, piece});
      if (is_there(s, part) && view_of(s, part, x).beyond == 0)
        return true;
    }
  return false;
}

/* put in its place by part; of too many the shallowest is left out */
static void insert(dem_touch *t, int *n, dem_touch now) {
  if (*n == DEM_TOUCHES_MAX) {
    int worst = 0;
    for (int i = 1; i < *n; i++)
      worst = t[i].gap > t[worst].gap ? i : worst;
    if (t[worst].gap <= now.gap)
      return;
    for (int i = worst; i + 1 < *n; i++)
      t[i] = t[i + 1];
    (*n)--;
  }
  int place = (*n)++;
  for (; place > 0 && t[place - 1].part > now.part; place--)
    t[place] = t[place - 1];
  t[place] = now;
}

int dem_screen_touches(const dem_screen *s, const int *part, size_t stride, int n, tdm_vec3 x, double radius,
                       dem_touch out[DEM_TOUCHES_MAX]) {
  bool hidden[2] = {false, false}; /* the nearest points of a family lie on bars that cross it */
  if (s->deck == DEM_DECK_PLATE) {
    hidden[0] = over_family(s, x, 1);
    hidden[1] = !hidden[0] && over_family(s, x, 0);
  }
  int count = 0;
  for (int i = 0; i < n; i++) {
    dem_touch now = {.part = part[(size_t)i * stride]};
    if (hidden[place_of(s, now.part).family])
      continue;
    now.gap = dem_screen_bar_gap(s, now.part, x, &now.normal);
    if (now.gap < radius)
      insert(out, &count, now);
  }
  return count;
}

bool dem_screen_passes(const dem_screen *s, int from, int to) {
  bar_place a = place_of(s, from), b = place_of(s, to);
  return a.family != b.family || a.bar == b.bar;
}
