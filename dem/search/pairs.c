/* Neighbour lists: see pairs.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/search/pairs.h"

#include "dem/exchange/balance.h"
#include "dem/exchange/keep.h"
#include "dem/exchange/near_chunks.h"
#include "dem/exchange/renewal.h"
#include "dem/particles/particles.h"
#include "dem/seam/crossings.h"
#include "dem/seam/homes.h"
#include "dem/search/near_walls.h"
#include "dem/search/nearby.h"
#include "dem/search/order.h"
#include "dem/search/search.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

tdm_vec3 dem_lists_shift(const dem_data *d) {
  if (d->model->ncoupled == 0)
    return tdm_v3(0, 0, 0);
  int b = d->model->coupled_body[0];
  return tdm_sub(d->state.pose[b].position, d->lists.pose_at_list[b].position);
}

double dem_lists_way_of_body(const dem_data *d, int b) {
  const dem_body *body = &d->model->body[b];
  const tdm_pose now = d->state.pose[b], then = d->lists.pose_at_list[b];
  double way = tdm_norm(tdm_sub(tdm_sub(now.position, then.position), dem_lists_shift(d)));
  if (body->coupled >= 0 || body->drive.given) {
    tdm_quat turn = tdm_quat_mul(tdm_quat_conj(then.orientation), now.orientation);
    way += 2 * sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z) * d->lists.reach[b];
  }
  return way;
}

/* by how much the images of a box that is strained have moved [m] */
static double strained_since(const dem_data *d) {
  tdm_vec3 grown = {0, 0, 0};
  for (int a = 0; a < 3; a++)
    (&grown.x)[a] = d->state.domain.length[a] - d->lists.length_at_list[a];
  return tdm_norm(grown);
}

/* may the lists still be used? Written so that NaN says no. */
static bool lists_hold(const dem_data *d, double moved2) {
  const double safety = 0.999; /* round-off must not decide */
  const dem_model *m = d->model;
  double moved = sqrt(moved2);
  uint64_t interval = (uint64_t)dem_search_interval(d->work.search);
  double nearer = 2 * moved + (m->domain.strained ? strained_since(d) : 0);
  if (!d->lists.valid || d->lists.stale || !(nearer < safety * d->lists.skin) ||
      (interval > 0 && d->lists.since_list >= interval))
    return false;
  for (int b = 0; b < m->nbody; b++)
    if (!(moved + dem_lists_way_of_body(d, b) < safety * d->lists.margin[b]))
      return false;
  return true;
}

/* ---- histories ---- */

/* the entry of particles a and b in the list, -1: none */
static int find_entry(const dem_pairs *list, int a, int b) {
  int i = a < b ? a : b, j = a < b ? b : a;
  for (int k = list->first[i]; k < list->first[i + 1]; k++)
    if (list->other[k] == j)
      return k;
  return -1;
}

/* Where the histories of chunk c's new entries, as the search found them, are in the list as it still is: 2 k + 1 when
 * the pair is turned round, 2 k when not, -1 when there is none. Into sink, which is not needed now. old: the numbers
 * that the particles had, NULL: the same. */
static void find_histories(dem_data *d, const size_t *chunk, const int *old, int c) {
  dem_pairs *list = &d->lists.pairs;
  size_t k = chunk[c];
  for (int i = c * DEM_CHUNK, end = dem_chunk_end(d, c); i < end; i++)
    for (int r = dem_row(&d->work.rows, i); r < dem_row(&d->work.rows, i + 1); r++, k++) {
      int j = d->work.rows.other[r], oi = old ? old[i] : i, oj = old ? old[j] : j, at = find_entry(list, oi, oj);
      list->reaction_slot[k] = at < 0 ? -1 : 2 * at + (oi > oj);
    }
  for (; k < chunk[c + 1]; k++)
    list->reaction_slot[k] = -1;
}

/* Bring the histories to their new entries, column by column; vectors turn round with their pairs. They are among the
 * entries from ... end - 1 of the list as it was. */
