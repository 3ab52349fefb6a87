/* Decks of a screen: see screen.h. Three surfaces: [A07]'s reduced hole, wires and a punched plate; the parts
 * of the latter two are their bars. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/screen/screen.h"

#include "dem/geometry/shape/rows.h"
#include "protocol/math/hash.h"

#include <stdlib.h>

static const dem_shape wires_and_plates, letting_go;

/* ---- reading ---- */

static const char *const decks[] = {
    [DEM_DECK_REDUCED] = "reduced", [DEM_DECK_WIRES] = "wires", [DEM_DECK_PLATE] = "plate"};
static const char *const models[] = {"center", "radius"};
static const char *const passing[] = {
    [DEM_PASSING_FALL] = "fall", [DEM_PASSING_AT_ONCE] = "at_once", [DEM_PASSING_OVER_HOLE] = "over_hole"};

enum { AISLES_MAX = 100000 }; /* of holes, on each side of the middle one */

static void read_reduced(tdm_object *o, dem_screen *s) {
  s->by_radius = tdm_get_choice(o, "model", models, 2, 0) == 1;
  s->passing = tdm_get_choice(o, "passing", passing, 3, 0);
  s->zeta = tdm_get_number(o, "zeta", 0, TDM_UNIT_INTERVAL);
  s->clearance = tdm_get_number(o, "clearance", -1, tdm_has(o, "clearance") ? TDM_NOT_NEGATIVE : TDM_ANY);
  if (tdm_has(o, "zeta") && tdm_has(o, "clearance"))
    tdm_object_fail(o, "clearance", "and \"zeta\" are two ways to give the clearance; remove one of them");
}

static void read_bars(tdm_object *o, dem_screen *s) {
  s->thickness = tdm_get_number(o, "thickness", s->bar, TDM_POSITIVE);
  if (s->deck == DEM_DECK_PLATE)
    return;
  s->layer = tdm_get_integer(o, "layers", 2, 1) == 1 ? 0 : 0.5 * s->thickness;
  if (tdm_get_integer(o, "layers", 2, 1) > 2)
    tdm_object_fail(o, "layers", "must be 1, wires in one plane, or 2, those along x over those along y");
  if (!o->err->status && !(s->thickness < dem_screen_pitch(s)))
    tdm_object_fail(o, "thickness", "is %g m but must be less than hole + bar, %g m, or there are no holes",
                    s->thickness, dem_screen_pitch(s));
}

static void count_aisles(tdm_object *o, dem_screen *s) {
  double aisles = nearbyint(s->radius / dem_screen_pitch(s));
  if (o->err->status)
    return;
  if (aisles > AISLES_MAX)
    tdm_object_fail(o, "radius", "gives %g holes along the radius, more than %d; is \"hole\" in metres?", aisles,
                    AISLES_MAX);
  if (aisles < 1)
    tdm_object_fail(o, "radius", "is %g m, less than half of hole + bar, %g m: there is no bar; give a larger deck",
                    s->radius, dem_screen_pitch(s));
  if (s->inner >= s->radius)
    tdm_object_fail(o, "inner_radius", "is %g m but must be less than \"radius\", %g m", s->inner, s->radius);
  s->aisles = (int)aisles;
}

static void read_screen(tdm_object *o, int body, dem_wall_list *list) {
  dem_screen s = {.deck = tdm_get_choice(o, "deck", decks, 3, -1), .zeta = 0, .clearance = -1};
  s.half = 0.5 * tdm_get_number(o, "hole", TDM_REQUIRED, TDM_POSITIVE);
  s.bar = tdm_get_number(o, "bar", TDM_REQUIRED, TDM_POSITIVE);
  s.radius = tdm_get_number(o, "radius", TDM_REQUIRED, TDM_POSITIVE);
  s.inner = tdm_get_number(o, "inner_radius", 0, TDM_NOT_NEGATIVE);
  s.pieces = s.inner > 0 ? 2 : 1;
  count_aisles(o, &s);
  if (s.deck == DEM_DECK_REDUCED)
    read_reduced(o, &s);
  else
    read_bars(o, &s);
  const dem_shape *reduced = s.passing == DEM_PASSING_FALL ? &dem_shape_screen : &letting_go;
  dem_wall wall = {.shape = s.deck == DEM_DECK_REDUCED ? reduced : &wires_and_plates, .body = body};
  wall.point = tdm_get_vec3(o, "center", &(tdm_vec3){0, 0, 0});
  wall.turn = tdm_get_orientation(o, "orientation");
  if (o->err->status)
    return;
  dem_screen *data = malloc(sizeof *data);
  if (!data) {
    tdm_fail(o->err, TDM_ERR_MEMORY, NULL, "no memory for a screen");
    return;
  }
  *data = s;
  wall.data = data;
  dem_walls_append(list, wall, o->err);
}

