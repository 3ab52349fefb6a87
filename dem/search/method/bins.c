/* Spheres sorted into cells: see bins.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/search/method/bins.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* a cell's edge exceeds what is asked for by so much, relative, that round-off cannot hide a neighbour two cells away
 * within FARTHEST cells; beyond, all share a cell */
#define MARGIN 1e-6
#define FARTHEST 1e8

static int bin(double x, double low, double inverse, int count) {
  double t = (x - low) * inverse;
  if (t >= 0 && t < count)
    return (int)t;
  if (!(t > -FARTHEST))
    t = -FARTHEST; /* NaN too: it is near to nothing */
  if (t > FARTHEST)
    t = FARTHEST;
  long long cell = (long long)floor(t) % count;
  return (int)(cell < 0 ? cell + count : cell);
}

void dem_bins_cell(const dem_bins *bins, const double x[3], int cell[3]) {
  for (int a = 0; a < 3; a++)
    cell[a] = bin(x[a], bins->low[a], bins->inverse[a], bins->count[a]);
}

static const dem_sphere *sphere_of(const dem_search_input *input, const int *member, int k) {
  return dem_search_sphere(input, member ? member[k] : k);
}

static double coordinate(const dem_sphere *s, int axis) {
  return axis == 0 ? s->position.x : axis == 1 ? s->position.y : s->position.z;
}

typedef struct {
  double low[3], high[3];
} extent;

static extent extent_of_all(const dem_search_input *input, const int *member, int n) {
  const int nthread = dem_search_threads(input, n);
  double x0 = INFINITY, y0 = INFINITY, z0 = INFINITY, x1 = -INFINITY, y1 = -INFINITY, z1 = -INFINITY;
#pragma omp parallel for schedule(static) num_threads(nthread) if (nthread > 1) reduction(min           \
                                                                                          : x0, y0, z0) \
    reduction(max                                                                                       \
              : x1, y1, z1)
  for (int k = 0; k < n; k++) {
    tdm_vec3 x = sphere_of(input, member, k)->position;
    x0 = x.x < x0 ? x.x : x0;
    y0 = x.y < y0 ? x.y : y0;
    z0 = x.z < z0 ? x.z : z0;
    x1 = x.x > x1 ? x.x : x1;
    y1 = x.y > y1 ? x.y : y1;
    z1 = x.z > z1 ? x.z : z1;
  }
  return (extent){{x0, y0, z0}, {x1, y1, z1}};
}

