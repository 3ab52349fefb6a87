/* The loop over particles and walls: planes DEM_W particles at a time, what touches other walls gathered until
 * there are DEM_W contacts. Only loops.h includes it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LOOP_WALL_LOOP_H
#define DEM_CONTACT_LOOP_WALL_LOOP_H

#include "dem/contact/loop/apply.h"

enum { NX, NY, NZ, OVERLAP, VX, VY, VZ, TURN, RADIUS, PER_MASS, ARM, SX, SY, SZ, PER_INERTIA, SHIFT };
enum { WALL_NUMBERS = SHIFT + DEM_LAW_NOTES };

/* contacts of walls, gathered until there are DEM_W; columns */
struct batch {
  double number[WALL_NUMBERS][DEM_W];
  double history[DEM_HISTORY_MAX][DEM_W];
  int entry[DEM_W], body[DEM_W], index[DEM_W];
  tdm_vec3 lever[DEM_W];                    /* of the contact point from the body's centre */
  tdm_vec3 velocity[DEM_W], angular[DEM_W]; /* of the wall there, its belt's included */
  int count;
};

/* couples of wall contacts, on the particle and on the body, and the power of the wall */
DEM_KERNEL void push_wall_couples(dem_loop_task *task, const batch *b, int l, tdm_vec3 force, tdm_vec3 couple) {
  const dem_model *m = task->model;
  dem_data *d = task->data;
  dem_push *push = &d->state.push[d->lists.walls.entry[b->entry[l]].particle];
  push->twist = tdm_axpy(-1 / b->number[RADIUS][l], couple, push->twist);
  tdm_wrench *load = &task->load[b->body[l]];
  load->moment = tdm_sub(load->moment, couple);
  if (m->energy)
    task->flux.wall_power += tdm_dot(force, b->velocity[l]) + tdm_dot(couple, b->angular[l]);
}

DEM_KERNEL dem_contact batch_contact(const dem_loop_task *task, batch *b, const row r) {
  dem_contact c = contact_of(task, r);
  double(*v)[DEM_W] = b->number;
  c.touching = vm_first(b->count);
  memcpy(c.pair.index, b->index, sizeof b->index);
  c.normal = (vd3){vd_load(v[NX]), vd_load(v[NY]), vd_load(v[NZ])};
  c.overlap = vd_load(v[OVERLAP]);
  c.radius = vd_load(v[RADIUS]);
  c.inverse_mass = vd_load(v[PER_MASS]);
  c.mass = vd_set(1) / c.inverse_mass;
  c.turn = vd_load(v[TURN]);
  if (r.all_terms) {
    c.spin = (vd3){vd_load(v[SX]), vd_load(v[SY]), vd_load(v[SZ])};
    c.inverse_inertia = vd_load(v[PER_INERTIA]);
  }
  if (DEM_LAW_SUMS > 0)
    c.radii[0] = c.radius, c.radii[1] = vd_set(INFINITY);
#if DEM_LAW_NOTES
  c.shift = vd_load(v[SHIFT]);
#endif
  return c;
}

/* the sums of the particles of the batch and of its walls, which have none */
DEM_INLINE void batch_load_sums(const dem_data *d, const batch *b, vd sums[2][DEM_LAW_SUMS + 1]) {
  int particle[DEM_W];
  for (int l = 0; l < DEM_W; l++)
    particle[l] = l < b->count ? d->lists.walls.entry[b->entry[l]].particle : d->state.nparticle;
  load_sums(d, particle, sums[0]);
  for (int q = 0; q < DEM_LAW_SUMS; q++)
    sums[1][q] = vd_set(0);
}

