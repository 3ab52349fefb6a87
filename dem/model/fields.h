/* The members of the model, struct by struct, in lists from which the fingerprints are made (store/fingerprint.c). A
 * new member needs its row here: without one test_dem_fingerprint fails.
 *
 * H(member, how, part): it is hashed. `how` is one of the AS_ macros of fingerprint.c; `part` the part of the bed that
 * it decides (DEM_BED_PART_LIST), RUN for what decides only the run, EACH for what has members of several parts. The
 * order of the rows is that of hashing, so changing it makes other fingerprints.
 * F(member, why): it is free to differ, as it decides no state, or others that are hashed decide it.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_MODEL_FIELDS_H
#define DEM_MODEL_FIELDS_H

#define DEM_MODEL_FIELDS(H, F)                               \
  H(normal, LAW, LAWS)                                       \
  H(wall_normal, WALL_LAW, LAWS)                             \
  H(tangential, LAW, LAWS)                                   \
  H(rolling, LAW, LAWS)                                      \
  H(twisting, LAW, LAWS)                                     \
  H(cohesion, LAW, LAWS)                                     \
  H(multi, OPTION_LAW, LAWS)                                 \
  H(multi_setting, MULTI_SETTING, LAWS)                      \
  H(clip, TAIL, LAWS)                                        \
  H(normal_setting, BYTES, LAWS)                             \
  H(flat, FLAT, BOX)                                         \
  H(flat_at, FLAT, BOX)                                      \
  H(domain, DOMAIN, EACH)                                    \
  H(settle, SETTLING, EACH)                                  \
  H(gravity, BYTES, GRAVITY)                                 \
  H(nmaterial, NUMBER, SHAPES)                               \
  H(nbody, NUMBER, SHAPES)                                   \
  H(nwall, NUMBER, SHAPES)                                   \
  H(material, MATERIALS, EACH)                               \
  H(body, BODIES, EACH)                                      \
  H(wall, WALLS, EACH)                                       \
  H(box, BOXES, EACH)                                        \
  H(settle_pair, PAIRS, PAIRS)                               \
  H(pair, PAIRS, RUN)                                        \
  H(group, GROUPS, EACH)                                     \
  H(pouring, POURINGS, EACH)                                 \
  H(nparticle, NUMBER, PARTICLES)                            \
  H(radius, PARTICLES, PARTICLES)                            \
  H(mass, PARTICLES, PARTICLES)                              \
  H(particle_material, PARTICLES, PARTICLES)                 \
  H(position, PARTICLES, PARTICLES)                          \
  H(velocity, PARTICLES, PARTICLES)                          \
  H(spin, PARTICLES, PARTICLES)                              \
  H(oriented, OPTION, PARTICLES)                             \
  H(unturned, OPTION, PARTICLES)                             \
  H(still, OPTIONAL, PARTICLES)                              \
  H(orientation, OPTIONAL, PARTICLES)                        \
  H(integrator, NAME, RUN)                                   \
  H(multi_step, MULTI_STEP, RUN)                             \
  H(wall_mass, NUMBER, RUN)                                  \
  H(ncoupled, NUMBER, RUN)                                   \
  H(nload, NUMBER, RUN)                                      \
  H(nsource, NUMBER, RUN)                                    \
  H(source, SOURCES, EACH)                                   \
  H(nsink, NUMBER, RUN)                                      \
  H(sink, SINKS, EACH)                                       \
  H(ncontainer, NUMBER, RUN)                                 \
  H(container, CONTAINERS, EACH)                             \
  H(screening, SCREENING, RUN)                               \
  H(ntrace, OPTION_NUMBER, RUN)                              \
  H(trace, TRACES, RUN)                                      \
  H(slices, OPTION_NUMBER, PARTICLES)                        \
  F(dt, "a state may go on with another step")               \
  F(proxy, "of the coupling")                                \
  F(time_start, "of the simulation")                         \
  F(time_end, "of the simulation")                           \
  F(interpolation, "of the coupling")                        \
  F(simd, "results have the same bits")                      \
  F(threads, "results have the same bits")                   \
  F(ranks, "results have the same bits")                     \
  F(search, "results have the same bits")                    \
  F(balance, "results have the same bits")                   \
  F(skin, "results have the same bits")                      \
  F(mean_radius, "for the skin")                             \
  F(largest_radius, "follows from the radii")                \
  F(first_here, "others are on their ranks")                 \
  F(end_here, "others are on their ranks")                   \
  F(loops, "follow from the laws")                           \
  F(wall_loops, "follow from the laws")                      \
  F(sum_loops, "follow from the laws")                       \
  F(nsum, "follows from the laws")                           \
  F(noting, "follows from the laws")                         \
  F(all_terms, "results have the same bits")                 \
  F(place, "follows from the laws")                          \
  F(couples, "follows from the laws")                        \
  F(columns, "follow from the laws and pairs")               \
  F(reach, "follows from the pairs")                         \
  F(energy, "an output")                                     \
  F(geometry_loads, "an output; nload counts them")          \
  F(triangle_forces, "an output")                            \
  F(ntriangle, "for an output")                              \
  F(first_triangle, "for an output")                         \
  F(guard, "watches, and changes nothing")                   \
  F(expected_speed, "for limits that are told")              \
  F(remembers, "follows from the integrator")                \
  F(settler, "always the same")                              \
  F(driven, "follows from flat, unturned, the groups")       \
  F(fixes, "follows from the groups")                        \
  F(start, "names the particles' state, which goes its way") \
  F(ndriven, "follows from the bodies")                      \
  F(coupled_body, "follows from the bodies")                 \
  F(ngeometry, "the walls are hashed")                       \
  F(geometry, "the walls are hashed")                        \
  F(ngroup, "each is hashed")                                \
  F(npouring, "each is hashed")                              \
  F(npoured, "follows from the pourings")                    \
  F(nbox, "each is hashed")

#define DEM_MATERIAL_FIELDS(H, F) \
  H(young, NUMBER, MATERIALS)     \
  H(poisson, NUMBER, MATERIALS)   \
  H(density, NUMBER, RUN)         \
  H(product, OPTION, RUN)         \
  F(name, "known by its number")  \
  F(shear, "follows from the others")

/* of pairs that the scene has; `given` of all */
#define DEM_PAIR_FIELDS(H, F)      \
  H(restitution, NUMBER, EACH)     \
  H(friction, NUMBER, EACH)        \
  H(static_friction, NUMBER, EACH) \
  H(floor, NUMBER, EACH)           \
  H(effective_young, NUMBER, EACH) \
  H(effective_shear, NUMBER, EACH) \
  H(stiffness, NUMBER, EACH)       \
  H(beta, NUMBER, EACH)            \
  H(normal_damping, NUMBER, EACH)  \
  H(viscosity, NUMBER, EACH)       \
  H(normal, BYTES, EACH)           \
  H(tangential, BYTES, EACH)       \
  H(rolling, BYTES, EACH)          \
  H(twisting, BYTES, EACH)         \
  H(cohesion, BYTES, EACH)         \
  H(multi, OPTION_BYTES, EACH)     \
  F(law, "follows from the laws")  \
  F(given, "hashed of every pair")

