/* The order of particles in memory: see order.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/search/order.h"

#include "dem/seam/homes.h"

#include <stdlib.h>

/* a number's 21 bits, two zeros between each */
static uint64_t spread(uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffffu;
  x = (x | x << 16) & 0x1f0000ff0000ffu;
  x = (x | x << 8) & 0x100f00f00f00f00fu;
  x = (x | x << 4) & 0x10c30c30c30c30c3u;
  return (x | x << 2) & 0x1249249249249249u;
}

/* cell of a coordinate; what flew far away or is no number is in the last one */
static uint64_t cell(double x, double low, double size) {
  double c = floor((x - low) / size);
  return c >= 0 && c < 0x1fffff ? (uint64_t)c : 0x1fffff;
}

/* of a particle in cell c: its place on the curve; or its slice, then its row in the slice, then its place in the row
 */
static uint64_t code(const uint64_t c[3], int slices) {
  if (slices == 0)
    return spread(c[0]) | spread(c[1]) << 1 | spread(c[2]) << 2;
  const int a = slices - 1;
  return c[a] << 42 | c[(a + 1) % 3] << 21 | c[(a + 2) % 3];
}

typedef struct {
  uint64_t code;
  int particle;
} place;

static int compare(const void *a, const void *b) {
  const place *p = a, *q = b;
  if (p->code != q->code)
    return p->code < q->code ? -1 : 1;
  return p->particle < q->particle ? -1 : p->particle > q->particle;
}

/* the corner of the cells, and their size */
static void bounds(const dem_data *d, int first, int end, tdm_vec3 *low, double *size) {
  *low = tdm_v3(INFINITY, INFINITY, INFINITY);
  *size = 0;
  for (int i = first; i < end; i++) {
    tdm_vec3 x = d->state.sphere[i].position;
    *low = tdm_v3(fmin(low->x, x.x), fmin(low->y, x.y), fmin(low->z, x.z));
    *size = fmax(*size, 2 * d->state.sphere[i].radius);
  }
}

static uint64_t code_of(const dem_data *d, int i, tdm_vec3 low, double size) {
  tdm_vec3 x = d->state.sphere[i].position;
  const uint64_t c[3] = {cell(x.x, low.x, size), cell(x.y, low.y, size), cell(x.z, low.z, size)};
  return code(c, d->model->slices);
}

void dem_order_codes(const dem_data *d, uint64_t *codes) {
  const int first = dem_home_first_particle(d), end = dem_home_end_particle(d);
  tdm_vec3 low;
  double all[4];
  bounds(d, first, end, &low, &all[3]);
  for (int a = 0; a < 3; a++)
    all[a] = -(&low.x)[a];
  dem_homes_largest_of(d, all, 4);
  low = tdm_v3(-all[0], -all[1], -all[2]);
  for (int i = first; i < end; i++)
    codes[i - first] = code_of(d, i, low, all[3]);
}

tdm_status dem_order(dem_data *d, int *from) {
  int np = d->state.nparticle;
  dem_scratch_mark mark = dem_scratch_now(&d->work.scratch);
  place *places = dem_scratch_take(&d->work.scratch, (size_t)np * sizeof *places);
  if (!places)
    return TDM_ERR_MEMORY;
  tdm_vec3 low;
  double size;
  bounds(d, 0, np, &low, &size);
  for (int i = 0; i < np; i++)
    places[i] = (place){code_of(d, i, low, size), i};
  qsort(places, (size_t)np, sizeof *places, compare);
  for (int p = 0; p < np; p++)
    from[p] = places[p].particle;
  dem_scratch_back(&d->work.scratch, mark);
  return TDM_OK;
}