static tdm_status carry_pairs(dem_data *d, const size_t *chunk, size_t from, size_t end) {
  const dem_columns *columns = &d->model->columns;
  dem_pairs *list = &d->lists.pairs;
  double *column = dem_scratch_take(&d->work.scratch, (end - from) * sizeof *column);
  if (!column)
    return TDM_ERR_MEMORY;
  for (size_t q = 0; q < (size_t)columns->ncolumn; q++) {
    double *to = list->history + q * list->capacity, sign = columns->vectors >> q & 1 ? -1 : 1;
#pragma omp parallel num_threads(d->work.nthread) if (d->work.nthread > 1)
    {
#pragma omp for schedule(static)
      for (size_t k = from; k < end; k++)
        column[k - from] = to[k];
#pragma omp for schedule(static)
      for (int c = dem_home_first(d); c < dem_home_end(d); c++)
        for (size_t k = chunk[c]; k < chunk[c + 1]; k++) {
          int at = list->reaction_slot[k];
          double there = at < 0 ? 0 : column[(size_t)(at >> 1) - from];
          to[k] = at < 0 ? 0 : at & 1 ? sign * there : there;
        }
    }
  }
  return TDM_OK;
}

/* ---- pairs ---- */

/* where the entries of each chunk will begin */
static void place_chunks(dem_data *d, size_t *chunk) {
  for (int c = dem_home_first(d); c < dem_home_end(d); c++) {
    chunk[c] = (size_t)(dem_row(&d->work.rows, dem_chunk_end(d, c)) - dem_row(&d->work.rows, c * DEM_CHUNK));
    chunk[c] = (chunk[c] + DEM_LANES_MAX - 1) / DEM_LANES_MAX * DEM_LANES_MAX;
  }
  dem_lay_out(d, chunk);
}

static void fill_chunk(dem_data *d, int c) {
  dem_pairs *list = &d->lists.pairs;
  int none = d->state.nparticle, k = (int)list->chunk[c];
  for (int i = c * DEM_CHUNK, end = dem_chunk_end(d, c); i < end; i++) {
    list->first[i] = k;
    for (int r = dem_row(&d->work.rows, i); r < dem_row(&d->work.rows, i + 1); r++, k++) {
      list->one[k] = i;
      list->other[k] = list->reaction_slot[k] = d->work.rows.other[r];
    }
  }
  for (; k < (int)list->chunk[c + 1]; k++)
    list->one[k] = list->other[k] = list->reaction_slot[k] = none;
}

/* leave away the pairs of which neither can move */
static void drop_fixed(dem_data *d) {
  dem_rows *rows = &d->work.rows;
  int at = 0, begin = 0;
  for (int i = rows->begin; i < rows->end; i++) {
    int *end = &rows->first[i + 1 - rows->begin], next = *end;
    for (int r = begin; r < next; r++)
      if (d->state.sphere[i].inverse_mass + d->state.sphere[rows->other[r]].inverse_mass > 0)
        rows->other[at++] = rows->other[r];
    begin = next;
    *end = at;
  }
  rows->count = (size_t)at;
}

/* The particles of other ranks that the search may name, whose spheres come here; the input is one among these and
 * those of home. */
static tdm_status find_near(dem_data *d, dem_search_input *input) {
  dem_near_runs near;
  if (dem_search_wants_all(d->work.search)) {
    dem_unite(d, DEM_PLACES);
    return TDM_OK;
  }
  if (dem_near_chunks(d, input->skin, &near))
    return TDM_ERR_MEMORY;
  input->run = near.run;
  input->nrun = near.nrun;
  return dem_nearby_choose(input);
}

/* The new list, in the place of the old one. carry: its histories are taken over, stay: from this rank's own entries;
 * old: the numbers that the particles had, NULL: the same. */
