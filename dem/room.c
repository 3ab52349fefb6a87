/* Room for a sphere: see room.h. */
#include "dem/room.h"

#include <stdlib.h>
#include <string.h>

/* the cell of a place: at the rim when it is outside */
static int cell_of(const dem_room *r, tdm_vec3 x) {
  const double at[3] = {x.x - r->low.x, x.y - r->low.y, x.z - r->low.z};
  int cell = 0;
  for (int a = 2; a >= 0; a--)
    cell = cell * r->n[a] + (int)fmax(0, fmin(floor(at[a] / r->edge), r->n[a] - 1));
  return cell;
}

/* as many cells as there are particles, about, none shorter than `edge` */
static size_t choose_cells(dem_room *r, tdm_vec3 size, double edge, size_t particles) {
  const double length[3] = {size.x, size.y, size.z};
  double cells;
  for (r->edge = edge;; r->edge *= 1.25) {
    cells = 1;
    for (int a = 0; a < 3; a++)
      cells *= floor(length[a] / r->edge) + 1;
    if (cells <= 2.0 * (double)particles + 1)
      break;
  }
  for (int a = 0; a < 3; a++)
    r->n[a] = (int)floor(length[a] / r->edge) + 1;
  return (size_t)cells;
}

static bool near_box(const dem_sphere *s, tdm_vec3 low, tdm_vec3 high, double radius) {
  double reach = s->radius + radius;
  tdm_vec3 x = s->position;
  return x.x >= low.x - reach && x.x <= high.x + reach && x.y >= low.y - reach && x.y <= high.y + reach &&
         x.z >= low.z - reach && x.z <= high.z + reach;
}

bool dem_room_open(dem_room *r, const dem_data *d, tdm_vec3 low, tdm_vec3 high, double radius) {
  *r = (dem_room){.low = low};
  int near = 0;
  double largest = radius;
  for (int i = 0; i < d->nparticle; i++)
    if (near_box(&d->sphere[i], low, high, radius)) {
      near++;
      largest = fmax(largest, d->sphere[i].radius);
    }
  size_t cells = choose_cells(r, tdm_sub(high, low), radius + largest, (size_t)near + 32);
  r->first = malloc(cells * sizeof *r->first);
  if (r->first)
    memset(r->first, 0xff, cells * sizeof *r->first);
  bool good = r->first != NULL;
  for (int i = 0; i < d->nparticle && good && near > 0; i++)
    if (near_box(&d->sphere[i], low, high, radius)) {
      good = dem_room_add(r, d, i);
      near--;
    }
  if (!good)
    dem_room_close(r);
  return good;
}

void dem_room_close(dem_room *r) {
  free(r->first);
  free(r->particle);
  free(r->next);
  *r = (dem_room){0};
}

bool dem_room_add(dem_room *r, const dem_data *d, int i) {
  if (r->count == r->capacity) {
    int capacity = 2 * r->capacity + 64;
    int *particle = realloc(r->particle, (size_t)capacity * sizeof *particle);
    r->particle = particle ? particle : r->particle;
    int *next = realloc(r->next, (size_t)capacity * sizeof *next);
    r->next = next ? next : r->next;
    if (!particle || !next)
      return false;
    r->capacity = capacity;
  }
  int cell = cell_of(r, d->sphere[i].position);
  r->particle[r->count] = i;
  r->next[r->count] = r->first[cell];
  r->first[cell] = r->count++;
  return true;
}

static bool overlaps_wall(const dem_data *d, tdm_vec3 x, double radius) {
  const dem_model *m = d->model;
  for (int w = 0; w < m->nwall; w++) {
    tdm_vec3 n;
    double gap = dem_wall_gap(&m->wall[w], &d->wall[w], x, &n);
    if (gap < radius && !(m->wall[w].primitive == DEM_PLANE && gap <= -radius))
      return true;
  }
  return false;
}

static bool overlaps_member(const dem_room *r, const dem_data *d, int cell, tdm_vec3 x, double radius) {
  for (int k = r->first[cell]; k >= 0; k = r->next[k]) {
    const dem_sphere *s = &d->sphere[r->particle[k]];
    tdm_vec3 c = tdm_sub(x, s->position);
    double sum = radius + s->radius;
    if (tdm_dot(c, c) < sum * sum)
      return true;
  }
  return false;
}

bool dem_room_free(const dem_room *r, const dem_data *d, tdm_vec3 x, double radius) {
  if (overlaps_wall(d, x, radius))
    return false;
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
        if (overlaps_member(r, d, (c * ny + b) * nx + a, x, radius))
          return false;
  return true;
}
