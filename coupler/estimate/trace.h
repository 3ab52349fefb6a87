/* The trace of a coupled body through a run, as the estimate of its error needs it: where it was, how fast, which
 * impulse the particles gave it, and what the two solvers differed by. A few thousand rows at most, however long the
 * run: all of it is summed up from the start, so that rows can be left out.
 *
 * Six parts each: way or velocity along x, y, z of the world, then turn or angular velocity about the body's own
 * principal axes, whose moments of inertia are what a moment about each of them has to overcome.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_ESTIMATE_TRACE_H
#define CPL_ESTIMATE_TRACE_H

#include "protocol/math/pose.h"

#include <stdbool.h>
#include <stdint.h>

enum { CPL_TRACE_ROWS = 2048, CPL_PARTS = 6 };

typedef struct {
  double t;                /* [s] */
  double way[CPL_PARTS];   /* from the start; turns are added up [m, rad] */
  double rate[CPL_PARTS];  /* [m/s, rad/s] */
  double given[CPL_PARTS]; /* impulse of the load that DEM found, since the start [N s, N m s] */
  double owed[CPL_PARTS];  /* the impulse that MBD's body was given, less that one */
  double got[CPL_PARTS];   /* the impulse that MBD's body was given: the integral of its load [N s, N m s] */
  double late[CPL_PARTS];  /* integral over time of the rate at MBD's end of a window less that at DEM's, the mean of
                            * this  window's and the last one's [m, rad] */
  double jolt[CPL_PARTS];  /* the same of the square of how far off the windows' own defects leave the rate */
  double made;             /* energy that the exchange has made: the work on MBD's body less that of DEM's [J] */
  double slip[CPL_PARTS];  /* the same of the way, from that by which the ends of a window are apart */
} cpl_trace_row;

typedef struct {
  double mass[CPL_PARTS]; /* inertia against each part [kg, kg m2], > 0 */
  tdm_quat axes;          /* turns principal axes into body axes */
  double driven;          /* largest energy that drivers have given or taken since the start; by the caller [J] */
  uint64_t windows;       /* so far */
  uint64_t seen, stride;  /* rows that there were, and how many of them for each that is kept */
  int nrow;
  cpl_trace_row *row;         /* (CPL_TRACE_ROWS) */
  cpl_trace_row last;         /* the last one, kept or not */
  cpl_trace_row end;          /* of the last window */
  double end_late[CPL_PARTS]; /* of the last window alone [m/s, rad/s] */
  double sampled[CPL_PARTS];  /* impulse until the last output time */
  double sample_time;         /* that time [s] */
} cpl_trace;

/* A window of a body. Where its output times lie closer than its ends, rows are theirs. */
typedef struct {
  double t0, t1;                /* [s] */
  const tdm_state *start, *end; /* in MBD */
  const tdm_state *other_end;   /* where DEM's body ends, before it knows MBD's; NULL: it went where MBD's did */
  tdm_wrench found, given;      /* mean loads: as DEM found it, and as MBD got it */
  int nload;                    /* coefficients of the load that MBD got; 0: it was held */
  const tdm_wrench *load;       /* (nload) W(s) = sum_j load[j] s^j, s = (t - t0)/(t1 - t0) */
  double made;                  /* work on the body in MBD less that in DEM [J] */
  int nsample;
  const double *sample_time;     /* (nsample) in (t0, t1] */
  const tdm_state *sample;       /* at these times: entry k is sample[k * stride] */
  const tdm_wrench *sample_load; /* means since the output time before, the same */
  int stride;
} cpl_trace_window;

/* A body of this mass and inertia (about the centre of mass, body axes [kg m2]) at its start: zeros but for these and
 * the first row; false: no memory. Where either says nothing (not finite, or zero) it counts as 1; about an axis
 * without inertia, a rod's own, the mean of the others counts. cpl_trace_free lets go of it in any case. */
bool cpl_trace_init(cpl_trace *trace, double mass, const tdm_mat3 *inertia, const tdm_state *start);
void cpl_trace_free(cpl_trace *trace);

void cpl_trace_add(cpl_trace *trace, const cpl_trace_window *window);

#endif
