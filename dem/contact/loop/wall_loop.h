/* The loop over particles and walls: planes DEM_W particles at a time, what touches other walls gathered until there
 * are DEM_W contacts. batch.h has these, part_loop.h walls with parts. Only loops.h includes it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LOOP_WALL_LOOP_H
#define DEM_CONTACT_LOOP_WALL_LOOP_H

#include "dem/contact/loop/batch.h"
#include "dem/contact/loop/part_loop.h"

/* ---- walls with one contact ---- */

/* Has wall w let particle i go, now or before, from which it is not yet clear? */
DEM_INLINE bool let_go(dem_data *d, int i, int w, double gap) {
  const dem_wall *wall = &d->model->wall[w];
  const dem_sphere *s = &d->state.sphere[i];
  uint8_t *front = &d->state.front[(size_t)i * (size_t)d->model->nwall + (size_t)w];
  dem_letting letting = DEM_HOLDS;
  if (gap >= s->radius)
    *front &= (uint8_t)~DEM_LET_GO;
  else
    letting = wall->shape->lets_go(wall, dem_wall_own(&d->state.wall[w], s->position), s->radius);
  if (letting == DEM_LETS_GO_FOR_ALL)
    *front |= DEM_LET_GO;
  return letting == DEM_LETS_GO_HERE || (*front & DEM_LET_GO);
}

DEM_KERNEL void simple_wall(dem_loop_task *task, batch *b, size_t begin, size_t end, const row r) {
  const dem_model *m = task->model;
  dem_data *d = task->data;
  const dem_wall_contacts *list = &d->lists.walls;
  if (begin == end)
    return;
  const dem_wall *wall = &m->wall[list->entry[begin].wall];
  const dem_wall_place *place = &d->state.wall[list->entry[begin].wall];
  const double reach = r.all_terms ? m->reach : 0;
  for (size_t k = begin; k < end; k++) {
    const dem_sphere *s = &d->state.sphere[list->entry[k].particle];
    if (left_out(task, s, wall->body))
      continue;
    tdm_vec3 n;
    double gap = dem_wall_sphere_gap(wall, place, s->position, s->radius, &n);
    const bool gone = wall->shape->lets_go && let_go(d, list->entry[k].particle, list->entry[k].wall, gap);
    if (gone || gap >= s->radius + reach || dem_wall_behind(wall, gap, s->radius))
      close_entry(list, k, r.ncolumn);
    else
      add_to_batch(task, b, k, gap, n, r);
  }
}

/* ---- planes, DEM_W particles at a time ---- */

/* What of dem_mobility_along is the same all over a plane. */
typedef struct {
  bool full;
  double straight; /* n Y_vv n, or 1/mass */
  tdm_vec3 mixed;  /* 2 Y_wv n */
  const tdm_mat3 *turning;
} plane_mobility;

DEM_INLINE plane_mobility plane_mobility_of(const dem_mobility *y, bool settling, tdm_vec3 n) {
  if (settling || !y->full)
    return (plane_mobility){.straight = settling ? 0 : y->per_mass};
  return (plane_mobility){true, tdm_dot(n, tdm_m3_mul(y->vv, n)), tdm_scale(2, tdm_m3_mul(y->wv, n)), &y->ww};
}

/* what the other contacts of the particles give those of entries k ... with a plane */
DEM_INLINE void plane_sums(const dem_data *d, size_t k, const int *particle, dem_contact *c,
                           vd sums[2][DEM_LAW_SUMS + 1]) {
  (void)d, (void)k, (void)particle;
#if DEM_LAW_NOTES
  c->shift = vd_load(note_column(d, DEM_NOTE_SIDE) + dem_note_of_wall(d, k));
#endif
  if (DEM_LAW_SUMS > 0) {
    c->radii[0] = c->radius, c->radii[1] = vd_set(INFINITY);
    load_sums(d, particle, sums[0]);
    for (int q = 0; q < DEM_LAW_SUMS; q++)
      sums[1][q] = vd_set(0);
  }
  c->own_sums = sums[0], c->other_sums = sums[1];
}

/* The contacts of entries k ... with a plane before the forces: what DEM_LAW_PLANES promises to be enough. False: there
 * are none. */
DEM_KERNEL bool touch_plane(const dem_loop_task *task, size_t k, int i[DEM_W], dem_contact *c, vd *arm) {
  const dem_data *d = task->data;
  const dem_wall_entry *entry = d->lists.walls.entry + k;
  const tdm_vec3 normal = d->state.wall[entry->wall].normal, on = d->state.wall[entry->wall].point;
  for (int l = 0; l < DEM_W; l++)
    i[l] = entry[l].particle;
  vd s[8];
  vd_spheres(d->state.sphere, i, s);
  vd3 above = vd3_sub((vd3){s[0], s[1], s[2]}, vd3_set(on));
  c->normal = vd3_set(normal);
  vd gap = vd3_dot(above, c->normal), radius = s[3];
  c->touching = vm_and(vm_less(gap, radius), vm_less(-radius, gap));
  c->overlap = radius - gap;
  c->radius = radius;
  c->mass = c->inverse_mass = vd_set(1);
  *arm = gap / radius;
  if (!c->pair.one)
    for (int l = 0; l < DEM_W; l++)
      c->pair.index[l] = d->state.material[i[l]] * task->model->nmaterial + task->model->wall[entry->wall].material;
  return vm_any(c->touching);
}

