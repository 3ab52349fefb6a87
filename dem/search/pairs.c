/* Neighbour lists: see pairs.h. */
#include "dem/search/pairs.h"

#include "dem/search/order.h"

#include <stdlib.h>
#include <string.h>

tdm_vec3 dem_lists_shift(const dem_data *d) {
  if (d->model->ncoupled == 0)
    return tdm_v3(0, 0, 0);
  int b = d->model->coupled_body[0];
  return tdm_sub(d->pose[b].position, d->pose_at_list[b].position);
}

/* by how much the images of a box that is strained have moved [m] */
static double strained_since(const dem_data *d) {
  tdm_vec3 grown = {0, 0, 0};
  for (int a = 0; a < 3; a++)
    (&grown.x)[a] = d->domain.length[a] - d->length_at_list[a];
  return tdm_norm(grown);
}

/* may the lists still be used? Written so that NaN says no. */
static bool lists_hold(const dem_data *d, double moved2) {
  const double safety = 0.999; /* round-off must not decide */
  const dem_model *m = d->model;
  double moved = sqrt(moved2);
  uint64_t interval = (uint64_t)dem_search_interval(d->search);
  double nearer = 2 * moved + (m->domain.strained ? strained_since(d) : 0);
  if (!d->list_valid || d->list_stale || !(nearer < safety * m->skin) || (interval > 0 && d->since_list >= interval))
    return false;
  tdm_vec3 u = dem_lists_shift(d);
  for (int b = 0; b < m->nbody; b++) {
    double away = moved;
    tdm_vec3 dx = tdm_sub(d->pose[b].position, d->pose_at_list[b].position);
    away += tdm_norm(tdm_sub(dx, u));
    if (m->body[b].coupled >= 0) {
      tdm_quat turn = tdm_quat_mul(tdm_quat_conj(d->pose_at_list[b].orientation), d->pose[b].orientation);
      away += 2 * sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z) * d->reach[b];
    }
    if (!(away < safety * d->margin[b]))
      return false;
  }
  return true;
}

/* ---- histories ---- */

/* the entry of particles a and b in a list, -1: none */
static int find_entry(const dem_pairs *list, int a, int b) {
  int i = a < b ? a : b, j = a < b ? b : a;
  for (int k = list->first[i]; k < list->first[i + 1]; k++)
    if (list->other[k] == j)
      return k;
  return -1;
}

/* Take over the histories of chunk c's entries from the list of before, whose particles had the numbers old[] (NULL:
 * the same). Vectors turn round when the order of a pair does. */
static void carry_pairs(dem_data *d, const dem_pairs *before, const int *old, int c) {
  dem_pairs *list = &d->pairs;
  const dem_law *law = d->model->law;
  size_t count = list->chunk[c + 1] - list->chunk[c];
  for (size_t q = 0; q < (size_t)law->ncolumn && count > 0; q++)
    memset(list->history + q * list->capacity + list->chunk[c], 0, count * sizeof(double));
  if (!before)
    return;
  for (size_t k = list->chunk[c]; k < list->chunk[c + 1]; k++) {
    int i = list->one[k], j = list->other[k];
    if (i >= d->nparticle)
      break;
    int oi = old ? old[i] : i, oj = old ? old[j] : j;
    int at = find_entry(before, oi, oj);
    if (at < 0)
      continue;
    bool turned = (oi < oj) != (i < j);
    for (size_t q = 0; q < (size_t)law->ncolumn; q++) {
      double value = before->history[q * before->capacity + (size_t)at];
      list->history[q * list->capacity + k] = turned && (law->vectors >> q & 1) ? -value : value;
    }
  }
}

/* ---- pairs ---- */

/* where the entries of each chunk begin; false: no memory */
static bool place_chunks(dem_data *d) {
  dem_pairs *list = &d->pairs;
  size_t at = 0;
  for (int c = 0; c < d->nchunk; c++) {
    int begin = c * DEM_CHUNK, end = c + 1 < d->nchunk ? begin + DEM_CHUNK : d->nparticle;
    list->chunk[c] = at;
    at += (size_t)(d->rows.first[end] - d->rows.first[begin]);
    at = (at + DEM_LANES_MAX - 1) / DEM_LANES_MAX * DEM_LANES_MAX;
  }
  list->chunk[d->nchunk] = list->count = at;
  return dem_pairs_reserve(list, at, d->model->law->ncolumn);
}

static void fill_chunk(dem_data *d, int c) {
  dem_pairs *list = &d->pairs;
  int begin = c * DEM_CHUNK, end = c + 1 < d->nchunk ? begin + DEM_CHUNK : d->nparticle, none = d->nparticle;
  int k = (int)list->chunk[c];
  for (int i = begin; i < end; i++) {
    list->first[i] = k;
    for (int r = d->rows.first[i]; r < d->rows.first[i + 1]; r++, k++) {
      list->one[k] = i;
      list->other[k] = list->sink[k] = d->rows.other[r];
    }
  }
  for (; k < (int)list->chunk[c + 1]; k++)
    list->one[k] = list->other[k] = list->sink[k] = none;
  if (c + 1 == d->nchunk)
    list->first[d->nparticle] = k;
}

