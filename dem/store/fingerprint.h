/* Numbers that change when what a stored state depends on does: the members of the model that model/fields.h names, and
 * what the shapes say of their own data. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_STORE_FINGERPRINT_H
#define DEM_STORE_FINGERPRINT_H

#include "dem/model/model.h"

/* What decides the settled bed, part by part: name in C, what differs when it does. Not time.dt, the coupling, speeds
 * of bodies and belts (they are held while settling), restitution and friction of the run, sources, sinks, the
 * integrator. */
#define DEM_BED_PART_LIST(X)                                        \
  X(LAWS, "dem.contact")                                            \
  X(BOX, "dem.domain or dem.dimension")                             \
  X(SETTLE, "dem.settle (speed, max_time, dt or drag)")             \
  X(GRAVITY, "gravity")                                             \
  X(MATERIALS, "dem.materials")                                     \
  X(PAIRS, "dem.pairs while settling")                              \
  X(POSES, "poses of bodies at the start")                          \
  X(SHAPES, "shapes of bodies")                                     \
  X(POURED, "what is poured")                                       \
  X(PARTICLES, "particles (number, sizes, masses, start or order)") \
  X(GROUPS, "forces on particles")

#define X(part, name) DEM_BED_##part,
enum { DEM_BED_PART_LIST(X) DEM_BED_PARTS };
#undef X
extern const char *const dem_bed_part_names[];

void dem_fingerprint_bed_parts(const dem_model *model, uint64_t part[DEM_BED_PARTS]);

/* All of these parts. */
uint64_t dem_fingerprint_bed(const dem_model *model);

/* What a state must share with a scene that starts from it (dem.start): contact laws, elastic constants, shapes,
 * periodic directions. */
uint64_t dem_fingerprint_start(const dem_model *model);

/* What decides how a run goes on, but time.dt: the bed's, and pairs, belts, masses and motions of bodies, sources,
 * sinks, integrator. */
uint64_t dem_fingerprint_whole(const dem_model *model);

#endif
