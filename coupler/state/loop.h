/* The coupled loop: its data. Windows are advanced in window.h; schemes work on it with solve.h.
 *
 * A window k covers the DEM steps k n … min((k+1) n, N). Times are step numbers times dt, never running sums.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_STATE_LOOP_H
#define CPL_STATE_LOOP_H

#include "coupler/session/session.h"
#include "coupler/settings/scheme.h"

typedef tdm_result cpl_results[CPL_NROLE];

/* Works of the loads between the solvers since the start [J]. */
typedef struct {
  double exchanged; /* on MBD's side, as it tells it */
  double made;      /* on MBD's side beside DEM's: what the exchange has made */
  double worked;    /* sum of the magnitudes, of windows and bodies, on DEM's side */
} cpl_exchange;

/* Every field that the run changes, once. The struct, its memory, and the copies that cpl_loop_save makes and
 * cpl_loop_restore brings back all come from this list.
 *
 *   V(kind, type, name)          a value
 *   A(kind, type, name, count)   an array of so many
 *   P(kind, name)                a path of all bodies, tdm_nodes
 *
 *   FIXED     set at the start of the run
 *   CARRIED   goes from one window to the next: saved and restored
 *   WITHIN    set in a window before it is read there
 */
#define CPL_LOOP_FIELDS(V, A, P)                                                                                       \
  /* the window under way */                                                                                           \
  V(CARRIED, uint64_t, window)                                                                                         \
  V(CARRIED, uint64_t, step0) /* DEM steps at its ends */                                                              \
  V(CARRIED, uint64_t, step1)                                                                                          \
  V(CARRIED, double, t0) /* [s] */                                                                                     \
  V(CARRIED, double, t1)                                                                                               \
  V(CARRIED, long, n)               /* DEM steps of the next window, unless the run ends before */                     \
  V(CARRIED, double, growth)        /* by the last window's mismatch, of "n": "auto"; 1 where n is given */            \
  V(CARRIED, long, n_least)         /* of the windows so far; the last of the run left out, if it is cut */            \
  V(CARRIED, long, n_most)          /* the same */                                                                     \
  V(CARRIED, uint64_t, next_sample) /* number of the next output time on the grid */                                   \
  V(WITHIN, bool, too_far)          /* a body turned too far in it: an error, unless it is taken back */               \
  V(WITHIN, int, nsample)           /* output times in (t0, t1] */                                                     \
  A(WITHIN, double, sample_time, loop->samples_most)                                                                   \
  A(WITHIN, double, row_time, loop->samples_most) /* the same as records have them: k times the interval */            \
  /* the bodies */                                                                                                     \
  A(CARRIED, tdm_state, state_start, loop->nbody)        /* at t0 */                                                   \
  A(WITHIN, tdm_state, state_end, loop->nbody)           /* at t1, once MBD has solved */                              \
  A(WITHIN, tdm_state, dem_end, loop->nbody)             /* at t1, as DEM foresaw it; schemes with a mismatch_order */ \
  A(FIXED, double, radius, loop->nbody)                  /* by which turns count as ways [m] */                        \
  A(FIXED, bool, prescribed, loop->nbody)                /* loads leave its motion as it is; false where not known */  \
  A(CARRIED, double, speed, loop->nbody)                 /* largest so far [m/s] */                                    \
  V(CARRIED, cpl_exchange, exchange)                     /* of "n": "auto": until t0 */                                \
  A(WITHIN, tdm_wrench, mean, loop->nbody)               /* mean load over the window, once DEM has solved */          \
  A(WITHIN, tdm_wrench, load, loop->nbody *TDM_LOAD_MAX) /* polynomial for MBD, row i: body i */                       \
  A(WITHIN, tdm_wrench, packed, loop->nbody *TDM_LOAD_MAX) /* the same without gaps, as it is sent */                  \
  A(CARRIED, tdm_wrench, external, loop->nbody) /* loads on MBD's bodies from elsewhere, held: cpl_loop_press */       \
  V(CARRIED, int, nload) /* coefficients of the load; of the last window until there are new ones */                   \
  /* the mechanism at t0, if the scheme needs it; points into its block */                                             \
  V(CARRIED, tdm_proxy, proxy)                                                                                         \
  A(CARRIED, double, proxy_block, loop->proxy_size)                                                                    \
  /* the bodies' paths (path.h) */                                                                                     \
  P(WITHIN, told)    /* of the window under way; no nodes: none were told */                                           \
  P(CARRIED, coming) /* of the time behind it */                                                                       \
  P(WITHIN, made)    /* the last one of cpl_path_through */                                                            \
  /* what DEM was last sent along */                                                                                   \
  V(WITHIN, const tdm_state *, sent_start) /* (nbody) */                                                               \
  V(WITHIN, const tdm_state *, sent_end)                                                                               \
  V(WITHIN, const double *, correction)       /* (nbody x 12) of DEM's path by its proxy, NULL: none */                \
  V(WITHIN, cpl_results, result)              /* last results; their arrays live in the session's buffers */           \
  A(CARRIED, char, memory, loop->memory_size) /* the scheme's */

