/* Neighbour lists: see pairs.h. */
#include "dem/search/pairs.h"

#include "dem/search/cells.h"

tdm_vec3 dem_lists_shift(const dem_data *d) {
  if (d->model->ncoupled == 0)
    return tdm_v3(0, 0, 0);
  int b = d->model->coupled_body[0];
  return tdm_sub(d->pose[b].position, d->pose_at_list[b].position);
}

/* may the lists still be used? Written so that NaN says no. */
static bool lists_hold(const dem_data *d, double moved2) {
  const double safety = 0.999; /* round-off must not decide */
  const dem_model *m = d->model;
  double moved = sqrt(moved2);
  if (!d->list_valid || d->list_stale || !(2 * moved < safety * m->skin))
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

/* append a partner; the slot starts empty */
static bool append(dem_data *d, dem_list *list, int other) {
  bool history = d->model->law->history;
  if (list->count == list->capacity) {
    if (!dem_list_reserve(list, list->count + 1, history))
      return false;
    d->ngrow++;
  }
  if (history)
    list->slot[list->count] = (dem_slot){0};
  list->other[list->count++] = other;
  return true;
}

static void sort_row(int *row, int n) {
  for (int a = 1; a < n; a++) {
    int value = row[a], b = a;
    for (; b > 0 && row[b - 1] > value; b--)
      row[b] = row[b - 1];
    row[b] = value;
  }
}

/* take the histories of particle i's contacts over from the list of before; both rows ascend */
static void carry_history(dem_list *list, const dem_list *before, int i) {
  int old = before->first[i], old_end = before->first[i + 1];
  for (int k = list->first[i]; k < (int)list->count && old < old_end; k++) {
    while (old < old_end && before->other[old] < list->other[k])
      old++;
    if (old < old_end && before->other[old] == list->other[k])
      list->slot[k] = before->slot[old];
  }
}

static bool build_pairs(dem_data *d, const dem_list *before) {
  const dem_model *m = d->model;
  dem_list *list = &d->pairs;
  double largest = 0;
  for (int i = 0; i < d->nparticle; i++)
    largest = fmax(largest, d->radius[i]);
  dem_cells cells;
  if (!dem_cells_fill(&cells, d, 2 * largest + m->skin))
    return false;

  for (int i = 0; i < d->nparticle; i++) {
    list->first[i] = (int)list->count;
    int near[27], nnear = dem_cells_near(&cells, d, i, near);
    for (int c = 0; c < nnear; c++)
      for (int k = d->grid.first[near[c]]; k < d->grid.first[near[c] + 1]; k++) {
        int j = d->grid.particle[k];
        tdm_vec3 dx = tdm_sub(d->position[i], d->position[j]);
        double range = d->radius[i] + d->radius[j] + m->skin;
        if (j > i && tdm_dot(dx, dx) < range * range && !append(d, list, j))
          return false;
      }
    sort_row(list->other + list->first[i], (int)list->count - list->first[i]);
    if (before)
      carry_history(list, before, i);
  }
  list->first[d->nparticle] = (int)list->count;
  return true;
}

static bool build_walls(dem_data *d, const dem_list *before) {
  const dem_model *m = d->model;
  dem_list *list = &d->walls;
  for (int i = 0; i < d->nparticle; i++) {
    list->first[i] = (int)list->count;
    for (int w = 0; w < m->nwall; w++) {
      const dem_wall *wall = &m->wall[w];
      tdm_vec3 n;
      double gap = dem_wall_gap(wall, &d->wall[w], d->position[i], &n);
      /* distance from where a contact begins; a plane ends one radius behind its surface */
      double away = gap - d->radius[i];
      if (wall->primitive == DEM_PLANE)
        away = fmax(away, -gap - d->radius[i]);
      if (away < m->skin) {
        if (!append(d, list, w))
          return false;
      } else {
        d->margin[wall->body] = fmin(d->margin[wall->body], away);
      }
    }
    if (before)
      carry_history(list, before, i);
  }
  list->first[d->nparticle] = (int)list->count;
  return true;
}

/* note where everything is */
static void note_positions(dem_data *d) {
  const dem_model *m = d->model;
  for (int i = 0; i < d->nparticle; i++)
    d->position_at_list[i] = d->position[i];
  for (int b = 0; b < m->nbody; b++) {
    d->pose_at_list[b] = d->pose[b];
    d->margin[b] = INFINITY;
    d->reach[b] = 0;
    if (m->body[b].coupled < 0)
      continue;
    for (int i = 0; i < d->nparticle; i++)
      d->reach[b] = fmax(d->reach[b], tdm_norm(tdm_sub(d->position[i], d->pose[b].position)));
  }
}

bool dem_lists_build(dem_data *d) {
  dem_list pairs = d->pairs, walls = d->walls;
  d->pairs = d->spare_pairs;
  d->walls = d->spare_walls;
  d->spare_pairs = pairs;
  d->spare_walls = walls;
  d->pairs.count = d->walls.count = 0;
  bool carry = d->model->law->history && d->list_valid;
  note_positions(d);
  d->list_valid = build_pairs(d, carry ? &d->spare_pairs : NULL) && build_walls(d, carry ? &d->spare_walls : NULL);
  d->list_stale = false;
  d->nrebuild++;
  return d->list_valid;
}

bool dem_lists_update(dem_data *d, double moved2) {
  return lists_hold(d, moved2) || dem_lists_build(d);
}
