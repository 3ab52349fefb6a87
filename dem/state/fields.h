/* The members of the state, in lists from which copying, storing, restoring, reordering and their tests are made. A new
 * member of dem_state needs its row here and nothing else.
 *
 * `d` is the dem_data at hand; nb, nw, nl, np the numbers of its bodies, walls, loads and particles.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_STATE_FIELDS_H
#define DEM_STATE_FIELDS_H

/* Arrays of particles: X(member, entries a particle, name of the section in stored states). */
#define DEM_PARTICLE_STATE(X)                             \
  X(state.sphere, 1, "sphere")                            \
  X(state.rotor, 1, "rotor")                              \
  X(state.pace, 1, "pace")                                \
  X(lists.position_at_list, 1, "position_at_list")        \
  X(state.mass, 1, "mass")                                \
  X(state.material, 1, "kind")                            \
  X(state.id, 1, "id")                                    \
  X(state.touched, 1, "touched")                          \
  X(state.held, d->model->ncontainer > 0, "held")         \
  X(state.drive, d->model->driven, "drive")               \
  X(state.memory, d->model->remembers, "memory")          \
  X(state.orientation, d->model->oriented, "orientation") \
  X(state.spot, d->model->screening.watched, "spot")      \
  X(state.front, d->model->nwall, "front")

/* Sums of contacts, which have memory of their own: X(member, name of the section); NULL where there is none. */
#define DEM_FORCE_STATE(X) \
  X(state.push, "push")    \
  X(state.spare_push, "spare_push")

/* Arrays whose sizes the model fixes, one after the other in a block that is stored as it is: X(member, entries). Some
 * are of the lists or the workspace; they are made anew before they are read. */
#define DEM_FIXED_STATE(X)                         \
  X(state.pose, nb)                                \
  X(state.twist, nb)                               \
  X(state.body_load, nl)                           \
  X(state.mobility, nb)                            \
  X(lists.pose_at_list, nb)                        \
  X(lists.margin, nb)                              \
  X(lists.reach, nb)                               \
  X(work.fast_load, nl)                            \
  X(state.wall, nw)                                \
  X(state.lid, nw)                                 \
  X(state.sample_sum, nl + 1)                      \
  X(state.sample_mean, nl + 1)                     \
  X(state.source, (size_t)d->model->nsource)       \
  X(state.sink, (size_t)d->model->nsink)           \
  X(state.container, (size_t)d->model->ncontainer) \
  X(state.traced, (size_t)d->model->ntrace)        \
  X(state.deck, (size_t)d->model->screening.ndeck) \
  X(state.screening, d->model->screening.ndeck > 0 ? 1 : 0)

/* Numbers and records, in the order in which they are stored: X(object, member, type in stored states: as large as the
 * member or larger). */
#define DEM_NUMBER_STATE(X)                    \
  X(state, nstep, uint64_t)                    \
  X(state, since_sort, uint64_t)               \
  X(state, ncontact, uint64_t)                 \
  X(state, sample_steps, double)               \
  X(state, restart, uint64_t)                  \
  X(state, strain_steps, uint64_t)             \
  X(lists, skin, double)                       \
  X(state, memory_dt, double)                  \
  X(state, strained, double)                   \
  X(state, strain_dt, double)                  \
  X(state, ledger, dem_ledger)                 \
  X(state, energy_balance, dem_energy_balance) \
  X(state, guard, dem_guard_state)             \
  X(state, energy, dem_energy)

/* What follows from the others (dem_domain_put), and what the head of a stored state has: copied, but not stored here:
 * X(object, member). */
#define DEM_DERIVED_STATE(X) \
  X(state, nparticle)        \
  X(state, domain)           \
  X(state, domain_rate)

/* Numbers of the lists, which a copy takes as they are: X(object, member). */
#define DEM_LIST_NUMBERS(X) \
  X(lists, nchunk)          \
  X(lists, mean_radius)     \
  X(lists, valid)           \
  X(lists, stale)           \
  X(lists, nrebuild)        \
  X(lists, since_list)      \
  X(lists, length_at_list)  \
  X(lists, home)

#endif