/* Bodies are held while settling: a bed is one also for other masses and motions. */
#define DEM_BODY_FIELDS(H, F)    \
  H(material, NUMBER, MATERIALS) \
  H(start, POSE, POSES)          \
  H(coupled, NUMBER, RUN)        \
  H(mass, NUMBER, RUN)           \
  H(drive, DRIVE, RUN)           \
  F(name, "known by its number")

#define DEM_DRIVE_FIELDS(H, F) \
  H(given, NUMBER, RUN)        \
  H(velocity, BYTES, RUN)      \
  H(angular, BYTES, RUN)       \
  H(center, BYTES, RUN)        \
  H(amplitude, BYTES, RUN)     \
  H(swing, BYTES, RUN)         \
  H(start, NUMBER, RUN)        \
  H(end, NUMBER, RUN)

/* PLACED: not of lids, which are away while settling. Belts rest meanwhile. */
#define DEM_WALL_FIELDS(H, F)                  \
  H(shape, SHAPE, SHAPES)                      \
  H(body, NUMBER, SHAPES)                      \
  H(point, BYTES, PLACED)                      \
  H(normal, BYTES, PLACED)                     \
  H(half, BYTES, PLACED)                       \
  H(radius, BYTES, PLACED)                     \
  H(length, NUMBER, PLACED)                    \
  H(inside, NUMBER, PLACED)                    \
  H(turn, BYTES, PLACED)                       \
  H(data, SHAPE_DATA, PLACED)                  \
  H(surface, BYTES, RUN)                       \
  H(material, OF_SHAPE, MATERIALS)             \
  F(geometry, "of the shapes, which have all") \
  F(endless, "follows from the sizes")         \
  F(solid, "for limits that are told")         \
  F(plates, "for what is told")                \
  F(moves, "follows from surface")

#define DEM_BOX_FIELDS(H, F)                \
  H(lid, NUMBER, SHAPES)                    \
  H(gap, NUMBER, SHAPES)                    \
  H(press, NUMBER, SHAPES)                  \
  F(body, "of its walls, which are hashed") \
  F(center, "of its walls")                 \
  F(turn, "of its walls")                   \
  F(half, "of its walls")                   \
  F(first_wall, "the walls are in order")   \
  F(nwall, "the walls are in order")        \
  F(unsaid, "for what is told")

