/* The loop over pairs of particles. Only loops.h includes it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LOOP_PAIR_LOOP_H
#define DEM_CONTACT_LOOP_PAIR_LOOP_H

#include "dem/contact/loop/apply.h"

/* relative spins and the rolling inertia of pairs; couples count with both of a pair only if one of them is asked for
 */
DEM_KERNEL void pair_spins(const dem_data *d, const int *i, const int *j, dem_contact *c) {
  double spin[3][DEM_W], inertia[DEM_W];
  for (int l = 0; l < DEM_W; l++) {
    const dem_rotor *a = &d->state.rotor[i[l]], *b = &d->state.rotor[j[l]];
    tdm_vec3 w = tdm_sub(tdm_scale(1 / a->radius, a->surface), tdm_scale(1 / b->radius, b->surface));
    spin[0][l] = w.x, spin[1][l] = w.y, spin[2][l] = w.z;
    inertia[l] = d->state.sphere[i[l]].inverse_mass / (1.4 * a->radius * a->radius) +
                 d->state.sphere[j[l]].inverse_mass / (1.4 * b->radius * b->radius);
  }
  c->spin = (vd3){vd_load(spin[0]), vd_load(spin[1]), vd_load(spin[2])};
  c->inverse_inertia = vd_load(inertia);
}

/* Forces, twists and couples of pairs, lane after lane: the torque of a couple is -radius x twist. One sum a particle
 * and pair, so that results do not depend on which pairs share a batch. */
DEM_KERNEL void push_couples(dem_data *d, const int *i, const int *j, const int *slot, unsigned touching, vd3 force,
                             vd3 twist, vd3 couple) {
  double f[3][DEM_W], t[3][DEM_W], m[3][DEM_W];
  vd_store(f[0], force.x), vd_store(f[1], force.y), vd_store(f[2], force.z);
  vd_store(t[0], twist.x), vd_store(t[1], twist.y), vd_store(t[2], twist.z);
  vd_store(m[0], couple.x), vd_store(m[1], couple.y), vd_store(m[2], couple.z);
  for (int l = 0; l < DEM_W; l++) {
    if (!(touching >> l & 1))
      continue;
    tdm_vec3 one = {f[0][l], f[1][l], f[2][l]}, sliding = {t[0][l], t[1][l], t[2][l]},
             turning = {m[0][l], m[1][l], m[2][l]};
    dem_push *a = &d->state.push[i[l]], *b = &d->state.push[slot[l]];
    a->force = tdm_add(a->force, one);
    b->force = tdm_sub(b->force, one);
    a->twist = tdm_add(a->twist, tdm_axpy(-1 / d->state.rotor[i[l]].radius, turning, sliding));
    b->twist = tdm_add(b->twist, tdm_axpy(1 / d->state.rotor[j[l]].radius, turning, sliding));
  }
}

/* fetch the partners to come; there is room behind the list */
DEM_INLINE void fetch_ahead(const dem_data *d, const int *j) {
  for (int l = 0; l < DEM_W; l++) {
    __builtin_prefetch(&d->state.sphere[j[l]]);
    __builtin_prefetch(&d->state.rotor[j[l]]);
    __builtin_prefetch(&d->state.push[j[l]], 1);
  }
}

/* To the nearest image, which moves along when the box is strained; s: columns of vd_sphere_difference. boxes: how many
 * boxes up the image is. */
DEM_INLINE void nearest_image(const dem_data *d, vd s[8], vd boxes[3]) {
  for (int a = 0; a < 3; a++) {
    if (!d->state.domain.periodic[a])
      continue;
    boxes[a] = vd_rint(s[a] * vd_set(1 / d->state.domain.length[a]));
    s[a] = s[a] - boxes[a] * vd_set(d->state.domain.length[a]);
    s[4 + a] = s[4 + a] - boxes[a] * vd_set(d->state.domain_rate[a]);
  }
}

/* power of the forces on moving images: what straining the box puts in */
DEM_INLINE void add_box_power(dem_loop_task *task, const vd boxes[3], vm touching, vd3 force) {
  const double *rate = task->data->state.domain_rate;
  vd3 speed = {boxes[0] * vd_set(rate[0]), boxes[1] * vd_set(rate[1]), boxes[2] * vd_set(rate[2])};
  double power[DEM_W];
  vd_store(power, vd_only(touching, vd3_dot(speed, force)));
  for (int l = 0; l < DEM_W; l++)
    task->flux.box_power += power[l];
}

/* How the contact point divides the distance r of the centres: as the radii do. */
typedef struct {
  vd share;   /* of each radius: arms r_i r / (r_i + r_j) */
  vd per_sum; /* 1 / (r_i + r_j) */
} pair_arms;

/* The contact of pairs with the differences s (vd_sphere_difference), in it x and its square r2, and the sum of radii:
 * all of it that does not depend on velocities. */
DEM_KERNEL pair_arms pair_geometry(const dem_data *d, const int *i, const int *j, const vd s[8], vd3 x, vd r2, vd sum,
                                   dem_contact *c) {
  const dem_model *m = c->model;
  /* one division for the three reciprocals of the distance, the sum of the radii and of the inverse masses */
  vd r = vd_sqrt(vd_max(r2, vd_set(1e-200))), both = r * sum;
  vd per_all = vd_set(1) / (both * s[7]), per_r = per_all * (sum * s[7]), per_sum = per_all * (r * s[7]);
  c->normal = vd3_scale(per_r, x);
  c->normal.z = vd_pick(vm_equal(r2, vd_set(0)), vd_set(1), c->normal.z); /* coincident centres: any direction */
  c->overlap = sum - r;
  c->radius = vd_set(0.25) * (sum * sum - s[3] * s[3]) * per_sum;
  c->inverse_mass = s[7];
  c->mass = per_all * both;
  if (!c->pair.one)
    for (int l = 0; l < DEM_W; l++)
      c->pair.index[l] = d->state.material[i[l]] * m->nmaterial + d->state.material[j[l]];
  if (DEM_LAW_SUMS > 0)
    c->radii[0] = vd_radii(d->state.sphere, i), c->radii[1] = vd_radii(d->state.sphere, j);
  return (pair_arms){r * per_sum, per_sum};
}

