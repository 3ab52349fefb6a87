/* The participant API: how a solver takes part in a co-simulation.
 *
 *   tdm_participant *p = NULL;
 *   tdm_participant_connect(&p, &def, err);            HELLO
 *   tdm_participant_initialize(p, &assignment, err);   waits for ASSIGN
 *   tdm_participant_ready(p, &ready, err);             READY
 *   tdm_participant_keep(p, &keeper);                  only with the capability "restore"
 *   tdm_participant_show(p, &shower);                  only with the capability "view"
 *   while (tdm_participant_next(p, &step, &result, err))   waits for STEP; false at FINISH or after an error
 *     ... solve from step.t0 to step.t1, fill result's arrays ...
 *     tdm_participant_advance(p, &result, err);        RESULT
 *   tdm_participant_finalize(&p, err);                 sends err, if it is set, as ERROR; frees
 *
 * What the thread says with tdm_remark (remark.h) goes to the server by itself, with RESULTs, signs of life and ERROR.
 *
 * tests/protocol/dummy_solver.c is a complete example. tdm_participant_run wraps this loop for a solver that is written
 * as a table of operations. A handle belongs to one thread.
 */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_WIRE_PARTICIPANT_H
#define TDM_WIRE_PARTICIPANT_H

#include "protocol/scene/remark.h"
#include "protocol/scene/scene.h"
#include "protocol/wire/message.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A connection to a server, from HELLO to the end. */
typedef struct tdm_participant tdm_participant;

/* How a participant introduces itself, and where to. */
typedef struct {
  const char *name;                /* shown in messages and logs */
  const char *role;                /* "dem" or "mbd" */
  const char *software;            /* "tandem-dem 0.1.0" */
  const char *endpoint;            /* "ipc:///…", "inproc://…" or "tcp://127.0.0.1:5555" */
  const char *const *capabilities; /* (ncapability) optional capabilities of PROTOCOL.md that the solver has */
  int ncapability;                 /* number of capabilities */
  void *context;                   /* ZeroMQ context to share (needed for inproc), NULL: its own */
  double timeout;                  /* the partner counts as lost after this silence [s] until ASSIGN sets it */
} tdm_participant_def;

/* A definition with defaults; role and endpoint are to be set. */
tdm_participant_def tdm_participant_default_def(void);

/* A body that both solvers share. */
typedef struct {
  const char *name; /* as this solver's section calls it */
  double mass;      /* [kg]; inf for a body that cannot be moved; known to dem only, 0 for mbd */
  tdm_mat3 inertia; /* about the centre of mass, body axes [kg m2]; dem only */
  tdm_state state;  /* at the start, world; dem only */
  tdm_vec3 origin;  /* the part's own origin, which STL files are drawn from: from the centre of mass, body axes [m] */
  const char *mesh; /* the STL file that its mass comes from, NULL: none */
  double scale;     /* of that file: metres a unit */
  int nfree;        /* mbd's READY: directions in which the coupling load and gravity alone move the body */
  tdm_vec3 free[3]; /* (nfree) unit, world */
} tdm_assigned_body;

/* The keys "origin", "mesh" and "scale" of a body in READY and ASSIGN: see PROTOCOL.md. The strings are the JSON's. */
void tdm_part_read(tdm_assigned_body *body, tdm_object *json);
void tdm_part_write(const tdm_assigned_body *body, json_t *json);

/* Path of a coupled body's position between the two ends of a window; the orientation goes by SLERP in both. */
typedef enum { TDM_LINEAR, TDM_HERMITE } tdm_interpolation;

