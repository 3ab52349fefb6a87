/* Decks of a screen: square holes in aisles, on a disc. Whatever is asked is found by arithmetic, so that a contact
 * costs the same with any number of holes.
 *
 * Own axes: x and y along the aisles, z across the deck, the origin in the middle of a hole. With the pitch
 * p = 2w + g, holes of edge 2w have their centres at (i p, j p), |i|, |j| <= n - 1 with n = R/p + 1 rounded, so that
 * there are 2n - 1 aisles each way; between them are 2n - 2 bars of width g at (k - n + 3/2) p, k = 0 ... 2n - 3
 * ([A07] Eq. 4.22, 4.23).
 *
 * [A07]: N. Alkhaldi, dissertation, chapter 4 (tumbler screening machines).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_SCREEN_SCREEN_H
#define DEM_GEOMETRY_SCREEN_SCREEN_H

#include "dem/geometry/touch.h"
#include "dem/geometry/wall/wall.h"

#include <stdbool.h>
#include <stddef.h>

typedef enum { DEM_DECK_REDUCED, DEM_DECK_WIRES, DEM_DECK_PLATE } dem_deck;

/* How a particle gets through a reduced hole: it falls through, held by its sides; who touches the deck over a hole is
 * through; nothing acts while it is over the hole, and the plane does beside it. */
typedef enum { DEM_PASSING_FALL, DEM_PASSING_AT_ONCE, DEM_PASSING_OVER_HOLE } dem_passing;

/* All doubles after the numbers, so that it has no gaps. */
typedef struct dem_screen {
  int deck;         /* dem_deck */
  int aisles;       /* n - 1: of holes, on each side of the middle one */
  int by_radius;    /* reduced: a particle's own radius must be inside the reduced hole too (model 1) */
  int passing;      /* reduced: dem_passing */
  int pieces;       /* of a bar: 2 where an inner circle cuts some, else 1 */
  double half;      /* w, of a hole [m] */
  double bar;       /* g [m] */
  double radius;    /* R [m] */
  double inner;     /* radius inside of which there is no deck [m] */
  double zeta;      /* reduced: clearance b as a share of w (model 2) or of w - r (model 1), 0 ... 1 */
  double clearance; /* reduced: b itself [m]; negative: zeta decides */
  double thickness; /* wires: their diameter, plate: its height, reduced: 0 [m] */
  double layer;     /* wires: z of those along x, and -z of those along y [m] */
} dem_screen;

/* From the middle of a hole to that of the next [m]. */
static inline double dem_screen_pitch(const dem_screen *screen) {
  return 2 * screen->half + screen->bar;
}

/* The screen that a wall is; NULL: it is none. */
const dem_screen *dem_screen_of(const dem_wall *wall);

/* Is x (own axes) farther from the disc of the deck than range [m]? Where it is not, this may say no all the same. */
static inline bool dem_screen_far(const dem_screen *s, tdm_vec3 x, double range) {
  const double above = range + s->layer + 0.5 * s->thickness, beside = range + s->radius;
  return fabs(x.z) > above || x.x * x.x + x.y * x.y > beside * beside;
}

/* Is x (own axes) over a hole, or under it or in it: hole (i, j)? Holes are those whose middles are on the disc. */
bool dem_screen_hole(const dem_screen *screen, tdm_vec3 x, int *i, int *j);

/* How many holes there are. */
long dem_screen_holes(const dem_screen *screen);

/* ---- the reduced hole ---- */

/* Half the width of the square over which the centre of a sphere of this radius must be to pass [m]: w - b, in model 1
 * w - b - r; 0 or less: it does not pass anywhere. */
double dem_screen_passage(const dem_screen *screen, double radius);

/* A plane of no thickness that lets through whom it has a hole for. In the space of centres it is an obstacle: what is
 * nearer to the disc than the radius, less the columns over the reduced holes. The gap is the radius more than the
 * signed distance of the centre from that obstacle (at an outer edge a lower bound of it), so there is no contact over
 * a reduced hole however near the plane is, and who drifts over a bar in mid-passage is pushed back by the side of the
 * hole. A centre inside leaves by the nearest surface: the gap is continuous everywhere, and so is the energy of an
 * elastic contact. */
double dem_screen_reduced_gap(const dem_screen *screen, tdm_vec3 x, double radius, tdm_vec3 *normal);

/* Is a centre at x over a reduced hole through which a sphere of this radius passes? */
bool dem_screen_over_hole(const dem_screen *screen, tdm_vec3 x, double radius);

/* ---- bars ---- */

/* Number of parts: pieces of bars, first of those along x, then of those along y. */
int dem_screen_parts(const dem_screen *screen);

/* From where to where a part reaches along its axis, and where it lies across it [m]. False: there is no such piece. */
bool dem_screen_bar(const dem_screen *screen, int part, double ends[2], double *across);

/* Signed distance of x from a part that exists, negative inside, and the unit normal there: a cylinder with half balls
 * as ends, or a box. */
double dem_screen_bar_gap(const dem_screen *screen, int part, tdm_vec3 x, tdm_vec3 *normal);

/* The same of the nearest part. */
double dem_screen_gap(const dem_screen *screen, tdm_vec3 x, tdm_vec3 *normal);

/* The parts nearer to x than range, ascending; their number, also when it is above `max` (then out is of no use). */
int dem_screen_near(const dem_screen *screen, tdm_vec3 x, double range, int *out, int max);

/* The touches of a sphere among the parts part[0], part[stride] ... (n of them), ascending. Wires are bodies of their
 * own: each that is nearer than the radius is touched. The bars of a plate are one body, touched where the distance has
 * a local minimum: over a bar not those that cross it, over a crossing once. */
int dem_screen_touches(const dem_screen *screen, const int *part, size_t stride, int n, tdm_vec3 x, double radius,
                       dem_touch out[DEM_TOUCHES_MAX]);

/* Does a contact that ended on part `from` go on as one that begins on `to`? On the same bar, or one that crosses it.
 */
bool dem_screen_passes(const dem_screen *screen, int from, int to);

#endif
