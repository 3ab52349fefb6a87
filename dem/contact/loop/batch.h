/* Contacts with one wall, gathered until there are DEM_W of them, and the laws for such a batch. It serves all walls
 * but planes, which need no gathering. Only loops.h includes it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LOOP_BATCH_H
#define DEM_CONTACT_LOOP_BATCH_H

#include "dem/contact/loop/apply.h"

/* contacts of one wall, in the order of the list */
struct batch {
  int wall, count;
  int entry[DEM_W], particle[DEM_W];
  double gap[DEM_W], normal[3][DEM_W]; /* of the particle's centre from the surface [m]; towards it, world */
};

/* What of a batch's contacts the laws do not see. */
typedef struct {
  vd3 lever;                       /* of the contact point from the body's centre [m] */
  vd arm;                          /* gap / radius */
  vd3 velocity;                    /* of the particle against the wall, at the contact point [m/s] */
  vd3 wall_velocity, wall_angular; /* of the wall there, its belt's included [m/s], [rad/s] */
} batch_motion;

/* dem_mobility_along in the lanes, where the mobility is full, from n Y_vv n and 2 Y_wv n: the same operations in the
 * same order */
DEM_KERNEL vd full_mobility_along(vd straight, vd3 mixed, const tdm_mat3 *ww, vd3 lever, vd3 n) {
  vd3 a = vd3_cross(lever, n), turned = vd3_add(mixed, vd3_turn(ww, a));
  return vd_max(straight + vd3_dot(a, turned), vd_set(0));
}

/* dem_per_effective_mass in the lanes; bodies are held while settling */
DEM_KERNEL vd per_effective_mass(const dem_mobility *y, bool settling, vd inverse_mass, vd3 lever, vd3 n) {
  if (settling)
    return inverse_mass;
  vd along = vd_set(y->per_mass);
  if (y->full)
    along = full_mobility_along(vd3_dot(n, vd3_turn(&y->vv, n)), vd3_scale(vd_set(2), vd3_turn(&y->wv, n)), &y->ww,
                                lever, n);
  vd of_fixed = vd_max(along, vd_set(1e-3 * y->per_mass));
  return vd_pick(vm_less(vd_set(0), inverse_mass), inverse_mass + along, of_fixed);
}

/* what a wall's own motion, a belt, adds */
DEM_KERNEL void add_belt(const dem_data *d, const batch *b, batch_motion *of) {
  const dem_wall *wall = &d->model->wall[b->wall];
  const dem_wall_place *place = &d->state.wall[b->wall];
  double v[3][DEM_W];
  for (int l = 0; l < DEM_W; l++) {
    tdm_vec3 n = {b->normal[0][l], b->normal[1][l], b->normal[2][l]};
    tdm_vec3 point = tdm_axpy(-b->gap[l], n, d->state.sphere[b->particle[l]].position);
    tdm_vec3 belt = dem_wall_surface(wall, place, point, n);
    v[0][l] = belt.x, v[1][l] = belt.y, v[2][l] = belt.z;
  }
  of->wall_velocity = vd3_add(of->wall_velocity, (vd3){vd_load(v[0]), vd_load(v[1]), vd_load(v[2])});
  of->wall_angular = vd3_add(of->wall_angular, vd3_set(tdm_m3_mul(place->axes, wall->surface.angular)));
}

