/* The DEM engine: the interface for all who use it, in a co-simulation, alone or in a program of their own.
 *
 *   dem_engine *engine = NULL;
 *   dem_engine_create(&engine, &assignment, NULL, err);    reads the scene section "dem", settles the particles
 *   dem_engine_start(engine);                              what there is to tell before the first step
 *   dem_engine_advance(engine, &window, &outcome, err);    as often as wanted
 *   dem_engine_destroy(&engine);
 *
 * SI units; vectors in world axes. A pose is that of a body's centre of mass, a load a force and a moment about it. The
 * coupled bodies (ncoupled) stand in the order of the assignment. Arrays are packed, the last index runs fastest.
 *
 * Errors come as a status and a message in err that names place, cause and cure: TDM_ERR_SCENE and TDM_ERR_JSON for
 * what a scene says, TDM_ERR_FILE, TDM_ERR_MEMORY, TDM_ERR_NUMERIC when the guard or a NaN stops the
 * run, TDM_ERR_INTERRUPTED, TDM_ERR_PROTOCOL for what another solver sent. After an error in advance or restore the
 * engine can be looked at and destroyed, not stepped.
 *
 * Creating an engine turns off GSL's own aborts for the whole process, and lets jansson's failed allocations be noted:
 * these errors are returned.
 * Several engines may live in a process. Each belongs to one thread at a time; it shares its work among dem.threads
 * threads of its own. Remarks (protocol/scene/remark.h) are those of the calling thread.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_DEM_H
#define DEM_DEM_H

#include "dem/base/ranks.h"
#include "dem/bodies/path.h"
#include "protocol/output/share.h"
#include "protocol/wire/participant.h"

/* A scene of particles that is being computed. */
typedef struct dem_engine dem_engine;

/* ---- create ---- */

/* Make an engine of a scene section (assignment->scene) and of what the rest of the scene fixes: times, the step, the
 * coupled bodies, and whether windows are to carry a mechanism. Particles are at rest after dem.settle, or as dem.start
 * has them; sources have made what is due at the start. The assignment is read, not kept. `participant`: the server
 * that hears signs of life meanwhile (borrowed for the engine's life); NULL: none, and a signal ends the work. *engine
 * must be NULL; it is set on success only. */
tdm_status dem_engine_create(dem_engine **engine, const tdm_assignment *assignment, tdm_participant *participant,
                             tdm_error *err);

/* Frees all; *engine becomes NULL. It may be NULL. */
void dem_engine_destroy(dem_engine **engine);

/* What there is to tell before the first step. The arrays live as long as the engine. */
typedef struct {
  const tdm_wrench *load;     /* (ncoupled) of the particles on the coupled bodies [N], [N m] */
  int nchannel;               /* outputs */
  const tdm_channel *channel; /* (nchannel) names and units of the outputs */
  const double *initial;      /* (nchannel) their values */
  int nwarning;               /* doubtful settings */
  const tdm_warning *warning; /* (nwarning) doubtful settings, with the cure */
  tdm_energy energy;          /* of the particles and contacts [J]; NaN where it cannot be accounted for */
  double rest;                /* energy below which all is at rest [J] */
  tdm_vec3 gravity;           /* [m/s2] */
  json_t *report;             /* figures of the start: docs/dem.md */
} dem_start;

/* Lives as long as the engine. */
const dem_start *dem_engine_start(const dem_engine *engine);

/* ---- advance ---- */

/* A window: whole steps from t0 to t1, and the bodies' ways meanwhile. The coupled bodies follow `path`, or the engine
 * carries the mechanism that holds them; with neither they stay where they are. Pointers are borrowed for the call. */
typedef struct {
  double t0, t1;                  /* [s] */
  uint64_t nstep;                 /* at least 1; where (t1 - t0)/nstep is time.dt to 1e-6, time.dt is taken */
  const dem_path *path;           /* (ncoupled) over the window */
  const dem_mechanism *mechanism; /* as it is at t0 */
  int nsample;                    /* output times */
  const double *sample_time;      /* (nsample) ascending, in (t0, t1] [s]; what is later is sampled at t1 */
  bool seen;                      /* there will be a snapshot of t1: forces on triangles, if the scene wants them */
} dem_window;

/* What a window came to. The caller gives the arrays that it wants; NULL: not wanted. */
typedef struct {
  tdm_wrench *load;        /* (ncoupled) mean load over the steps, [L18] Eq. 2 */
  tdm_interface *body;     /* (ncoupled), zeroed: moments and work of the load; with a mechanism also the end states */
  tdm_wrench *further;     /* (ncoupled x TDM_FURTHER) further moments, of an assignment with matched_load */
  tdm_energy *energy;      /* at t1, as in dem_start */
  double *channel;         /* (nsample x nchannel) values of the outputs */
  tdm_wrench *sample_load; /* (nsample x ncoupled) mean loads since the sample before */
} dem_outcome;

/* Compute one window, up to the first error. */
tdm_status dem_engine_advance(dem_engine *engine, const dem_window *window, const dem_outcome *outcome, tdm_error *err);

/* ---- save and restore ---- */

/* Keep the state in memory, in slot 0 ... TDM_SLOTS_MAX - 1. */
tdm_status dem_engine_save(dem_engine *engine, int slot, tdm_error *err);

/* Go back to the state of a slot: what follows has the same bits. TDM_ERR_PROTOCOL: nothing was saved there. A whole
 * state as bytes or a file: store/state_file.h. */
tdm_status dem_engine_restore(dem_engine *engine, int slot, tdm_error *err);

/* ---- observe ---- */

/* The state: particles, contacts, poses and loads of the bodies (state/data.h); its model is what the scene fixed. Both
 * are the engine's and change with every step. On several ranks particles and contacts of other homes are there only
 * after a snapshot with contacts. */
const struct dem_data *dem_engine_data(const dem_engine *engine);

/* What there is to see (protocol/view/view.h): the scenery once, then snapshots of the present state. Both objects are
 * the caller's and reused. Looking changes nothing of the run. From the first time on the engine notes at the end of
 * each window where new particles are. */
tdm_status dem_engine_scenery(dem_engine *engine, tdm_scenery *scenery, tdm_error *err);
tdm_status dem_engine_snapshot(dem_engine *engine, tdm_snapshot *snapshot, tdm_error *err);

/* The same, but on several ranks with a share of the particles alone: each rank has another one, until the next look,
 * and writes it into the files of a frame (protocol/output/share.h) when it is told to. So none has all. */
tdm_status dem_engine_share(dem_engine *engine, tdm_snapshot *snapshot, tdm_error *err);
tdm_status dem_engine_write_shares(dem_engine *engine, const tdm_snapshot *share, const tdm_shared_frame *frame,
                                   tdm_error *err);

/* What each rank did in the windows so far: work (size of the ranks, base/ranks.h). Nothing in a process that is alone.
 */
tdm_status dem_engine_work(dem_engine *engine, dem_rank_work *work, tdm_error *err);

#endif