/* Give each reaction on a particle of a later chunk a place of its own. */
static bool place_crossings(dem_data *d) {
  dem_pairs *list = &d->pairs;
  dem_crossings *x = &d->crossings;
  int count = 0, first = d->nparticle + 1;
  for (int c = 0; c < d->nchunk - 1; c++)
    for (size_t k = list->chunk[c]; k < list->chunk[c + 1]; k++)
      count += list->other[k] < d->nparticle && list->other[k] >= (c + 1) * DEM_CHUNK;
  if (!dem_crossings_reserve(d, count))
    return false;
  x->count = count;
  memset(x->chunk, 0, (size_t)(d->nchunk + 1) * sizeof *x->chunk);
  int place = 0;
  for (int c = 0; c < d->nchunk - 1; c++)
    for (size_t k = list->chunk[c]; k < list->chunk[c + 1]; k++)
      if (list->other[k] < d->nparticle && list->other[k] >= (c + 1) * DEM_CHUNK) {
        x->particle[place] = list->other[k];
        list->sink[k] = first + place++;
        x->chunk[list->other[k] / DEM_CHUNK + 1]++;
      }
  for (int c = 0; c < d->nchunk; c++)
    x->chunk[c + 1] += x->chunk[c];
  for (int p = count - 1; p >= 0; p--) /* places of a chunk ascend: filled from its end */
    x->order[--x->chunk[x->particle[p] / DEM_CHUNK + 1]] = p;
  /* every entry but the first now stands at the start of its chunk: shift by one */
  for (int c = 0; c < d->nchunk; c++)
    x->chunk[c] = x->chunk[c + 1];
  x->chunk[d->nchunk] = count;
  memset(d->push + d->nparticle, 0, (size_t)(count + 1) * sizeof *d->push);
  return true;
}

/* leave away the pairs of which neither can move */
static void drop_fixed(dem_data *d) {
  int at = 0, begin = 0;
  for (int i = 0; i < d->nparticle; i++) {
    int end = d->rows.first[i + 1];
    for (int r = begin; r < end; r++)
      if (d->sphere[i].inverse_mass + d->sphere[d->rows.other[r]].inverse_mass > 0)
        d->rows.other[at++] = d->rows.other[r];
    begin = end;
    d->rows.first[i + 1] = at;
  }
  d->rows.count = (size_t)at;
}

static bool build_pairs(dem_data *d, const dem_pairs *before, const int *old) {
  dem_search_input input = {
      .sphere = d->sphere, .n = d->nparticle, .skin = d->model->skin, .domain = d->domain, .nthread = d->nthread};
  if (!dem_search_run(d->search, &input, &d->rows))
    return false;
  if (d->model->driven)
    drop_fixed(d);
  if (!place_chunks(d))
    return false;
#pragma omp parallel for schedule(static) num_threads(d->nthread) if (d->nthread > 1)
  for (int c = 0; c < d->nchunk; c++)
    fill_chunk(d, c);
  if (d->model->law->ncolumn > 0) {
#pragma omp parallel for schedule(static) num_threads(d->nthread) if (d->nthread > 1)
    for (int c = 0; c < d->nchunk; c++)
      carry_pairs(d, before, old, c);
  }
  return place_crossings(d);
}

/* ---- walls ---- */

static bool append_wall(dem_data *d, dem_wall_entry entry) {
  dem_wall_contacts *list = &d->walls;
  if (list->count == list->capacity) { /* histories come later */
    size_t capacity = list->capacity + list->capacity / 2 + 256;
    dem_wall_entry *grown = realloc(list->entry, capacity * sizeof *grown);
    if (!grown)
      return false;
    list->entry = grown;
    int ncolumn = d->model->law->ncolumn;
    free(list->history);
    list->history = ncolumn > 0 ? malloc(capacity * (size_t)ncolumn * sizeof(double)) : NULL;
    if (ncolumn > 0 && !list->history)
      return false;
    list->capacity = capacity;
  }
  list->entry[list->count++] = entry;
  return true;
}

static int compare_entries(const dem_wall_entry *a, const dem_wall_entry *b) {
  if (a->particle != b->particle)
    return a->particle < b->particle ? -1 : 1;
  if (a->wall != b->wall)
    return a->wall < b->wall ? -1 : 1;
  return a->part < b->part ? -1 : a->part > b->part;
}

static int by_entry(const void *a, const void *b) {
  return compare_entries(a, b);
}

/* the histories of the wall contacts, both lists ascending */
static void carry_walls(dem_data *d, const dem_wall_contacts *before) {
  dem_wall_contacts *list = &d->walls;
  size_t ncolumn = (size_t)d->model->law->ncolumn, old = 0, nold = before ? before->count : 0;
  for (size_t k = 0; k < list->count; k++) {
    while (old < nold && compare_entries(&before->entry[old], &list->entry[k]) < 0)
      old++;
    bool same = old < nold && compare_entries(&before->entry[old], &list->entry[k]) == 0;
    for (size_t q = 0; q < ncolumn; q++)
      list->history[q * list->capacity + k] = same ? before->history[q * before->capacity + old] : 0;
  }
}

