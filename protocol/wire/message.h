/* Messages: what goes over the wire. PROTOCOL.md is the specification; this file is its C side.
 *
 * A message is one frame: a header of 24 bytes and a payload. Control messages carry JSON, STEP and RESULT a fixed
 * block of counts followed by raw float64 arrays. All little-endian. Every size is checked against the frame before it
 * is used, so a frame from anywhere can be handed to these functions.
 */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_WIRE_MESSAGE_H
#define TDM_WIRE_MESSAGE_H

#include "protocol/base/status.h"
#include "protocol/version.h"
#include "protocol/view/view.h"
#include "protocol/wire/nodes.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* one row a message: name, number, who sends it */
#define TDM_MESSAGE_LIST(X)  \
  X(HELLO, 1, "solver")      \
  X(ASSIGN, 2, "server")     \
  X(READY, 3, "solver")      \
  X(STEP, 4, "server")       \
  X(RESULT, 5, "solver")     \
  X(SAVE, 6, "server")       \
  X(RESTORE, 7, "server")    \
  X(CHECKPOINT, 8, "server") \
  X(FINISH, 9, "server")     \
  X(ERROR, 10, "both")       \
  X(HEARTBEAT, 11, "both")   \
  X(REMARKS, 12, "solver")   \
  X(VIEW, 13, "both")

/* Types of messages, with their numbers on the wire. */
typedef enum {
#define X(name, number, from) TDM_##name = number,
  TDM_MESSAGE_LIST(X)
#undef X
} tdm_message_type;

enum {
  TDM_HEADER_BYTES = 24,
  TDM_FRAME_MAX = 64 * 1024 * 1024,  /* larger frames are refused */
  TDM_VIEW_MAX = 1024 * 1024 * 1024, /* but for a VIEW, which may have so many bytes */
  TDM_STEP_BYTES = 48,               /* fixed blocks behind the header */
  TDM_RESULT_BYTES = 40,
  TDM_COUNT_MAX = 1 << 20,                                               /* of any count in STEP or RESULT */
  TDM_FURTHER = 6,                                                       /* coefficients behind the parabola */
  TDM_LOAD_MAX = 3 + TDM_FURTHER,                                        /* of a load polynomial */
  TDM_FREE_MAX = 32,                                                     /* independent velocities of a reduced model */
  TDM_INTERFACE_DOUBLES = 3 * TDM_WRENCH_DOUBLES + TDM_STATE_DOUBLES + 2 /* of a tdm_interface */
};

/* The header of a frame that was received. */
typedef struct {
  tdm_message_type type;  /* kind of the message */
  uint64_t window;        /* window that the message belongs to, from 0 */
  const uint8_t *payload; /* inside the frame */
  size_t size;            /* of the payload [bytes] */
} tdm_header;

/* A growing buffer that holds one outgoing frame. Zero-initialise; free with tdm_frame_free. */
typedef struct {
  uint8_t *data;         /* (size) what there is so far */
  size_t size, capacity; /* used, and allocated [bytes] */
} tdm_frame;

/* Free the buffer; *frame is as new. */
void tdm_frame_free(tdm_frame *frame);

/* Name of a message type ("STEP"), "?" when it is none. */
const char *tdm_message_name(int type);

/* Check a frame and read its header. TDM_ERR_VERSION for another protocol version, else TDM_ERR_PROTOCOL. */
tdm_status tdm_header_read(tdm_header *header, const void *frame, size_t size, tdm_error *err);

/* ---- control messages ---- */

/* Encode `json` (borrowed; NULL: no payload) into frame. */
tdm_status tdm_control_write(tdm_frame *frame, tdm_message_type type, uint64_t window, const json_t *json,
                             tdm_error *err);
/* The JSON object in the payload (new reference, the caller decrefs; an empty payload is an empty object). */
tdm_status tdm_control_read(const tdm_header *header, json_t **json, tdm_error *err);

/* n doubles as a JSON array (new reference); numbers that are not finite become null. */
json_t *tdm_numbers_to_json(const double *values, int n);

