/* What the ranks of a run (base/ranks.h) tell each other of the state.
 *
 * Each rank works on its home: a run of whole chunks, whose particles it moves, lists and evaluates. Arrays have places
 * for the particles of all ranks, and lists are laid out as those of all chunks, but only what is of the home, or
 * visits it, is there and takes memory (exchange/keep.h). What is decided for all (when lists are built, what sources
 * and sinks do) every rank decides alike. In a step, in the words of [A07] Section 3.5,
 *
 *   immigrants   home particles that a contact of another rank names: their places and velocities go there, where they
 *                are visitors
 *   returned     the reactions on visitors, each in its place between the chunks (crossings.h), go home and are added
 *                there in the order of a run of one process
 *   sums         loads and energies of all chunks go to all ranks, which add them in the order of the chunks
 *
 * so that the bits are those of one process. With the numbers of a later chunk behind those of an earlier one, visitors
 * come from ranks behind and reactions return there, as in [A07]. Homes are as long as makes the measured times of
 * their chunks alike, if the scene asks for that (dem.decomposition.balance). Whoever reads more of particles that are
 * not at home asks for it first: dem_unite makes whole arrays the same on all ranks. What goes from home to home when
 * lists are built is in exchange/. In a process that is alone all of this is nothing.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SEAM_HOMES_H
#define DEM_SEAM_HOMES_H

#include "dem/state/data.h"
#include "protocol/base/log.h"
#include "protocol/wire/participant.h"

#include <math.h>

/* What can be the same on all ranks. */
enum {
  DEM_PLACES = 1,   /* sphere, rotor */
  DEM_MOTION = 2,   /* the other arrays of particles (DEM_PARTICLE_STATE) */
  DEM_FORCES = 4,   /* DEM_FORCE_STATE */
  DEM_CONTACTS = 8, /* histories, notes, sums of laws */
  DEM_LISTS = 16,   /* entries of pairs and walls */
  DEM_STATE = 15,
  DEM_WHOLE = 31,
  DEM_ON_FIRST = 8 /* bits up: rank 0 has it, too */
};

static inline bool dem_alone(const dem_data *d) {
  return !d->work.homes.ranks;
}

/* The chunk before which such a share of all chunks lies. */
static inline int dem_chunk_of_share(int nchunk, double share) {
  const double round_off = 1e-6;
  return (int)ceil(nchunk * share - round_off);
}

/* Where the homes of so many ranks begin at the start, as shares of the chunks. */
static inline double dem_home_at_start(int rank, int size) {
  return (double)rank / size;
}

/* The first of n particles of a rank's home at the start; of rank `size` n. */
static inline int dem_first_at_start(int n, int rank, int size) {
  const int nchunk = dem_chunks(n), c = dem_chunk_of_share(nchunk, dem_home_at_start(rank, size));
  return c < nchunk ? c * DEM_CHUNK : n;
}

/* First chunk of a rank's home; of rank `size` the number of chunks. */
static inline int dem_chunk_of_rank(const dem_data *d, int rank) {
  return dem_chunk_of_share(d->lists.nchunk, d->lists.home[rank]);
}

/* Home chunks: from the first to before the end; all of them in a process that is alone. */
static inline int dem_home_first(const dem_data *d) {
  return dem_alone(d) ? 0 : dem_chunk_of_rank(d, d->work.homes.ranks->rank);
}

static inline int dem_home_end(const dem_data *d) {
  return dem_alone(d) ? d->lists.nchunk : dem_chunk_of_rank(d, d->work.homes.ranks->rank + 1);
}

/* First particle of a chunk; of one behind the last the number of particles, newcomers included. */
static inline int dem_chunk_start(const dem_data *d, int chunk) {
  return chunk < d->lists.nchunk ? chunk * DEM_CHUNK : d->state.nparticle;
}

/* Home particles: from the first to before the end. */
static inline int dem_home_first_particle(const dem_data *d) {
  return dem_alone(d) ? 0 : dem_chunk_start(d, dem_home_first(d));
}

