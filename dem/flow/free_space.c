/* Room for a sphere: see free_space.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/flow/free_space.h"

#include "dem/state/wall_gap.h"

#include <stdlib.h>
#include <string.h>

enum { SCANS = 12 }; /* looks at all members that cost as much as making cells */

/* ---- members ---- */

static tdm_status grow(dem_free_space *r) {
  int capacity = 2 * r->capacity + 64;
  dem_occupant *member = realloc(r->member, (size_t)capacity * sizeof *member);
  r->member = member ? member : r->member;
  int *next = member && r->first ? realloc(r->next, (size_t)capacity * sizeof *next) : NULL;
  r->next = next ? next : r->next;
  if (!member || (r->first && !next))
    return TDM_ERR_MEMORY;
  r->capacity = capacity;
  return TDM_OK;
}

tdm_status dem_free_space_open(dem_free_space *r, const dem_data *d, tdm_vec3 low, tdm_vec3 high, double radius) {
  const dem_model *m = d->model;
  *r = (dem_free_space){.low = dem_flatten(m, low, m->flat_at),
                        .high = dem_flatten(m, high, m->flat_at),
                        .radius = radius,
                        .largest = radius};
  for (int i = 0; i < d->state.nparticle; i++)
    if (dem_free_space_add(r, d, i)) {
      dem_free_space_close(r);
      return TDM_ERR_MEMORY;
    }
  return TDM_OK;
}

void dem_free_space_close(dem_free_space *r) {
  free(r->first);
  free(r->member);
  free(r->next);
  *r = (dem_free_space){0};
}

/* ---- cells ---- */

/* the cell of a place: at the rim when it is outside */
static int cell_of(const dem_free_space *r, tdm_vec3 x) {
  const double at[3] = {x.x - r->low.x, x.y - r->low.y, x.z - r->low.z};
  int cell = 0;
  for (int a = 2; a >= 0; a--)
    cell = cell * r->n[a] + (int)fmax(0, fmin(floor(at[a] * r->per_edge), r->n[a] - 1));
  return cell;
}

/* about as many cells as members, none too short; returns their number */
static size_t choose_cells(dem_free_space *r) {
  const double length[3] = {r->high.x - r->low.x, r->high.y - r->low.y, r->high.z - r->low.z};
  double cells;
  for (r->edge = 1.001 * (r->radius + r->largest);; r->edge *= 1.25) { /* round-off must not decide */
    cells = 1;
    for (int a = 0; a < 3; a++)
      cells *= floor(length[a] / r->edge) + 1;
    if (cells <= 2.0 * r->count + 1)
      break;
  }
  for (int a = 0; a < 3; a++)
    r->n[a] = (int)floor(length[a] / r->edge) + 1;
  r->per_edge = 1 / r->edge;
  return (size_t)cells;
}

static void put_in_cell(dem_free_space *r, int member) {
  int cell = cell_of(r, r->member[member].position);
  r->next[member] = r->first[cell];
  r->first[cell] = member;
}

/* without memory for cells all members are looked at */
static void make_cells(dem_free_space *r) {
  size_t cells = choose_cells(r);
  r->first = malloc(cells * sizeof *r->first);
  r->next = malloc((size_t)r->capacity * sizeof *r->next);
  if (!r->first || !r->next) {
    free(r->first);
    free(r->next);
    r->first = r->next = NULL;
    return;
  }
  memset(r->first, 0xff, cells * sizeof *r->first); /* -1 */
  for (int k = 0; k < r->count; k++)
    put_in_cell(r, k);
}

/* the images k of a sphere at x that are near the box along an axis: from[axis] to to[axis] */
static void find_images(const dem_free_space *r, const dem_data *d, const dem_sphere *s, double from[3], double to[3]) {
  double reach = s->radius + r->radius;
  for (int a = 0; a < 3; a++) {
    double x = (&s->position.x)[a], low = (&r->low.x)[a] - reach, high = (&r->high.x)[a] + reach;
    double length = d->state.domain.length[a];
    bool repeats = d->model->domain.repeats && d->state.domain.periodic[a];
    from[a] = repeats ? ceil((low - x) / length) : x >= low ? 0 : 1;
    to[a] = repeats ? floor((high - x) / length) : x <= high ? 0 : -1;
  }
}

static tdm_status add_member(dem_free_space *r, tdm_vec3 x, double radius) {
  if (r->count == r->capacity && grow(r))
    return TDM_ERR_MEMORY;
  r->largest = fmax(r->largest, radius);
  r->member[r->count++] = (dem_occupant){x, radius};
  if (r->first)
    put_in_cell(r, r->count - 1);
  return TDM_OK;
}

tdm_status dem_free_space_add(dem_free_space *r, const dem_data *d, int i) {
  const dem_sphere *s = &d->state.sphere[i];
  double from[3], to[3];
  find_images(r, d, s, from, to);
  for (double c = from[2]; c <= to[2]; c++)
    for (double b = from[1]; b <= to[1]; b++)
      for (double a = from[0]; a <= to[0]; a++) {
        tdm_vec3 shift =
            tdm_v3(a * d->state.domain.length[0], b * d->state.domain.length[1], c * d->state.domain.length[2]);
        if (add_member(r, tdm_add(s->position, shift), s->radius))
          return TDM_ERR_MEMORY;
      }
  return TDM_OK;
}

/* ---- asking ---- */

static bool overlaps_wall(const dem_data *d, tdm_vec3 x, double radius) {
  for (int w = 0; w < d->model->nwall; w++)
    if (dem_touches_at(d, w, x, radius))
      return true;
  return false;
}

static bool overlaps(const dem_occupant *s, tdm_vec3 x, double radius) {
  tdm_vec3 c = tdm_sub(x, s->position);
  double sum = radius + s->radius;
  return tdm_dot(c, c) < sum * sum;
}

static bool overlaps_any(dem_free_space *r, tdm_vec3 x, double radius) {
  int k = 0;
  while (k < r->count && !overlaps(&r->member[k], x, radius))
    k++;
  r->looked += k;
  return k < r->count;
}

/* the same by the cell of x and those around it */
static bool overlaps_near(const dem_free_space *r, tdm_vec3 x, double radius) {
  int cell = cell_of(r, x), nx = r->n[0], ny = r->n[1];
  const int at[3] = {cell % nx, cell / nx % ny, cell / nx / ny};
  int from[3], to[3];
  for (int a = 0; a < 3; a++) {
    from[a] = at[a] > 0 ? at[a] - 1 : 0;
    to[a] = at[a] < r->n[a] - 1 ? at[a] + 1 : at[a];
  }
  for (int c = from[2]; c <= to[2]; c++)
    for (int b = from[1]; b <= to[1]; b++)
      for (int a = from[0]; a <= to[0]; a++)
        for (int k = r->first[(c * ny + b) * nx + a]; k >= 0; k = r->next[k])
          if (overlaps(&r->member[k], x, radius))
            return true;
  return false;
}

bool dem_free_space_free(dem_free_space *r, const dem_data *d, tdm_vec3 x, double radius) {
  if (overlaps_wall(d, x, radius))
    return false;
  if (!r->first && r->looked > SCANS * (r->count + 64L))
    make_cells(r);
  return !(r->first ? overlaps_near(r, x, radius) : overlaps_any(r, x, radius));
}
