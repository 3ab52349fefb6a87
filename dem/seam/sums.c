/* Sums over all chunks: see sums.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/seam/sums.h"

#include "dem/seam/homes.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
  int n;
  dem_chunk_sums *of_chunk;
  const void *of;
} summing;

static void sum_chunk(dem_data *d, int chunk, void *context) {
  const summing *s = context;
  double *sums = d->work.chunk_sum + (size_t)chunk * (size_t)s->n;
  memset(sums, 0, (size_t)s->n * sizeof *sums);
  s->of_chunk(d, chunk, s->of, sums);
}

void dem_sum_chunks(dem_data *d, int n, dem_chunk_sums *of_chunk, const void *of, double *sums) {
  double *all = d->work.chunk_sum;
  assert(n <= DEM_CHUNK_SUMS);
  dem_each_chunk(d, sum_chunk, &(summing){n, of_chunk, of});
  dem_unite_chunks(d, all, (size_t)n * sizeof *all);
  memset(sums, 0, (size_t)n * sizeof *sums);
  for (int c = 0; c < d->lists.nchunk; c++)
    for (int k = 0; k < n; k++)
      sums[k] += all[c * n + k];
}

/* ---- loads and energies of a step ---- */

enum { OF_RANK = 3 }; /* doubles that a rank tells of itself in the sums, besides those of chunks */

static size_t sums_of_chunk(const dem_data *d) {
  return (size_t)d->model->nload * (sizeof(tdm_wrench) / sizeof(double)) +
         (d->model->energy ? sizeof(dem_flux) / sizeof(double) : 0);
}

tdm_status dem_sums_reserve(dem_data *d) {
  dem_homes *s = &d->work.homes;
  const size_t n = OF_RANK * (size_t)s->ranks->size + (size_t)d->lists.nchunk * sums_of_chunk(d);
  if (n > s->nsums || !s->sums) {
    free(s->sums);
    s->nsums = n + n / 4 + 64;
    s->sums = malloc(s->nsums * sizeof *s->sums);
  }
  return s->sums ? TDM_OK : TDM_ERR_MEMORY;
}

/* a chunk's loads and energies to or from a place among the sums */
static void copy_sums(dem_data *d, int chunk, double *place, bool to) {
  const size_t nload = (size_t)d->model->nload * sizeof(tdm_wrench), of = d->model->energy ? sizeof(dem_flux) : 0;
  char *sums = (char *)place;
  void *load = &d->work.chunk_load[(size_t)chunk * (size_t)d->model->nload], *flux = &d->work.chunk_flux[chunk];
  memcpy(to ? sums : load, to ? load : sums, nload);
  memcpy(to ? sums + nload : flux, to ? flux : sums + nload, of);
}

long dem_sums_of_step(dem_data *d, long touching) {
  dem_homes *s = &d->work.homes;
  if (!s->ranks)
    return touching;
  const double begin = tdm_clock();
  const size_t each = sums_of_chunk(d);
  int first[DEM_RANKS_MAX + 1];
  for (int r = 0; r <= s->ranks->size; r++)
    first[r] = OF_RANK * r + dem_chunk_of_rank(d, r) * (int)each;
  double *own = s->sums + first[s->ranks->rank];
  own[0] = (double)touching;
  s->touching = touching;
  own[1] = s->stop;
  own[2] = 0;
  for (int c = dem_home_first(d), k = 0; c < dem_home_end(d); c++, k++) {
    own[2] += s->cost[c];
    copy_sums(d, c, own + OF_RANK + (size_t)k * each, true);
  }
  s->ranks->gather(s->sums, sizeof *s->sums, first);
  double sum = 0;
  s->busiest = s->mean = 0;
  for (int r = 0; r < s->ranks->size; r++) {
    double *of = s->sums + first[r];
    sum += of[0];
    s->busiest = fmax(s->busiest, of[2]);
    s->mean += of[2] / s->ranks->size;
    s->stopped = s->stopped || of[1] > 0;
    for (int c = dem_chunk_of_rank(d, r), k = 0; c < dem_chunk_of_rank(d, r + 1); c++, k++)
      copy_sums(d, c, of + OF_RANK + (size_t)k * each, false);
  }
  s->spent += tdm_clock() - begin;
  return (long)sum;
}