/* Entries of one plane; end - begin is a multiple of DEM_W and not 0. The same numbers, in the same order, as
 * simple_wall. */
DEM_KERNEL void plane_loop(dem_loop_task *task, size_t begin, size_t end, const row r) {
  const dem_model *m = task->model;
  dem_data *d = task->data;
  const dem_wall_contacts *list = &d->lists.walls;
  int w = list->entry[begin].wall, body = m->wall[w].body;
  tdm_vec3 normal = d->state.wall[w].normal, on = d->state.wall[w].point, center = d->state.pose[body].position;
  tdm_twist now = d->state.twist[body];
  dem_contact c = contact_of(task, r);
  c.normal = vd3_set(normal);
  c.turn = vd_set(tdm_dot(now.angular, normal));
  const vd3 spin = vd3_set(now.angular), drift = vd3_set(now.velocity);
  const plane_mobility mobility = plane_mobility_of(&d->state.mobility[body], task->settling, normal);
  tdm_wrench *load = &task->load[body];

  for (size_t k = begin; k < end; k += DEM_W) {
    int i[DEM_W];
    for (int l = 0; l < DEM_W; l++)
      i[l] = list->entry[k + (size_t)l].particle;
    vd s[8], b[4];
    vd_spheres(d->state.sphere, i, s);
    vd3 x = {s[0], s[1], s[2]};
    vd gap = vd3_dot(vd3_sub(x, vd3_set(on)), c.normal), radius = s[3];
    c.touching = vm_and(vm_less(gap, radius), vm_less(-radius, gap));
    double *history = list->history + k;
    if (!vm_any(c.touching)) {
      close_history(history, list->capacity, r.ncolumn);
      continue;
    }
    vd3 velocity = {s[4], s[5], s[6]};
    vd3 lever = vd3_sub(vd3_axpy(-gap, c.normal, x), vd3_set(center));
    vd3 of_wall = vd3_add(drift, vd3_cross(spin, lever));
    vd arm = gap / radius;
    if (r.rubs) {
      vd_rotor_sum(d->state.rotor, i, i, b);
      vd3 surface = {vd_set(0.5) * b[0], vd_set(0.5) * b[1], vd_set(0.5) * b[2]};
      velocity = vd3_axpy(-arm, vd3_cross(surface, c.normal), velocity);
    }
    velocity = vd3_sub(velocity, of_wall);
    c.overlap = radius - gap;
    c.radius = radius;
    vd along = vd_set(mobility.straight);
    if (mobility.full)
      along = full_mobility_along(along, vd3_set(mobility.mixed), mobility.turning, lever, c.normal);
    c.inverse_mass = s[7] + along;
    c.mass = vd_set(1) / c.inverse_mass;
    if (!c.pair.one)
      for (int l = 0; l < DEM_W; l++)
        c.pair.index[l] = d->state.material[i[l]] * m->nmaterial + m->wall[w].material;
    vd sums[2][DEM_LAW_SUMS + 1];
    plane_sums(d, k, i, &c, sums);
    outcome out = law(task, &c, velocity, history, list->capacity, r, 0);
    vd3 twist = vd3_scale(vd_pick(c.touching, arm, vd_set(0)), out.twist);
    vd3 moment = vd3_only(c.touching, vd3_cross(lever, out.force));
    vd_push_walls(d->state.push, i, (vd[3]){out.force.x, out.force.y, out.force.z}, (vd[3]){twist.x, twist.y, twist.z},
                  (vd[3]){moment.x, moment.y, moment.z}, load);
    task->touching += __builtin_popcount(vm_bits(c.touching));
  }
}

/* ---- all walls ---- */

DEM_KERNEL void wall_loop(dem_loop_task *task, const row constants) {
  const dem_model *m = task->model;
  const row r = row_of(m, constants);
  const dem_wall_contacts *list = &task->data->lists.walls;
  batch b = {.count = 0};
  size_t last = task->wall_end;
  for (size_t k = task->wall_first, next; k < last; k = next) {
    const dem_wall *wall = &m->wall[list->entry[k].wall];
    b.wall = list->entry[k].wall;
    for (next = k + 1; next < last && list->entry[next].wall == list->entry[k].wall;)
      next++;
    if (wall->shape->touches) {
      wall_with_parts(task, &b, k, next, r);
    } else {
      bool whole = (DEM_LAW_SUMS + DEM_LAW_NOTES == 0 || DEM_LAW_PLANES) && !constants.all_terms &&
                   wall->shape->half_space && !wall->moves && !m->driven;
      size_t rest = whole ? next - (next - k) % DEM_W : k;
      if (whole && rest > k)
        r.planes(task, k, rest);
      simple_wall(task, &b, rest, next, r);
    }
    if (b.count > 0) /* so that sums are in the order of the list */
      r.flush(task, &b);
  }
}

#endif
