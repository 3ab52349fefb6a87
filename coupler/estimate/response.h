/* How the motion of coupled bodies answers to a force that should not act: what the mechanism holds them by, found from
 * their traces, and the particles' part of it (docs/theory/coupling.md, "The error of a run").
 *
 * Parts are ways and turns as in trace.h, of one body or of several that springs, dampers and bushings tie together.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_ESTIMATE_RESPONSE_H
#define CPL_ESTIMATE_RESPONSE_H

#include "coupler/estimate/trace.h"

enum { CPL_RESPONSE_PARTS = 12 };

/* One part of the motion, at the rows of a trace: those that are kept, and the last. */
typedef struct {
  const cpl_trace *trace;
  int k, n; /* which part, rows */
} cpl_part;

cpl_part cpl_part_of(const cpl_trace *trace, int k);
const cpl_trace_row *cpl_part_row(const cpl_part *part, int i);

/* e'' = S'/inertia - C e' - K e */
typedef struct {
  int n;
  double inertia[CPL_RESPONSE_PARTS];                       /* of body and particles [kg, kg m2] */
  double stiffness[CPL_RESPONSE_PARTS][CPL_RESPONSE_PARTS]; /* K, over the inertia of the row [1/s2] */
  double damping[CPL_RESPONSE_PARTS][CPL_RESPONSE_PARTS];   /* C, likewise [1/s] */
} cpl_response;

/* The force that the mechanism exerts on each of n <= CPL_RESPONSE_PARTS parts, less what does not change from one row
 * to the next, as stiffness and damping of all of them [N/m, N s/m, ...]; the traces have the same rows. *known is
 * false, and both are zero, where that force is none of this: stops, cables, friction, drivers, large turns. False: no
 * memory. */
bool cpl_response_mechanism(int n, const cpl_part *part, double stiffness[][CPL_RESPONSE_PARTS],
                            double damping[][CPL_RESPONSE_PARTS], bool *known);

/* Does no error grow by more than e over this time [s]? False without memory as well. */
bool cpl_response_stable(const cpl_response *response, double time);

/* Errors are carried on over rows by the exact solution for a force that is constant from row to row. */
typedef struct cpl_carrier cpl_carrier;

/* NULL: no memory; cpl_carrier_destroy sets *carrier to NULL. */
cpl_carrier *cpl_carrier_create(const cpl_response *response);
void cpl_carrier_destroy(cpl_carrier **carrier);

/* e (2 n: the ways, then the rates) over h [s], while the impulses `impulse` (n) come. */
void cpl_carrier_go(cpl_carrier *carrier, double h, const double *impulse, double *e);

#endif
