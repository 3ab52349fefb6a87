/* The list of particles near walls: see near_walls.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/search/near_walls.h"

#include "dem/seam/homes.h"
#include "dem/state/wall_gap.h"

#include <stdlib.h>
#include <string.h>

static int compare_entries(const dem_wall_entry *a, const dem_wall_entry *b) {
  int chunk_a = a->particle / DEM_CHUNK, chunk_b = b->particle / DEM_CHUNK;
  if (chunk_a != chunk_b)
    return chunk_a < chunk_b ? -1 : 1;
  if (a->wall != b->wall)
    return a->wall < b->wall ? -1 : 1;
  if (a->particle != b->particle)
    return a->particle < b->particle ? -1 : 1;
  return a->part < b->part ? -1 : a->part > b->part;
}

/* ---- one chunk ---- */

typedef struct {
  dem_wall_entry *entry;
  size_t count, capacity;
  double *margin; /* (nbody) as dem_lists.margin, of this chunk's particles */
  bool failed;    /* there was no memory */
} near_chunk;

static bool reserve(near_chunk *to, size_t more) {
  if (to->count + more <= to->capacity)
    return true;
  size_t capacity = to->capacity + to->capacity / 2 + more + 64;
  dem_wall_entry *grown = realloc(to->entry, capacity * sizeof *grown);
  to->failed = to->failed || !grown;
  if (!grown)
    return false;
  to->entry = grown;
  to->capacity = capacity;
  return true;
}

/* how far part `part` of a wall is from touching a sphere at x, own axes; a little less, and 0 if that is not known */
static float away_from(const dem_wall *wall, int part, tdm_vec3 x, double radius) {
  if (!wall->shape->triangles)
    return 0;
  const double away = sqrt(dem_triangle_distance2(&wall->shape->triangles(wall)->triangle[part], x)) - radius;
  return away > 0 ? (float)((1 - 1e-6) * away) : 0;
}

static void lower(double *margin, double away) {
  *margin = away < *margin ? away : *margin;
}

/* the parts of wall w near particle i, whose centre is at `own` in the wall's axes */
static void list_parts(const dem_data *d, int i, int w, int from, tdm_vec3 own, double range, near_chunk *to) {
  const dem_wall *wall = &d->model->wall[w];
  int some[64], *near = some, n = wall->shape->near(wall, from, own, range, some, 64);
  if (n > 64) {
    near = malloc((size_t)n * sizeof *near);
    if (near)
      wall->shape->near(wall, from, own, range, near, n);
  }
  to->failed = to->failed || !near;
  if (near && reserve(to, (size_t)n))
    for (int k = 0; k < n; k++)
      to->entry[to->count++] = (dem_wall_entry){i, w, near[k], away_from(wall, near[k], own, range - d->lists.skin)};
  if (near != some)
    free(near);
}

enum { GROUP = 16 }; /* particles that lie side by side when they are in order */

/* The parts of wall w near particles first ... end - 1, at most GROUP. Where the box around them has none of the wall,
 * as is so for most of a large bed, none of them is looked at. */
static void list_group(const dem_data *d, int first, int end, int w, near_chunk *to) {
  const dem_wall *wall = &d->model->wall[w];
  tdm_vec3 own[GROUP], low = {INFINITY, INFINITY, INFINITY}, high = tdm_scale(-1, low);
  double range[GROUP];
  for (int i = first; i < end; i++) {
    const tdm_vec3 x = own[i - first] = dem_wall_own(&d->state.wall[w], d->state.sphere[i].position);
    const double r = range[i - first] = d->state.sphere[i].radius + d->model->reach + d->lists.skin;
    low = tdm_v3(fmin(low.x, x.x - r), fmin(low.y, x.y - r), fmin(low.z, x.z - r));
    high = tdm_v3(fmax(high.x, x.x + r), fmax(high.y, x.y + r), fmax(high.z, x.z + r));
  }
  lower(&to->margin[wall->body], d->lists.skin); /* what is not listed is farther */
  const int from = wall->shape->within ? wall->shape->within(wall, low, high) : 0;
  if (from < 0)
    return;
  for (int i = first; i < end; i++)
    list_parts(d, i, w, from, own[i - first], range[i - first], to);
}

/* Returns how far a particle that is not listed is, more where it is. */
static double list_wall(const dem_data *d, int i, int w, near_chunk *to) {
  const dem_wall *wall = &d->model->wall[w];
  const double radius = d->state.sphere[i].radius;
  double gap = dem_gap(d, i, w, NULL);
  /* distance from where a contact acts; a plane ends one radius behind its surface */
  double away = gap - radius - d->model->reach;
  if (wall->endless)
    away = fmax(away, -gap - radius);
  if (!(away < d->lists.skin))
    return away;
  if (reserve(to, 1))
    to->entry[to->count++] = (dem_wall_entry){i, w, 0, 0};
  return INFINITY;
}

static void list_chunk(const dem_data *d, int c, near_chunk *to) {
  const int first = c * DEM_CHUNK, end = dem_chunk_end(d, c);
  for (int w = 0; w < d->model->nwall; w++) {
    const dem_wall *wall = &d->model->wall[w];
    double margin = INFINITY;
    if (wall->shape->near)
      for (int i = first; i < end && !to->failed; i += GROUP)
        list_group(d, i, i + GROUP < end ? i + GROUP : end, w, to);
    else
      for (int i = first; i < end && !to->failed; i++)
        lower(&margin, list_wall(d, i, w, to));
    lower(&to->margin[wall->body], margin);
  }
}

