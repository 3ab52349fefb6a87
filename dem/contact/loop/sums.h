/* Sums over the contacts of each particle: how the loops of forces read them, and the loops that add them up. Only
 * loops.h includes it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LOOP_SUMS_H
#define DEM_CONTACT_LOOP_SUMS_H

#include "dem/contact/loop/pair_loop.h"
#include "dem/contact/loop/wall_loop.h"

#if DEM_LAW_SUMS > 0

typedef void sum_kernel(const dem_contact *, vd sum[]);

/* to the sums of each particle that touches, lane after lane */
DEM_INLINE void add_sums(dem_data *d, const int *slot, const dem_contact *c, const vd sum[]) {
  for (int q = 0; q < DEM_LAW_SUMS; q++) {
    double lane[DEM_W];
    vd_store(lane, vd_only(c->touching, sum[q]));
    for (int l = 0; l < DEM_W; l++)
      d->work.contact_sum[(size_t)slot[l] * DEM_LAW_SUMS + (size_t)q] += lane[l];
  }
}

DEM_KERNEL void sum_pairs(dem_loop_task *task, sum_kernel *contribution) {
  const dem_model *m = task->model;
  dem_data *d = task->data;
  const dem_pairs *list = &d->lists.pairs;
  dem_contact c = contact_of(task, (row){0});
  for (size_t k = list->chunk[task->chunk]; k < list->chunk[task->chunk + 1]; k += DEM_W) {
    const int *i = list->one + k, *j = list->other + k;
    vd s[8], boxes[3], sum = vd_radii(d->state.sphere, i) + vd_radii(d->state.sphere, j);
    vd_sphere_difference(d->state.sphere, i, j, s);
    if (m->domain.repeats)
      nearest_image(d, s, boxes);
    vd3 x = {s[0], s[1], s[2]};
    vd r2 = vd3_dot(x, x);
    c.touching = vm_less(r2, sum * sum);
    if (!vm_any(c.touching))
      continue;
    pair_geometry(d, i, j, s, x, r2, sum, &c);
    vd of[DEM_LAW_SUMS];
    contribution(&c, of);
    add_sums(d, i, &c, of);
    c.normal = vd3_scale(vd_set(-1), c.normal);
    c.radii[0] = vd_radii(d->state.sphere, j), c.radii[1] = vd_radii(d->state.sphere, i);
    contribution(&c, of);
    add_sums(d, list->reaction_slot + k, &c, of);
  }
}

DEM_KERNEL void sum_batch(dem_loop_task *task, batch *b, sum_kernel *contribution) {
  dem_contact c = batch_contact(task, b, (row){0});
  vd of[DEM_LAW_SUMS];
  int slot[DEM_W];
  for (int l = 0; l < DEM_W; l++) /* lanes without a contact add nothing to the particle of the first */
    slot[l] = task->data->lists.walls.entry[b->entry[l < b->count ? l : 0]].particle;
  contribution(&c, of);
  add_sums(task->data, slot, &c, of);
  b->count = 0;
}

#endif

#endif
