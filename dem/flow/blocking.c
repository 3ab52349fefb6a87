/* Blocked holes: see blocking.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/flow/blocking.h"

#include "dem/geometry/screen/screen.h"
#include "dem/seam/homes.h"
#include "dem/state/wall_gap.h"

#include <stdlib.h>
#include <string.h>

static const double near = 1.05;      /* radii from the screen within which a particle lies on it */
static const double round_off = 1e-9; /* of times [s] */

const dem_screen *dem_deck_screen(const dem_model *m, int deck) {
  const int w = m->screening.deck[deck].screen;
  return w >= 0 ? dem_screen_of(&m->wall[w]) : NULL;
}

/* ---- where a particle lies ---- */

/* The deck on whose screen particle i lies, and its place there, own axes; -1: on none. */
static int deck_below(const dem_data *d, int i, tdm_vec3 *own) {
  const dem_model *m = d->model;
  const dem_sphere *s = &d->state.sphere[i];
  for (int k = 0; k < m->screening.ndeck; k++) {
    const int w = m->screening.deck[k].screen;
    if (w < 0)
      continue;
    *own = dem_wall_own(&d->state.wall[w], s->position);
    if (dem_screen_far(dem_screen_of(&m->wall[w]), *own, near * s->radius))
      continue;
    if (dem_gap(d, i, w, NULL) < near * s->radius)
      return k;
  }
  return -1;
}

/* Note where particle i lies at time t [s]. */
static void note(dem_data *d, int i, double t) {
  dem_spot *spot = &d->state.spot[i], now = {0};
  tdm_vec3 own;
  const int k = d->model->material[d->state.material[i]].product ? deck_below(d, i, &own) : -1;
  if (k >= 0) {
    const dem_screen *screen = dem_deck_screen(d->model, k);
    now = (dem_spot){.x = own.x, .y = own.y, .spot_since = t, .hole_since = t, .deck = k + 1};
    now.over = dem_screen_hole(screen, own, &now.i, &now.j);
    if (spot->deck == now.deck && hypot(own.x - spot->x, own.y - spot->y) < screen->half)
      now.x = spot->x, now.y = spot->y, now.spot_since = spot->spot_since;
    if (spot->deck == now.deck && spot->over && now.over && spot->i == now.i && spot->j == now.j)
      now.hole_since = spot->hole_since;
  }
  *spot = now;
}

/* ---- counting ---- */

static int ascending(const void *a, const void *b) {
  const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return (x > y) - (x < y);
}

/* a hole as a number: its deck in the highest bits */
enum { PLACE_BITS = 24 };

static uint64_t hole_number(const dem_spot *s) {
  const uint64_t middle = (uint64_t)1 << (PLACE_BITS - 1);
  return ((uint64_t)(s->deck - 1) << 2 * PLACE_BITS) | ((middle + (uint64_t)s->i) << PLACE_BITS) |
         (middle + (uint64_t)s->j);
}

/* Count held particles and blocked holes; two particles in one hole block one. */
static void count(dem_data *d, double t) {
  const dem_screening_def *s = &d->model->screening;
  uint64_t *hole = d->work.hole;
  size_t n = 0;
  for (int k = 0; k < s->ndeck; k++)
    d->state.deck[k].blocked = d->state.deck[k].held = 0;
  for (int i = 0; i < d->state.nparticle; i++) {
    const dem_spot *spot = &d->state.spot[i];
    if (spot->deck == 0)
      continue;
    const double long_ago = t - s->deck[spot->deck - 1].blocking_time + round_off;
    d->state.deck[spot->deck - 1].held += spot->spot_since <= long_ago;
    if (spot->over && spot->hole_since <= long_ago)
      hole[n++] = hole_number(spot);
  }
  qsort(hole, n, sizeof *hole, ascending);
  for (size_t k = 0; k < n; k++)
    d->state.deck[hole[k] >> 2 * PLACE_BITS].blocked += k == 0 || hole[k] != hole[k - 1];
  for (int k = 0; k < s->ndeck; k++)
    if (d->state.deck[k].blocked > d->state.deck[k].blocked_most)
      d->state.deck[k].blocked_most = d->state.deck[k].blocked;
}

void dem_blocking_look(dem_data *d, double t) {
  const dem_screening_def *s = &d->model->screening;
  if (!s->watched || d->state.nstep % s->every != 0)
    return;
  dem_unite(d, DEM_PLACES | DEM_MOTION); /* dem_gap asks which a screen has let go */
#pragma omp parallel for schedule(static) num_threads(d->work.nthread) if (d->work.nthread > 1)
  for (int i = 0; i < d->state.nparticle; i++)
    note(d, i, t);
  count(d, t);
}