static tdm_status build_pairs(dem_data *d, bool carry, bool stay, const int *old) {
  dem_pairs *list = &d->lists.pairs;
  dem_search_input input = {.sphere = d->state.sphere,
                            .n = d->state.nparticle,
                            .some = !dem_alone(d),
                            .begin = dem_home_first_particle(d),
                            .end = dem_home_end_particle(d),
                            .skin = d->lists.skin + d->model->reach,
                            .domain = d->state.domain,
                            .nthread = d->work.nthread,
                            .scratch = &d->work.scratch};
  dem_time_spent(d->work.timers, DEM_PHASE_LIST);
  if ((input.some && find_near(d, &input)) || dem_search_run(d->work.search, &input, &d->work.rows))
    return TDM_ERR_MEMORY;
  dem_time_spent(d->work.timers, DEM_PHASE_SEARCH);
  if (d->model->driven)
    drop_fixed(d);
  const int ncolumn = d->model->columns.ncolumn, first = dem_home_first(d), end = dem_home_end(d);
  const size_t old_first = stay ? list->chunk[first] : 0, old_end = stay ? list->chunk[end] : carry ? list->count : 0;
  size_t *chunk = d->work.chunk_spare;
  place_chunks(d, chunk);
  size_t count = chunk[d->lists.nchunk];
  if (count > INT_MAX / 2 ||
      dem_pairs_reserve(list, count, ncolumn, old_first, old_end)) /* twice: columns have two sides */
    return TDM_ERR_MEMORY;
  if (ncolumn > 0) {
#pragma omp parallel for schedule(static) num_threads(d->work.nthread) if (d->work.nthread > 1)
    for (int c = first; c < end; c++)
      if (carry)
        find_histories(d, chunk, old, c);
      else if (chunk[c + 1] > chunk[c])
        memset(list->reaction_slot + chunk[c], -1, (chunk[c + 1] - chunk[c]) * sizeof *list->reaction_slot);
    if (carry_pairs(d, chunk, old_first, old_end))
      return TDM_ERR_MEMORY;
  }
  memcpy(list->chunk, chunk, (size_t)(d->lists.nchunk + 1) * sizeof *chunk);
  list->count = count;
#pragma omp parallel for schedule(static) num_threads(d->work.nthread) if (d->work.nthread > 1)
  for (int c = first; c < end; c++)
    fill_chunk(d, c);
  list->first[dem_home_end_particle(d)] = (int)chunk[end]; /* where the last row ends */
  list->first[d->state.nparticle] = (int)count;
  return TDM_OK;
}

/* ---- both ---- */

/* note where everything is of home particles */
static void note_positions(dem_data *d) {
  const dem_model *m = d->model;
  const int first = dem_home_first_particle(d), end = dem_home_end_particle(d);
#pragma omp parallel for schedule(static) num_threads(d->work.nthread) if (d->work.nthread > 1)
  for (int i = first; i < end; i++)
    d->lists.position_at_list[i] = d->state.sphere[i].position;
  memcpy(d->lists.length_at_list, d->state.domain.length, sizeof d->lists.length_at_list);
  d->lists.since_list = 0;
  for (int b = 0; b < m->nbody; b++) {
    d->lists.pose_at_list[b] = d->state.pose[b];
    d->lists.margin[b] = INFINITY;
    d->lists.reach[b] = 0;
    if (m->body[b].coupled < 0 && !m->body[b].drive.given)
      continue;
    double reach2 = 0;
#pragma omp parallel for schedule(static) num_threads(d->work.nthread) if (d->work.nthread > 1) reduction(max : reach2)
    for (int i = first; i < end; i++) {
      tdm_vec3 r = tdm_sub(d->state.sphere[i].position, d->state.pose[b].position);
      reach2 = fmax(reach2, tdm_dot(r, r));
    }
    d->lists.reach[b] = sqrt(reach2);
  }
}

/* what was found of home particles, of those of all ranks: reach and margin */
static void share_bounds(dem_data *d) {
  if (dem_alone(d))
    return;
  dem_homes_largest_of(d, d->lists.reach, d->model->nbody);
  for (int b = 0; b < d->model->nbody; b++)
    d->lists.margin[b] = -d->lists.margin[b];
  dem_homes_largest_of(d, d->lists.margin, d->model->nbody);
  for (int b = 0; b < d->model->nbody; b++)
    d->lists.margin[b] = -d->lists.margin[b];
}

