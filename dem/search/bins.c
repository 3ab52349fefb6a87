/* Spheres sorted into cells: see bins.h. */
#include "dem/search/bins.h"

#include <math.h>
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
  return &input->sphere[member ? member[k] : k];
}

static double coordinate(const dem_sphere *s, int axis) {
  return axis == 0 ? s->position.x : axis == 1 ? s->position.y : s->position.z;
}

typedef struct {
  double low[3], high[3];
} extent;

static extent extent_of_all(const dem_search_input *input, const int *member, int n) {
  extent e = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (int k = 0; k < n; k++) {
    tdm_vec3 x = sphere_of(input, member, k)->position;
    e.low[0] = x.x < e.low[0] ? x.x : e.low[0];
    e.low[1] = x.y < e.low[1] ? x.y : e.low[1];
    e.low[2] = x.z < e.low[2] ? x.z : e.low[2];
    e.high[0] = x.x > e.high[0] ? x.x : e.high[0];
    e.high[1] = x.y > e.high[1] ? x.y : e.high[1];
    e.high[2] = x.z > e.high[2] ? x.z : e.high[2];
  }
  return e;
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

/* as many cells as the spheres' extent asks for, but not many more than there are spheres */
static void choose_grid(dem_bins *bins, const dem_search_input *input, const int *member, int n, double edge) {
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

static bool reserve(dem_bins *bins, size_t n, size_t ncell) {
  if (bins->first_capacity < ncell + 1) {
    size_t capacity = ncell + ncell / 4 + 1;
    int *first = realloc(bins->first, capacity * sizeof *first);
    if (!first)
      return false;
    bins->first = first;
    bins->first_capacity = capacity;
  }
  if (bins->capacity < n + DEM_LANES) {
    size_t capacity = n + n / 8 + DEM_LANES;
    dem_bins_free(&(dem_bins){.x = bins->x, .index = bins->index});
    bins->capacity = 0;
    bins->x = malloc(4 * capacity * sizeof *bins->x);
    bins->index = malloc(2 * capacity * sizeof *bins->index);
    if (!bins->x || !bins->index)
      return false;
    bins->y = bins->x + capacity;
    bins->z = bins->y + capacity;
    bins->r = bins->z + capacity;
    bins->cell = bins->index + capacity;
    bins->capacity = capacity;
  }
  return true;
}

void dem_bins_free(dem_bins *bins) {
  free(bins->first);
  free(bins->x);
  free(bins->index);
  *bins = (dem_bins){0};
}

typedef struct {
  dem_bins *bins;
  const dem_search_input *input;
  const int *member;
} binning;

static void find_cells(void *context, int t) {
  const binning *b = context;
  dem_bins *bins = b->bins;
  int end = dem_part(bins->n, t + 1, b->input->nthread);
  for (int k = dem_part(bins->n, t, b->input->nthread); k < end; k++) {
    tdm_vec3 p = sphere_of(b->input, b->member, k)->position;
    int x = bin(p.x, bins->low[0], bins->inverse[0], bins->count[0]);
    int y = bin(p.y, bins->low[1], bins->inverse[1], bins->count[1]);
    int z = bin(p.z, bins->low[2], bins->inverse[2], bins->count[2]);
    bins->cell[k] = (z * bins->count[1] + y) * bins->count[0] + x;
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

bool dem_bins_fill(dem_bins *bins, const dem_search_input *input, const int *member, int n, double edge) {
  choose_grid(bins, input, member, n, edge);
  size_t ncell = (size_t)bins->count[0] * (size_t)bins->count[1] * (size_t)bins->count[2];
  if (!reserve(bins, (size_t)n, ncell))
    return false;
  bins->n = n;
  dem_search_parallel(input->nthread, find_cells, &(binning){bins, input, member});

  /* counting sort, which keeps the order */
  memset(bins->first, 0, (ncell + 1) * sizeof *bins->first);
  for (int k = 0; k < n; k++)
    bins->first[bins->cell[k]]++;
  int at = 0;
  for (size_t c = 0; c <= ncell; c++) {
    int length = bins->first[c];
    bins->first[c] = at;
    at += length;
  }
  for (int k = 0; k < n; k++)
    place(bins, input, member, k, bins->first[bins->cell[k]]++);
  /* every entry now stands at the start of the next cell: shift by one */
  memmove(bins->first + 1, bins->first, ncell * sizeof *bins->first);
  bins->first[0] = 0;
  return true;
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

/* the same as ranges from begin up to end */
static int beside_in_x(int b, int n, dem_run range[2]) {
  if (n < 3 || (b > 0 && b < n - 1)) {
    range[0] = n < 3 ? (dem_run){0, n} : (dem_run){b - 1, b + 2};
    return 1;
  }
  range[0] = (dem_run){0, b == 0 ? 2 : 1};
  range[1] = (dem_run){b == 0 ? n - 1 : n - 2, n};
  return 2;
}

int dem_bins_runs(const dem_bins *bins, const int cell[3], int from, dem_run run[DEM_MOST_RUNS]) {
  int y[3], z[3], n = 0;
  dem_run x[2];
  int nx = beside_in_x(cell[0], bins->count[0], x);
  int ny = beside(cell[1], bins->count[1], y), nz = beside(cell[2], bins->count[2], z);
  for (int c = 0; c < nz; c++)
    for (int b = 0; b < ny; b++) {
      const int *row = bins->first + ((size_t)z[c] * (size_t)bins->count[1] + (size_t)y[b]) * (size_t)bins->count[0];
      for (int a = 0; a < nx; a++) {
        int begin = row[x[a].begin], end = row[x[a].end];
        run[n] = (dem_run){begin > from ? begin : from, end};
        n += run[n].end > run[n].begin;
      }
    }
  return n;
}

/* the cell at which part t of the spheres begins */
static int part_cell(const dem_bins *bins, int t, int nthread) {
  int low = 0, high = bins->count[0] * bins->count[1] * bins->count[2];
  int sphere = dem_part(bins->n, t, nthread);
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

/* Candidates, copied side by side: so that they are compared in full vectors, without a branch for each run. */
enum { BATCH = 128 };
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

/* append the near pairs of sphere p of bins `from` with the batch */
DEM_SEARCH_KERNEL void compare(const batch *with, const dem_bins *from, int p, const dem_near *near, bool periodic,
                               dem_pairs *found) {
  double excess[BATCH + DEM_LANES]; /* distance squared less the reach squared */
  double x = from->x[p], y = from->y[p], z = from->z[p], r = from->r[p];
  for (int k = 0; k < with->n; k += DEM_LANES)
    for (int l = k; l < k + DEM_LANES; l++)
      excess[l] = dem_excess(near, periodic, x - with->x[l], y - with->y[l], z - with->z[l], r + with->r[l]);
  int index = from->index[p];
  dem_pair *pair = found->pair;
  size_t count = found->count;
  for (int k = 0; k < with->n; k++) {
    pair[count] = (dem_pair){index, with->index[k]};
    count += excess[k] < 0;
  }
  found->count = count;
}

DEM_SEARCH_KERNEL void scan(const dem_bins *bins, const dem_run *run, int nrun, const dem_bins *from, int begin,
                            int end, const dem_near *near, bool periodic, dem_pairs *found) {
  batch with;
  int k = 0, at = nrun > 0 ? run[0].begin : 0;
  while (k < nrun) {
    with.n = 0;
    while (k < nrun && with.n < BATCH) {
      int room = BATCH - with.n, left = run[k].end - at;
      take_run(&with, bins, at, left < room ? left : room);
      at += room;
      if (left <= room && ++k < nrun)
        at = run[k].begin;
    }
    for (int p = begin; p < end; p++) {
      if (!dem_pairs_reserve(found, BATCH))
        return;
      compare(&with, from, p, near, periodic, found);
    }
  }
}

/* the instructions differ, the numbers do not: sums and products are the same, and none are fused */
__attribute__((target_clones("avx512f", "avx2", "default"))) void
dem_bins_scan(const dem_bins *bins, const dem_run *run, int nrun, const dem_bins *from, int begin, int end,
              const dem_near *near, dem_pairs *found) {
  if (near->periodic)
    scan(bins, run, nrun, from, begin, end, near, true, found);
  else
    scan(bins, run, nrun, from, begin, end, near, false, found);
}

/* the pairs within cell c, and those with the cells around that come later */
static void pairs_of_cell(const dem_bins *bins, const dem_near *near, int c, dem_pairs *found) {
  int begin = bins->first[c], end = bins->first[c + 1];
  if (begin == end)
    return;
  for (int p = begin; p < end - 1; p++)
    dem_bins_scan(bins, &(dem_run){p + 1, end}, 1, bins, p, p + 1, near, found);
  int row = c / bins->count[0], cell[3] = {c % bins->count[0], row % bins->count[1], row / bins->count[1]};
  dem_run run[DEM_MOST_RUNS];
  int nrun = dem_bins_runs(bins, cell, end, run);
  dem_bins_scan(bins, run, nrun, bins, begin, end, near, found);
}

void dem_bins_pairs(const dem_bins *bins, const dem_near *near, int t, int nthread, dem_pairs *found) {
  int end = part_cell(bins, t + 1, nthread);
  for (int c = part_cell(bins, t, nthread); c < end; c++)
    pairs_of_cell(bins, near, c, found);
}
