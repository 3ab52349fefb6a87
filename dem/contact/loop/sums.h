/* Sums over the contacts of each particle: how the loops of forces read them, and the loops that add them up. Only
 * loops.h includes it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LOOP_SUMS_H
#define DEM_CONTACT_LOOP_SUMS_H

#include "dem/contact/loop/pair_loop.h"
#include "dem/contact/loop/wall_loop.h"

#if DEM_LAW_SUMS > 0

typedef void sum_kernel(const dem_contact *, vd sum[]);

/* To the sums of each particle that touches, lane after lane, in each first to `slot` and then, unless NULL, to
 * `other`: the order of the list, whatever the number of lanes. */
DEM_INLINE void add_sums(dem_data *d, const dem_contact *c, const int *slot, const vd sum[], const int *other,
                         const vd to_other[]) {
  for (int q = 0; q < DEM_LAW_SUMS; q++) {
    double lane[2][DEM_W], *of = d->work.contact_sum + q;
    vd_store(lane[0], vd_only(c->touching, sum[q]));
    if (other)
      vd_store(lane[1], vd_only(c->touching, to_other[q]));
    for (int l = 0; l < DEM_W; l++) {
      of[(size_t)slot[l] * DEM_LAW_SUMS] += lane[0][l];
      if (other)
        of[(size_t)other[l] * DEM_LAW_SUMS] += lane[1][l];
    }
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
    vd of[2][DEM_LAW_SUMS];
    contribution(&c, of[0]);
    c.normal = vd3_scale(vd_set(-1), c.normal);
    c.radii[0] = vd_radii(d->state.sphere, j), c.radii[1] = vd_radii(d->state.sphere, i);
    contribution(&c, of[1]);
    add_sums(d, &c, i, of[0], list->reaction_slot + k, of[1]);
  }
}

DEM_KERNEL void sum_planes(dem_loop_task *task, size_t begin, size_t end, sum_kernel *contribution) {
  dem_contact c = contact_of(task, (row){0});
  for (size_t k = begin; k < end; k += DEM_W) {
    int i[DEM_W];
    vd arm, of[DEM_LAW_SUMS];
    if (!touch_plane(task, k, i, &c, &arm))
      continue;
    c.radii[0] = c.radius, c.radii[1] = vd_set(INFINITY);
    contribution(&c, of);
    add_sums(task->data, &c, i, of, NULL, NULL);
  }
}

DEM_KERNEL void sum_batch(dem_loop_task *task, batch *b, sum_kernel *contribution) {
  batch_motion motion;
  dem_contact c;
  batch_contact(task, b, (row){0}, &c, &motion);
  vd of[DEM_LAW_SUMS];
  contribution(&c, of);
  add_sums(task->data, &c, b->particle, of, NULL, NULL);
  b->count = 0;
}

#endif

#endif