/* ---- histories ---- */

/* the first entry of a chunk in a list that ascends */
static size_t first_of_chunk(const dem_wall_contacts *list, int c) {
  size_t low = 0, high = list->count;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (list->entry[middle].particle / DEM_CHUNK < c)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* the histories of a chunk's contacts, both lists ascending; stay: `before` has the same chunks */
static void carry_chunk(dem_data *d, const dem_wall_contacts *before, bool stay, int c) {
  dem_wall_contacts *list = &d->lists.walls;
  const size_t ncolumn = (size_t)d->model->columns.ncolumn, nold = !before ? 0
                                                                   : stay  ? before->chunk[c + 1]
                                                                           : before->count;
  size_t old = !before || ncolumn == 0 ? 0 : stay ? before->chunk[c] : first_of_chunk(before, c);
  for (size_t k = list->chunk[c]; k < list->chunk[c + 1] && ncolumn > 0; k++) {
    while (old < nold && compare_entries(&before->entry[old], &list->entry[k]) < 0)
      old++;
    bool same = old < nold && compare_entries(&before->entry[old], &list->entry[k]) == 0;
    for (size_t q = 0; q < ncolumn; q++)
      list->history[q * list->capacity + k] = same ? before->history[q * before->capacity + old] : 0;
  }
}

/* ---- all chunks ---- */

/* The home chunks' entries, one behind the other, with histories. */
static tdm_status join(dem_data *d, const near_chunk *chunk, const dem_wall_contacts *before, bool stay) {
  dem_wall_contacts *list = &d->lists.walls;
  const int first = dem_home_first(d), end = dem_home_end(d);
  for (int c = first; c < end; c++) {
    if (chunk[c].failed)
      return TDM_ERR_MEMORY;
    list->chunk[c] = chunk[c].count;
    for (int b = 0; b < d->model->nbody; b++)
      lower(&d->lists.margin[b], chunk[c].margin[b]);
  }
  dem_lay_out(d, list->chunk);
  const size_t count = list->chunk[d->lists.nchunk];
  list->count = 0;
  if (dem_walls_reserve(list, count, d->model->columns.ncolumn))
    return TDM_ERR_MEMORY;
  list->count = count;
#pragma omp parallel for schedule(static) num_threads(d->work.nthread) if (d->work.nthread > 1)
  for (int c = first; c < end; c++) {
    if (chunk[c].count > 0)
      memcpy(list->entry + list->chunk[c], chunk[c].entry, chunk[c].count * sizeof *list->entry);
    carry_chunk(d, before, stay, c);
  }
  return TDM_OK;
}

tdm_status dem_near_walls_build(dem_data *d, const dem_wall_contacts *before, bool stay) {
  const int nchunk = d->lists.nchunk;
  const size_t nbody = (size_t)d->model->nbody, nmargin = (size_t)nchunk * nbody;
  near_chunk *chunk = calloc((size_t)nchunk, sizeof *chunk);
  double *margin = malloc((nmargin + 1) * sizeof *margin);
  tdm_status status = chunk && margin ? TDM_OK : TDM_ERR_MEMORY;
  for (size_t k = 0; k < nmargin && !status; k++)
    margin[k] = INFINITY;
  if (!status) {
#pragma omp parallel for schedule(dynamic) num_threads(d->work.nthread) if (d->work.nthread > 1)
    for (int c = dem_home_first(d); c < dem_home_end(d); c++) {
      near_chunk own = {.margin = margin + (size_t)c * nbody}; /* beside no other thread's */
      list_chunk(d, c, &own);
      chunk[c] = own;
    }
    status = join(d, chunk, before, stay);
  }
  for (int c = 0; chunk && c < nchunk; c++)
    free(chunk[c].entry);
  free(chunk);
  free(margin);
  return status;
}

/* ---- new numbers ---- */

typedef struct {
  dem_wall_entry entry;
  int at;
} renumbered;

static int by_entry(const void *a, const void *b) {
  return compare_entries(&((const renumbered *)a)->entry, &((const renumbered *)b)->entry);
}

tdm_status dem_near_walls_renumber(const dem_data *d, dem_wall_contacts *list, size_t first, size_t end,
                                   const int *now) {
  size_t ncolumn = (size_t)d->model->columns.ncolumn, n = end - first;
  dem_wall_entry *entry = list->entry + first;
  if (n == 0 || ncolumn == 0)
    return TDM_OK;
  renumbered *key = malloc(n * sizeof *key);
  double *copy = malloc(n * sizeof *copy);
  for (size_t k = 0; key && k < n; k++) {
    key[k].entry = entry[k];
    if (now)
      key[k].entry.particle = now[key[k].entry.particle];
    key[k].at = (int)k;
  }
  if (key && copy) {
    qsort(key, n, sizeof *key, by_entry);
    for (size_t k = 0; k < n; k++)
      entry[k] = key[k].entry;
    for (size_t q = 0; q < ncolumn; q++) {
      double *history = list->history + q * list->capacity + first;
      memcpy(copy, history, n * sizeof *copy);
      for (size_t k = 0; k < n; k++)
        history[k] = copy[key[k].at];
    }
  }
  bool good = key && copy;
  free(key);
  free(copy);
  return good ? TDM_OK : TDM_ERR_MEMORY;
}
