/* Hierarchical grid, for spheres of widely different sizes: a grid of cells a level, each sphere in the level of its
 * size. Cells of the largest diameter of a level and the skin are wide enough for all smaller spheres: so each sphere
 * looks at the cells around it in its own level and in those of larger spheres, never at smaller ones.
 *
 * A level takes in smaller spheres as long as one grid of cells is cheaper than two: see dem_cells_fit.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/search/method/bins.h"

#include <math.h>
#include <string.h>

/* classes of size, each twice the volume of the one before; the last takes all that are larger */
enum { CLASSES = 128 };

typedef struct {
  dem_bins level[CLASSES]; /* (nlevel) from the largest spheres to the smallest */
  int nlevel;
  int *member; /* (n) the spheres by level */
} levels;

typedef struct {
  const levels *grid;
  dem_near near;
  int nthread;
  dem_found *found;
} finding;

static int class_of(double radius, double smallest) {
  double ratio = radius / smallest, volume = ratio * ratio * ratio;
  int octave = volume >= 1 && isfinite(volume) ? ilogb(volume) : 0;
  return octave < CLASSES ? octave : CLASSES - 1;
}

/* radius with half the skin */
static double radius_of(const dem_search_input *input, int i) {
  return dem_search_sphere(input, i)->radius + input->skin / 2;
}

static double smallest_radius(const dem_search_input *input) {
  double smallest = INFINITY;
  for (int i = 0; i < input->n; i++)
    smallest = radius_of(input, i) < smallest ? radius_of(input, i) : smallest;
  return smallest;
}

/* near pairs of spheres begin ... end - 1 of `fine` with all spheres of `coarse`; those that follow each other are
 * mostly in one cell of it */
static void pairs_across(const dem_bins *fine, const dem_bins *coarse, const dem_near *near, int begin, int end,
                         dem_found *found) {
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
  for (int a = 0; a < f->grid->nlevel; a++) {
    const dem_bins *fine = &f->grid->level[a];
    int begin = dem_search_part(fine->n, t, f->nthread), end = dem_search_part(fine->n, t + 1, f->nthread);
    dem_bins_pairs(fine, &f->near, t, f->nthread, &f->found[t]);
    for (int b = 0; b < a; b++)
      pairs_across(fine, &f->grid->level[b], &f->near, begin, end, &f->found[t]);
  }
}

typedef struct {
  int count;
  double largest, cubes; /* radius with half the skin [m], sum of the cubes of these [m3] */
} sizes;

/* The level of each class, counted from the largest spheres; returns the number of levels and what they hold. */
static int choose_levels(const sizes class[CLASSES], int level_of[CLASSES], sizes level[CLASSES]) {
  const double worth = 10; /* measured with bench_search */
  int nlevel = 0;
  for (int c = CLASSES - 1; c >= 0; c--) {
    if (class[c].count > 0) {
      sizes *last = nlevel > 0 ? &level[nlevel - 1] : NULL;
      if (last && dem_cells_fit(last->count + class[c].count, last->largest, last->cubes + class[c].cubes, worth)) {
        last->count += class[c].count;
        last->cubes += class[c].cubes;
      } else {
        level[nlevel++] = class[c];
      }
    }
    level_of[c] = nlevel - 1;
  }
  return nlevel;
}

/* Sort the spheres by level and fill each level's cells. */
static tdm_status fill_levels(levels *grid, const dem_search_input *input) {
  sizes class[CLASSES] = {0}, level[CLASSES];
  double smallest = smallest_radius(input);
  for (int i = 0; i < input->n; i++) {
    double r = radius_of(input, i);
    sizes *c = &class[class_of(r, smallest)];
    c->count++;
    c->cubes += r * r * r;
    c->largest = r > c->largest ? r : c->largest;
  }
  int level_of[CLASSES], at[CLASSES];
  grid->nlevel = choose_levels(class, level_of, level);
  for (int l = 0, sum = 0; l < grid->nlevel; sum += level[l++].count)
    at[l] = sum;
  for (int i = 0; i < input->n; i++)
    grid->member[at[level_of[class_of(radius_of(input, i), smallest)]]++] = i;
  for (int l = 0; l < grid->nlevel; l++)
    if (dem_bins_fill(&grid->level[l], input, grid->member + at[l] - level[l].count, level[l].count,
                      2 * level[l].largest))
      return TDM_ERR_MEMORY;
  return TDM_OK;
}

static tdm_status find(void *state, const dem_search_input *input, dem_found *found) {
  (void)state;
  if (input->n < 2)
    return TDM_OK;
  levels grid = {.member = dem_scratch_take(input->scratch, (size_t)input->n * sizeof *grid.member)};
  if (!grid.member || fill_levels(&grid, input))
    return TDM_ERR_MEMORY;
  dem_search_parallel(input->nthread, find_part, &(finding){&grid, dem_near_make(input), input->nthread, found});
  return TDM_OK;
}

const dem_search_method dem_search_grid = {.find = find};
