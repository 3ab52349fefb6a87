/* What is near in chunks of other ranks: see near_chunks.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/exchange/near_chunks.h"

#include "dem/seam/homes.h"

#include <stdlib.h>

/* Particles that go together, four pages, and how many such parts a chunk has. Whole chunks would be three times as
 * many particles, and nearly as many pages as those of home. */
enum { PART = 256, PARTS = DEM_CHUNK / PART };
_Static_assert(DEM_CHUNK % PART == 0, "a chunk has whole parts");

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

/* around a chunk and its parts; those of the last chunk may be empty */
typedef struct {
  box all, part[PARTS];
} boxes;

static box box_of(const dem_data *d, int begin, int end) {
  box b = empty_box();
  for (int i = begin; i < end; i++) {
    const dem_sphere *s = &d->state.sphere[i];
    const tdm_vec3 x = s->position;
    if (isfinite(x.x + x.y + x.z)) /* else it is near to nothing */
      extend(&b, &(box){{x.x, x.y, x.z}, {x.x, x.y, x.z}, s->radius});
  }
  return b;
}

/* the particle behind a part that begins here */
static int end_of_part(const dem_data *d, int begin) {
  return begin + PART < d->state.nparticle ? begin + PART : d->state.nparticle;
}

static boxes boxes_of_chunk(const dem_data *d, int c) {
  boxes b = {.all = empty_box()};
  for (int p = 0, begin = dem_chunk_start(d, c); p < PARTS; p++, begin += PART) {
    b.part[p] = box_of(d, begin, end_of_part(d, begin));
    extend(&b.all, &b.part[p]);
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
  boxes *chunk;   /* (nchunk) */
  box *home;      /* (ranks) around each rank's chunks */
  dem_mail *mail; /* (capacity) */
  int nmail, capacity;
  int end; /* the particle behind the last letter's */
} looking;

/* may a part be near to one of the rank's? */
static bool near_rank(const looking *l, const box *part, int rank) {
  if (!near(l->d, part, &l->home[rank], l->skin))
    return false;
  for (int c = dem_chunk_of_rank(l->d, rank); c < dem_chunk_of_rank(l->d, rank + 1); c++) {
    const boxes *chunk = &l->chunk[c];
    if (near(l->d, part, &chunk->all, l->skin))
      for (int p = 0; p < PARTS; p++)
        if (near(l->d, part, &chunk->part[p], l->skin))
          return true;
  }
  return false;
}

/* Particles begin ... end - 1 go to the rank, or come from it: in one letter with those just before. */
static tdm_status add_letter(looking *l, int rank, int begin, int end, bool goes) {
  if (l->nmail == l->capacity) {
    const int capacity = 2 * l->capacity + 64;
    dem_mail *mail = realloc(l->mail, (size_t)capacity * sizeof *mail);
    if (!mail)
      return TDM_ERR_MEMORY;
    l->mail = mail;
    l->capacity = capacity;
  }
  dem_sphere *first = &l->d->state.sphere[begin];
  const size_t bytes = (size_t)(end - begin) * sizeof *first;
  if (l->nmail == 0 || l->mail[l->nmail - 1].rank != rank || l->end != begin)
    l->mail[l->nmail++] = goes ? (dem_mail){.rank = rank, .send = first} : (dem_mail){.rank = rank, .receive = first};
  dem_mail *last = &l->mail[l->nmail - 1];
  *(goes ? &last->sent : &last->received) += bytes;
  l->end = end;
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

/* parts of chunk c, of one rank, that the other one needs */
static tdm_status choose_parts(looking *l, int c, int rank, bool goes, dem_near_runs *runs) {
  const int reader = goes ? rank : l->d->work.homes.ranks->rank;
  for (int p = 0; p < PARTS; p++) {
    if (!near_rank(l, &l->chunk[c].part[p], reader))
      continue;
    const int begin = dem_chunk_start(l->d, c) + p * PART, end = end_of_part(l->d, begin);
    if (add_letter(l, rank, begin, end, goes))
      return TDM_ERR_MEMORY;
    if (!goes)
      add_run(runs, begin, end);
  }
  return TDM_OK;
}

/* What earlier ranks need of home, and what this one does of later ranks. */
static tdm_status choose(looking *l, dem_near_runs *runs) {
  const dem_data *d = l->d;
  const dem_ranks *ranks = d->work.homes.ranks;
  const int here = ranks->rank;
  for (int r = 0; r < ranks->size; r++) {
    const bool goes = r < here;
    const int owner = goes ? here : r;
    const box *reader = &l->home[goes ? r : here];
    if (r == here || !near(d, &l->home[owner], reader, l->skin))
      continue;
    for (int c = dem_chunk_of_rank(d, owner); c < dem_chunk_of_rank(d, owner + 1); c++)
      if (near(d, &l->chunk[c].all, reader, l->skin) && choose_parts(l, c, r, goes, runs))
        return TDM_ERR_MEMORY;
  }
  return TDM_OK;
}

/* the boxes of all chunks and homes, on all ranks */
static void make_boxes(looking *l) {
  dem_data *d = l->d;
  for (int c = dem_home_first(d); c < dem_home_end(d); c++)
    l->chunk[c] = boxes_of_chunk(d, c);
  dem_unite_chunks(d, l->chunk, sizeof *l->chunk);
  for (int r = 0; r < d->work.homes.ranks->size; r++) {
    l->home[r] = empty_box();
    for (int c = dem_chunk_of_rank(d, r); c < dem_chunk_of_rank(d, r + 1); c++)
      extend(&l->home[r], &l->chunk[c].all);
  }
}

tdm_status dem_near_chunks(dem_data *d, double skin, dem_near_runs *runs) {
  dem_homes *s = &d->work.homes;
  const size_t nchunk = (size_t)d->lists.nchunk, size = (size_t)s->ranks->size;
  *runs = (dem_near_runs){.run = dem_scratch_take(&d->work.scratch, 2 * PARTS * nchunk * sizeof *runs->run)};
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