/* The search that the scene asks for; else the one for the particles there are now, whenever some came. */
static tdm_status choose_search(dem_data *d) {
  if (d->work.search && (d->model->search || (d->lists.valid && !d->lists.stale)))
    return TDM_OK;
  const char *name = d->model->search;
  const int first = dem_home_first_particle(d);
  if (!name)
    name = dem_search_choose(&(dem_search_input){
        .sphere = d->state.sphere + first, .n = dem_home_end_particle(d) - first, .skin = d->lists.skin});
  if (d->work.search && strcmp(name, dem_search_name(d->work.search)) == 0)
    return TDM_OK;
  dem_search_destroy(&d->work.search);
  d->work.search = dem_search_create(name);
  d->work.search_destroy = dem_search_destroy;
  return d->work.search ? TDM_OK : TDM_ERR_MEMORY;
}

/* Choose the skin, when the scene does not: with lists that held for T steps under a skin s something moves by about
 * s/2T a step. A list costs about four steps, a skin s about 1.3 s/r of one for the pairs that do not touch: the sum is
 * least at sqrt(3 r s/T). Half way there each time. */
static void adapt_skin(dem_data *d, bool sort) {
  double r = d->lists.mean_radius, steps = (double)d->lists.since_list;
  if (d->model->skin > 0 || steps == 0 || ((sort || d->lists.stale) && steps < 100))
    return;
  double best = sqrt(3 * r * d->lists.skin / steps), most = 0.5 * r;
  for (int a = 0; a < 3; a++) /* as much as a box that repeats allows */
    if (d->state.domain.periodic[a])
      most = fmin(most, 0.45 * d->state.domain.length[a] - 2 * d->model->largest_radius);
  d->lists.skin = fmax(0.02 * r, fmin(most, sqrt(best * d->lists.skin)));
}

/* Put the particles in the order of their places. Returns the numbers they had, NULL: no memory. */
static const int *sort_particles(dem_data *d, bool carry) {
  dem_wall_contacts *walls = &d->work.spare_walls; /* of before */
  size_t n = (size_t)d->state.nparticle;
  int *from = dem_scratch_take(&d->work.scratch, n * sizeof *from);
  dem_scratch_mark mark = dem_scratch_now(&d->work.scratch);
  bool good = from && !dem_order(d, from) && !dem_data_permute(d, from);
  int *now = dem_scratch_take(&d->work.scratch, n * sizeof *now);
  for (size_t p = 0; good && now && p < n; p++)
    now[from[p]] = (int)p;
  good = good && now && (!carry || !dem_near_walls_renumber(d, walls, 0, walls->count, now));
  dem_scratch_back(&d->work.scratch, mark);
  d->state.since_sort = 0;
  return good ? from : NULL;
}

/* What each rank has goes to new homes: in a new order, or because homes move. */
static tdm_status renew_homes(dem_data *d, bool sort, const double *home) {
  const size_t n = (size_t)(dem_home_end_particle(d) - dem_home_first_particle(d));
  uint64_t *code = sort ? malloc((n + 1) * sizeof *code) : NULL;
  if (sort && !code)
    return TDM_ERR_MEMORY;
  if (sort) {
    dem_order_codes(d, code);
    d->state.since_sort = 0;
  }
  const tdm_status status = dem_renew_homes(d, code, home);
  free(code);
  return status;
}

/* Memory for the work on lists: that of push, on several ranks of home's. */
static void lend_push(dem_data *d, bool all) {
  const int first = dem_home_first_particle(d);
  const size_t n = all ? (size_t)d->work.push_capacity : (size_t)(dem_home_end_particle(d) - first);
  d->work.scratch.block = (char *)(d->state.push + first);
  d->work.scratch.size = n * sizeof *d->state.push;
}

static void take_push_back(dem_data *d) {
  dem_scratch_done(&d->work.scratch);
  dem_zero(d, d->work.scratch.block, d->work.scratch.most);
}