/* An error as a control message's JSON and back: {"status": "TDM_ERR_SCENE", "path": …, "message": …}. */
json_t *tdm_error_to_json(const tdm_error *err);
void tdm_error_from_json(const json_t *json, tdm_error *err);

/* ---- VIEW ---- */

/* Encode what there is to see into frame: the scenery, or where that is NULL the snapshot. TDM_ERR_PROTOCOL: it is
 * larger than TDM_VIEW_MAX. */
tdm_status tdm_view_write(tdm_frame *frame, uint64_t window, const tdm_scenery *scenery, const tdm_snapshot *snapshot,
                          tdm_error *err);

/* ---- STEP and RESULT ---- */

/* The reduced model of a mechanism at the end of a window, in its f independent velocities u' (PROTOCOL.md, section 6);
 * k coupled bodies. Matrices row by row, SI units, world axes. */
typedef struct {
  int nbody;            /* k */
  int nfree;            /* f; 0: no freedom, or more than TDM_FREE_MAX: then Y alone is there */
  double *Y;            /* (6k x 6k) mobility: accelerations of the bodies by the loads on them */
  double *velocity;     /* (f) u' */
  double *acceleration; /* (f) u'' with the load at the end of the window */
  double *J;            /* (6k x f) twists of the bodies by u' */
  double *B;            /* (f x 6k) u'' by the loads */
  double *stiffness;    /* (f x f) A_k: -du''/du */
  double *damping;      /* (f x f) A_c: -du''/du' */
  double *J_rate;       /* (6k x f) dJ/dt along the motion */
  double *B_rate;       /* (f x 6k) dB/dt */
} tdm_mobility;

/* What lets DEM carry the mechanism through a window (PROTOCOL.md, section 7). */
typedef struct {
  const double *acceleration; /* (nbody x 6) of v and w at t0, with the loads `load` */
  const tdm_wrench *load;     /* (nbody) loads at t0 that the accelerations belong to */
  const double *correction;   /* (nbody x 12) what the path is to be changed by at t1: way [m], turn [rad], rates */
  tdm_mobility mobility;      /* at t0 */
} tdm_proxy;

/* One window, as the solver gets it. Arrays belong to the message buffer and live until the next receive. */
typedef struct {
  uint64_t window;           /* from 0 */
  double t0, t1;             /* start and end of the window [s] */
  uint64_t nstep;            /* DEM steps in it, at least 1 */
  int nbody;                 /* coupled bodies, in the order of ASSIGN */
  int nstate;                /* nbody, or 0 when no path is sent (to mbd) */
  int nload;                 /* coefficients of the load polynomial, 0 when no load is sent (to dem) */
  int nsample;               /* output times inside (t0, t1] */
  const tdm_state *start;    /* (nstate) bodies at t0 */
  const tdm_state *end;      /* (nstate) bodies at t1 */
  const tdm_wrench *load;    /* (nbody x nload) W(s) = sum_j load[j] s^j, s = (t - t0)/(t1 - t0) */
  const double *sample_time; /* (nsample) [s], ascending */
  bool seen;                 /* to solvers with the capability "view": a snapshot of t1 will be asked for */
  double ahead;              /* to mbd: RESULT is to tell the path from t1 on until then [s]; 0: no path */
  tdm_nodes path;            /* to dem with the capability "path": how the bodies go; the last node is at t1. No node:
                              * as `end` or the proxy says */
  bool has_proxy;            /* to dem with the capability: `end` means nothing, the bodies move as `proxy` says */
  tdm_proxy proxy;           /* if has_proxy */
} tdm_step;

/* What DEM knows of a coupled body's part in a window. Doubles only. */
typedef struct {
  /* (1/H) times the integral of W P_j(2s - 1) dt, P_j Legendre's polynomials, W acting as the integrator's own kicks:
   * moment[0] H is exactly the impulse on the body */
  tdm_wrench moment[3];
  tdm_state end; /* where DEM has the body at t1: by its proxy, without drift that is being closed; else by the path */
  double work;   /* of the load on the body along that [J] */
  double blending; /* of the load along the closing of drift [J] */
} tdm_interface;