static int compare_double(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* where nearly all are: the outermost 2 % of a sample left out on either side */
static extent extent_of_most(const dem_search_input *input, const int *member, int n) {
  enum { SAMPLE = 512 };
  double value[SAMPLE];
  extent e = {0};
  int step = n / SAMPLE + 1;
  for (int a = 0; a < 3; a++) {
    int m = 0;
    for (int k = 0; k < n; k += step) {
      double x = coordinate(sphere_of(input, member, k), a);
      if (isfinite(x))
        value[m++] = x;
    }
    if (m == 0)
      continue;
    qsort(value, (size_t)m, sizeof *value, compare_double);
    e.low[a] = value[m / 50];
    e.high[a] = value[m - 1 - m / 50];
  }
  return e;
}

/* cells in each direction; the product, which may be too large for an int */
static double counts(dem_bins *bins, const dem_domain *domain, const extent *e, double edge, double most) {
  double product = 1;
  for (int a = 0; a < 3; a++) {
    double cells = domain->periodic[a] ? domain->length[a] / edge : (e->high[a] - e->low[a]) / edge + 1;
    bins->count[a] = !(cells >= 1) ? 1 : cells < most ? (int)cells : (int)most;
    product *= cells >= 1 ? floor(cells) : 1;
  }
  return product;
}

static void fewer_cells(dem_bins *bins, double most) {
  while ((double)bins->count[0] * bins->count[1] * bins->count[2] > most) {
    int a = bins->count[0] >= bins->count[1] ? 0 : 1;
    a = bins->count[a] >= bins->count[2] ? a : 2;
    bins->count[a] = bins->count[a] / 2;
  }
}

void dem_bins_grid(dem_bins *bins, const dem_search_input *input, const int *member, int n, double edge) {
  const dem_domain *domain = &input->domain;
  const double most = 2.0 * n + 64;
  edge *= 1 + MARGIN;
  extent e = extent_of_all(input, member, n);
  if (!(counts(bins, domain, &e, edge, most) <= most)) {
    e = extent_of_most(input, member, n);
    counts(bins, domain, &e, edge, most);
    fewer_cells(bins, most);
  }
  for (int a = 0; a < 3; a++) {
    bool repeats = domain->periodic[a];
    bins->low[a] = repeats ? domain->low[a] : isfinite(e.low[a]) ? e.low[a] : 0;
    bins->inverse[a] = repeats ? bins->count[a] / domain->length[a] : 1 / edge;
  }
}

static tdm_status take(dem_bins *bins, dem_scratch *scratch, size_t n, size_t ncell) {
  n += DEM_LANES;
  bins->first = dem_scratch_take(scratch, (ncell + 1) * sizeof *bins->first);
  bins->x = dem_scratch_take(scratch, 4 * n * sizeof *bins->x);
  bins->index = dem_scratch_take(scratch, 2 * n * sizeof *bins->index);
  if (!bins->first || !bins->x || !bins->index)
    return TDM_ERR_MEMORY;
  bins->y = bins->x + n;
  bins->z = bins->y + n;
  bins->r = bins->z + n;
  bins->cell = bins->index + n;
  return TDM_OK;
}

/* Counting sort, which keeps the order; each thread has a part of the spheres. */
typedef struct {
  dem_bins *bins;
  const dem_search_input *input;
  const int *member;
  int nthread;
  size_t ncell;
  int *at; /* (nthread x ncell) spheres of each part in each cell, then where its next one goes */
} binning;

static void count_part(void *context, int t) {
  const binning *b = context;
  dem_bins *bins = b->bins;
  int *count = b->at + (size_t)t * b->ncell, end = dem_search_part(bins->n, t + 1, b->nthread);
  memset(count, 0, b->ncell * sizeof *count);
  for (int k = dem_search_part(bins->n, t, b->nthread); k < end; k++) {
    tdm_vec3 p = sphere_of(b->input, b->member, k)->position;
    int x = bin(p.x, bins->low[0], bins->inverse[0], bins->count[0]);
    int y = bin(p.y, bins->low[1], bins->inverse[1], bins->count[1]);
    int z = bin(p.z, bins->low[2], bins->inverse[2], bins->count[2]);
    bins->cell[k] = (z * bins->count[1] + y) * bins->count[0] + x;
    count[bins->cell[k]]++;
  }
}

static void place(dem_bins *bins, const dem_search_input *input, const int *member, int k, int at) {
  const dem_sphere *s = sphere_of(input, member, k);
  bins->index[at] = member ? member[k] : k;
  bins->x[at] = s->position.x;
  bins->y[at] = s->position.y;
  bins->z[at] = s->position.z;
  bins->r[at] = s->radius;
}

static void place_part(void *context, int t) {
  const binning *b = context;
  int *at = b->at + (size_t)t * b->ncell, end = dem_search_part(b->bins->n, t + 1, b->nthread);
  for (int k = dem_search_part(b->bins->n, t, b->nthread); k < end; k++)
    place(b->bins, b->input, b->member, k, at[b->bins->cell[k]]++);
}

tdm_status dem_bins_fill(dem_bins *bins, const dem_search_input *input, const int *member, int n, double edge) {
  dem_bins_grid(bins, input, member, n, edge);
  binning b = {bins, input, member, dem_search_threads(input, n), 1, NULL};
  for (int a = 0; a < 3; a++)
    b.ncell *= (size_t)bins->count[a];
  if (take(bins, input->scratch, (size_t)n, b.ncell))
    return TDM_ERR_MEMORY;
  bins->n = n;
  dem_scratch_mark mark = dem_scratch_now(input->scratch);
  b.at = dem_scratch_take(input->scratch, (size_t)b.nthread * b.ncell * sizeof *b.at);
  if (!b.at)
    return TDM_ERR_MEMORY;
  dem_search_parallel(b.nthread, count_part, &b);
  int at = 0;
  for (size_t c = 0; c < b.ncell; c++) {
    bins->first[c] = at;
    for (int t = 0; t < b.nthread; t++) {
      int *next = &b.at[(size_t)t * b.ncell + c], length = *next;
      *next = at;
      at += length;
    }
  }
  bins->first[b.ncell] = at;
  dem_search_parallel(b.nthread, place_part, &b);
  dem_scratch_back(input->scratch, mark);
  return TDM_OK;
}

/* the bins next to b in a direction of n bins, without repeating one */
static int beside(int b, int n, int out[3]) {
  int many = n < 3 ? n : 3;
  for (int k = 0; k < many; k++) {
    int c = n < 3 ? k : b + k - 1;
    out[k] = c < 0 ? c + n : c >= n ? c - n : c;
  }
  return many;
}

/* the bins in and next to begin ... end - 1, as ranges */
static int beside_in_x(dem_run own, int n, dem_run range[2]) {
  dem_run r = {own.begin - 1, own.end + 1};
  if (r.end - r.begin > n) {
    range[0] = (dem_run){0, n};
    return 1;
  }
  range[0] = (dem_run){r.begin < 0 ? 0 : r.begin, r.end > n ? n : r.end};
  if (r.begin >= 0 && r.end <= n)
    return 1;
  range[1] = r.begin < 0 ? (dem_run){n - 1, n} : (dem_run){0, 1};
  return 2;
}

int dem_bins_runs(const dem_bins *bins, dem_run x, int y, int z, int from, dem_run run[DEM_MOST_RUNS]) {
  int ys[3], zs[3], n = 0;
  dem_run xs[2];
  int nx = beside_in_x(x, bins->count[0], xs);
  int ny = beside(y, bins->count[1], ys), nz = beside(z, bins->count[2], zs);
  for (int c = 0; c < nz; c++)
    for (int b = 0; b < ny; b++) {
      const int *row = bins->first + ((size_t)zs[c] * (size_t)bins->count[1] + (size_t)ys[b]) * (size_t)bins->count[0];
      for (int a = 0; a < nx; a++) {
        int begin = row[xs[a].begin], end = row[xs[a].end];
        run[n] = (dem_run){begin > from ? begin : from, end};
        n += run[n].end > run[n].begin;
      }
    }
  return n;
}

/* the cell at which part t of the spheres begins */
static int part_cell(const dem_bins *bins, int t, int nthread) {
  int low = 0, high = bins->count[0] * bins->count[1] * bins->count[2];
  int sphere = dem_search_part(bins->n, t, nthread);
  if (t == nthread)
    return high;
  while (low < high) {
    int middle = low + (high - low) / 2;
    if (bins->first[middle] < sphere)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* Candidates, copied side by side: so that they are compared in full vectors, without a branch for each run or hit. */
enum { BATCH = 64 };
typedef struct {
  int n;
  double x[BATCH + DEM_LANES], y[BATCH + DEM_LANES], z[BATCH + DEM_LANES], r[BATCH + DEM_LANES];
  int index[BATCH + DEM_LANES];
} batch;

/* copies up to DEM_LANES - 1 too many, which are overwritten or not looked at */
DEM_SEARCH_KERNEL void take_run(batch *to, const dem_bins *bins, int begin, int length) {
  for (int k = 0; k < length; k += DEM_LANES) {
    int from = begin + k, at = to->n + k;
    memcpy(to->x + at, bins->x + from, DEM_LANES * sizeof *to->x);
    memcpy(to->y + at, bins->y + from, DEM_LANES * sizeof *to->y);
    memcpy(to->z + at, bins->z + from, DEM_LANES * sizeof *to->z);
    memcpy(to->r + at, bins->r + from, DEM_LANES * sizeof *to->r);
    memcpy(to->index + at, bins->index + from, DEM_LANES * sizeof *to->index);
  }
  to->n += length;
}

/* bit l: is excess[l] negative? The mask of eight doubles is narrowed to eight bytes, a multiplication gathers these.
 */
DEM_SEARCH_KERNEL uint64_t negative(const double excess[DEM_LANES]) {
  typedef double lanes __attribute__((vector_size(DEM_LANES * sizeof(double))));
  typedef int8_t bytes __attribute__((vector_size(DEM_LANES)));
  lanes e;
  uint64_t b;
  memcpy(&e, excess, sizeof e);
  bytes narrow = __builtin_convertvector(e < 0, bytes);
  memcpy(&b, &narrow, sizeof b);
  return ((b & 0x0101010101010101u) * 0x0102040810204080u) >> 56;
}

/* bit k: is candidate k near sphere p of bins `from`? Lanes beyond the last candidate hold whatever was there before;
 * their bits, which depend on them alone, are masked at the end. (valgrind does not follow that through the product in
 * `negative`, and reports a jump that depends on uninitialised values.) */
DEM_SEARCH_KERNEL uint64_t compare(const batch *with, const dem_bins *from, int p, const dem_near *near,
                                   bool periodic) {
  double x = from->x[p], y = from->y[p], z = from->z[p], r = from->r[p];
  uint64_t hits = 0;
  for (int k = 0; k < with->n; k += DEM_LANES) {
    double excess[DEM_LANES];
    for (int l = 0; l < DEM_LANES; l++)
      excess[l] =
          dem_excess(near, periodic, x - with->x[k + l], y - with->y[k + l], z - with->z[k + l], r + with->r[k + l]);
    hits |= negative(excess) << k;
  }
  return with->n < BATCH ? hits & ((UINT64_C(1) << with->n) - 1) : hits;
}

/* bits for all but the first `skip` candidates */
static inline uint64_t all_but(int skip) {
  return skip <= 0 ? ~UINT64_C(0) : skip >= BATCH ? 0 : ~UINT64_C(0) << skip;
}

DEM_SEARCH_KERNEL void scan(const dem_bins *bins, const dem_run *run, int nrun, const dem_bins *from, dem_run own,
                            bool later, const dem_near *near, bool periodic, dem_found *found) {
  batch with;
  int k = 0, at = nrun > 0 ? run[0].begin : 0;
  for (int passed = 0; k < nrun; passed += with.n) {
    with.n = 0;
    while (k < nrun && with.n < BATCH) {
      int room = BATCH - with.n, left = run[k].end - at;
      take_run(&with, bins, at, left < room ? left : room);
      at += room;
      if (left <= room && ++k < nrun)
        at = run[k].begin;
    }
    for (int p = own.begin; p < own.end; p++) {
      if (dem_found_reserve(found, BATCH))
        return;
      uint64_t hits = compare(&with, from, p, near, periodic);
      if (later)
        hits &= all_but(p + 1 - own.begin - passed);
      int index = from->index[p];
      dem_found_pair *pair = found->pair + found->count;
      for (; hits; hits &= hits - 1)
        *pair++ = (dem_found_pair){index, with.index[__builtin_ctzll(hits)]};
      found->count = (size_t)(pair - found->pair);
    }
  }
}

/* the instructions differ, the numbers do not: sums and products are the same, and none are fused (clang 14 gives what
 * is cloned a name that other files do not find) */
#if defined(__x86_64__) && !defined(__clang__) && DEM_SIMD_WIDEST > 0
#define CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define CLONES
#endif
CLONES void dem_bins_scan(const dem_bins *bins, const dem_run *run, int nrun, const dem_bins *from, dem_run own,
                          bool later, const dem_near *near, dem_found *found) {
  if (near->periodic)
    scan(bins, run, nrun, from, own, later, near, true, found);
  else
    scan(bins, run, nrun, from, own, later, near, false, found);
}

/* A few cells that follow each other in x are taken together: copying their candidates is shared. */
enum { TOGETHER_CELLS = 4, TOGETHER_SPHERES = 3 };

void dem_bins_pairs(const dem_bins *bins, const dem_near *near, int t, int nthread, dem_found *found) {
  const int *first = bins->first, nx = bins->count[0], end = part_cell(bins, t + 1, nthread);
  for (int c = part_cell(bins, t, nthread), next; c < end; c = next) {
    next = c + 1;
    if (first[c] == first[next])
      continue;
    int row = c / nx, x = c - row * nx;
    int most = row * nx + nx < end ? row * nx + nx : end;
    most = c + TOGETHER_CELLS < most ? c + TOGETHER_CELLS : most;
    while (next < most && first[next] - first[c] < TOGETHER_SPHERES)
      next++;
    dem_run run[DEM_MOST_RUNS + 1] = {{first[c], first[next]}};
    int nrun = 1 + dem_bins_runs(bins, (dem_run){x, x + next - c}, row % bins->count[1], row / bins->count[1],
                                 first[next], run + 1);
    dem_bins_scan(bins, run, nrun, bins, run[0], true, near, found);
  }
}