DEM_KERNEL void wall_batch(dem_loop_task *task, batch *b, const row r) {
  dem_data *d = task->data;
  const dem_wall_contacts *list = &d->lists.walls;
  const int ncolumn = r.ncolumn;
  double(*v)[DEM_W] = b->number;
  dem_contact c = batch_contact(task, b, r);
  vd3 velocity = {vd_load(v[VX]), vd_load(v[VY]), vd_load(v[VZ])};
  vd sums[2][DEM_LAW_SUMS + 1];
  if (DEM_LAW_SUMS > 0)
    batch_load_sums(d, b, sums);
  c.own_sums = sums[0], c.other_sums = sums[1];
  outcome out = law(task, &c, velocity, b->history[0], DEM_W, r, DEM_ENERGY_WALL_NORMAL);

  double f[6][DEM_W], couple[3][DEM_W];
  if (r.all_terms)
    vd_store(couple[0], out.couple.x), vd_store(couple[1], out.couple.y), vd_store(couple[2], out.couple.z);
  vd_store(f[0], out.force.x), vd_store(f[1], out.force.y), vd_store(f[2], out.force.z);
  vd_store(f[3], out.twist.x), vd_store(f[4], out.twist.y), vd_store(f[5], out.twist.z);
  for (int l = 0; l < b->count; l++) {
    size_t k = (size_t)b->entry[l];
    for (int q = 0; q < ncolumn; q++)
      list->history[(size_t)q * list->capacity + k] = b->history[q][l];
    dem_push *push = &d->state.push[list->entry[k].particle];
    tdm_vec3 force = {f[0][l], f[1][l], f[2][l]}, twist = {f[3][l], f[4][l], f[5][l]};
    push->force = tdm_add(push->force, force);
    push->twist = tdm_axpy(v[ARM][l], twist, push->twist);
    if (task->entry_force)
      task->entry_force[k] = force;
    tdm_wrench *load = &task->load[b->body[l]];
    load->force = tdm_sub(load->force, force);
    load->moment = tdm_sub(load->moment, tdm_cross(b->lever[l], force));
    if (r.all_terms)
      push_wall_couples(task, b, l, force, (tdm_vec3){couple[0][l], couple[1][l], couple[2][l]});
  }
  task->touching += __builtin_popcount(vm_bits(c.touching));
  b->count = 0;
}

DEM_INLINE void close_entry(const dem_wall_contacts *list, size_t k, const int ncolumn) {
  for (int q = 0; q < ncolumn; q++)
    list->history[(size_t)q * list->capacity + k] = 0;
}

/* does this evaluation leave the particle's contacts with a body out? */
DEM_INLINE bool left_out(const dem_loop_task *task, const dem_sphere *s, int body) {
  if (task->share != DEM_ALL && (task->share == DEM_FAST) != (s->inverse_mass * task->model->multi_step.mass > 1))
    return true;
  return s->inverse_mass == 0 &&
         (task->settling || task->data->state.mobility[body].per_mass == 0); /* neither can move */
}

/* One contact of entry k, on the wall's surface at `gap` from the particle's centre, into the batch. */
DEM_KERNEL void add_to_batch(dem_loop_task *task, batch *b, size_t k, double gap, tdm_vec3 n, const row r) {
  const dem_model *m = task->model;
  dem_data *d = task->data;
  const dem_wall_contacts *list = &d->lists.walls;
  int i = list->entry[k].particle, w = list->entry[k].wall, body = m->wall[w].body, l = b->count++;
  const dem_sphere *s = &d->state.sphere[i];
  tdm_vec3 point = tdm_axpy(-gap, n, s->position), lever = tdm_sub(point, d->state.pose[body].position);
  tdm_twist now = d->state.twist[body];
  tdm_vec3 wall_v = tdm_add(now.velocity, tdm_cross(now.angular, lever));
  tdm_vec3 wall_w = now.angular;
  if (m->wall[w].moves && !task->settling) {
    wall_v = tdm_add(wall_v, dem_wall_surface(&m->wall[w], &d->state.wall[w], point, n));
    wall_w = tdm_add(wall_w, tdm_m3_mul(d->state.wall[w].axes, m->wall[w].surface.angular));
  }
  double arm = gap / s->radius;
  tdm_vec3 v = r.rubs ? tdm_axpy(-arm, tdm_cross(d->state.rotor[i].surface, n), s->velocity) : s->velocity;
  v = tdm_sub(v, wall_v);
  /* bodies are held while settling */
  double per_mass =
      task->settling ? s->inverse_mass : dem_per_effective_mass(&d->state.mobility[body], s->inverse_mass, lever, n);
  const double numbers[] = {n.x,       n.y,      n.z, s->radius - gap, v.x, v.y, v.z, tdm_dot(wall_w, n),
                            s->radius, per_mass, arm};
  for (int q = 0; q <= ARM; q++)
    b->number[q][l] = numbers[q];
  if (r.all_terms) {
    tdm_vec3 spin = tdm_axpy(1 / s->radius, d->state.rotor[i].surface, tdm_scale(-1, wall_w));
    b->number[SX][l] = spin.x, b->number[SY][l] = spin.y, b->number[SZ][l] = spin.z;
    b->number[PER_INERTIA][l] = s->inverse_mass / (1.4 * s->radius * s->radius);
    b->velocity[l] = wall_v;
    b->angular[l] = wall_w;
  }
#if DEM_LAW_NOTES
  b->number[SHIFT][l] = note_column(d, DEM_NOTE_SIDE)[dem_note_of_wall(d, k)];
#endif
  for (int q = 0; q < r.ncolumn; q++)
    b->history[q][l] = list->history[(size_t)q * list->capacity + k];
  b->entry[l] = (int)k;
  b->body[l] = body;
  b->index[l] = d->state.material[i] * m->nmaterial + m->wall[w].material;
  b->lever[l] = lever;
  if (b->count == DEM_W)
    r.flush(task, b);
}

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