/* Lanes without a contact repeat the first one, and do not touch. */
DEM_KERNEL void batch_contact(const dem_loop_task *task, batch *b, const row r, dem_contact *c, batch_motion *of) {
  const dem_model *m = task->model;
  const dem_data *d = task->data;
  const dem_wall *wall = &m->wall[b->wall];
  const tdm_twist now = d->state.twist[wall->body];
  for (int l = b->count; l < DEM_W; l++) {
    b->entry[l] = b->entry[0], b->particle[l] = b->particle[0], b->gap[l] = b->gap[0];
    for (int a = 0; a < 3; a++)
      b->normal[a][l] = b->normal[a][0];
  }
  begin_contact(task, r, c);
  vd s[8], rotor[4], gap = vd_load(b->gap);
  vd_spheres(d->state.sphere, b->particle, s);
  c->touching = vm_first(b->count);
  c->normal = (vd3){vd_load(b->normal[0]), vd_load(b->normal[1]), vd_load(b->normal[2])};
  of->lever = vd3_sub(vd3_axpy(-gap, c->normal, (vd3){s[0], s[1], s[2]}), vd3_set(d->state.pose[wall->body].position));
  of->wall_angular = vd3_set(now.angular);
  of->wall_velocity = vd3_add(vd3_set(now.velocity), vd3_cross(of->wall_angular, of->lever));
  if (wall->moves && !task->settling)
    add_belt(d, b, of);
  of->arm = gap / s[3];
  of->velocity = (vd3){s[4], s[5], s[6]};
  c->overlap = s[3] - gap;
  c->radius = s[3];
  c->turn = vd3_dot(of->wall_angular, c->normal);
  if (r.rubs) {
    vd_rotor_sum(d->state.rotor, b->particle, b->particle, rotor);
    vd3 surface = vd3_scale(vd_set(0.5), (vd3){rotor[0], rotor[1], rotor[2]});
    of->velocity = vd3_axpy(-of->arm, vd3_cross(surface, c->normal), of->velocity);
    if (r.all_terms) {
      c->spin = vd3_axpy(vd_set(1) / c->radius, surface, vd3_scale(vd_set(-1), of->wall_angular));
      c->inverse_inertia = s[7] / (vd_set(1.4) * c->radius * c->radius);
    }
  }
  of->velocity = vd3_sub(of->velocity, of->wall_velocity);
  c->inverse_mass = per_effective_mass(&d->state.mobility[wall->body], task->settling, s[7], of->lever, c->normal);
  c->mass = vd_set(1) / c->inverse_mass;
  if (!c->pair.one)
    for (int l = 0; l < DEM_W; l++)
      c->pair.index[l] = d->state.material[b->particle[l]] * m->nmaterial + wall->material;
  if (DEM_LAW_SUMS > 0)
    c->radii[0] = c->radius, c->radii[1] = vd_set(INFINITY);
}

/* the sums of the particles of the batch and of its walls, which have none; what the notes of the others give */
DEM_INLINE void batch_load_sums(const dem_data *d, const batch *b, dem_contact *c, vd sums[2][DEM_LAW_SUMS + 1]) {
  load_sums(d, b->particle, sums[0]);
  for (int q = 0; q < DEM_LAW_SUMS; q++)
    sums[1][q] = vd_set(0);
  c->own_sums = sums[0], c->other_sums = sums[1];
#if DEM_LAW_NOTES
  c->shift = vd_lanes(note_column(d, DEM_NOTE_SIDE) + dem_note_of_wall(d, 0), b->entry);
#endif
}

/* columns `first` ... of the histories of the batch */
DEM_INLINE void batch_load_history(const dem_data *d, const batch *b, int first, int n, double (*history)[DEM_W]) {
  const dem_wall_contacts *list = &d->lists.walls;
  for (int q = 0; q < n; q++)
    vd_store(history[q], vd_lanes(list->history + (size_t)(first + q) * list->capacity, b->entry));
}

/* Forces on particles and wall, with all terms: contact after contact, couples after the rest of each, and the power of
 * the wall. */
