/* The multibody engine: the interface for all who use it, in a co-simulation, alone or in a program of their own.
 *
 *   mbd_engine *engine = NULL;
 *   mbd_engine_create(&engine, &assignment, NULL, err);    reads the scene section "mbd", assembles the mechanism
 *   mbd_engine_start(engine);                              what there is to tell before the first window
 *   mbd_engine_advance(engine, &window, &outcome, err);    as often as wanted: loads in, poses out
 *   mbd_engine_destroy(&engine);
 *
 * SI units; vectors in world axes. A pose is that of a body's centre of mass, a load a force and a moment about it. The
 * coupled bodies (ncoupled) stand in the order of the assignment. Arrays are packed, the last index runs fastest.
 *
 * Errors come as a status and a message in err that names place, cause and cure: TDM_ERR_SCENE for what a scene says,
 * TDM_ERR_FILE, TDM_ERR_MEMORY, TDM_ERR_NUMERIC where the motion cannot be integrated or the guard stops it,
 * TDM_ERR_INTERRUPTED, TDM_ERR_PROTOCOL for what another solver sent. After an error in advance the engine can be
 * observed, restored and destroyed.
 *
 * Several engines may live in a process. Each belongs to one thread at a time. Remarks (protocol/scene/remark.h) are
 * those of the calling thread. Create turns GSL's error handler off (protocol/math/gsl_errors.h).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_MBD_H
#define MBD_MBD_H

#include "mbd/mechanics/state.h"
#include "protocol/view/view.h"
#include "protocol/wire/participant.h"

/* A multibody system that is being computed. */
typedef struct mbd_engine mbd_engine;

/* ---- create ---- */

/* Make an engine of a scene section (assignment->scene) and of what the rest of the scene fixes: times, the coupled
 * bodies, whether windows are to tell accelerations, mobility and the path ahead, and whether states are restored. The
 * mechanism is assembled at the start. The assignment is read, not kept. `participant`: the server that hears signs of
 * life meanwhile (borrowed for the engine's life); NULL: none, and a signal ends the work. *engine must be NULL; it is
 * set on success only. */
tdm_status mbd_engine_create(mbd_engine **engine, const tdm_assignment *assignment, tdm_participant *participant,
                             tdm_error *err);

/* Frees all; *engine becomes NULL. It may be NULL. */
void mbd_engine_destroy(mbd_engine **engine);

/* What there is to tell before the first window, without load. The arrays live as long as the engine. */
typedef struct {
  const tdm_assigned_body *body; /* (ncoupled) mass, inertia, state, free directions */
  const double *acceleration;    /* (ncoupled x 6) if the assignment asks for it [m/s2, rad/s2] */
  const tdm_mobility *mobility;  /* if the assignment asks for it */
  const tdm_nodes *path;         /* until the assignment's `ahead`; no nodes: the accelerations tell it */
  const bool *prescribed;        /* (ncoupled) loads leave the body's motion as it is; NULL: not asked for */
  int nchannel;                  /* outputs */
  const tdm_channel *channel;    /* (nchannel) names and units of the outputs */
  const double *initial;         /* (nchannel) their values */
  int nwarning;                  /* doubtful settings */
  const tdm_warning *warning;    /* (nwarning) doubtful settings, with the cure */
  tdm_energy energy;             /* [J] */
  tdm_vec3 gravity;              /* [m/s2] */
  int freedom;                   /* degrees of freedom that joints and drivers leave */
  json_t *report;                /* figures of the start: docs/mbd.md */
} mbd_start;

/* Lives as long as the engine. */
const mbd_start *mbd_engine_start(const mbd_engine *engine);

/* ---- advance ---- */

/* A window, and the loads in it. Pointers are borrowed for the call. */
typedef struct {
  double t0, t1;             /* [s]; t0 is where the engine stands */
  int nload;                 /* coefficients of the load, TDM_LOAD_MAX at most; 0: no load */
  const tdm_wrench *load;    /* (ncoupled x nload) W(s) = sum_j load_j s^j, s = (t - t0)/(t1 - t0) */
  int nsample;               /* output times */
  const double *sample_time; /* (nsample) output times, ascending, in (t0, t1] [s] */
  double ahead;              /* tell the path from t1 until then [s]; 0: none */
} mbd_window;

/* What a window came to. The caller gives the arrays that it wants; NULL: not wanted. */
typedef struct {
  tdm_state *state;        /* (ncoupled) at t1 */
  double *acceleration;    /* (ncoupled x 6) at t1, of an assignment with it */
  tdm_mobility *mobility;  /* at t1, of an assignment with it; its arrays are the engine's until the next window */
  tdm_nodes *path;         /* of a window with `ahead`; as mobility */
  tdm_energy *energy;      /* at t1 */
  double *channel;         /* (nsample x nchannel) values of the outputs */
  tdm_state *sample_state; /* (nsample x ncoupled) */
  /* Called at each sample time, in their order: meanwhile mbd_engine_snapshot shows that time. */
  tdm_status (*look)(void *looker, int sample, tdm_error *err);
  void *looker; /* what `look` gets */
} mbd_outcome;

/* Compute one window, up to the first error. */
tdm_status mbd_engine_advance(mbd_engine *engine, const mbd_window *window, const mbd_outcome *outcome, tdm_error *err);

/* Let the integrator make no more than so many steps from now on; 0: no limit. A window that needs more ends with
 * TDM_ERR_LIMIT. */
void mbd_engine_limit_steps(mbd_engine *engine, long most);

/* ---- save and restore ---- */

/* Keep the state in memory, in slot 0 ... TDM_SLOTS_MAX - 1. */
tdm_status mbd_engine_save(mbd_engine *engine, int slot, tdm_error *err);

/* Go back to the state of a slot: what follows has the same bits. TDM_ERR_PROTOCOL: nothing was saved there. */
tdm_status mbd_engine_restore(mbd_engine *engine, int slot, tdm_error *err);

/* ---- observe ---- */

/* What the scene fixes, and the state (mechanics/state.h), which changes with every window. Both are the engine's. */
const mbd_model *mbd_engine_model(const mbd_engine *engine);
const mbd_data *mbd_engine_data(const mbd_engine *engine);

/* What there is to see: the mechanism's bodies and lines, and where they are now. Both may be reused; they are the
 * caller's. Looking changes nothing of the run. */
tdm_status mbd_engine_scenery(const mbd_engine *engine, tdm_scenery *scenery, tdm_error *err);
tdm_status mbd_engine_snapshot(const mbd_engine *engine, tdm_snapshot *snapshot, tdm_error *err);

/* The integrator's counters up to now (the engine's, until the next window). */
const mbd_stats *mbd_engine_stats(mbd_engine *engine);

/* The most that the balance of energies was off at the end of a window [J], and as a share of the energy (guard.h). */
double mbd_engine_energy_off(const mbd_engine *engine, double *share);

#endif
