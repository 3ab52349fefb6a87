/* A session: the two solvers of a run, from HELLO to FINISH, with time-outs.
 *
 * Whatever a partner does (dies, hangs, sends garbage), a call here returns within the time-out with an error that
 * names it and ends with the last lines of its log.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_SESSION_SESSION_H
#define CPL_SESSION_SESSION_H

#include "coupler/session/launch.h"
#include "coupler/settings/settings.h"
#include "protocol/base/progress.h"
#include "protocol/record/record.h"
#include "protocol/wire/transport.h"

/* A solver as the server sees it. */
typedef struct {
  bool connected, ready;
  tdm_peer peer;
  char name[64], software[128]; /* from HELLO */
  json_t *capabilities;         /* from HELLO, array of strings */
  cpl_child *child;             /* NULL when it was started by hand */
  int nchannel;
  tdm_channel *channel; /* (nchannel) from READY */
  double *initial;      /* (nchannel) values at the start */
  json_t *report;       /* from READY */
  json_t *remarks;      /* from its last REMARKS, as tdm_remarks_from_json makes them; NULL: none */
  bool has_gravity;
  tdm_vec3 gravity;  /* from READY, if it tells [m/s2] */
  int saving;        /* SAVEs that it has not answered yet */
  double rest;       /* from READY: energy below which all is at rest for it [J]; 0: it does not say */
  tdm_energy energy; /* from READY: at the start; NaN when not known */
  tdm_frame store;   /* arrays of its last RESULT */
  double step_time;  /* its own work on all windows [s] */
  double trip_time;  /* from sending STEPs to having RESULTs [s]: its work and the exchange */
} cpl_partner;

typedef struct {
  tdm_transport *transport;
  const cpl_settings *settings;
  const struct cpl_scheme *scheme; /* of the settings, or their fallback; from the start on */
  unsigned further[CPL_NROLE];     /* flags of cpl_need: what is asked of solvers beside the scheme's needs */
  cpl_partner partner[CPL_NROLE];
  tdm_assigned_body *body; /* (nbody) from mbd's READY; names are dem's */
  tdm_wrench *load;        /* (nbody) from dem's READY: at the start */
  double *acceleration;    /* (nbody x 6) from mbd's READY if the scheme needs it: at the start, without load */
  tdm_mobility mobility;   /* the same */
  tdm_nodes path;          /* from mbd's READY: from the start until the first window's end; no nodes: not told */
  bool *prescribed;        /* (nbody) from mbd's READY: loads leave the body's motion as it is; NULL: not told */
  char refused[256];       /* why the last stranger was turned away, "" if none was */
  json_t *warnings;        /* array of {"path", "message"} of both */
  json_t *bodies;          /* of mbd's READY: `body` has strings of it */
  uint64_t remarks_taken;  /* messages REMARKS so far */
  tdm_progress progress;   /* of what solvers are at until they are READY */
  tdm_frame out;
  tdm_recorder *recorder; /* borrowed: takes all frames; NULL: none does */
  double last_heartbeat;
  double seen_from; /* states are looked at from then on [s]: STEPs until then or later announce it */
  bool seen_next;   /* so is the state at the end of the next window */
} cpl_session;

/* Listen at `endpoint` (tcp ports may be wildcards: tdm_transport_endpoint tells). The context is for inproc. */
tdm_status cpl_session_open(cpl_session *session, const cpl_settings *settings, const char *endpoint, void *context,
                            tdm_error *err);

/* Wait for HELLO of both, assign mbd, then dem with mbd's bodies: after this both are READY. */
tdm_status cpl_session_start(cpl_session *session, const tdm_scene *scene, tdm_error *err);

/* The same in parts, for one role: wait for its HELLO; and, when a scheme is chosen and (for dem) mbd is READY, for its
 * READY. */
tdm_status cpl_session_meet(cpl_session *session, cpl_role role, tdm_error *err);
tdm_status cpl_session_assign(cpl_session *session, cpl_role role, const tdm_scene *scene, tdm_error *err);

/* Wait for a message of a type from a role, as the calls below do by themselves; HELLO: from any role. The header's
 * payload lives until the next receive. An ERROR that comes, a partner that ends or is silent too long, and any other
 * message is an error that names the partner. */
tdm_status cpl_session_wait(cpl_session *session, cpl_role role, tdm_message_type type, tdm_header *header,
                            tdm_error *err);

