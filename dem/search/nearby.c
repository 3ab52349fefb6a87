/* Which spheres the rows of a part of them can name: see nearby.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/search/nearby.h"

#include "dem/search/method/bins.h"

#include <math.h>
#include <string.h>

/* The part's spheres mark their cells, then the cells around are marked, too. */
typedef struct {
  dem_bins grid;      /* without spheres */
  char *marked;       /* (cells) */
  tdm_vec3 low, high; /* beyond these nothing is near [m] */
} marks;

static size_t cell_of(const dem_bins *grid, tdm_vec3 x) {
  int cell[3];
  dem_bins_cell(grid, (double[]){x.x, x.y, x.z}, cell);
  return ((size_t)cell[2] * (size_t)grid->count[1] + (size_t)cell[1]) * (size_t)grid->count[0] + (size_t)cell[0];
}

/* Mark what is next to a marked cell along an axis, in a grid that repeats; `copy`: room for the marks. */
static void mark_beside(marks *m, int axis, char *copy) {
  const int *count = m->grid.count;
  const size_t nx = (size_t)count[0], ny = (size_t)count[1], nz = (size_t)count[2], ncell = nx * ny * nz;
  const size_t step = axis == 0 ? 1 : axis == 1 ? nx : nx * ny, line = step * (size_t)count[axis];
  memcpy(copy, m->marked, ncell);
  for (size_t begin = 0; begin < ncell; begin += line)
    for (size_t k = 0; k < line; k++)
      m->marked[begin + k] |= copy[begin + (k < step ? k + line - step : k - step)] |
                              copy[begin + (k + step < line ? k + step : k + step - line)];
}

static void extend(marks *m, tdm_vec3 x) {
  const tdm_vec3 low = m->low, high = m->high;
  m->low = tdm_v3(x.x < low.x ? x.x : low.x, x.y < low.y ? x.y : low.y, x.z < low.z ? x.z : low.z);
  m->high = tdm_v3(x.x > high.x ? x.x : high.x, x.y > high.y ? x.y : high.y, x.z > high.z ? x.z : high.z);
}

/* `reach`: how far the centres of near spheres can be from each other */
static tdm_status mark(marks *m, const dem_search_input *input, const int *number, double reach) {
  const int n = input->end - input->begin;
  dem_bins_grid(&m->grid, input, number, n, reach);
  const size_t ncell = (size_t)m->grid.count[0] * (size_t)m->grid.count[1] * (size_t)m->grid.count[2];
  char *copy = dem_scratch_take(input->scratch, ncell);
  m->marked = dem_scratch_take(input->scratch, ncell);
  if (!copy || !m->marked)
    return TDM_ERR_MEMORY;
  memset(m->marked, 0, ncell);
  m->low = tdm_v3(INFINITY, INFINITY, INFINITY);
  m->high = tdm_scale(-1, m->low);
  for (int i = input->begin; i < input->end; i++) {
    const tdm_vec3 x = input->sphere[i].position;
    extend(m, x);
    m->marked[cell_of(&m->grid, x)] = 1;
  }
  for (int a = 0; a < 3; a++) {
    mark_beside(m, a, copy);
    const bool repeats = input->domain.periodic[a];
    (&m->low.x)[a] = repeats ? -INFINITY : (&m->low.x)[a] - reach;
    (&m->high.x)[a] = repeats ? INFINITY : (&m->high.x)[a] + reach;
  }
  return TDM_OK;
}

static bool may_be_near(const marks *m, tdm_vec3 x) {
  return x.x >= m->low.x && x.x <= m->high.x && x.y >= m->low.y && x.y <= m->high.y && x.z >= m->low.z &&
         x.z <= m->high.z && m->marked[cell_of(&m->grid, x)];
}

/* More than the largest sum of two radii and the skin, so that round-off does not decide. */
static double reach_of(const dem_search_input *input, const int *run, int nrun) {
  double largest = 0;
  for (int i = input->begin; i < input->end; i++)
    largest = input->sphere[i].radius > largest ? input->sphere[i].radius : largest;
  for (int k = 0; k < nrun; k++)
    for (int i = run[2 * k]; i < run[2 * k + 1]; i++)
      largest = input->sphere[i].radius > largest ? input->sphere[i].radius : largest;
  return (1 + 1e-6) * (2 * largest + input->skin);
}

static int length_of(const int *run, int nrun) {
  int n = 0;
  for (int k = 0; k < nrun; k++)
    n += run[2 * k + 1] - run[2 * k];
  return n;
}

tdm_status dem_nearby_choose(dem_search_input *input) {
  const int behind[] = {input->end, input->n}, *run = input->run ? input->run : behind;
  const int nrun = input->run ? input->nrun : 1;
  int n = input->end - input->begin;
  int *number = dem_scratch_take(input->scratch, (size_t)(n + length_of(run, nrun) + 1) * sizeof *number);
  if (!number)
    return TDM_ERR_MEMORY;
  for (int k = 0; k < n; k++)
    number[k] = input->begin + k;
  const dem_scratch_mark before = dem_scratch_now(input->scratch);
  marks m;
  if (n > 0 && mark(&m, input, number, reach_of(input, run, nrun)))
    return TDM_ERR_MEMORY;
  const int own = n;
  for (int k = 0; own > 0 && k < nrun; k++)
    for (int j = run[2 * k]; j < run[2 * k + 1]; j++)
      if (may_be_near(&m, input->sphere[j].position))
        number[n++] = j;
  dem_scratch_back(input->scratch, before);
  input->number = number;
  input->n = n;
  return TDM_OK;
}
