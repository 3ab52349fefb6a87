/* The data of the coupled loop: what schemes, observers and the paths through a window look at.
 *
 * A window k covers the DEM steps k n ... min((k+1) n, N). Times are step numbers times dt, never running sums.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_LOOP_LOOP_H
#define CPL_LOOP_LOOP_H

#include "coupler/loop/extrapolate.h"
#include "coupler/loop/mismatch.h"
#include "coupler/loop/observer.h"
#include "coupler/session/scheme.h"
#include "coupler/session/session.h"
#include "coupler/session/settings.h"

#include <math.h>

struct cpl_record;

/* Paths of the coupled bodies through a window (path.h). */
typedef struct {
  int nbody;
  bool takes;       /* DEM has the capability "path" */
  bool *prescribed; /* (nbody) loads leave the motion of the body as it is; false where that is not known */
  tdm_nodes told;   /* of the window under way; no nodes: none were told */
  tdm_nodes coming; /* of the time behind it */
  tdm_nodes made;   /* the last one of cpl_path_through */
} cpl_paths;

typedef struct cpl_loop {
  const cpl_settings *settings;
  const cpl_scheme *scheme;
  cpl_session *session;
  struct cpl_record *record;
  int nbody;

  /* the window under way */
  uint64_t window;
  uint64_t step0, step1; /* DEM steps at its ends */
  double t0, t1;         /* [s] */
  long n;                /* DEM steps of the next window, unless the run ends before */
  long n_least, n_most;  /* of the windows so far; the last of the run left out, if it is cut */
  int nsample;           /* output times in (t0, t1] */
  double *sample_time;   /* (nsample) */
  double *row_time;      /* (nsample) the same as the records have them: k times the interval, not rounded to a step */
  uint64_t next_sample;  /* number of the next output time on the grid */

  /* the bodies */
  tdm_state *state_start; /* (nbody) at t0 */
  tdm_state *state_end;   /* (nbody) at t1, once MBD has solved */
  tdm_state *dem_end;     /* (nbody) at t1, as DEM foresaw it; schemes with a mismatch_order */
  double *radius;         /* (nbody) by which turns count as ways [m] */
  double *speed;          /* (nbody) largest so far [m/s] */
  tdm_wrench *mean;       /* (nbody) mean load over the window, once DEM has solved */
  cpl_history *history;   /* (nbody) */
  tdm_wrench *load;       /* (nbody x TDM_LOAD_MAX) load polynomial for MBD, row i: body i */
  int nload;              /* its coefficients; of the last window until there are new ones */
  tdm_proxy proxy;        /* the mechanism at t0, if the scheme needs it; points into proxy_block */
  double *proxy_block;
  cpl_paths paths;
  void *own;                              /* the scheme's */
  const void *scheme_settings;            /* what the scene says to it, NULL: nothing */
  tdm_wrench *packed;                     /* load without gaps, as it is sent */
  const tdm_state *sent_start, *sent_end; /* (nbody) the path that DEM was last sent along */
  const double *correction;               /* (nbody x 12) of DEM's path by its proxy, NULL: none */
  const tdm_nodes *through; /* MBD's path through the window that is solved, for observers; no nodes: none were told */
  tdm_result result[CPL_NROLE]; /* last results; their arrays live in the session's buffers */

  cpl_observing observing[CPL_OBSERVERS_MAX]; /* in the order in which they are called */
  int nobserving;
} cpl_loop;

static inline bool cpl_loop_done(const cpl_loop *loop) {
  return loop->step1 >= cpl_total_steps(loop->settings);
}

/* The way [m] that a body makes in the window at its largest speed until t1; turns count at its radius. */
static inline double cpl_motion(const cpl_loop *loop, int body) {
  double speed = cpl_speed(&loop->state_end[body], loop->radius[body]);
  return (loop->t1 - loop->t0) * fmax(speed, loop->speed[body]);
}

#endif
