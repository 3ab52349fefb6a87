/* Hierarchical grid, for spheres of widely different sizes: a grid of cells a level, each sphere in the level of its
 * size; the sizes of a level differ by at most a factor of two. A sphere is nearer to one of a larger level than the
 * larger level's cell, so that the cells around it hold all its partners there: each sphere looks at its own level and
 * at the larger ones, never at smaller ones. */
#include "dem/search/bins.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_LEVELS = 64 };

typedef struct {
  dem_bins level[MOST_LEVELS];
  int *member; /* (n) the spheres by level */
  size_t capacity;
} grid_state;

typedef struct {
  const grid_state *grid;
  dem_near near;
  int nthread;
  dem_pairs *found;
} finding;

static int level_of(double radius, double smallest) {
  double ratio = radius / smallest;
  int level = ratio >= 1 && isfinite(ratio) ? ilogb(ratio) : 0;
  return level < MOST_LEVELS ? level : MOST_LEVELS - 1;
}

static double smallest_radius(const dem_search_input *input) {
  double smallest = INFINITY;
  for (int i = 0; i < input->n; i++)
    smallest = input->sphere[i].radius < smallest ? input->sphere[i].radius : smallest;
  return smallest;
}

/* near pairs of spheres begin ... end - 1 of `fine` with all spheres of `coarse`; those that follow each other are mostly
 * in one cell of it */
static void pairs_across(const dem_bins *fine, const dem_bins *coarse, const dem_near *near, int begin, int end,
                         dem_pairs *found) {
  int cell[3], next[3];
  for (int p = begin, q; p < end; p = q) {
    dem_bins_cell(coarse, (double[]){fine->x[p], fine->y[p], fine->z[p]}, cell);
    for (q = p + 1; q < end; q++) {
      dem_bins_cell(coarse, (double[]){fine->x[q], fine->y[q], fine->z[q]}, next);
      if (memcmp(cell, next, sizeof cell) != 0)
        break;
    }
    dem_run run[DEM_MOST_RUNS];
    int nrun = dem_bins_runs(coarse, (dem_run){cell[0], cell[0] + 1}, cell[1], cell[2], 0, run);
    dem_bins_scan(coarse, run, nrun, fine, (dem_run){p, q}, false, near, found);
  }
}

static void find_part(void *context, int t) {
  const finding *f = context;
  const dem_near *near = &f->near;
  for (int a = 0; a < MOST_LEVELS; a++) {
    const dem_bins *fine = &f->grid->level[a];
    if (fine->n == 0)
      continue;
    int begin = dem_part(fine->n, t, f->nthread), end = dem_part(fine->n, t + 1, f->nthread);
    dem_bins_pairs(fine, near, t, f->nthread, &f->found[t]);
    for (int b = a + 1; b < MOST_LEVELS; b++) {
      const dem_bins *coarse = &f->grid->level[b];
      if (coarse->n > 0)
        pairs_across(fine, coarse, near, begin, end, &f->found[t]);
    }
  }
}

/* Sort the spheres by level and fill each level's cells. */
static bool fill_levels(grid_state *grid, const dem_search_input *input) {
  int count[MOST_LEVELS] = {0}, at[MOST_LEVELS];
  double largest[MOST_LEVELS] = {0}, smallest = smallest_radius(input);
  for (int i = 0; i < input->n; i++) {
    double r = input->sphere[i].radius;
    int l = level_of(r, smallest);
    count[l]++;
    largest[l] = r > largest[l] ? r : largest[l];
  }
  for (int l = 0, sum = 0; l < MOST_LEVELS; sum += count[l++])
    at[l] = sum;
  for (int i = 0; i < input->n; i++)
    grid->member[at[level_of(input->sphere[i].radius, smallest)]++] = i;
  for (int l = 0; l < MOST_LEVELS; l++) {
    grid->level[l].n = 0;
    if (count[l] > 0 && !dem_bins_fill(&grid->level[l], input, grid->member + at[l] - count[l], count[l],
                                       2 * largest[l] + input->skin))
      return false;
  }
  return true;
}

static bool find(void *state, const dem_search_input *input, dem_pairs *found) {
  grid_state *grid = state;
  if (input->n < 2)
    return true;
  if (grid->capacity < (size_t)input->n) {
    size_t capacity = (size_t)input->n + (size_t)input->n / 8;
    int *member = realloc(grid->member, capacity * sizeof *member);
    if (!member)
      return false;
    grid->member = member;
    grid->capacity = capacity;
  }
  if (!fill_levels(grid, input))
    return false;
  dem_search_parallel(input->nthread, find_part, &(finding){grid, dem_near_make(input), input->nthread, found});
  return true;
}

static void release(void *state) {
  grid_state *grid = state;
  for (int l = 0; l < MOST_LEVELS; l++)
    dem_bins_free(&grid->level[l]);
  free(grid->member);
}

const dem_search_method dem_search_grid = {
    .name = "grid", .state_size = sizeof(grid_state), .find = find, .release = release};