/* AXIS: of each axis in turn */
#define DEM_DOMAIN_FIELDS(H, F)          \
  H(periodic, AXIS, BOX)                 \
  H(low, AXIS, BOX)                      \
  H(length, AXIS, BOX)                   \
  H(rate, AXIS, RUN)                     \
  F(wanted, "nothing is hashed without") \
  F(repeats, "follows from periodic")    \
  F(open, "follows from periodic")       \
  F(strained, "follows from rate")

#define DEM_SETTLING_FIELDS(H, F)             \
  H(speed, NUMBER, SETTLE)                    \
  H(max_time, NUMBER, SETTLE)                 \
  H(dt, NUMBER, SETTLE)                       \
  H(drag, NUMBER, SETTLE)                     \
  F(wanted, "a bed is for those who want it") \
  F(store, "where, not what")

#define DEM_GROUP_FIELDS(H, F) \
  H(first, NUMBER, GROUPS)     \
  H(count, NUMBER, GROUPS)     \
  H(fixed, NUMBER, GROUPS)     \
  H(force, BYTES, GROUPS)      \
  H(acceleration, BYTES, GROUPS)

#define DEM_POURING_FIELDS(H, F) \
  H(first, NUMBER, POURED)       \
  H(count, NUMBER, POURED)       \
  H(largest, NUMBER, POURED)     \
  H(seed, BYTES, POURED)         \
  H(frame, BYTES, POURED)        \
  H(low, BYTES, POURED)          \
  H(high, BYTES, POURED)         \
  F(entry, "for messages")

#define DEM_SOURCE_FIELDS(H, F) \
  H(material, NUMBER, RUN)      \
  H(mass, NUMBER, RUN)          \
  H(rate, NUMBER, RUN)          \
  H(mass_rate, NUMBER, RUN)     \
  H(start, NUMBER, RUN)         \
  H(end, NUMBER, RUN)           \
  H(factor, NUMBER, RUN)        \
  H(relative, NUMBER, RUN)      \
  H(count, BYTES, RUN)          \
  H(total_mass, NUMBER, RUN)    \
  H(sizes, SIZES, RUN)          \
  H(low, BYTES, RUN)            \
  H(high, BYTES, RUN)           \
  H(velocity, BYTES, RUN)       \
  H(seed, BYTES, RUN)           \
  F(name, "known by its number")

#define DEM_SIZES_FIELDS(H, F) \
  H(distribution, NUMBER, RUN) \
  H(min, NUMBER, RUN)          \
  H(max, NUMBER, RUN)          \
  H(mean, NUMBER, RUN)         \
  H(deviation, NUMBER, RUN)    \
  H(nradius, NUMBER, RUN)      \
  H(total, NUMBER, RUN)        \
  H(radius, BYTES, RUN)        \
  H(upto, BYTES, RUN)

#define DEM_CONTAINER_FIELDS(H, F) \
  H(frame, NUMBER, RUN)            \
  H(low, BYTES, RUN)               \
  H(high, BYTES, RUN)              \
  H(jam_time, NUMBER, RUN)         \
  H(jam_start, NUMBER, RUN)        \
  F(name, "known by its number")

#define DEM_SINK_FIELDS(H, F) \
  H(type, NUMBER, RUN)        \
  H(body, NUMBER, RUN)        \
  H(frame, NUMBER, RUN)       \
  H(low, BYTES, RUN)          \
  H(high, BYTES, RUN)         \
  H(point, BYTES, RUN)        \
  H(normal, BYTES, RUN)       \
  H(across, BYTES, RUN)       \
  H(radius, BYTES, RUN)       \
  H(angle, BYTES, RUN)        \
  H(height, BYTES, RUN)       \
  H(nedge, NUMBER, RUN)       \
  H(edge, BYTES, RUN)         \
  F(name, "known by its number")

/* only of scenes that have it */
#define DEM_SCREENING_FIELDS(H, F)     \
  H(ndeck, NUMBER, RUN)                \
  H(deck, DECKS, RUN)                  \
  H(deck_of, BYTES, RUN)               \
  H(start, NUMBER, RUN)                \
  H(smoothing, NUMBER, RUN)            \
  F(watched, "follows from the decks") \
  F(every, "follows from the decks and the step")

#define DEM_DECK_FIELDS(H, F)         \
  H(sorted, NUMBER, RUN)              \
  H(screen, NUMBER, RUN)              \
  H(blocking_time, NUMBER, RUN)       \
  F(holes, "follows from the screen") \
  F(name, "known by its number")

#define DEM_TRACE_FIELDS(H, F) \
  H(source, NUMBER, RUN)       \
  H(particle, BYTES, RUN)      \
  F(body, "for an output")     \
  F(name, "for an output")

#endif