/* Mechanical energy inside a solver, the coupling load's work not counted as supplied. */
typedef struct {
  double kinetic;  /* NaN: not looked at in this window [J] */
  double stored;   /* kinetic, potential, elastic; NaN likewise [J] */
  double supplied; /* since the start by what is not the other solver: motors, prescribed bodies, newcomers [J] */
  double
      exchanged; /* mbd: work of the coupling loads on its bodies since the start, as it integrated them; dem: 0 [J] */
} tdm_energy;

/* What a solver gives back: mbd states, dem loads. For a solver written with participant.h the arrays are there,
 * zeroed, with their sizes set. */
typedef struct {
  uint64_t window;         /* that of the STEP */
  double t;                /* time reached [s] */
  double wall;             /* wall time of the solver's own work on this window [s] */
  int nbody;               /* coupled bodies */
  int nstate;              /* nbody (mbd) or 0 */
  int nload;               /* loads a body: 1 = mean over the window; 0 (mbd) */
  int nsample;             /* as in the STEP */
  int nchannel;            /* further outputs a sample, as announced in READY */
  int nacceleration;       /* nbody if ASSIGN asks for "acceleration", else 0 */
  bool has_mobility;       /* ASSIGN asks for "mobility" */
  tdm_state *state;        /* (nstate) at t1 */
  tdm_wrench *load;        /* (nbody x nload) */
  tdm_state *sample_state; /* (nsample x nstate) at the sample times */
  tdm_wrench *sample_load; /* (nsample x nbody, only if nload > 0) mean since the sample time before */
  double *channel;         /* (nsample x nchannel) at the sample times */
  double *acceleration;    /* (nacceleration x 6) of v and w at t1, with the load at the end of the window */
  int ninterface;          /* nbody if ASSIGN asks for "interface", else 0 */
  int nfurther;            /* nbody if ASSIGN asks for "matched_load", else 0 */
  bool has_energy;         /* ASSIGN asks for "energy" */
  tdm_interface *body;     /* (ninterface) */
  tdm_energy *energy;      /* (1 if has_energy) */
  tdm_wrench *further;     /* (nfurther x TDM_FURTHER) what P_3, P_4, ... have in the load polynomial */
  tdm_mobility mobility;   /* if has_mobility; to be sent: the solver's own arrays */
  tdm_nodes path;          /* of the bodies from t1 to the STEP's `ahead`, if that asks for it; likewise */
} tdm_result;

/* Numbers in a reduced model whose nbody and nfree are set, and its arrays pointed into a block of so many, in wire
 * order. */
size_t tdm_mobility_doubles(const tdm_mobility *mobility);
void tdm_mobility_point(tdm_mobility *mobility, double *block);
/* Copy all numbers of a reduced model to a block of so many. */
void tdm_mobility_copy(double *block, const tdm_mobility *mobility);

/* Encode a STEP into frame. */
tdm_status tdm_step_write(tdm_frame *frame, const tdm_step *step, tdm_error *err);

/* The arrays of *step point into `store`, which is grown as needed (aligned copies; the caller frees it). Refuses
 * numbers that are not finite, and windows that run backwards. */
tdm_status tdm_step_read(tdm_step *step, const tdm_header *header, tdm_frame *store, tdm_error *err);

/* Encode a RESULT into frame. */
tdm_status tdm_result_write(tdm_frame *frame, const tdm_result *result, tdm_error *err);
/* As tdm_step_read; numbers that are not finite pass here: the server names the body and the solver. */
tdm_status tdm_result_read(tdm_result *result, const tdm_header *header, tdm_frame *store, tdm_error *err);

/* Point the arrays of a result, whose counts are set, into `store` (zeroed). */
tdm_status tdm_result_layout(tdm_result *result, tdm_frame *store, tdm_error *err);

#ifdef __cplusplus
}
#endif

#endif
