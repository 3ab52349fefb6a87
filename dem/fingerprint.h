/* Numbers that change when what a stored state depends on does. What a new law, shape or key adds to a scene is to be
 * hashed here. */
#ifndef DEM_FINGERPRINT_H
#define DEM_FINGERPRINT_H

#include "dem/model.h"

/* What decides the settled bed: materials, pairs while settling, contact laws, walls, poses, particles with their body
 * forces, what is poured, gravity, domain, dimension, settle keys. Not time.dt, the coupling, restitution and friction
 * of the run, sources, sinks, the integrator. */
uint64_t dem_fingerprint_bed(const dem_model *model);

/* What a state must share with a scene that starts from it (dem.start): contact laws, elastic constants, shapes,
 * periodic directions. */
uint64_t dem_fingerprint_start(const dem_model *model);

/* What decides how a run goes on, but time.dt: the bed's, and pairs, sources, number and size classes of the sinks,
 * integrator. */
uint64_t dem_fingerprint_whole(const dem_model *model);

#endif
