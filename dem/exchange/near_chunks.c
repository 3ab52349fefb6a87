/* Chunks that are near: see near_chunks.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/exchange/near_chunks.h"

#include "dem/seam/homes.h"

#include <stdlib.h>

/* Around the centres of some particles. Of none, or of those that are nowhere: low > high, near to nothing. */
typedef struct {
  double low[3], high[3]; /* [m] */
  double radius;          /* the largest [m] */
} box;

static box empty_box(void) {
  return (box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, 0};
}

static void extend(box *b, const box *by) {
  for (int a = 0; a < 3; a++) {
    b->low[a] = by->low[a] < b->low[a] ? by->low[a] : b->low[a];
    b->high[a] = by->high[a] > b->high[a] ? by->high[a] : b->high[a];
  }
  b->radius = by->radius > b->radius ? by->radius : b->radius;
}

static box box_of_chunk(const dem_data *d, int c) {
  box b = empty_box();
  for (int i = dem_chunk_start(d, c); i < dem_chunk_start(d, c + 1); i++) {
    const dem_sphere *s = &d->state.sphere[i];
    const tdm_vec3 x = s->position;
    if (isfinite(x.x + x.y + x.z)) /* else it is near to nothing */
      extend(&b, &(box){{x.x, x.y, x.z}, {x.x, x.y, x.z}, s->radius});
  }
  return b;
}

/* May a particle in one box be within `skin` of touching one in the other, or one of its images? Two ranks that ask
 * this give the boxes in the same order, so that they get the same answer. */
static bool near(const dem_data *d, const box *a, const box *b, double skin) {
  const dem_domain *domain = &d->state.domain;
  const double reach = (1 + 1e-6) * (a->radius + b->radius + skin); /* round-off does not decide */
  for (int q = 0; q < 3; q++) {
    if (!(a->low[q] <= a->high[q] && b->low[q] <= b->high[q]))
      return false;
    const double wide = 0.5 * (a->high[q] - a->low[q]) + 0.5 * (b->high[q] - b->low[q]);
    double way = 0.5 * (b->low[q] + b->high[q]) - 0.5 * (a->low[q] + a->high[q]);
    if (domain->periodic[q])
      way = remainder(way, domain->length[q]);
    if (!(fabs(way) <= reach + (1 + 1e-12) * wide))
      return false;
  }
  return true;
}

/* What is looked for, and found. */
typedef struct {
  dem_data *d;
  double skin;
  box *chunk;     /* (nchunk) */
  box *home;      /* (ranks) around each rank's chunks */
  dem_mail *mail; /* (capacity) a letter a chunk */
  int nmail, capacity;
} looking;

/* may chunk c be near to a chunk of the rank? */
static bool near_rank(const looking *l, int c, int rank) {
  if (!near(l->d, &l->chunk[c], &l->home[rank], l->skin))
    return false;
  for (int k = dem_chunk_of_rank(l->d, rank); k < dem_chunk_of_rank(l->d, rank + 1); k++)
    if (near(l->d, &l->chunk[c], &l->chunk[k], l->skin))
      return true;
  return false;
}

/* chunk c goes to the rank, or comes from it */
static tdm_status add_letter(looking *l, int rank, int c, bool goes) {
  if (l->nmail == l->capacity) {
    const int capacity = 2 * l->capacity + 64;
    dem_mail *mail = realloc(l->mail, (size_t)capacity * sizeof *mail);
    if (!mail)
      return TDM_ERR_MEMORY;
    l->mail = mail;
    l->capacity = capacity;
  }
  dem_sphere *first = &l->d->state.sphere[dem_chunk_start(l->d, c)];
  const size_t bytes = (size_t)(dem_chunk_start(l->d, c + 1) - dem_chunk_start(l->d, c)) * sizeof *first;
  l->mail[l->nmail++] = goes ? (dem_mail){.rank = rank, .send = first, .sent = bytes}
                             : (dem_mail){.rank = rank, .receive = first, .received = bytes};
  return TDM_OK;
}

static void add_run(dem_near_runs *runs, int begin, int end) {
  if (runs->nrun > 0 && runs->run[2 * runs->nrun - 1] == begin) {
    runs->run[2 * runs->nrun - 1] = end;
    return;
  }
  runs->run[2 * runs->nrun] = begin;
  runs->run[2 * runs->nrun + 1] = end;
  runs->nrun++;
}

/* Home chunks that earlier ranks need, and those of later ranks that this one does. */
static tdm_status choose(looking *l, dem_near_runs *runs) {
  const dem_data *d = l->d;
  const dem_ranks *ranks = d->work.homes.ranks;
  const int here = ranks->rank;
  for (int r = 0; r < ranks->size; r++) {
    const bool goes = r < here;
    const int owner = goes ? here : r, reader = goes ? r : here;
    if (r == here || !near(d, &l->home[owner], &l->home[reader], l->skin))
      continue;
    for (int c = dem_chunk_of_rank(d, owner); c < dem_chunk_of_rank(d, owner + 1); c++) {
      if (!near_rank(l, c, reader))
        continue;
      if (add_letter(l, r, c, goes))
        return TDM_ERR_MEMORY;
      if (!goes)
        add_run(runs, dem_chunk_start(d, c), dem_chunk_start(d, c + 1));
    }
  }
  return TDM_OK;
}

/* the boxes of all chunks and homes, on all ranks */
static void make_boxes(looking *l) {
  dem_data *d = l->d;
  for (int c = dem_home_first(d); c < dem_home_end(d); c++)
    l->chunk[c] = box_of_chunk(d, c);
  dem_unite_chunks(d, l->chunk, sizeof *l->chunk);
  for (int r = 0; r < d->work.homes.ranks->size; r++) {
    l->home[r] = empty_box();
    for (int c = dem_chunk_of_rank(d, r); c < dem_chunk_of_rank(d, r + 1); c++)
      extend(&l->home[r], &l->chunk[c]);
  }
}

tdm_status dem_near_chunks(dem_data *d, double skin, dem_near_runs *runs) {
  dem_homes *s = &d->work.homes;
  const size_t nchunk = (size_t)d->lists.nchunk, size = (size_t)s->ranks->size;
  *runs = (dem_near_runs){.run = dem_scratch_take(&d->work.scratch, 2 * nchunk * sizeof *runs->run)};
  const dem_scratch_mark mark = dem_scratch_now(&d->work.scratch);
  looking l = {.d = d,
               .skin = skin,
               .chunk = dem_scratch_take(&d->work.scratch, nchunk * sizeof *l.chunk),
               .home = dem_scratch_take(&d->work.scratch, size * sizeof *l.home)};
  if (!runs->run || !l.chunk || !l.home)
    return TDM_ERR_MEMORY;
  make_boxes(&l);
  const tdm_status status = choose(&l, runs);
  if (!status && !(s->united & DEM_PLACES)) {
    const double begin = tdm_clock();
    s->ranks->begin(l.mail, l.nmail);
    s->ranks->finish();
    s->spent += tdm_clock() - begin;
  }
  free(l.mail);
  dem_scratch_back(&d->work.scratch, mark);
  return status;
}