/* the list of before with new numbers; to ascend again it is sorted, histories with it */
static bool renumber_walls(dem_data *d, dem_wall_contacts *list, const int *now) {
  size_t ncolumn = (size_t)d->model->law->ncolumn, n = list->count;
  if (n == 0 || ncolumn == 0)
    return true;
  struct {
    dem_wall_entry entry;
    int at;
  } *key = malloc(n * sizeof *key);
  double *copy = malloc(n * sizeof *copy);
  for (size_t k = 0; key && k < n; k++) {
    key[k].entry = list->entry[k];
    key[k].entry.particle = now[key[k].entry.particle];
    key[k].at = (int)k;
  }
  if (key && copy) {
    qsort(key, n, sizeof *key, by_entry);
    for (size_t k = 0; k < n; k++)
      list->entry[k] = key[k].entry;
    for (size_t q = 0; q < ncolumn; q++) {
      memcpy(copy, list->history + q * list->capacity, n * sizeof *copy);
      for (size_t k = 0; k < n; k++)
        list->history[q * list->capacity + k] = copy[key[k].at];
    }
  }
  bool good = key && copy;
  free(key);
  free(copy);
  return good;
}

static bool list_walls_of(dem_data *d, int i) {
  const dem_model *m = d->model;
  const dem_sphere *s = &d->sphere[i];
  for (int w = 0; w < m->nwall; w++) {
    const dem_wall *wall = &m->wall[w];
    tdm_vec3 n;
    double gap = dem_wall_gap(wall, &d->wall[w], s->position, &n);
    /* distance from where a contact begins; a plane ends one radius behind its surface */
    double away = gap - s->radius;
    if (wall->primitive == DEM_PLANE)
      away = fmax(away, -gap - s->radius);
    if (!(away < m->skin))
      d->margin[wall->body] = fmin(d->margin[wall->body], away);
    else if (!append_wall(d, (dem_wall_entry){i, w, 0}))
      return false;
  }
  return true;
}

static bool build_walls(dem_data *d, const dem_wall_contacts *before) {
  d->walls.count = 0;
  for (int i = 0; i < d->nparticle; i++) {
    if (i % DEM_CHUNK == 0)
      d->walls.chunk[i / DEM_CHUNK] = d->walls.count;
    if (!list_walls_of(d, i))
      return false;
  }
  if (d->nparticle == 0)
    d->walls.chunk[0] = 0;
  d->walls.chunk[d->nchunk] = d->walls.count;
  carry_walls(d, before);
  return true;
}

/* ---- both ---- */

/* note where everything is */
static void note_positions(dem_data *d) {
  const dem_model *m = d->model;
  for (int i = 0; i < d->nparticle; i++)
    d->position_at_list[i] = d->sphere[i].position;
  memcpy(d->length_at_list, d->domain.length, sizeof d->length_at_list);
  d->since_list = 0;
  for (int b = 0; b < m->nbody; b++) {
    d->pose_at_list[b] = d->pose[b];
    d->margin[b] = INFINITY;
    d->reach[b] = 0;
    if (m->body[b].coupled < 0)
      continue;
    for (int i = 0; i < d->nparticle; i++)
      d->reach[b] = fmax(d->reach[b], tdm_norm(tdm_sub(d->sphere[i].position, d->pose[b].position)));
  }
}

/* the lists of before become the spare ones */
static void swap_lists(dem_data *d) {
  dem_pairs pairs = d->pairs;
  dem_wall_contacts walls = d->walls;
  d->pairs = d->spare_pairs;
  d->walls = d->spare_walls;
  d->spare_pairs = pairs;
  d->spare_walls = walls;
}

bool dem_lists_build(dem_data *d) {
  bool sort = d->nparticle > DEM_CHUNK && d->since_sort >= DEM_SORT_STEPS;
  swap_lists(d);
  bool carry = d->model->law->ncolumn > 0 && d->list_valid, good = true;
  const int *old = NULL;
  d->list_valid = false;
  if (sort) {
    int *from = d->number, *now = malloc((size_t)d->nparticle * sizeof *now);
    good = now && dem_order(d, from) && dem_data_permute(d, from);
    for (int p = 0; good && p < d->nparticle; p++)
      now[from[p]] = p;
    good = good && (!carry || renumber_walls(d, &d->spare_walls, now));
    free(now);
    old = from;
    d->since_sort = 0;
  }
  note_positions(d);
  d->nchunk = dem_chunks(d->nparticle);
  d->list_valid =
      good && build_pairs(d, carry ? &d->spare_pairs : NULL, old) && build_walls(d, carry ? &d->spare_walls : NULL);
  d->list_stale = false;
  d->nrebuild++;
  return d->list_valid;
}

bool dem_lists_update(dem_data *d, double moved2) {
  bool sort = d->nparticle > DEM_CHUNK && d->since_sort >= DEM_SORT_STEPS;
  return (!sort && lists_hold(d, moved2)) || dem_lists_build(d);
}