/* The entries of walls of before are to ascend again, if their particles have other numbers or are in other chunks. The
 * numbers that particles had, if this puts them in order; NULL: they are what they are. */
static tdm_status renumber(dem_data *d, bool sort, bool renewed, bool carry, const int **old) {
  dem_wall_contacts *walls = &d->work.spare_walls;
  *old = NULL;
  if (renewed) {
    const size_t first = walls->chunk[dem_home_first(d)], end = walls->chunk[dem_home_end(d)];
    return carry ? dem_near_walls_renumber(d, walls, first, end, NULL) : TDM_OK;
  }
  if (sort) {
    *old = sort_particles(d, carry);
    return *old ? TDM_OK : TDM_ERR_MEMORY;
  }
  if (d->lists.stale && carry && d->lists.nchunk > 1) /* particles went from chunk to chunk */
    return dem_near_walls_renumber(d, walls, 0, walls->count, NULL);
  return TDM_OK;
}

/* All that lists are made of is where it belongs: each rank has that of its home, by what the costs of chunks and the
 * order of particles want. *renewed: it came there now. */
static tdm_status prepare(dem_data *d, bool sort, bool *renewed) {
  double home[DEM_RANKS_MAX + 1];
  const bool moves = dem_homes_balance(d, home);
  *renewed = false;
  if (dem_alone(d))
    return TDM_OK;
  if (!d->lists.stale) {
    d->lists.nchunk = dem_chunks(d->state.nparticle);
    *renewed = sort || moves;
    return *renewed ? renew_homes(d, sort, home) : TDM_OK;
  }
  dem_unite(d, DEM_WHOLE); /* particles came, on all ranks alike */
  d->work.homes.planned = false;
  memcpy(d->lists.home, home, ((size_t)d->work.homes.ranks->size + 1) * sizeof *home);
  return TDM_OK;
}

tdm_status dem_lists_build(dem_data *d) {
  const bool sort = d->state.nparticle > DEM_CHUNK && d->state.since_sort >= DEM_SORT_STEPS;
  bool renewed;
  if (prepare(d, sort, &renewed) || choose_search(d))
    return TDM_ERR_MEMORY;
  const bool stay = d->lists.valid && !d->lists.stale && (renewed || !sort); /* entries are of these numbers */
  if (d->lists.valid)
    adapt_skin(d, sort);
  dem_wall_contacts walls = d->lists.walls;
  d->lists.walls = d->work.spare_walls;
  d->work.spare_walls = walls;
  bool carry = d->model->columns.ncolumn > 0 && d->lists.valid;
  const int *old;
  d->lists.valid = false;
  d->work.scratch = (dem_scratch){.kept = d->work.scratch.kept};
  if (dem_alone(d))
    lend_push(d, true);
  tdm_status status = renumber(d, sort, renewed, carry, &old);
  d->lists.nchunk = dem_chunks(d->state.nparticle);
  if (!dem_alone(d))
    lend_push(d, false);
  note_positions(d);
  if (!status)
    status = build_pairs(d, carry, stay, old);
  take_push_back(d);
  if (!status)
    status = dem_crossings_place(d);
  if (!status)
    status = dem_near_walls_build(d, carry ? &d->work.spare_walls : NULL, stay);
  if (!status)
    share_bounds(d);
  if (!status)
    dem_keep_home(d);
  d->lists.valid = !status;
  d->lists.stale = false;
  d->lists.since_list = 0;
  d->lists.nrebuild++;
  d->work.notes.valid = d->work.among = false;
  return status;
}

tdm_status dem_lists_update(dem_data *d, double moved2) {
  bool sort = d->state.nparticle > DEM_CHUNK && d->state.since_sort >= DEM_SORT_STEPS;
  if (!d->work.search && choose_search(d)) /* of a copy */
    return TDM_ERR_MEMORY;
  return !sort && lists_hold(d, moved2) ? TDM_OK : dem_lists_build(d);
}