/* What the server assigns: the scene, the bodies, and what messages are to carry. */
typedef struct {
  json_t *scene;                   /* the solver's own section, borrowed; its JSON path is `role` */
  double time_start, time_end;     /* [s] */
  double dt;                       /* DEM step [s] */
  long n;                          /* DEM steps of the longest window */
  tdm_interpolation interpolation; /* position of a body inside a window */
  int nbody;                       /* coupled bodies */
  const tdm_assigned_body *body;   /* (nbody) entry i stands at coupling.bodies[i].<role> in the scene */
  bool acceleration, mobility;     /* READY and RESULT are to carry these (mbd with the capability) */
  bool interface, energy;          /* RESULT is to carry these (dem; any role) */
  bool matched_load;               /* RESULT is to carry further coefficients of the load (dem with the capability) */
  double ahead;                    /* READY is to tell the path until then [s]; 0: none (mbd with the capability) */
  bool restores;                   /* SAVE and RESTORE will come, perhaps in every window */
  bool proxy;                      /* STEP will have a proxy (dem with the capability) */
  bool sent_velocity;              /* contacts take the velocities of STEP's `end` all through the window, not those
                                    * of the path (dem with the capability) */
} tdm_assignment;

/* A further output that is sampled on the output grid. */
typedef struct {
  char name[64]; /* "joint.slider.fx": dots part, no spaces or commas */
  char unit[16]; /* "N" */
  bool gaps;     /* its values may be NaN: not defined then */
} tdm_channel;

/* What the solver says when it has loaded its scene. All arrays are borrowed and copied into the message. */
typedef struct {
  const tdm_assigned_body *body; /* mbd: (nbody) name, mass, inertia, state of each coupled body */
  const tdm_wrench *load;        /* dem: (nbody) load on each coupled body at the start */
  const double *acceleration;    /* (nbody x 6) without load, if the assignment asks for it */
  const tdm_mobility *mobility;  /* at the start, without load, if the assignment asks for it */
  const tdm_nodes *path;      /* mbd: until the assignment's `ahead`, without load; NULL: the accelerations tell it */
  const bool *prescribed;     /* mbd: (nbody) whether loads leave the body's motion as it is; NULL: not known */
  double rest;                /* energy below which all is at rest for this solver [J]; 0: it does not say */
  const tdm_energy *energy;   /* at the start, if the assignment asks for it; NULL: not known then */
  int nchannel;               /* further outputs */
  const tdm_channel *channel; /* (nchannel) */
  const double *initial;      /* (nchannel) values at the start */
  int nwarning;               /* doubtful settings */
  const tdm_warning *warning; /* (nwarning) doubtful settings, with the cure; refused under --strict */
  const tdm_vec3 *gravity;    /* that it computes with, world [m/s2]; NULL: not told */
  json_t *report;             /* the solver's own figures (degrees of freedom, step limits …), may be NULL */
} tdm_ready;

/* Connect and send HELLO. *p is set only on success. */
tdm_status tdm_participant_connect(tdm_participant **p, const tdm_participant_def *def, tdm_error *err);

/* Wait for ASSIGN. The assignment's data lives as long as the participant. TDM_ERR_INTERRUPTED when the server says
 * FINISH instead: then the solver ends, with exit status 0. */
tdm_status tdm_participant_initialize(tdm_participant *p, tdm_assignment *assignment, tdm_error *err);

/* Send READY. */
tdm_status tdm_participant_ready(tdm_participant *p, const tdm_ready *ready, tdm_error *err);

/* A solver with the capability "restore" keeps states in memory when the server asks for it between two windows; slot
 * is 0 ... TDM_SLOTS_MAX - 1. After restore it behaves, bit for bit, as it did after save; a slot that nothing was
 * saved in is its error (TDM_ERR_PROTOCOL). */
enum { TDM_SLOTS_MAX = 16 };

/* How a solver keeps its state and brings it back. */
typedef struct {
  void *self; /* the solver, for both */
  /* Copy the state into a slot. */
  tdm_status (*save)(void *self, int slot, tdm_error *err);
  /* Bring back what is in a slot. */
  tdm_status (*restore)(void *self, int slot, tdm_error *err);
} tdm_keeper;

/* From now on tdm_participant_next answers SAVE and RESTORE itself, with these (copied). */
void tdm_participant_keep(tdm_participant *p, const tdm_keeper *keeper);