/* what the laws gave, on the particles and, with energies, into the balance */
DEM_KERNEL void push_pair(dem_loop_task *task, size_t k, const dem_contact *c, const outcome *out, vd share,
                          const vd boxes[3], const row constants) {
  const dem_model *m = task->model;
  dem_data *d = task->data;
  const dem_pairs *list = &d->lists.pairs;
  const int *i = list->one + k, *slot = list->reaction_slot + k;
  if (constants.all_terms && m->energy && m->domain.strained)
    add_box_power(task, boxes, c->touching, out->force);
  vd force[3] = {out->force.x, out->force.y, out->force.z};
  vd3 twist = vd3_scale(share, out->twist);
  if (constants.all_terms && m->couples)
    push_couples(d, i, list->other + k, slot, vm_bits(c->touching), out->force, twist, out->couple);
  else if (constants.rubs)
    vd_push_pairs(d->state.push, i, slot, force, (vd[3]){twist.x, twist.y, twist.z});
  else
    vd_push_forces(d->state.push, i, slot, force);
}

DEM_KERNEL void pair_loop(dem_loop_task *task, const row constants) {
  const dem_model *m = task->model;
  const row law_row = row_of(m, constants);
  const int ncolumn = law_row.ncolumn;
  dem_data *d = task->data;
  const dem_pairs *list = &d->lists.pairs;
  const dem_sphere *sphere = d->state.sphere;
  const dem_rotor *rotor = d->state.rotor;
  dem_contact c = contact_of(task, constants);
  const vd reach = vd_set(constants.all_terms ? m->reach : 0);
  const bool repeats = m->domain.repeats, shared = constants.all_terms && task->share != DEM_ALL;
  const bool many = d->state.nparticle > 20000; /* more than a cache of the second level holds */
  long touching = 0;

  for (size_t k = list->chunk[task->chunk]; k < list->chunk[task->chunk + 1]; k += DEM_W) {
    const int *i = list->one + k, *j = list->other + k;
    if (many)
      fetch_ahead(d, j + 2 * DEM_W);
    vd boxes[3] = {vd_set(0), vd_set(0), vd_set(0)};
    vd s[8], b[4] = {vd_set(0), vd_set(0), vd_set(0), vd_set(0)};
    vd_sphere_difference(sphere, i, j, s);
    if (constants.rubs)
      vd_rotor_sum(rotor, i, j, b);
    else
      b[3] = vd_radii(sphere, i) + vd_radii(sphere, j);
    if (repeats)
      nearest_image(d, s, boxes);
    vd3 x = {s[0], s[1], s[2]};
    vd r2 = vd3_dot(x, x), sum = b[3], far = sum;
    if (constants.all_terms)
      far = far + reach;
    c.touching = vm_less(r2, far * far);
    vm own = c.touching;
    vd kept[DEM_HISTORY_MAX];
    if (shared) { /* the histories of the other contacts stay */
      vm fast = vm_less(vd_set(1 / m->multi_step.mass), s[7]), all = vm_first(DEM_W);
      own = task->share == DEM_FAST ? fast : vm_without(all, fast);
      c.touching = vm_and(c.touching, own);
      if (!vm_any(own))
        continue;
      for (int q = 0; q < ncolumn; q++)
        kept[q] = vd_load(list->history + (size_t)q * list->capacity + k);
    }
    if (!shared && !vm_any(c.touching)) {
      close_history(list->history + k, list->capacity, ncolumn);
      continue;
    }
    pair_arms arms = pair_geometry(d, i, j, s, x, r2, sum, &c);
    vd3 surface = {b[0], b[1], b[2]}, velocity = {s[4], s[5], s[6]};
    c.turn = vd3_dot(surface, c.normal) * arms.per_sum;
    if (constants.rubs)
      velocity = vd3_axpy(-arms.share, vd3_cross(surface, c.normal), velocity);
    if (constants.all_terms)
      pair_spins(d, i, j, &c);
    vd sums[2][DEM_LAW_SUMS + 1];
    load_sums(d, i, sums[0]);
    load_sums(d, j, sums[1]);
    c.own_sums = sums[0], c.other_sums = sums[1];
    if (DEM_LAW_NOTES)
      c.shift = vd_load(note_column(d, DEM_NOTE_SIDE) + k) + vd_load(note_column(d, DEM_NOTE_OTHER) + k);
    if (!constants.all_terms)
      touching += __builtin_popcount(vm_bits(c.touching));
    outcome out = law(task, &c, velocity, list->history + k, list->capacity, law_row, 0);
    for (int q = 0; shared && q < ncolumn; q++) {
      double *history = list->history + (size_t)q * list->capacity + k;
      vd_store(history, vd_pick(own, vd_load(history), kept[q]));
    }
    if (constants.all_terms) /* cohesion may have opened some */
      touching += __builtin_popcount(vm_bits(c.touching));
    push_pair(task, k, &c, &out, arms.share, boxes, constants);
  }
  task->touching += touching;
}

#endif