static inline int dem_home_end_particle(const dem_data *d) {
  return dem_alone(d) ? d->state.nparticle : dem_chunk_start(d, dem_home_end(d));
}

/* Work on each home chunk, on all threads: chunks do not touch each other's. One thread does not start OpenMP, which
 * takes as long as some ten contacts. */
typedef void dem_chunk_work(dem_data *data, int chunk, void *context);
void dem_each_chunk(dem_data *data, dem_chunk_work *work, void *context);

/* Zeros, on all threads. */
void dem_zero(const dem_data *data, void *array, size_t bytes);

/* Begin to share what is the same on all ranks now; NULL: stay alone. */
void dem_homes_begin(dem_data *data, const dem_ranks *ranks);

/* What is said here of other ranks' particles (DEM_PLACES ...) is no longer true: each rank changed its own. */
static inline void dem_parted(dem_data *d, unsigned what) {
  d->work.homes.united &= ~(what | what << DEM_ON_FIRST);
}

/* All is the same on all ranks now: each has read it. */
static inline void dem_united(dem_data *d) {
  d->work.homes.united = DEM_WHOLE | DEM_WHOLE << DEM_ON_FIRST;
  d->work.homes.spread = true;
}

/* What chunks cost is measured anew from this step on: where the run goes on at another step or with other homes. */
void dem_homes_measure(dem_data *data);

/* The data was copied from what each rank kept: each has its home's. */
static inline void dem_homes_restored(dem_data *d) {
  dem_parted(d, DEM_WHOLE);
  d->work.homes.planned = false;
  d->work.homes.spread = true;
  dem_homes_measure(d);
}

/* Make this the same on all ranks: what is there of a particle or contact is what its home has. */
void dem_unite(dem_data *data, unsigned what);

/* Likewise on rank 0 alone, which writes states and finds contacts to be seen; the others keep what they have. */
void dem_collect(dem_data *data, unsigned what);

/* Likewise an array with an entry of `size` bytes a particle, a chunk, or for each entry of a list (chunk: as below).
 */
void dem_unite_particles(dem_data *data, void *array, size_t size);
void dem_unite_chunks(dem_data *data, void *array, size_t size);
void dem_unite_entries(dem_data *data, void *array, size_t size, const size_t *chunk);

/* Lay out a list of all chunks: chunk (nchunk + 1) has the number of entries of each home chunk, and becomes the first
 * entry of each chunk, of all, and their number. */
void dem_lay_out(dem_data *data, size_t *chunk);

/* The largest of all ranks' numbers, the smallest, the largest of each of n. */
double dem_homes_largest(const dem_data *data, double x);
static inline double dem_homes_smallest(const dem_data *d, double x) {
  return -dem_homes_largest(d, -x);
}
void dem_homes_largest_of(const dem_data *data, double *x, int n);

/* n records of each rank, of `size` bytes, on all ranks: one rank's behind the other's, `*all` of them. The caller's to
 * free. */
void *dem_homes_join(const dem_data *data, const void *own, int n, size_t size, int *all);

/* Each rank's number, on all ranks: all (ranks). */
void dem_homes_number(const dem_data *data, long x, long *all);

/* The sum of all ranks' numbers; is something so on any rank? */
long dem_homes_sum(const dem_data *data, long x);
bool dem_homes_any(const dem_data *data, bool here);

/* Does this rank write what all have? */
static inline bool dem_homes_writes(const dem_data *d) {
  return dem_alone(d) || d->work.homes.ranks->rank == 0;
}

/* tdm_participant_alive with one answer for all ranks: that of the last step. */
tdm_status dem_homes_alive(dem_data *data, tdm_participant *participant);

/* ---- times of chunks, for balance (exchange/balance.h) ---- */

/* The clock that chunks are measured with [s]: tdm_clock; tests have another one, by which homes move often. */
extern double (*dem_homes_clock)(void);

/* A home chunk took the time since `begin`, by that clock. */
static inline void dem_home_took(dem_data *d, int chunk, double begin) {
  d->work.homes.cost[chunk] += dem_homes_clock() - begin;
}

#endif