/* ---- what all decks do ---- */

static void box_of_screen(const dem_wall *wall, tdm_vec3 *low, tdm_vec3 *high) {
  const dem_screen *s = wall->data;
  *high = tdm_v3(s->radius, s->radius, 0.5 * s->thickness + s->layer);
  *low = tdm_scale(-1, *high);
}

static unsigned long long hash_of(const dem_wall *wall) {
  const dem_screen *s = wall->data;
  const double numbers[] = {s->deck,   s->aisles, s->by_radius, s->passing,   s->half,      s->bar,
                            s->radius, s->inner,  s->zeta,      s->clearance, s->thickness, s->layer};
  return tdm_hash_bytes(TDM_HASH_START, numbers, sizeof numbers);
}

/* ---- holes ---- */

const dem_screen *dem_screen_of(const dem_wall *wall) {
  return wall->shape->hash == hash_of ? wall->data : NULL; /* all kinds of decks have that one */
}

static double round_off(const dem_screen *s) {
  return 1e-9 * dem_screen_pitch(s);
}

/* is the middle of hole (i, j) on the disc? */
static bool on_disc(const dem_screen *s, int i, int j) {
  const double pitch = dem_screen_pitch(s), rho = hypot(i * pitch, j * pitch);
  return rho >= s->inner - round_off(s) && rho <= s->radius + round_off(s);
}

/* the number of the aisle that x is nearest to */
static int aisle_of(const dem_screen *s, double x) {
  return (int)fmax(-s->aisles, fmin(nearbyint(x / dem_screen_pitch(s)), s->aisles));
}

bool dem_screen_hole(const dem_screen *s, tdm_vec3 x, int *i, int *j) {
  const double pitch = dem_screen_pitch(s);
  *i = aisle_of(s, x.x);
  *j = aisle_of(s, x.y);
  return fabs(x.x - *i * pitch) <= s->half && fabs(x.y - *j * pitch) <= s->half && on_disc(s, *i, *j);
}

/* how many of the holes (i, 0), (i, 1) ... have their middles nearer than rho to that of the deck */
static long nearer(const dem_screen *s, int i, double rho) {
  const double pitch = dem_screen_pitch(s), across = i * pitch;
  return across < rho ? (long)fmin(ceil(sqrt(rho * rho - across * across) / pitch), s->aisles + 1) : 0;
}

/* Row by row of a quarter of the deck: those with j > 0 or i > 0 are there four times. */
long dem_screen_holes(const dem_screen *s) {
  long n = 0;
  for (int i = 1; i <= s->aisles; i++)
    n += nearer(s, i, s->radius + round_off(s)) - nearer(s, i, s->inner - round_off(s));
  return 4 * n + on_disc(s, 0, 0);
}

/* ---- drawing ---- */

enum { POLYGONS_MAX = 20000, ROUND = 12, ROUND_PARTS = 300 };

/* A bar's section, across and up from its axis [m], clockwise from the left upper corner: of a deck of no thickness a
 * line, of wires round unless there are very many. Returns the number of corners. */
static int section_of(const dem_screen *s, double at[ROUND][2]) {
  const double high = 0.5 * s->thickness, wide = s->deck == DEM_DECK_WIRES ? high : 0.5 * s->bar;
  const bool round = s->deck == DEM_DECK_WIRES && dem_screen_parts(s) <= ROUND_PARTS;
  const int n = s->thickness == 0 ? 2 : round ? ROUND : 4;
  for (int k = 0; k < n; k++) {
    const double angle = M_PI / 2 + M_PI * (1 - 2 * k) / n;
    at[k][0] = round ? high * cos(angle) : k % 4 == 1 || k % 4 == 2 ? wide : -wide;
    at[k][1] = round ? high * sin(angle) : k < 2 ? high : -high;
  }
  return n;
}

