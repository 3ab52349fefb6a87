/* What a rank keeps: see keep.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/exchange/keep.h"

#include "dem/base/pages.h"
#include "dem/seam/homes.h"

bool dem_keep_poisons;

/* entries first ... end - 1, of `size` bytes each */
static void forget(void *array, size_t first, size_t end, size_t size) {
  char *begin, *last;
  if (!array || first >= end || size == 0)
    return;
  char *from = (char *)array + first * size;
  if (dem_keep_poisons)
    memset(from, 0xff, (end - first) * size); /* NaN, -1 */
  else
    dem_pages_release(from, (end - first) * size, &begin, &last);
}

/* of an array with an entry for each of `all`: all but first ... end - 1 */
static void forget_others(void *array, size_t size, size_t first, size_t end, size_t all) {
  forget(array, 0, first, size);
  forget(array, end, all, size);
}

static void forget_particles(dem_data *d) {
  const size_t np = (size_t)d->state.nparticle, first = (size_t)dem_home_first_particle(d),
               end = (size_t)dem_home_end_particle(d);
#define X(field, n, name) forget_others(d->field, (size_t)(n) * sizeof *d->field, first, end, np);
  DEM_PARTICLE_STATE(X)
#undef X
#define X(field, name) forget_others(d->field, sizeof *d->field, first, end, np);
  DEM_FORCE_STATE(X)
#undef X
  forget(d->lists.pairs.first, 0, first, sizeof *d->lists.pairs.first);
  forget(d->lists.pairs.first, end + 1, np, sizeof *d->lists.pairs.first);
}

static void forget_pairs(const dem_data *d) {
  const dem_pairs *p = &d->lists.pairs;
  const size_t first = p->chunk[dem_home_first(d)], end = p->chunk[dem_home_end(d)], all = p->capacity;
  forget_others(p->one, sizeof *p->one, first, end, all);
  forget_others(p->other, sizeof *p->other, first, end, all);
  forget_others(p->reaction_slot, sizeof *p->reaction_slot, first, end, all);
  for (size_t q = 0; p->history && q < (size_t)d->model->columns.ncolumn; q++)
    forget_others(p->history + q * all, sizeof *p->history, first, end, all);
}

/* of the entries of walls those from `first` to before `end` are kept */
static void forget_walls(const dem_data *d, const dem_wall_contacts *w, size_t first, size_t end) {
  forget_others(w->entry, sizeof *w->entry, first, end, w->capacity);
  for (size_t q = 0; w->history && q < (size_t)d->model->columns.ncolumn; q++)
    forget_others(w->history + q * w->capacity, sizeof *w->history, first, end, w->capacity);
}

/* Is it time to forget? Not while arrays are gathered for every list, as where particles come or go all the time:
 * taking pages anew costs more than the gathering. */
static bool may_forget(dem_homes *s) {
  const bool again = s->spread && s->spread_before;
  const bool forget = !again && (s->spread || s->holds);
  s->holds = again;
  s->spread_before = s->spread;
  s->spread = false;
  return forget;
}

void dem_keep_home(dem_data *d) {
  const dem_wall_contacts *walls = &d->lists.walls;
  if (dem_alone(d))
    return;
  dem_parted(d, DEM_WHOLE);
  if (!may_forget(&d->work.homes) && !dem_keep_poisons)
    return;
  forget_particles(d);
  forget_pairs(d);
  forget_walls(d, walls, walls->chunk[dem_home_first(d)], walls->chunk[dem_home_end(d)]);
  forget_walls(d, &d->work.spare_walls, 0, 0); /* those of before */
}