DEM_INLINE vd row_dot(const double of[3], vd3 a) {
  return vd_set(of[0]) * a.x + vd_set(of[1]) * a.y + vd_set(of[2]) * a.z;
}

/* dem_mobility_along at DEM_W places of the plane, where the mobility is full: the same operations in the same order */
DEM_KERNEL vd along_plane(const plane_mobility *y, vd3 lever, vd3 n) {
  const tdm_mat3 *w = y->turning;
  vd3 a = vd3_cross(lever, n), mixed = {vd_set(y->mixed.x), vd_set(y->mixed.y), vd_set(y->mixed.z)};
  vd3 turned = vd3_add(mixed, (vd3){row_dot(w->m[0], a), row_dot(w->m[1], a), row_dot(w->m[2], a)});
  return vd_max(vd_set(y->straight) + vd3_dot(a, turned), vd_set(0));
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
  vd3 above = {s[0] - vd_set(on.x), s[1] - vd_set(on.y), s[2] - vd_set(on.z)};
  c->normal = (vd3){vd_set(normal.x), vd_set(normal.y), vd_set(normal.z)};
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
  c.normal = (vd3){vd_set(normal.x), vd_set(normal.y), vd_set(normal.z)};
  c.turn = vd_set(tdm_dot(now.angular, normal));
  const vd3 spin = {vd_set(now.angular.x), vd_set(now.angular.y), vd_set(now.angular.z)};
  const vd3 drift = {vd_set(now.velocity.x), vd_set(now.velocity.y), vd_set(now.velocity.z)};
  const plane_mobility mobility = plane_mobility_of(&d->state.mobility[body], task->settling, normal);
  tdm_wrench *load = &task->load[body];

  for (size_t k = begin; k < end; k += DEM_W) {
    int i[DEM_W];
    for (int l = 0; l < DEM_W; l++)
      i[l] = list->entry[k + (size_t)l].particle;
    vd s[8], b[4];
    vd_spheres(d->state.sphere, i, s);
    vd3 x = {s[0], s[1], s[2]};
    vd3 above = {x.x - vd_set(on.x), x.y - vd_set(on.y), x.z - vd_set(on.z)};
    vd gap = vd3_dot(above, c.normal), radius = s[3];
    c.touching = vm_and(vm_less(gap, radius), vm_less(-radius, gap));
    double *history = list->history + k;
    if (!vm_any(c.touching)) {
      close_history(history, list->capacity, r.ncolumn);
      continue;
    }
    vd3 velocity = {s[4], s[5], s[6]};
    vd3 lever = vd3_sub(vd3_axpy(-gap, c.normal, x), (vd3){vd_set(center.x), vd_set(center.y), vd_set(center.z)});
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
    c.inverse_mass = s[7] + (mobility.full ? along_plane(&mobility, lever, c.normal) : vd_set(mobility.straight));
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

/* ---- walls with parts: meshes ---- */

/* The entries of one particle with one wall, [begin, end), and those among them, ascending, that are contacts now. */
typedef struct {
  size_t begin, end;
  int n;
  size_t at[DEM_TOUCHES_MAX];
} touching_parts;

static bool holds(const touching_parts *now, size_t k) {
  for (int c = 0; c < now->n; c++)
    if (now->at[c] == k)
      return true;
  return false;
}

static bool has_history(const dem_wall_contacts *list, size_t k, int ncolumn) {
  for (int q = 0; q < ncolumn; q++)
    if (list->history[(size_t)q * list->capacity + k] != 0)
      return true;
  return false;
}

/* Hand the history of a contact that ended on a part to the one that begins on a neighbour. */
static void pass_histories(const dem_wall *wall, const dem_wall_contacts *list, const touching_parts *now,
                           int ncolumn) {
  for (int c = 0; c < now->n && ncolumn > 0; c++) {
    const size_t to = now->at[c];
    bool fresh = !has_history(list, to, ncolumn);
    for (size_t from = now->begin; from < now->end && fresh; from++) {
      if (!has_history(list, from, ncolumn) || holds(now, from) ||
          !wall->shape->passes(wall, list->entry[from].part, list->entry[to].part))
        continue;
      for (int q = 0; q < ncolumn; q++) {
        double *column = list->history + (size_t)q * list->capacity;
        column[to] = column[from];
        column[from] = 0;
      }
      fresh = false;
    }
  }
}

/* the contacts of one particle: entries begin ... end */
DEM_KERNEL void parts_of_one(dem_loop_task *task, batch *b, size_t begin, size_t end, const row r) {
  const dem_model *m = task->model;
  dem_data *d = task->data;
  const dem_wall_contacts *list = &d->lists.walls;
  int i = list->entry[begin].particle, w = list->entry[begin].wall;
  const dem_wall *wall = &m->wall[w];
  const dem_sphere *s = &d->state.sphere[i];
  if (left_out(task, s, wall->body))
    return;
  dem_touch found[DEM_TOUCHES_MAX];
  touching_parts now = {.begin = begin, .end = end};
  now.n = wall->shape->touches(wall, &list->entry[begin].part, DEM_PART_STRIDE, (int)(end - begin),
                               dem_wall_own(&d->state.wall[w], s->position), s->radius + (r.all_terms ? m->reach : 0),
                               found);
  size_t k = begin;
  for (int c = 0; c < now.n; c++) { /* both ascend */
    while (list->entry[k].part != found[c].part)
      k++;
    now.at[c] = k;
  }
  pass_histories(wall, list, &now, r.ncolumn);
  int next = 0;
  for (k = begin; k < end; k++) {
    if (next < now.n && now.at[next] == k)
      next++;
    else
      close_entry(list, k, r.ncolumn);
  }
  for (int c = 0; c < now.n; c++)
    add_to_batch(task, b, now.at[c], found[c].gap, tdm_m3_mul(d->state.wall[w].axes, found[c].normal), r);
}

DEM_KERNEL void wall_with_parts(dem_loop_task *task, batch *b, size_t begin, size_t end, const row r) {
  const dem_wall_contacts *list = &task->data->lists.walls;
  for (size_t k = begin, next; k < end; k = next) {
    next = k + 1;
    while (next < end && list->entry[next].particle == list->entry[k].particle)
      next++;
    parts_of_one(task, b, k, next, r);
  }
}

/* ---- all walls ---- */

DEM_KERNEL void wall_loop(dem_loop_task *task, const row constants) {
  const dem_model *m = task->model;
  const row r = row_of(m, constants);
  const dem_wall_contacts *list = &task->data->lists.walls;
  batch b = {0};
  for (int l = 0; l < DEM_W; l++) /* lanes that stay empty compute with harmless numbers */
    b.number[RADIUS][l] = b.number[PER_MASS][l] = b.number[OVERLAP][l] = b.number[PER_INERTIA][l] = 1;

  size_t last = task->wall_end;
  for (size_t k = task->wall_first, next; k < last; k = next) {
    const dem_wall *wall = &m->wall[list->entry[k].wall];
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