/* A solver with the capability "view" tells what there is to see of it when the server asks between two windows: the
 * scenery, and after that snapshots. Looking changes nothing of the run. A snapshot of the end of a window is announced
 * in its STEP (step->seen). Both objects are the participant's: they are reused, and cleared or resized by who fills
 * them. */
typedef struct {
  void *self; /* the solver's own */
  /* What stays as it is. */
  tdm_status (*scenery)(void *self, tdm_scenery *scenery, tdm_error *err);
  /* The state that the solver has now. */
  tdm_status (*snapshot)(void *self, tdm_snapshot *snapshot, tdm_error *err);
} tdm_shower;

/* From now on tdm_participant_next answers VIEW itself, with these (copied). */
void tdm_participant_show(tdm_participant *p, const tdm_shower *shower);

/* Wait for the next STEP. Sets *step and a zeroed *result with its arrays laid out for this role. Returns false at
 * FINISH (err untouched) or after an error. */
bool tdm_participant_next(tdm_participant *p, tdm_step *step, tdm_result *result, tdm_error *err);

/* Send the RESULT of the step that _next gave; its window, time and wall time are filled in here. */
tdm_status tdm_participant_advance(tdm_participant *p, const tdm_result *result, tdm_error *err);

/* To be called after every step of the solver's own: tells the server that it lives. Cheap: one look at the clock, and
 * a message at most twice a second. Returns TDM_ERR_INTERRUPTED when the server asked to stop or is gone: drop the work
 * then. p is NULL when a solver runs by itself: then a signal asks it to stop. */
tdm_status tdm_participant_alive(tdm_participant *p);

/* Say what the solver is at, with printf's arguments, while that takes long and no STEP is under way ("settling: t =
 * 0.3 s"): to be called as often as tdm_participant_alive. Without a server (p is NULL) it goes to standard error. */
void tdm_participant_progress(tdm_participant *p, const char *format, ...) __attribute__((format(printf, 2, 3)));
void tdm_participant_progress_end(tdm_participant *p);

/* Send ERROR if err is set, close and free. *p becomes NULL. p or *p may be NULL. */
void tdm_participant_finalize(tdm_participant **p, const tdm_error *err);

/* ---- a solver as a table of operations ---- */

/* A solver: what it is, what it can, what it does. */
typedef struct {
  const char *role;                /* "dem" or "mbd" */
  const char *software;            /* "tandem-dem 0.1.0" */
  const char *const *capabilities; /* (ncapability) of PROTOCOL.md */
  int ncapability;                 /* number of capabilities */
  /* Load the scene; *self is the solver's own. Fill *ready with pointers that live as long as *self. `p` is for
   * tdm_participant_alive. On error *self may be set and is destroyed by the caller. */
  tdm_status (*create)(void **self, const tdm_assignment *assignment, tdm_ready *ready, tdm_participant *p,
                       tdm_error *err);
  /* Solve one window and fill the arrays of result. */
  tdm_status (*step)(void *self, const tdm_step *step, tdm_result *result, tdm_error *err);
  /* Capability "restore": as in tdm_keeper; NULL: none. */
  tdm_status (*save)(void *self, int slot, tdm_error *err);
  /* Likewise. */
  tdm_status (*restore)(void *self, int slot, tdm_error *err);
  /* Capability "view" (tdm_shower); NULL: none. */
  tdm_status (*scenery)(void *self, tdm_scenery *scenery, tdm_error *err);
  /* The same. */
  tdm_status (*snapshot)(void *self, tdm_snapshot *snapshot, tdm_error *err);
  void (*destroy)(void *self); /* NULL is allowed as self */
} tdm_solver_ops;

/* The loop above. Errors of the solver are sent to the server as ERROR. Returns TDM_OK after FINISH. */
tdm_status tdm_participant_run(const tdm_solver_ops *ops, const tdm_participant_def *def, tdm_error *err);

/* main() of a solver process: --connect ENDPOINT [--name NAME] [--timeout S] | --help | --version. Logs to standard
 * error. Returns the exit status. */
int tdm_solver_main(const tdm_solver_ops *ops, int argc, char **argv);

#ifdef __cplusplus
}
#endif

#endif