DEM_KERNEL void push_wall_terms(dem_loop_task *task, const batch *b, const outcome *out, const batch_motion *of) {
  const dem_model *m = task->model;
  tdm_wrench *load = &task->load[m->wall[b->wall].body];
  vd3 moment = vd3_cross(of->lever, out->force), twist = vd3_scale(of->arm, out->twist);
  const vd3 column[] = {out->force, twist, moment, out->couple, of->wall_velocity, of->wall_angular};
  enum { FORCE, TWIST, MOMENT, COUPLE, VELOCITY, ANGULAR, COLUMNS };
  double lane[COLUMNS][3][DEM_W];
  for (int q = 0; q < COLUMNS; q++)
    vd_store(lane[q][0], column[q].x), vd_store(lane[q][1], column[q].y), vd_store(lane[q][2], column[q].z);
  for (int l = 0; l < b->count; l++) {
    tdm_vec3 at[COLUMNS];
    for (int q = 0; q < COLUMNS; q++)
      at[q] = (tdm_vec3){lane[q][0][l], lane[q][1][l], lane[q][2][l]};
    dem_push *push = &task->data->state.push[b->particle[l]];
    push->force = tdm_add(push->force, at[FORCE]);
    push->twist = tdm_add(push->twist, at[TWIST]);
    push->twist = tdm_axpy(-1 / task->data->state.sphere[b->particle[l]].radius, at[COUPLE], push->twist);
    load->force = tdm_sub(load->force, at[FORCE]);
    load->moment = tdm_sub(load->moment, at[MOMENT]);
    load->moment = tdm_sub(load->moment, at[COUPLE]);
    if (m->energy)
      task->flux.wall_power += tdm_dot(at[FORCE], at[VELOCITY]) + tdm_dot(at[COUPLE], at[ANGULAR]);
  }
}

/* Likewise without the terms. */
DEM_KERNEL void push_wall(dem_loop_task *task, const batch *b, vm touching, const outcome *out,
                          const batch_motion *of) {
  vd3 twist = vd3_only(touching, vd3_scale(of->arm, out->twist));
  vd3 moment = vd3_only(touching, vd3_cross(of->lever, out->force));
  vd_push_walls(task->data->state.push, b->particle, (vd[3]){out->force.x, out->force.y, out->force.z},
                (vd[3]){twist.x, twist.y, twist.z}, (vd[3]){moment.x, moment.y, moment.z},
                &task->load[task->model->wall[b->wall].body]);
}

/* the force of each entry of the batch on its particle */
DEM_KERNEL void keep_forces(const dem_loop_task *task, const batch *b, vd3 force) {
  double f[3][DEM_W];
  vd_store(f[0], force.x), vd_store(f[1], force.y), vd_store(f[2], force.z);
  for (int l = 0; l < b->count; l++)
    task->entry_force[b->entry[l]] = (tdm_vec3){f[0][l], f[1][l], f[2][l]};
}

DEM_KERNEL void wall_batch(dem_loop_task *task, batch *b, const row r) {
  dem_data *d = task->data;
  const dem_wall_contacts *list = &d->lists.walls;
  double history[DEM_HISTORY_MAX][DEM_W];
  batch_motion of;
  dem_contact c;
  batch_contact(task, b, r, &c, &of);
  vd sums[2][DEM_LAW_SUMS + 1];
  batch_load_sums(d, b, &c, sums);
  batch_load_history(d, b, 0, r.ncolumn, history);
  outcome out = law(task, &c, of.velocity, history[0], DEM_W, r, DEM_ENERGY_WALL_NORMAL);
  for (int q = 0; q < r.ncolumn; q++)
    for (int l = 0; l < b->count; l++)
      list->history[(size_t)q * list->capacity + (size_t)b->entry[l]] = history[q][l];
  if (task->entry_force)
    keep_forces(task, b, out.force);
  if (r.all_terms)
    push_wall_terms(task, b, &out, &of);
  else
    push_wall(task, b, c.touching, &out, &of);
  task->touching += __builtin_popcount(vm_bits(c.touching));
  b->count = 0;
}

/* One contact of entry k, on the wall's surface at `gap` from the particle's centre, into the batch. */
DEM_KERNEL void add_to_batch(dem_loop_task *task, batch *b, size_t k, double gap, tdm_vec3 n, const row r) {
  int l = b->count++;
  b->entry[l] = (int)k;
  b->particle[l] = task->data->lists.walls.entry[k].particle;
  b->gap[l] = gap;
  b->normal[0][l] = n.x, b->normal[1][l] = n.y, b->normal[2][l] = n.z;
  if (b->count == DEM_W)
    r.flush(task, b);
}

/* ---- what does not touch ---- */

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

#endif