/* Windows of "n": "auto" whose mismatch was far too large: taken back and solved again, shorter; or kept, since a
 * solver cannot go back or no shorter window is allowed. */
typedef struct {
  uint64_t taken_back, kept;
  double first; /* start of the first one [s] */
} cpl_too_long;

/* Slots of cpl_loop_save: the scheme's within a window; the start of the window. */
enum { CPL_SLOT_SCHEME = 0, CPL_SLOT_WINDOW = 1 };

typedef struct cpl_loop {
  const cpl_settings *settings;
  const void *scheme_settings; /* the scheme's own */
  const cpl_scheme *scheme;
  cpl_session *session;
  int nbody;
  bool takes_path; /* DEM has the capability "path" */
  bool goes_back;  /* windows that are too long are taken back */
  cpl_too_long too_long;
  size_t samples_most, proxy_size, memory_size;
  void *own;                  /* what the scheme holds beside its memory */
  void *saved[TDM_SLOTS_MAX]; /* copies of cpl_loop_save, NULL: none */
#define CPL_VALUE(kind, type, name) type name;
#define CPL_ARRAY(kind, type, name, count) type *name;
#define CPL_PATH(kind, name) tdm_nodes name;
  CPL_LOOP_FIELDS(CPL_VALUE, CPL_ARRAY, CPL_PATH)
#undef CPL_VALUE
#undef CPL_ARRAY
#undef CPL_PATH
} cpl_loop;

/* Set up the loop after both solvers are READY; cpl_loop_free lets go of it whatever happened. */
tdm_status cpl_loop_init(cpl_loop *loop, const cpl_settings *settings, cpl_session *session, tdm_error *err);
void cpl_loop_free(cpl_loop *loop);

/* From now on these loads (nbody) of somebody else's act on MBD's bodies, beside DEM's; between windows. */
void cpl_loop_press(cpl_loop *loop, const tdm_wrench *external);

bool cpl_loop_done(const cpl_loop *loop);

/* Keep what MBD says of the mechanism at the end of a window; `acceleration` (nbody x 6) under loop->load there. */
void cpl_loop_keep_mechanism(cpl_loop *loop, const double *acceleration, const tdm_mobility *mobility);

/* Keep loop and solvers under a slot (0 ... TDM_SLOTS_MAX - 1), or go back to it: between windows, or to the start of
 * the window under way. cpl_session_restores must hold. What it holds in loop->own stays as it is. */
tdm_status cpl_loop_save(cpl_loop *loop, int slot, tdm_error *err);
tdm_status cpl_loop_restore(cpl_loop *loop, int slot, tdm_error *err);

#endif