/* After both HELLOs: the scheme of the scene, or its fallback when a solver lacks what that needs (session_asks.c). */
tdm_status cpl_session_choose(cpl_session *session, tdm_error *err);

/* Take up what a role says in its READY (session_ready.c). */
tdm_status cpl_session_read_ready(cpl_session *session, cpl_role role, const tdm_header *header, tdm_error *err);

/* After both READYs: a warning where the solvers go by different gravities. */
void cpl_session_compare(cpl_session *session);

/* What RESULT may carry beside the exchange's own. */
typedef struct {
  const char *name;
  unsigned need; /* flag of cpl_need: asked for by schemes that need it; 0: by none */
  bool always;   /* asked for whatever the scheme, for the ledger */
  bool per_body; /* empty without coupled bodies */
  bool may_lack; /* where there is nothing to tell */
} cpl_extra;
enum { CPL_NEXTRA = 6 };
extern const cpl_extra cpl_extras[CPL_NEXTRA];

/* Look at what a role has sent (session_check.c): counts and times as they were asked for, numbers that can be squared,
 * unit quaternions, inertias and mobilities that are some. The error says what is wrong; the caller puts the name of
 * the sender in front. */
tdm_status cpl_session_check_ready(const cpl_session *session, cpl_role role, tdm_error *err);
tdm_status cpl_session_check_result(const cpl_session *session, int role, const tdm_step *step,
                                    const tdm_result *result, tdm_error *err);

/* What the scheme of this run needs of a role's solver, as its settings are: flags of cpl_need. */
unsigned cpl_session_needs(const cpl_session *session, cpl_role role);

/* Whether a role's solver has announced a capability. */
bool cpl_session_has(const cpl_session *session, cpl_role role, const char *capability);

/* The names of the schemes that both solvers can go with, by what their HELLOs announce, in `out` (size bytes):
 * "dem-first; with a given coupling.n lommen, hold". Returns out. */
const char *cpl_session_schemes(const cpl_session *session, char *out, size_t size);

/* Whether the mobility of all coupled bodies fits into a message. */
bool cpl_session_fits_mobility(const cpl_session *session);

/* Whether SAVE and RESTORE come in this run: the scheme needs them, or windows that are too long are taken back. */
bool cpl_session_restores(const cpl_session *session);

/* Path of a position that DEM is sent along without nodes: the scene's, or the scheme's. */
tdm_interpolation cpl_session_interpolation(const cpl_session *session);

/* Whether a role's RESULTs carry "acceleration", "mobility", "interface" or "energy" in this run, or "ahead": mbd's
 * READY and RESULTs may tell the path of the next window. */
bool cpl_session_asks(const cpl_session *session, cpl_role role, const char *extra);

/* A sign of life to all, when the last one is half a second old: while nothing is asked of them. */
void cpl_session_beat(cpl_session *session);

/* One STEP and its RESULT. The result's arrays live until the next step of the same role. */
tdm_status cpl_session_step(cpl_session *session, cpl_role role, const tdm_step *step, tdm_result *result,
                            tdm_error *err);

/* Ask a solver with the capability "restore" to keep its state under a slot (0 ... TDM_SLOTS_MAX - 1), or to go back to
 * it; between windows only. SAVE is not waited for: that it failed is told when the solver is listened to next. */
tdm_status cpl_session_save(cpl_session *session, cpl_role role, int slot, tdm_error *err);
tdm_status cpl_session_restore(cpl_session *session, cpl_role role, int slot, tdm_error *err);

/* What a solver is asked to show. */
typedef enum { CPL_SCENERY, CPL_SNAPSHOT, CPL_SNAPSHOT_WITH_CONTACTS } cpl_sight;

/* Ask a solver with the capability "view" for its scenery or a snapshot, between windows only. The payload of *header,
 * which lives until the next receive, is its answer, undecoded; empty: it has none. */
tdm_status cpl_session_view(cpl_session *session, cpl_role role, cpl_sight sight, tdm_header *header, tdm_error *err);

/* Whether a role's state at time t [s] will be looked at, as far as is known. */
bool cpl_session_sees(const cpl_session *session, cpl_role role, double t);

/* The name of its HELLO, or its role. */
const char *cpl_session_name(const cpl_session *session, cpl_role role);

/* FINISH to all that are connected, or ERROR when `err` is set (the run was given up); then free. Does not stop
 * processes. */
void cpl_session_close(cpl_session *session, const tdm_error *err);

#endif
