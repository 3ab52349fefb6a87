/* The contacts of the present state with their forces: see contacts.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/output/contacts.h"

#include "dem/state/wall_gap.h"
#include "dem/step/forces.h"

#include <stdlib.h>
#include <string.h>

/* ---- pairs ---- */

/* from the second of a pair, in its nearest image, to the first */
static tdm_vec3 between(const dem_data *d, int i, int j) {
  const tdm_vec3 x = tdm_sub(d->state.sphere[i].position, d->state.sphere[j].position);
  double s[3] = {x.x, x.y, x.z};
  for (int a = 0; a < 3; a++)
    if (d->state.domain.periodic[a])
      s[a] -= d->state.domain.length[a] * rint(s[a] / d->state.domain.length[a]);
  return tdm_v3(s[0], s[1], s[2]);
}

/* The pair of entry k, whose reaction on the second one is this. */
static tdm_status add_pair(const dem_data *d, size_t k, tdm_vec3 reaction, tdm_snapshot *s, tdm_error *err) {
  const int i = d->lists.pairs.one[k], j = d->lists.pairs.other[k];
  const dem_sphere *a = &d->state.sphere[i], *b = &d->state.sphere[j];
  const tdm_vec3 x = between(d, i, j);
  if (!(tdm_norm(x) < a->radius + b->radius) && !(tdm_norm(reaction) > 0))
    return TDM_OK;
  const tdm_view_contact contact = {.particle = (int64_t)d->state.id[i],
                                    .other = (int64_t)d->state.id[j],
                                    .from = a->position,
                                    .to = tdm_sub(a->position, x),
                                    .force = -tdm_dot(reaction, tdm_unit(x))};
  return tdm_snapshot_add_contact(s, &contact, err);
}

static dem_loop_task task_of(dem_data *d, int chunk) {
  return (dem_loop_task){.model = d->model, .data = d, .chunk = chunk, .load = d->work.chunk_load};
}

/* `d` is a copy with forces: its reactions go elsewhere. */
static tdm_status look_at_pairs(dem_data *d, tdm_snapshot *s, tdm_error *err) {
  dem_pairs *list = &d->lists.pairs;
  const size_t first = (size_t)d->state.nparticle + 1;
  dem_push *own = calloc(first + list->count, sizeof *own), *before = d->state.push;
  if (!own)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %zu contacts", list->count);
  for (size_t k = 0; k < list->count; k++)
    list->reaction_slot[k] = (int)(first + k);
  d->state.push = own;
  for (int c = 0; c < d->lists.nchunk; c++) {
    dem_loop_task task = task_of(d, c);
    d->model->loops->pairs(&task);
  }
  d->state.push = before;
  for (size_t k = 0; k < list->count && err->status == TDM_OK; k++)
    if (list->one[k] < d->state.nparticle)
      add_pair(d, k, own[first + k].force, s, err);
  free(own);
  return err->status;
}

/* ---- walls ---- */

/* Entries `begin` to `end` of a chunk, all of one particle and wall. */
static tdm_status look_at_wall(dem_data *d, int chunk, size_t begin, size_t end, tdm_snapshot *s, tdm_error *err) {
  const int i = d->lists.walls.entry[begin].particle, w = d->lists.walls.entry[begin].wall;
  const dem_sphere *a = &d->state.sphere[i];
  tdm_vec3 normal;
  const double gap = dem_gap(d, i, w, &normal);
  if (!(gap < a->radius + d->model->reach))
    return TDM_OK;
  d->state.push[i] = (dem_push){0};
  dem_loop_task task = task_of(d, chunk);
  task.wall_first = begin;
  task.wall_end = end;
  d->model->wall_loops->walls(&task);
  if (!(task.touching > 0))
    return TDM_OK;
  const tdm_view_contact contact = {.particle = (int64_t)d->state.id[i],
                                    .other = -1,
                                    .from = a->position,
                                    .to = tdm_axpy(-gap, normal, a->position),
                                    .force = tdm_dot(d->state.push[i].force, normal)};
  return tdm_snapshot_add_contact(s, &contact, err);
}

static tdm_status look_at_walls(dem_data *d, tdm_snapshot *s, tdm_error *err) {
  const dem_wall_contacts *list = &d->lists.walls;
  for (int c = 0; c < d->lists.nchunk; c++)
    for (size_t k = list->chunk[c], next; k < list->chunk[c + 1]; k = next) {
      next = k + 1;
      while (next < list->chunk[c + 1] && list->entry[next].wall == list->entry[k].wall &&
             list->entry[next].particle == list->entry[k].particle)
        next++;
      if (look_at_wall(d, c, k, next, s, err) != TDM_OK)
        return err->status;
    }
  return TDM_OK;
}

tdm_status dem_contacts_look(const dem_data *data, tdm_snapshot *s, tdm_error *err) {
  dem_data *copy = dem_data_allocate(data->model);
  if (!copy || dem_data_copy(copy, data))
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %ld contacts", data->state.ncontact);
  else if (dem_forces_now(copy, false, err) == TDM_OK && look_at_pairs(copy, s, err) == TDM_OK)
    look_at_walls(copy, s, err);
  dem_data_destroy(&copy);
  return err->status;
}
