/* The coupled loop: windows, the exchange with both solvers, the output grid.
 *
 * A window k covers the DEM steps k n … min((k+1) n, N). Times are step numbers times dt, never running sums.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_LOOP_WINDOW_H
#define CPL_LOOP_WINDOW_H

#include "coupler/loop/ledger.h"
#include "coupler/loop/path.h"
#include "coupler/scheme/extrapolate.h"
#include "coupler/scheme/scheme.h"
#include "coupler/session/session.h"
#include "coupler/session/settings.h"

struct cpl_record;

/* Of schemes that iterate. */
typedef struct {
  uint64_t windows; /* iterated on; 0 with other schemes */
  uint64_t all;     /* iterations in them */
  int largest;      /* in one window */
  uint64_t not_converged;
} cpl_iterations;

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
  void *own; /* the scheme's */
  cpl_iterations iterations;
  uint64_t surprises;                     /* windows of proxy in which the mechanism changed */
  double first_surprise;                  /* the first one's start [s] */
  tdm_wrench *packed;                     /* load without gaps, as it is sent */
  const tdm_state *sent_start, *sent_end; /* (nbody) the path that DEM was last sent along */
  const double *correction;               /* (nbody x 12) of DEM's path by its proxy, NULL: none */
  cpl_ledger ledger;
  tdm_result result[CPL_NROLE]; /* last results; their arrays live in the session's buffers */
} cpl_loop;

/* Set up the loop after both solvers are READY. */
tdm_status cpl_loop_init(cpl_loop *loop, const cpl_settings *settings, cpl_session *session, struct cpl_record *record,
                         tdm_error *err);
void cpl_loop_free(cpl_loop *loop);

/* Solve one window by the scheme and record it. */
tdm_status cpl_loop_advance(cpl_loop *loop, tdm_error *err);
bool cpl_loop_done(const cpl_loop *loop);

/* ---- what schemes use ---- */

/* The way [m] that a body makes in the window at its largest speed until t1; turns count at its radius. */
double cpl_motion(const cpl_loop *loop, int body);

/* MBD over the window under loop->load (its first `ncoefficient` entries a body): sets state_end. */
tdm_status cpl_solve_mbd(cpl_loop *loop, int ncoefficient, tdm_error *err);

/* DEM over the window with a proxy: it carries the mechanism, as MBD left it, through the window itself, and ends
 * beside that by `correction` (nbody x 12, see tdm_proxy; NULL: zeros). Sets mean, dem_end, and load to the polynomial
 * with the moments that DEM found (nload coefficients: the mean alone for one step a window, a line for two and three)
 * and with the further coefficients that end where its proxy did, if both solvers know them.
 */
tdm_status cpl_solve_dem_proxy(cpl_loop *loop, const double *correction, tdm_error *err);

/* DEM over the window along a path (nbody states at t0 and t1): sets mean. */
tdm_status cpl_solve_dem_along(cpl_loop *loop, const tdm_state *start, const tdm_state *end, tdm_error *err);

/* A whole window: MBD on the polynomial through the last nmean (1 to 3) means, DEM on the path from state_start to
 * state_end that comes of it. */
tdm_status cpl_mbd_first(cpl_loop *loop, int nmean, tdm_error *err);

#endif