/* One bar as a prism between two ends, of which the uppermost face shows its force. */
static void draw_bar(const dem_wall *wall, const dem_wall_view *view, int part, dem_polygons *all, tdm_error *err) {
  const dem_screen *s = wall->data;
  double ends[2], across, at[ROUND][2];
  if (!dem_screen_bar(s, part, ends, &across))
    return;
  const bool second = part >= dem_screen_parts(s) / 2;
  const double level = second ? -s->layer : s->layer;
  const int n = section_of(s, at);
  dem_polygon end[2];
  for (int e = 0; e < 2; e++) {
    end[e] = (dem_polygon){.body = wall->body, .solid = s->thickness > 0, .part = -1, .ncorner = n};
    for (int k = 0; k < n; k++) {
      const double side = across + at[k][0], z = level + at[k][1];
      end[e].corner[k] = dem_wall_world(view->place, second ? tdm_v3(side, ends[e], z) : tdm_v3(ends[e], side, z));
    }
    if (n > 2)
      dem_polygons_add(all, &end[e], err);
  }
  for (int k = 0; k < (n > 2 ? n : 1); k++) {
    const int next = (k + 1) % n;
    const dem_polygon face = {.body = wall->body,
                              .solid = s->thickness > 0,
                              .part = k == 0 ? part : -1,
                              .ncorner = 4,
                              .corner = {end[0].corner[k], end[1].corner[k], end[1].corner[next], end[0].corner[next]}};
    dem_polygons_add(all, &face, err);
  }
}

/* Bars of no thickness are framed by rings, as wide as they are. */
static void draw_rims(const dem_wall *wall, const dem_wall_view *view, dem_polygons *all, tdm_error *err) {
  const dem_screen *s = wall->data;
  dem_wall_draw_ring(wall, view, fmax(s->inner, s->radius - s->bar), s->radius, false, all, err);
  if (s->inner > 0)
    dem_wall_draw_ring(wall, view, s->inner, fmin(s->radius, s->inner + s->bar), false, all, err);
}

static void draw_screen(const dem_wall *wall, const dem_wall_view *view, dem_polygons *all, tdm_error *err) {
  const dem_screen *s = wall->data;
  const int parts = dem_screen_parts(s);
  double at[ROUND][2];
  if (parts * (section_of(s, at) + 2) > POLYGONS_MAX) {
    /* a net that is too fine for polygons */
    dem_wall_draw_ring(wall, view, s->inner, s->radius, s->thickness > 0, all, err);
    return;
  }
  for (int part = 0; part < parts && err->status == TDM_OK; part++)
    draw_bar(wall, view, part, all, err);
  if (s->thickness == 0)
    draw_rims(wall, view, all, err);
}

/* ---- the reduced hole ---- */

static double gap_of_reduced(const dem_wall *wall, tdm_vec3 x, tdm_vec3 *normal) {
  return dem_screen_reduced_gap(wall->data, x, 0, normal);
}

static double gap_of_sphere(const dem_wall *wall, tdm_vec3 x, double radius, tdm_vec3 *normal) {
  return dem_screen_reduced_gap(wall->data, x, radius, normal);
}

const dem_shape dem_shape_screen = {
    .type = "screen",
    .number = 7,
    .read = read_screen,
    .gap = gap_of_reduced,
    .sphere_gap = gap_of_sphere,
    .box = box_of_screen,
    .polygons = draw_screen,
    .hash = hash_of,
    .destroy = free,
};

static dem_letting lets_go(const dem_wall *wall, tdm_vec3 x, double radius) {
  const dem_screen *s = wall->data;
  if (!dem_screen_over_hole(s, x, radius))
    return DEM_HOLDS;
  return s->passing == DEM_PASSING_AT_ONCE ? DEM_LETS_GO_FOR_ALL : DEM_LETS_GO_HERE;
}

static const dem_shape letting_go = {
    .number = 13,
    .gap = gap_of_reduced,
    .sphere_gap = gap_of_sphere,
    .lets_go = lets_go,
    .box = box_of_screen,
    .polygons = draw_screen,
    .hash = hash_of,
    .destroy = free,
};

/* ---- wires and plates ---- */

static double gap_of_bars(const dem_wall *wall, tdm_vec3 x, tdm_vec3 *normal) {
  return dem_screen_gap(wall->data, x, normal);
}

static int bars_of(const dem_wall *wall) {
  return dem_screen_parts(wall->data);
}

static int near_bars(const dem_wall *wall, int from, tdm_vec3 x, double range, int *out, int max) {
  (void)from;
  return dem_screen_near(wall->data, x, range, out, max);
}

static int touches_of(const dem_wall *wall, const int *part, size_t stride, int n, tdm_vec3 x, double radius,
                      dem_touch out[DEM_TOUCHES_MAX]) {
  return dem_screen_touches(wall->data, part, stride, n, x, radius, out);
}

static bool passes(const dem_wall *wall, int from, int to) {
  return dem_screen_passes(wall->data, from, to);
}

static const dem_shape wires_and_plates = {
    .number = 8,
    .gap = gap_of_bars,
    .box = box_of_screen,
    .polygons = draw_screen,
    .parts = bars_of,
    .near = near_bars,
    .touches = touches_of,
    .passes = passes,
    .hash = hash_of,
    .destroy = free,
};
