/* Homes that cost alike: see balance.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/exchange/balance.h"

#include "dem/seam/homes.h"

#include <string.h>

/* the most that the chunks of one home cost */
static double most_of(const double *cost, const int *first, int size) {
  double most = 0;
  for (int r = 0; r < size; r++) {
    double sum = 0;
    for (int c = first[r]; c < first[r + 1]; c++)
      sum += cost[c];
    most = fmax(most, sum);
  }
  return most;
}

/* Homes that cost alike: each begins (size + 1) with the chunk that is nearest to its share of all costs. */
static void share_out(const dem_data *d, int *first) {
  const int n = d->lists.nchunk, size = d->work.homes.ranks->size;
  const double *cost = d->work.homes.cost;
  double all = 0, before = 0;
  for (int c = 0; c < n; c++)
    all += cost[c];
  first[0] = 0;
  for (int r = 1, c = 0; r < size; r++) {
    while (c < n && before + 0.5 * cost[c] < all * r / size)
      before += cost[c++];
    first[r] = c;
  }
  first[size] = n;
}

/* Do the costs of all chunks, which all ranks know now, want other homes? */
static bool better_homes(const dem_data *d, double *home) {
  const int size = d->work.homes.ranks->size;
  const double *cost = d->work.homes.cost, tolerance = d->model->balance.tolerance;
  int now[DEM_RANKS_MAX + 1], better[DEM_RANKS_MAX + 1];
  const int all[2] = {0, d->lists.nchunk};
  for (int r = 0; r <= size; r++)
    now[r] = dem_chunk_of_rank(d, r);
  share_out(d, better);
  const double mean = most_of(cost, all, 1) / size, most = most_of(cost, now, size);
  if (!(most > (1 + tolerance) * mean) || !(most_of(cost, better, size) < most - tolerance * mean))
    return false;
  for (int r = 0; r <= size; r++)
    home[r] = (double)better[r] / d->lists.nchunk;
  return true;
}

bool dem_homes_balance(dem_data *d, double *home) {
  enum { STEPS = 500 }; /* between looks of runs that are not balanced, which tell the same number */
  dem_homes *s = &d->work.homes;
  const dem_balance_def *balance = &d->model->balance;
  const uint64_t every = balance->every > 0 ? (uint64_t)balance->every : STEPS;
  if (s->ranks)
    memcpy(home, d->lists.home, ((size_t)s->ranks->size + 1) * sizeof *home);
  if (!s->ranks || d->lists.nchunk > s->ncost || d->state.nstep - s->looked < every)
    return false;
  bool moved = false;
  if (balance->every > 0) {
    dem_unite_chunks(d, s->cost, sizeof *s->cost);
    moved = better_homes(d, home);
  }
  s->nmove += moved;
  dem_homes_measure(d);
  return moved;
}

double dem_homes_imbalance(const dem_data *d) {
  const dem_homes *s = &d->work.homes;
  const double mean = s->all_mean + s->mean;
  return mean > 0 ? (s->all_busiest + s->busiest) / mean - 1 : 0;
}
